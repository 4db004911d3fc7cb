"""Coverage on boards whose constant friction scatters from assembly to assembly.

`quick` recordings of Table I, of which only scatter and noise are drawn anew; the posteriors
are those of a fit with the default analysis, of fewer draws. The levels take turns, so that
a campaign that is stopped has as many of each. Runs so short do not pass the rule by which a
fit counts as converged; the largest R-hat is among the figures.
"""

import numpy as np
from campaigns.evidence import Gathered
from campaigns.promises import Outcome
from scipy.stats import beta
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis, CalibrationRules
from bayesfric.campaign import run_on_processes
from bayesfric.fitting.drawing import draw_posterior
from bayesfric.inference.diagnostics import diagnose_all
from bayesfric.inference.model import Model
from bayesfric.rigs.opening import open_rigs
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

FINGERPRINT = ("simulators", "likelihood.gravity", "fit.gravity")
LEVELS = (0.0, 0.07, 0.15)
SEEDS = range(40_000, 40_200)
COVERED = (0.05, 0.95)  # ranks inside the interval of 90 %
BOUNDS = (0.85, 0.95)


def cases(seeds=SEEDS):
    """Return the cases by name, in their order."""
    return {f"{seed}-{int(100 * level):02d}": (seed, level) for seed in seeds for level in LEVELS}


def case(given):
    """Fit one recording; say where each coefficient of Table I lies in its posterior.

    Parameters
    ----------
    given : (int, float)
        Seed of the recording, and by which share c2 scatters.
    """
    seed, level = given
    truth = Truth(omega_intercept=level)
    recording = simulate_recording("quick", seed=seed, truth=truth, rigs=("gravity",))
    analysis = Analysis(seed=seed, sampler=CalibrationRules().sampler)
    with threadpool_limits(limits=1):
        model = Model([rig.likelihood(analysis) for rig in open_rigs(recording, ["gravity"])])
        theta = model.natural(draw_posterior(model, analysis).z)
    named = model.by_name(theta.reshape(-1, theta.shape[-1]))
    ranks = {
        f"{name}[{size}]": float((named[f"{name}[{size}]"] < value).mean())
        for size, law in table1_coefficients().items()
        for name, value in law._asdict().items()
    }
    r_hat = max(diagnostic.r_hat for diagnostic in diagnose_all(theta))
    return {"seed": seed, "level": level, "r_hat": r_hat, "ranks": ranks}


def figures(done):
    """Return by level and coefficient the coverage of 90 % intervals, with 95 % bounds.

    The three sizes of one recording share their scatter: bounds are those of so many
    recordings, not of three times as many.
    """
    by_level = {level: [record for record in done if record["level"] == level] for level in LEVELS}
    return {f"{level:g}": coverage(records) for level, records in by_level.items()}


def coverage(records):
    """Return the coverage of c1, c2, c3 over some recordings, with 95 % bounds."""
    entry = {
        "recordings": len(records),
        "largest_r_hat": max(record["r_hat"] for record in records),
    }
    for name in ("c1", "c2", "c3"):
        ranks = np.array(
            [
                [r for key, r in record["ranks"].items() if key.startswith(name)]
                for record in records
            ]
        )
        inside = ((ranks > COVERED[0]) & (ranks < COVERED[1])).mean(axis=1)
        hits, count = float(inside.sum()), len(records)
        entry[name] = {
            "coverage": hits / count,
            "low": float(beta.ppf(0.025, hits, count - hits + 1)) if hits else 0.0,
            "high": float(beta.ppf(0.975, hits + 1, count - hits)) if hits < count else 1.0,
        }
    return entry


def coverage_as_promised(words, entry):
    """Return the promised coverage of each coefficient beside the one that was found."""
    return [
        Outcome(
            f"{words}: 90 % intervals of {name} hold it",
            entry[name]["coverage"],
            *BOUNDS,
            entry[name]["low"],
            entry[name]["high"],
            n=entry["recordings"],
        )
        for name in ("c1", "c2", "c3")
    ]


def gather(folder):
    """Run the campaign."""
    done = list(run_on_processes(case, cases(), folder, workers=2).values())
    return Gathered(
        seeds=[SEEDS.start, SEEDS.stop - 1],
        figures=figures(done),
        cases=done,
        fixed=[record for record in done if record["seed"] == SEEDS.start],
    )


def promises(figures):
    """Return what was promised beside what was found."""
    levels = (coverage_as_promised(f"c2 scatters by {level}", figures[level]) for level in figures)
    return [outcome for outcomes in levels for outcome in outcomes]
