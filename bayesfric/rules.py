"""Thresholds of an engine in one frozen dataclass, whose docstring tells what each decides."""

from typing import Any, NamedTuple

from bayesfric.docstrings import fields_of


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
        Its docstring has an entry ``name: sentence [unit; page]`` for each field; without
        docstrings (``python -OO``) there are none to tell.
    """
    listed = []
    for name, words in fields_of(type(rules).__doc__).items():
        sentence, _, about = words.removesuffix("]").rpartition(" [")
        unit, _, page = about.partition("; ")
        listed.append(Rule(name, getattr(rules, name), unit, sentence, page))
    return tuple(listed)
