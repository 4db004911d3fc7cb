"""Table I lies in the posterior."""

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.optimize import lsq_linear

from bayesfric.claims.base import Case, Claim, Finding, Verdict
from bayesfric.evidence import savage_dickey
from bayesfric.likelihood.coefficients import coefficient_parameters
from bayesfric.paper import table1
from bayesfric.priors import log_density

Array = NDArray[np.float64]
LN10 = float(np.log(10))


def tail_probability(draws: Array, point: Array, rounding: Array) -> float:
    """Return how likely a draw is further out than the nearest point that rounds alike.

    Parameters
    ----------
    draws : ndarray, shape (S, d)
        Of a distribution that is close to normal.
    point, rounding : ndarray, shape (d,)
        A printed point and half a unit of the last digit of each number.

    Returns
    -------
    float
        Of a χ² with d degrees of freedom, at the squared Mahalanobis distance.
    """
    root = np.linalg.cholesky(np.atleast_2d(np.cov(draws, rowvar=False)))
    white = np.linalg.solve(root, np.diag(rounding))
    off = np.linalg.solve(root, draws.mean(axis=0) - point)
    nearest = lsq_linear(white, off, bounds=(-1, 1))
    return float(stats.chi2(point.size).sf(2 * nearest.cost))


def _judge(claim: Claim, case: Case) -> Finding:
    """Weigh Table I against all other values by the Savage–Dickey ratio."""
    board = "gravity" if "gravity" in case.data else "motor"
    sizes = [size for size in case.data[board].sizes if size in table1()]
    if not sizes:
        return Finding("not-testable", "The recording has no pulley size of Table I.")
    theta = case.baseline(board)  # type: ignore[arg-type]
    parameters = coefficient_parameters(tuple(sizes), case.analysis)
    printed = [getattr(table1()[p.name[3:-1]], p.name[:2]) for p in parameters]
    point = np.array([number.value for number in printed])
    rounding = np.array([number.rounding for number in printed])
    draws = np.stack([theta[p.name] for p in parameters], axis=1)
    # The printed point stands for all that round to it: draws moved by as much have, at
    # the point, the mean density over those.
    rng = np.random.default_rng([case.analysis.seed, 9])
    moved = draws + rng.uniform(-rounding, rounding, draws.shape)
    prior = [log_density(p.prior, value) for p, value in zip(parameters, point, strict=True)]
    ratio = savage_dickey(moved, point, float(np.sum(prior)))
    tail = tail_probability(draws, point, rounding)
    rules = case.analysis.claims
    log10 = ratio.log_evidence / LN10
    verdict: Verdict = "undecided"
    reason = f"Table I is within the posterior (tail probability {tail:.2g})"
    if tail < rules.refute_tail_probability:
        verdict = "refuted"
        reason = f"So far from Table I is a part of {tail:.1g} of the posterior, or less"
    elif log10 >= rules.support_log10_bayes_factor:
        verdict = "supported"
    figures: dict[str, float | str] = {"joint_tail_probability": tail, "method": ratio.method}
    for p, column, value in zip(parameters, draws.T, point, strict=True):
        figures[f"{p.name}_over_table1"] = float(column.mean() / value)
        figures[f"{p.name}_relative_sd"] = float(column.std() / abs(value))
    return Finding(
        verdict,
        f"{reason}; the Bayes factor in favour of it is 10^{log10:.1f}.",
        figures,
        log10,
        ratio.error / LN10,
        why="prediction is not what this claim is about",
    )


CLAIM = Claim(
    name="coefficients",
    place=8,
    statement="The coefficients are those of Table I.",
    paper="Table I, as printed.",
    judge=_judge,
    board="gravity",
)
