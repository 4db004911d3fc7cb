"""Evidence of friction models by bridge sampling, against very large importance samples."""

import numpy as np
from campaigns.evidence import Gathered
from campaigns.promises import Outcome
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis, Sampler
from bayesfric.effects import all_effects
from bayesfric.fitting.hypothesis import LawWithEffects, chart_of, model_of
from bayesfric.inference.evidence.bridge import bridge_evidence, in_one_place
from bayesfric.inference.evidence.importance import importance_draws
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.sampling import sample
from bayesfric.rigs import all_rigs
from bayesfric.rigs.data import Data
from bayesfric.simulate import simulate_recording

FINGERPRINT = ("simulators", "likelihood.gravity", "evidence")
SEED = 3
DRAWS = 300_000
LARGEST_DIFFERENCE = 3.0  # errors
LARGEST_K = 0.7
FIXED = "paper"  # what the nightly job repeats
HYPOTHESES = {
    "paper": LawWithEffects(),
    "viscous": LawWithEffects(effects=(("viscous", "constant"),)),
    "tension-curvature": LawWithEffects(effects=(("tension-curvature", "quadratic"),)),
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


def figures(done):
    """Return by hypothesis how far the two evidences differ, with the error of it."""
    return {
        record["hypothesis"]: {
            "difference_nat": record["bridge"] - record["importance"],
            "error_nat": float(np.hypot(record["bridge_error"], record["importance_error"])),
            "pareto_k": record["pareto_k"],
        }
        for record in done
    }


def gather(folder):
    """Run the campaign."""
    done = [case(name) for name in HYPOTHESES]
    fixed = [record for record in done if record["hypothesis"] == FIXED]
    return Gathered([SEED], figures(done), done, fixed)


def promises(figures):
    """Return what was promised beside what was found."""
    return [
        outcome
        for name, entry in figures.items()
        for outcome in (
            Outcome(
                f"{name}: bridge less importance sample, in errors",
                entry["difference_nat"] / entry["error_nat"],
                -LARGEST_DIFFERENCE,
                LARGEST_DIFFERENCE,
            ),
            Outcome(
                f"{name}: Pareto k of the importance sample", entry["pareto_k"], most=LARGEST_K
            ),
        )
    ]
