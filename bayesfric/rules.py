"""Thresholds of an engine in one frozen dataclass: a unit, a sentence and a page each."""

from dataclasses import field, fields
from typing import Any, NamedTuple


class Rule(NamedTuple):
    """A threshold as a reader is told of it.

    Parameters
    ----------
    name : str
        Of the field.
    value : float
        The threshold.
    unit : str
        ``1`` for a pure number.
    sentence : str
        What it decides.
    page : str
        Of docs/decisions, where that is argued.
    """

    name: str
    value: float
    unit: str
    sentence: str
    page: str


def rule(value: float, unit: str, sentence: str, page: str) -> Any:
    """Return the field of a threshold, for the body of a frozen dataclass."""
    return field(default=value, metadata={"unit": unit, "sentence": sentence, "page": page})


def rules_of(rules: Any) -> tuple[Rule, ...]:
    """Return the thresholds of an engine in the order of its dataclass.

    Parameters
    ----------
    rules : dataclass
        Whose fields are made by :func:`rule`.
    """
    return tuple(
        Rule(entry.name, getattr(rules, entry.name), **entry.metadata) for entry in fields(rules)
    )
