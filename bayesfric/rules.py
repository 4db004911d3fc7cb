"""Thresholds of an engine in one frozen dataclass, whose docstring tells what each decides."""

import re
from dataclasses import fields
from inspect import getdoc
from typing import Any, NamedTuple

ENTRY = re.compile(r"^(\w+) : (.+) \(([\w-]+)\)\n((?: {4}.+\n?)+)", re.MULTILINE)
"""Of a docstring: name, unit, page and, indented below, the sentence."""


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


def rules_of(rules: Any) -> tuple[Rule, ...]:
    """Return the thresholds of an engine in the order of its dataclass.

    Parameters
    ----------
    rules : dataclass
        Its docstring has an entry ``name : unit (page)`` for each field, and the sentence below;
        without docstrings (``python -OO``) there are none to tell.
    """
    decides = {
        name: (unit, " ".join(sentence.split()), page)
        for name, unit, page, sentence in ENTRY.findall(getdoc(type(rules)) or "")
    }
    return tuple(
        Rule(entry.name, getattr(rules, entry.name), *decides[entry.name])
        for entry in fields(rules)
        if entry.name in decides
    )
