"""Rules that every stored result must keep, whatever the data were.

A result that breaks one of these is no finding: the computation is at fault. They are run on
every diagnosis before it is written, on every stored file by ``report`` and in the tests, and
by :func:`bayesfric.testing.check_result` on a file of anybody's.
"""

from collections.abc import Mapping
from typing import Any

from bayesfric.invariants.common import COMMON, Rule
from bayesfric.invariants.diagnosis import DIAGNOSIS
from bayesfric.invariants.others import CLAIMS, FIT, MARGINS, SCORECARD
from bayesfric.schemas.base import Check

__all__ = ["RULES", "broken", "check_record", "statements"]

RULES: dict[str, dict[str, Rule]] = {
    "fit": COMMON | FIT,
    "claims": COMMON | CLAIMS,
    "diagnosis": COMMON | DIAGNOSIS,
    "margins": COMMON | MARGINS,
    "scorecard": COMMON | SCORECARD,
}
"""Rules by the kind of file and by name."""
PLACES_SHOWN = 3  # of the places that break one rule


def check_record(record: Mapping[str, Any]) -> tuple[Check, ...]:
    """Return each rule of a result, and whether it holds.

    Parameters
    ----------
    record : mapping
        A result as JSON has it, with its ``schema``.

    Raises
    ------
    ValueError
        It is no result of a kind that there are rules for.
    """
    schema = record.get("schema")
    kind = str(schema).removeprefix("bayesfric.").split("/")[0]
    if kind not in RULES:
        expected = ", ".join(f"bayesfric.{name}" for name in RULES)
        raise ValueError(f"expected a result with a schema of {expected}; got {schema!r}")
    # A result does not judge the judgement of itself.
    looked_at = {key: value for key, value in record.items() if key not in ("checks", "analysis")}
    checks = []
    for name, rule in RULES[kind].items():
        wrong = rule.breaks(looked_at)
        more = f", and {len(wrong) - PLACES_SHOWN} more" if len(wrong) > PLACES_SHOWN else ""
        checks.append(
            Check(
                check=name,
                holds=not wrong,
                detail="; ".join(wrong[:PLACES_SHOWN]) + more if wrong else None,
            )
        )
    return tuple(checks)


def broken(checks: tuple[Check, ...]) -> tuple[str, ...]:
    """Return a sentence for ``attention`` for each rule that is broken."""
    return tuple(
        f"A fault of the computation, and no finding ({check.check}): {check.detail}."
        for check in checks
        if not check.holds
    )


def statements() -> dict[str, dict[str, str]]:
    """Return the statement of each rule, by the kind of file and by name."""
    return {
        kind: {name: rule.statement for name, rule in rules.items()}
        for kind, rules in RULES.items()
    }
