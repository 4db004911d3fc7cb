"""Runs of samplers on one posterior to figures, and figures to targets."""

import numpy as np
from arviz_stats.base.array import array_stats

from bayesfric.inference.diagnostics import diagnose_draws

GOALS = {"warm": 5.0, "cold": 10.0, "limit": 0.5, "z": 3.0}
CONVERGED = 1.05  # R-hat; a peer whose chains differ by more is told, and not compared with
WANTED = 4000  # effective draws, from a cold start


def figures_of(run, coefficients):
    """Return what one run of a sampler achieved.

    Parameters
    ----------
    run : mapping of str to ndarray
        As :mod:`benchmark.peers` or :mod:`benchmark.ours` stores it.
    coefficients : int
        How many of the first parameters are coefficients of the law.

    Returns
    -------
    dict of str to float
        Effective draws of the worst coefficient, these a second of sampling alone, and the
        seconds to 4,000 of them, all that comes before included. Processor time.
    """
    theta, seconds = run["theta"], float(run["seconds"])
    if "weights" in run:
        effective = 1 / float((run["weights"] ** 2).sum())
    else:
        effective = min(_effective(theta[..., place]) for place in range(coefficients))
    rate = effective / seconds
    return {
        "effective_draws": effective,
        "per_second": rate,
        "cold_s": float(run["before"]) + WANTED / rate,
        "r_hat": max(_r_hat(theta[..., place]) for place in range(theta.shape[-1])),
    }


def _effective(draws):
    if draws.ndim == 3:  # ensembles, whose walkers depend on one another
        return diagnose_draws(draws).ess_bulk
    return float(array_stats.ess(draws, method="bulk"))


def _r_hat(draws):
    if draws.ndim == 1:  # independent draws
        return 1.0
    return float(array_stats.rhat(draws.reshape(len(draws), -1)))


def moments(run):
    """Return means and standard deviations with their Monte Carlo errors, (2, D) each."""
    theta = run["theta"]
    if "weights" in run:
        return _weighted_moments(theta, run["weights"])
    values, errors = [], []
    for place in range(theta.shape[-1]):
        draws = theta[..., place]
        chains = draws
        if draws.ndim == 3:
            chains = draws.transpose(0, 2, 1).reshape(-1, draws.shape[1])
        values.append([draws.mean(), draws.std()])
        errors.append([draws.std() / np.sqrt(_effective(draws)), _sd_error(chains)])
    return np.transpose(values), np.transpose(errors)


def _weighted_moments(theta, weights):
    """Return the same of independent draws with weights that sum to one (Geweke 1989)."""
    mean = weights @ theta
    square = (theta - mean) ** 2
    sd = np.sqrt(weights @ square)
    error = np.sqrt(weights**2 @ square)
    sd_error = np.sqrt(weights**2 @ (square - sd**2) ** 2) / (2 * sd)
    return np.array([mean, sd]), np.array([error, sd_error])


def _sd_error(chains):
    return float(array_stats.mcse(chains, method="sd"))


def largest_z(ours, other):
    """Return the largest difference of a mean or a standard deviation in Monte Carlo errors."""
    (first, error), (second, theirs) = moments(ours), moments(other)
    return float(np.abs((first - second) / np.hypot(error, theirs)).max())


def pooled(runs):
    """Return the draws of repeats, each of a seed of its own, as those of one run."""
    whole = {"theta": np.concatenate([run["theta"] for run in runs])}
    if "weights" in runs[0]:
        whole["weights"] = np.concatenate([run["weights"] for run in runs]) / len(runs)
    return whole


def spread(values):
    """Return the median and the range of repeats."""
    return {
        "median": float(np.median(values)),
        "lowest": float(np.min(values)),
        "highest": float(np.max(values)),
    }


def targets(problem, by_sampler, z):
    """Return the targets of one posterior.

    Parameters
    ----------
    problem : str
        Its name.
    found : dict of str to dict of str to dict
        Sampler and figure to median and range; ``ours``, ``limit`` and peers.
    z : dict of str to float
        Limit or peer to the largest difference from ours.
    """
    ours = by_sampler["ours"]
    peers = {
        name: figures
        for name, figures in by_sampler.items()
        if name not in ("ours", "limit") and figures["r_hat"]["highest"] < CONVERGED
    }
    rows = []
    if peers:
        fastest = max(peers, key=lambda peer: peers[peer]["per_second"]["median"])
        soonest = min(peers, key=lambda peer: peers[peer]["cold_s"]["median"])
        warm = ours["per_second"]["median"], peers[fastest]["per_second"]["median"]
        cold = ours["cold_s"]["median"], peers[soonest]["cold_s"]["median"]
        rows = [
            _row(f"{problem}: draws a second, {fastest}", *warm, warm[0] / warm[1], "warm"),
            _row(f"{problem}: seconds from cold, {soonest}", *cold, cold[1] / cold[0], "cold"),
        ]
    bound = ours["per_second"]["median"], by_sampler["limit"]["per_second"]["median"]
    rows.append(_row(f"{problem}: share of the limit", *bound, bound[0] / bound[1], "limit"))
    rows += [
        {
            "name": f"{problem}: agreement with {peer}, largest difference in errors",
            "ours": None,
            "peer": None,
            "ratio": value,
            "goal": GOALS["z"],
            "met": value < GOALS["z"],
        }
        for peer, value in z.items()
        if peer in peers or peer == "limit"
    ]
    return rows


def _row(name, ours, peer, ratio, goal):
    return at_least(name, ours, peer, ratio, GOALS[goal])


def at_least(name, ours, peer, ratio, goal):
    """Return the row of a ratio that is not to be less than its goal."""
    return {
        "name": name,
        "ours": ours,
        "peer": peer,
        "ratio": float(ratio),
        "goal": goal,
        "met": bool(ratio >= goal),
    }


def within(name, ours, limit):
    """Return the row of a figure that is not to exceed a limit: its share of it is the ratio."""
    return {
        "name": name,
        "ours": float(ours),
        "peer": limit,
        "ratio": float(ours / limit),
        "goal": 1.0,
        "met": bool(ours <= limit),
    }
