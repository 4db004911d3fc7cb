"""What a result file leaves out without a reason, or explains without leaving it out."""

import re
from typing import Any, TypeVar

from pydantic import BaseModel

Record = TypeVar("Record", bound=BaseModel)
REASON = re.compile(r"(^|_)why$")


def unexplained(value: Any, place: str = "") -> list[str]:
    """Return the places, as in /loops/0/tuning, where what is missing and its reason do not agree.

    Settings are left alone: they are the user's, as in analysis.toml. So are the fields of
    simulators, where null says that one has none.
    """
    if value is None:
        return [place]
    if isinstance(value, list):
        return [w for k, item in enumerate(value) for w in unexplained(item, f"{place}/{k}")]
    if not isinstance(value, dict):
        return []
    wrong = []
    for key, entry in value.items():
        if REASON.search(key) or key in ("analysis", "fields"):
            continue
        why = value.get(f"{key}_why")
        if why or (entry == [] and f"{key}_why" in value):
            wrong += [f"{place}/{key}"] if bool(why) != (entry in (None, [])) else []
        else:
            wrong += unexplained(entry, f"{place}/{key}")
    return wrong


def explained(record: Record) -> Record:
    """Return a record of which all that is missing has a reason, and nothing else has one."""
    wrong = unexplained(record.model_dump(mode="json"))
    assert wrong == [], wrong
    return record
