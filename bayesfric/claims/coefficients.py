"""Table I lies in the posterior."""

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.optimize import lsq_linear

from bayesfric.claims.base import Case, Claim, Finding, Verdict
from bayesfric.claims.comparison import odds, share
from bayesfric.claims.studies import Task
from bayesfric.fitting.hypothesis import Hypothesis
from bayesfric.paper import table1
from bayesfric.rigs.coefficients import coefficient_parameters

Array = NDArray[np.float64]
LN10 = float(np.log(10))
PRINTED = Hypothesis(printed=True)


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
    """Weigh Table I, rounding included, against all that the priors allow."""
    if lack := claim.untestable(case.entered):
        return Finding("not-testable", lack)
    name = claim.rig(case.entered)
    sizes = [size for size in case.entered.data[name].sizes if size in table1()]
    if not sizes:
        return Finding("not-testable", "The recording has no pulley size of Table I.")
    theta = case.baseline(name)
    parameters = coefficient_parameters(tuple(sizes), case.analysis)
    printed = [getattr(table1()[p.name[3:-1]], p.name[:2]) for p in parameters]
    point = np.array([number.value for number in printed])
    rounding = np.array([number.rounding for number in printed])
    draws = np.stack([theta[p.name] for p in parameters], axis=1)
    tail = tail_probability(draws, point, rounding)
    figures: dict[str, float] = {"joint_tail_probability": tail}
    for p, column, value in zip(parameters, draws.T, point, strict=True):
        figures[f"{p.name}_over_table1"] = float(column.mean() / value)
        figures[f"{p.name}_relative_sd"] = float(column.std() / abs(value))
    hypotheses = (case.entered.baseline, *claim.against(case.entered))
    own, narrow = (case.studied[Task(name, one)] for one in hypotheses)
    log10, error, why = None, None, own.why or narrow.why
    if own.evidence is not None and narrow.evidence is not None:
        log10 = (narrow.evidence.log_evidence - own.evidence.log_evidence) / LN10
        error = float(np.hypot(own.evidence.error, narrow.evidence.error)) / LN10
    rules = case.analysis.claims
    verdict: Verdict = "undecided"
    if tail < rules.refute_tail_probability:
        verdict = "refuted"
        reason = f"Table I is far out in the posterior (joint tail probability {tail:.1g})"
    else:
        reason = f"Table I lies within the posterior (joint tail probability {tail:.2f})"
        if log10 is not None and log10 >= rules.support_log10_bayes_factor:
            verdict = "supported"
    weight = "" if log10 is None else f"; its odds against other values are {odds(log10)}"
    width = max(value for name, value in figures.items() if name.endswith("_relative_sd"))
    return Finding(
        verdict,
        f"{reason}{weight}. The widest coefficient is known to {share(width)}.",
        figures,
        log10,
        error,
        why=why or "prediction is not what this claim is about",
    )


CLAIM = Claim(
    name="coefficients",
    place=8,
    statement="The coefficients are those of Table I.",
    paper="Table I, as printed.",
    judge=_judge,
    motion="accelerated",
    rivals=(PRINTED,),
    by_size=False,
)
