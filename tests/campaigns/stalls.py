"""Near-threshold boards, a fifth of whose trials stay at rest: bias with and without these.

Friction is so much above the one that the masses were chosen for that the slower trials of
each condition hardly move, or do not. The same recordings are weighed with the trials that
did not move and, as a rule that leaves them out would have it, without. Posteriors are by
importance sampling around the mode, or chains where no sample is to be relied on.
"""

import numpy as np
from campaigns.evidence import Gathered
from campaigns.promises import Outcome

from bayesfric.analysis import Analysis, Sampler
from bayesfric.campaign import run_on_processes
from bayesfric.fitting.hypothesis import LawWithEffects, chart_of, model_of
from bayesfric.inference.evidence.importance import importance_draws
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.sampling import sample
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import open_rigs
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

FINGERPRINT = ("simulators", "likelihood.gravity", "evidence")
SEEDS = range(60)
FIXED_SEEDS = range(4)  # that the nightly job repeats
LARGEST_BIAS = 0.2  # of a posterior sd
AT_REST = 0.15, 0.3  # share of trials, by which the boards are near the threshold
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
    model = model_of(Data((trials,)), Analysis(), LawWithEffects(), {})
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    weighed = importance_draws(model.log_posterior, laplace, seed, chart_of(model), DRAWS)
    if weighed is None:  # weights with heavy tails: chains, as the claims take them
        density, chart = model.log_posterior, chart_of(model)
        z = sample(density, laplace, Sampler(), seed, chart=chart).z
        errors = {"pareto_k": None}
    else:
        evidence, z = weighed
        errors = {"pareto_k": evidence.pareto_k}
    named = model.by_name(model.natural(z.reshape(-1, z.shape[-1])))
    for size, law in LAWS.items():
        for name, value in law._asdict().items():
            draws = named[f"{name}[{size}]"]
            errors[f"{name}[{size}]"] = {
                "error": float(draws.mean() - value),
                "sd": float(draws.std()),
            }
    return errors


def bias(cases, which):
    """Return the mean error over posterior sd of c1 and c2 over sizes, and its standard error.

    The sizes of a recording share its scatter, so recordings are the unit.
    """
    biases = {}
    for name in ("c1", "c2"):
        offsets = np.array(
            [
                np.mean(
                    [
                        record[which][f"{name}[{size}]"]["error"]
                        / record[which][f"{name}[{size}]"]["sd"]
                        for size in LAWS
                    ]
                )
                for record in cases
            ]
        )
        error = offsets.std(ddof=1) / np.sqrt(offsets.size) if offsets.size > 1 else float("nan")
        biases[name] = {"bias_in_sd": float(offsets.mean()), "standard_error": float(error)}
    return biases


def run(seeds, folder):
    """Weigh some recordings."""
    cases = {f"{seed:04d}": seed for seed in seeds}
    return list(run_on_processes(case, cases, folder, workers=2).values())


def gather(folder):
    """Run the campaign."""
    done = run(SEEDS, folder)
    at_rest = sum(record["at_rest"] for record in done) / len(done)
    figures = {"recordings": len(done), "share_at_rest": at_rest}
    return Gathered(
        seeds=[SEEDS.start, SEEDS.stop - 1],
        figures=figures | {which: bias(done, which) for which in ("with", "without")},
        cases=done,
        fixed=[record for record in done if record["seed"] in FIXED_SEEDS],
    )


def promises(figures):
    """Return what was promised beside what was found."""
    return [
        Outcome("share of trials that stay at rest", figures["share_at_rest"], *AT_REST),
        *(
            Outcome(
                f"bias of {name} over {figures['recordings']} recordings, in posterior sd",
                bias_of["bias_in_sd"],
                -LARGEST_BIAS,
                LARGEST_BIAS,
                bias_of["bias_in_sd"] - 1.96 * bias_of["standard_error"],
                bias_of["bias_in_sd"] + 1.96 * bias_of["standard_error"],
            )
            for name, bias_of in figures["with"].items()
        ),
    ]
