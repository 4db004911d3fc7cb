"""The two rigs mostly agree within 5 %."""

from bayesfric.claims.base import Case, Claim, Finding, verdict_by
from bayesfric.claims.odds import share
from bayesfric.claims.rigs_agree import difference_of_conditions, most_within
from bayesfric.probabilities import stated


def _judge(claim: Claim, case: Case) -> Finding:
    """Judge how many conditions agree, in the model in which the rigs may differ."""
    off = difference_of_conditions(claim, case)
    if isinstance(off, Finding):
        return off
    rules = case.analysis.claims
    within = most_within(rules, off)
    probability = float(within.mean())
    close = (abs(off) <= rules.rig_usual_tolerance).mean(axis=0)
    return Finding(
        verdict_by(rules, probability),
        f"With probability {stated(probability)} most of {len(off)} conditions agree within "
        f"{share(rules.rig_usual_tolerance)}.",
        {
            "probability": probability,
            "conditions": len(off),
            "share_of_conditions_within": float(close.mean()),
        },
        why="the claim rests on a probability",
    )


CLAIM = Claim(
    name="rigs-mostly-agree",
    place=11,
    statement="Most friction values of the motor board are within 5 % of the gravity board's law.",
    paper="Most mean frictions of the motor board lie within 5 % of eq. (16).",
    judge=_judge,
    regime="accelerated",
    beside="steady",
    by_size=False,
)
