"""The two rigs agree."""

import numpy as np
from numpy.typing import NDArray

from bayesfric.claims.base import Case, Claim, Finding, Verdict
from bayesfric.claims.comparison import share
from bayesfric.rigs.base import Unsupported

Array = NDArray[np.float64]
DRAWS = 2000


def _judge(claim: Claim, case: Case) -> Finding:
    """Predict the steady rig from the other alone, at its nominal calibration."""
    entered, rules = case.entered, case.analysis.claims
    ours, theirs = entered.first("accelerated"), entered.first("steady")
    if ours is None or theirs is None:
        return Finding("not-testable", "The recording lacks one of the two boards.")
    steady = entered.trials(theirs)
    common = steady.select(steady.table["pulley_size"].isin(entered.data[ours].sizes))
    if common is None:
        return Finding("not-testable", "The two boards have no pulley size in common.")
    draws = case.baseline(ours)
    some = np.linspace(0, len(next(iter(draws.values()))) - 1, DRAWS).astype(int)
    found = common.compare({name: values[some] for name, values in draws.items()})
    if isinstance(found, Unsupported):
        return Finding("not-testable", found.reason)
    condition = ["pulley_size", "n_pulleys", "wrap_angle_deg", *common.loads]
    groups = list(found.trials.groupby(condition, sort=False).indices.values())
    rng = np.random.default_rng([case.analysis.seed, 10])
    ratios = []
    for rows in groups:
        values = found.measured_n[rows]
        # The mean is known as well as the trials repeat.
        error = values.std(ddof=1) / np.sqrt(len(rows)) if len(rows) > 1 else 0.0
        measured = values.mean() + error * rng.standard_normal(DRAWS)
        ratios.append(measured / found.predicted_n[:, rows].mean(axis=1))
    off = np.abs(np.array(ratios) - 1)
    probability = float((off < rules.rig_tolerance).all(axis=0).mean())
    factor = f"{found.calibration.replace(' ', '_')}_factor"
    verdict: Verdict = "undecided"
    if probability >= rules.support_probability:
        verdict = "supported"
    elif probability <= rules.refute_probability:
        verdict = "refuted"
    middle = np.median(np.array(ratios), axis=1) - 1
    low, reconciling, high = np.quantile(found.factor, [0.05, 0.5, 0.95])
    return Finding(
        verdict,
        f"All {len(groups)} conditions agree within {share(rules.rig_tolerance)} with "
        f"probability {probability:.2f}; the largest median difference is "
        f"{share(float(np.abs(middle).max()))}. A {found.calibration} of {reconciling:.4f} of "
        "the specified one reconciles the rigs best.",
        {
            "probability": probability,
            "conditions": len(groups),
            "conditions_within_5_percent": int((np.abs(middle) < 0.05).sum()),
            "largest_median_difference": float(np.abs(middle).max()),
            factor: float(reconciling),
            f"{factor}_q05": float(low),
            f"{factor}_q95": float(high),
        },
        why="the claim rests on a probability",
    )


CLAIM = Claim(
    name="rigs-agree",
    place=9,
    statement="The motor board's friction is what the law of the gravity board gives.",
    paper="Means of the motor board lie within 5 % of eq. (16) mostly, within 10 % at most.",
    judge=_judge,
    motion="accelerated",
    by_size=False,
)
