"""Recovery of Table I from simulated `quick` recordings: one case, and the coverage."""

import numpy as np

from bayesfric.fitting.posterior import fit
from bayesfric.simulate import simulate_recording, table1_coefficients

RIGS = ("gravity_board", "motor_board")
SEEDS = range(100)
LEVELS = {"50": (0.25, 0.75), "90": (0.05, 0.95)}


def case(seed):
    """Fit one recording; say where the truth lies in each posterior."""
    result = fit(simulate_recording("quick", seed=seed))
    posterior = result.draws["posterior"]
    figures = {}
    for size, law in table1_coefficients().items():
        for name, truth in law._asdict().items():
            draws = posterior[name].sel(pulley=size).to_numpy()
            summary = result.summary.pulleys[size][name]
            figures[f"{name}[{size}]"] = {
                "rank": float((draws < truth).mean()),
                "mean": summary.mean,
                "sd": summary.sd,
                "mcse": summary.mcse_mean,
            }
    return {"seed": seed, "converged": result.summary.converged, "coefficients": figures}


def coverage(cases):
    """Coverage of each interval with 99 % bounds by a bootstrap over recordings.

    The nine coefficients of one recording share their scatter, so recordings are
    what is redrawn. The bounds are those that an exact interval would show: the
    bootstrap distribution of the coverage, moved to the nominal level.
    """
    ranks = np.array([[f["rank"] for f in case["coefficients"].values()] for case in cases])
    rng = np.random.default_rng(99)
    redraw = rng.integers(0, len(ranks), (20_000, len(ranks)))
    found = {}
    for level, (low, high) in LEVELS.items():
        by_recording = ((ranks > low) & (ranks < high)).mean(axis=1)
        redrawn = by_recording[redraw].mean(axis=1) - by_recording.mean()
        bounds = float(int(level) / 100) + np.quantile(redrawn, [0.005, 0.995])
        found[level] = {
            "coverage": float(by_recording.mean()),
            "bounds": [float(bounds[0]), float(bounds[1])],
        }
    return found
