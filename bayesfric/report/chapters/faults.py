"""The invariants that stored results break."""

from collections.abc import Iterator

from bayesfric.invariants import RULES, broken, check_record
from bayesfric.report.content import Notice
from bayesfric.report.stored import StoredResults


def faults(stored: StoredResults) -> Iterator[Notice]:
    """Yield a notice for each invariant that a stored result breaks."""
    records = {
        "fit.json": stored.pooled if stored.fitted is None else stored.fitted.fit,
        "claims.json": None if stored.claims is None else stored.claims.record,
        "diagnosis.json": None if stored.diagnosis is None else stored.diagnosis.record,
        "margins.json": stored.margins,
        "scorecard.json": stored.scorecard,
    }
    for name, record in records.items():
        if record is None or name.removesuffix(".json") not in RULES:
            continue
        lines = broken(check_record(record.model_dump(mode="json", by_alias=True)))
        for line in lines:
            yield Notice("attention", line, title=f"{name} contradicts itself")
