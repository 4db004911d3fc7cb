"""Table I lies in the posterior, and the posterior is narrow enough for this statement."""

from collections.abc import Mapping

import numpy as np
import scipy

from bayesfric.analysis import ClaimRules
from bayesfric.arrays import Array
from bayesfric.claims.base import Case, Claim, Finding, Verdict
from bayesfric.claims.odds import share
from bayesfric.effects import all_effects
from bayesfric.fitting.hypothesis import model_of
from bayesfric.inference.informed import informed_by_data
from bayesfric.observation.coefficients import coefficient_parameters
from bayesfric.paper import paper, table1
from bayesfric.physics.friction import Coefficients, coulomb_friction
from bayesfric.physics.laws import BASELINES
from bayesfric.probabilities import stated

LEAST_TENSION_N = 5.0  # Table II names no lower bound; the paper's lightest weights give more


def tail_probability(draws: Array, point: Array, rounding: Array) -> float:
    """Return the tail probability of the nearest point that rounds to a printed point.

    Parameters
    ----------
    draws : ndarray, shape (S, d)
        Draws of a nearly normal distribution.
    point, rounding : ndarray, shape (d,)
        A printed point and half a unit of the last digit of each number.

    Returns
    -------
    float
        Tail of a χ² with d degrees of freedom, at the squared Mahalanobis distance.
    """
    root = np.linalg.cholesky(np.atleast_2d(np.cov(draws, rowvar=False)))
    white = np.linalg.solve(root, np.diag(rounding))
    off = np.linalg.solve(root, draws.mean(axis=0) - point)
    nearest = scipy.optimize.lsq_linear(white, off, bounds=(-1, 1))
    return float(scipy.special.chdtrc(point.size, 2 * nearest.cost))


def largest_difference(theta: Mapping[str, Array], sizes: list[str]) -> Array:
    """Return the largest relative difference of Table I's friction, over sizes and Table II.

    The relative difference has its extremes at the corners of the tested range, where
    tension and wrap angle are least or most; the number of pulleys cancels.

    Parameters
    ----------
    theta : mapping of str to ndarray of shape (S,)
        Draws of the coefficients.
    sizes : list of str
        Sizes of Table I.

    Returns
    -------
    ndarray, shape (S,)
        Difference relative to the friction of each draw.
    """
    tested = paper()["table2"]
    off = []
    for size in sizes:
        row = table1()[size]
        law = Coefficients(*(theta[f"{name}[{size}]"] for name in Coefficients._fields))
        printed = Coefficients(row.c1.value, row.c2.value, row.c3.value)
        for tension in (LEAST_TENSION_N, tested["tension_max_n"]):
            for wrap in tested["average_wrap_angle_deg"]:
                condition = (1.0, wrap, tension)
                ratio = coulomb_friction(printed, *condition) / coulomb_friction(law, *condition)
                off.append(np.abs(ratio - 1))
    return np.asarray(np.max(off, axis=0))


def decide(
    rules: ClaimRules, tail: float, probability: float, uninformed: list[str]
) -> tuple[Verdict, str]:
    """Return the verdict of the rules and the reason.

    Parameters
    ----------
    rules : ClaimRules
        Thresholds.
    tail : float
        Joint tail probability of Table I.
    probability : float
        Probability that friction by Table I is within the tolerance over the tested range.
    uninformed : list of str
        Coefficients that rest on their priors.
    """
    within = (
        f"in the range of Table II, friction by Table I is within {share(rules.table1_tolerance)} "
        f"of the posterior's with probability {stated(probability)}"
    )
    if tail < rules.refute_tail_probability:
        out = f"Table I is far out in the tail (joint tail probability {tail:.1g}); {within}."
        refuted = probability <= rules.refute_probability
        return ("refuted" if refuted else "undecided"), out
    inside = f"Table I lies within the posterior (joint tail probability {tail:.2f})"
    if uninformed:
        names = ", ".join(uninformed)
        return "undecided", f"{inside}, but the prior, not these data, determines {names}."
    if probability >= rules.support_probability:
        return "supported", f"{inside}; {within}."
    return "undecided", f"{inside}, which is too wide to decide: {within}."


def _judge(claim: Claim, case: Case) -> Finding:
    """Judge whether Table I fits, and whether the data determine it narrowly enough."""
    if lack := claim.untestable(case.entered):
        return Finding("not-testable", lack)
    if BASELINES[case.entered.law].without:
        return Finding("not-testable", "The law that was chosen lacks coefficients of Table I.")
    name = claim.subject(case.entered)
    data = case.entered.data[name]
    sizes = [size for size in data.sizes if size in table1()]
    if not sizes:
        return Finding("not-testable", "The recording has no pulley size of Table I.")
    if undrawn := case.undrawn(name):
        return undrawn
    theta = case.draws(name)
    parameters = coefficient_parameters(tuple(sizes), case.analysis)
    printed = [getattr(table1()[p.name[3:-1]], p.name[:2]) for p in parameters]
    point = np.array([number.value for number in printed])
    rounding = np.array([number.rounding for number in printed])
    draws = np.stack([theta[p.name] for p in parameters], axis=1)
    tail = tail_probability(draws, point, rounding)
    off = largest_difference(theta, sizes)
    rules = case.analysis.claims
    probability = float((off <= rules.table1_tolerance).mean())
    model = model_of(data, case.analysis, case.entered.claimed, all_effects())
    whole = np.stack([theta[parameter] for parameter in model.names], axis=1)
    informed = dict(zip(model.names, informed_by_data(model, whole), strict=True))
    uninformed = [p.name for p in parameters if not informed[p.name]]
    figures: dict[str, float | str] = {
        "joint_tail_probability": tail,
        "probability_within_tolerance": probability,
        "largest_difference_q95": float(np.quantile(off, 0.95)),
        "uninformed": ", ".join(uninformed),
    }
    for p, column, value in zip(parameters, draws.T, point, strict=True):
        figures[f"{p.name}_over_table1"] = float(column.mean() / value)
        figures[f"{p.name}_relative_sd"] = float(column.std() / abs(value))
    verdict, reason = decide(rules, tail, probability, uninformed)
    # A Bayes factor against free coefficients would depend mainly on the width of the priors.
    return Finding(verdict, reason, figures, why="the claim rests on a probability")


CLAIM = Claim(
    name="coefficients",
    place=10,
    statement="The coefficients are those of Table I of the paper (Miyasaka et al. 2015).",
    paper="Table I, as printed.",
    judge=_judge,
    regime="accelerated",
    instead="steady",
    by_size=False,
)
