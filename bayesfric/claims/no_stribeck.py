"""No Stribeck term, at the speeds that were recorded."""

from dataclasses import replace

from bayesfric.claims.base import Case, Claim, Finding
from bayesfric.claims.comparison import compare
from bayesfric.claims.effect_sizes import slowest_speed
from bayesfric.fitting.hypothesis import LawWithEffects


def _judge(claim: Claim, case: Case) -> Finding:
    """Compare with the rivals, and name the speed below which the claim is not testable."""
    finding = compare(claim, case)
    if finding.verdict == "not-testable":
        return finding
    slowest = slowest_speed(case.entered.data[claim.subject(case.entered)])
    return replace(
        finding,
        reason=f"{finding.reason} Below {slowest:.2g} m/s, the slowest recorded speed, the claim "
        "is not testable.",
        figures={**finding.figures, "not_testable_below_m_s": slowest},
    )


CLAIM = Claim(
    name="no-stribeck",
    place=9,
    statement="Friction does not rise towards standstill.",
    paper="With rolling bearings neither stiction nor a Stribeck term is needed (Sec. II).",
    judge=_judge,
    regime="accelerated",
    instead="steady",
    speeds=2,
    rivals=tuple(
        LawWithEffects(effects=(("stribeck", law),)) for law in ("exponential", "gaussian")
    ),
)
