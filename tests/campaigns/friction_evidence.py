"""Evidence of friction models by bridge sampling, against very large importance samples."""

from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis, Sampler
from bayesfric.effects import all_effects
from bayesfric.fitting.hypothesis import Hypothesis, chart_of, model_of
from bayesfric.inference.evidence import bridge_evidence, importance_draws, in_one_place
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.sampling import sample
from bayesfric.rigs import all_rigs
from bayesfric.rigs.data import Data
from bayesfric.simulate import simulate_recording

RIGS = ("gravity_board",)
SEED = 3
DRAWS = 300_000
HYPOTHESES = {
    "paper": Hypothesis(),
    "viscous": Hypothesis(effects=(("viscous", "constant"),)),
    "tension-curvature": Hypothesis(effects=(("tension-curvature", "quadratic"),)),
}


def case(name):
    """Return both log evidences of a hypothesis on one `quick` recording."""
    recording = simulate_recording("quick", seed=SEED, rigs=("gravity",))
    data = Data((all_rigs()["gravity"].trials(recording),))
    settings = Sampler(burn=30, steps=120, thin=3)
    with threadpool_limits(1):
        model = model_of(data, Analysis(), HYPOTHESES[name], all_effects())
        density = model.log_posterior
        laplace = laplace_approximation(density, model.start(), model.scale())
        draws = sample(density, laplace, settings, SEED, converged=in_one_place)
        bridge = bridge_evidence(density, draws.z, SEED)
        large, _ = importance_draws(density, laplace, SEED + 1, chart_of(model), DRAWS)
    return {
        "hypothesis": name,
        "bridge": bridge.log_evidence,
        "bridge_error": bridge.error,
        "importance": large.log_evidence,
        "importance_error": large.error,
        "pareto_k": large.pareto_k,
    }
