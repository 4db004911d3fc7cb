"""The two rigs agree."""

import numpy as np
import pandas as pd

from bayesfric.analysis import ClaimRules
from bayesfric.arrays import Array
from bayesfric.claims.apart import differences
from bayesfric.claims.base import Case, Claim, Finding, verdict_by
from bayesfric.claims.odds import share
from bayesfric.claims.studies import Task
from bayesfric.probabilities import stated


def agree(rules: ClaimRules, off: Array) -> Array:
    """Return for each draw whether the conditions lie within the paper's two tolerances.

    Parameters
    ----------
    rules : ClaimRules
        Contains the tolerance of all conditions, and that of most conditions.
    off : ndarray, shape (C, S)
        Relative difference of each condition and draw.

    Returns
    -------
    ndarray of bool, shape (S,)
    """
    all_within = (np.abs(off) <= rules.rig_tolerance).all(axis=0)
    return np.asarray(np.logical_and(most_within(rules, off), all_within))


def most_within(rules: ClaimRules, off: Array) -> Array:
    """Return for each draw whether most conditions lie within the narrower tolerance, (S,)."""
    return np.asarray((np.abs(off) <= rules.rig_usual_tolerance).mean(axis=0) > 0.5)


def difference_of_conditions(claim: Claim, case: Case) -> Array | Finding:
    """Return the relative difference of each condition and draw, or a finding without one.

    Parameters
    ----------
    claim : Claim
        About two rigs.
    case : Case
        Of a recording.

    Returns
    -------
    ndarray, shape (C, S), or Finding
    """
    if lack := claim.untestable(case.entered):
        return Finding("not-testable", lack)
    *_, task = claim.tasks(case.entered)
    studied = case.studied[task]
    if not studied.theta:
        return Finding("undecided", f"The posterior could not be drawn: {studied.why}.")
    sizes = _conditions(case, task)
    by_size = differences(studied.theta, tuple(sizes.unique()))
    return np.array([by_size[size] for size in sizes])


def _conditions(case: Case, task: Task) -> "pd.Series[str]":
    """Return the pulley size of each condition of the second rig."""
    _, second = case.entered.data[task.data].rigs
    condition = ["pulley_size", "n_pulleys", "wrap_angle_deg", *second.loads]
    return second.table.drop_duplicates(condition)["pulley_size"]


def _judge(claim: Claim, case: Case) -> Finding:
    """Judge the relative difference between the rigs, given the data of both."""
    off = difference_of_conditions(claim, case)
    if isinstance(off, Finding):
        return off
    *_, task = claim.tasks(case.entered)
    studied, rules = case.studied[task], case.analysis.claims
    first, second = case.entered.data[task.data].rigs
    sizes = _conditions(case, task)
    by_size = differences(studied.theta, tuple(sizes.unique()))
    probability = float(agree(rules, off).mean())
    medians = {size: float(np.median(off)) for size, off in by_size.items()}
    furthest = max(medians, key=lambda size: abs(medians[size]))
    figures: dict[str, float | int | dict[str, float]] = {
        "probability": probability,
        "conditions": len(sizes),
        "largest_median_difference": abs(medians[furthest]),
        "difference": medians,
        "difference_q05": {size: float(np.quantile(off, 0.05)) for size, off in by_size.items()},
        "difference_q95": {size: float(np.quantile(off, 0.95)) for size, off in by_size.items()},
    }
    shared = {p.name for p in first.likelihood(case.analysis).parameters}
    for p in second.likelihood(case.analysis).parameters:
        if p.name not in shared:
            low, middle, high = np.quantile(studied.theta[p.name], [0.05, 0.5, 0.95])
            figures |= {p.name: middle, f"{p.name}_q05": low, f"{p.name}_q95": high}
    return Finding(
        verdict_by(rules, probability),
        f"With probability {stated(probability)} all {len(sizes)} conditions agree within "
        f"{share(rules.rig_tolerance)} and most within {share(rules.rig_usual_tolerance)}. "
        "This includes the uncertainty of each rig's calibration. "
        f"The largest median difference is {100 * medians[furthest]:+.2g} % ({furthest}).",
        figures,
        why="the claim rests on a probability",
    )


CLAIM = Claim(
    name="rigs-agree",
    place=12,
    statement="The law of the gravity board predicts the friction of the motor board.",
    paper="Most mean frictions of the motor board lie within 5 % of eq. (16), all within 10 %.",
    judge=_judge,
    regime="accelerated",
    beside="steady",
    by_size=False,
)
