"""Near-threshold boards, a fifth of whose trials stay at rest: bias with and without these.

Friction is so much above the one that the masses were chosen for that the slower trials of
each condition hardly move, or do not. The same recordings are weighed with the trials that
did not move and, as a rule that leaves them out would have it, without. Posteriors are by
importance sampling around the mode, or chains where no sample is to be relied on.
"""

import numpy as np

from bayesfric.analysis import Analysis, Sampler
from bayesfric.fitting.hypothesis import Hypothesis, chart_of, model_of
from bayesfric.inference.evidence import importance_draws
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.sampling import sample
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import open_rigs
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

RIGS = ("gravity_board",)
SEEDS = range(60)
MORE_FRICTION = 1.5
LAWS = {
    size: Coefficients(*(MORE_FRICTION * value for value in law))
    for size, law in table1_coefficients().items()
}
DRAWS = 2000


def case(seed):
    """Weigh one recording with and without its stalls.

    Parameters
    ----------
    seed : int
        Of the recording.

    Returns
    -------
    dict
        Share of trials at rest, and of each coefficient its mean less the truth and sd.
    """
    truth = Truth(coefficients=LAWS, tau=0.02, omega=0.03, omega_intercept=0.05)
    recording = simulate_recording("quick", seed=seed, truth=truth, rigs=("gravity",))
    (whole,) = open_rigs(recording, ["gravity"])
    moved = whole.moved() or whole
    trials = recording.gravity.trials
    still = float((trials["did_not_move"] == "true").mean()) if "did_not_move" in trials else 0.0
    return {
        "seed": seed,
        "at_rest": still,
        "with": posterior(whole, seed),
        "without": posterior(moved, seed),
    }


def posterior(trials, seed):
    """Return mean less truth and sd of each coefficient, and the Pareto k of any weights."""
    model = model_of(Data((trials,)), Analysis(), Hypothesis(), {})
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    weighed = importance_draws(model.log_posterior, laplace, seed, chart_of(model), DRAWS)
    if weighed is None:  # weights with heavy tails: chains, as the claims take them
        density, chart = model.log_posterior, chart_of(model)
        z = sample(density, laplace, Sampler(), seed, chart=chart).z
        found = {"pareto_k": None}
    else:
        evidence, z = weighed
        found = {"pareto_k": evidence.pareto_k}
    named = model.by_name(model.natural(z.reshape(-1, z.shape[-1])))
    for size, law in LAWS.items():
        for name, value in law._asdict().items():
            draws = named[f"{name}[{size}]"]
            found[f"{name}[{size}]"] = {
                "error": float(draws.mean() - value),
                "sd": float(draws.std()),
            }
    return found


def bias(cases, which):
    """Return the mean error over posterior sd of c1 and c2 over sizes, and its standard error.

    The sizes of a recording share its scatter, so recordings are the unit.
    """
    found = {}
    for name in ("c1", "c2"):
        each = np.array(
            [
                np.mean(
                    [
                        one[which][f"{name}[{size}]"]["error"] / one[which][f"{name}[{size}]"]["sd"]
                        for size in LAWS
                    ]
                )
                for one in cases
            ]
        )
        error = each.std(ddof=1) / np.sqrt(each.size) if each.size > 1 else float("nan")
        found[name] = {"bias_in_sd": float(each.mean()), "standard_error": float(error)}
    return found
