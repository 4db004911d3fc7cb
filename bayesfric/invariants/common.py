"""Rules for every result: numbers are finite, intervals in order, probabilities are ones."""

import math
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

ROUNDING, SHARES = 1e-9, 1e-6  # by which rounding may move a number, and a sum of shares
PROBABILITY = re.compile(r"(^|_)probability(_|$)|^p_value$|^below_floor$|^p$")
NOT_ONE = re.compile(r"_(se|why|max)$")
INTERVAL = ("q05", "q50", "q95")


class Rule(NamedTuple):
    """A rule that a result must keep.

    Parameters
    ----------
    statement : str
        What it says.
    breaks : callable
        Of a result as JSON has it, to what breaks the rule, each in words.
    """

    statement: str
    breaks: Callable[[Mapping[str, Any]], list[str]]


Breaks = Callable[[Mapping[str, Any]], list[str]]


def rule(rules: dict[str, Rule], statement: str) -> Callable[[Breaks], Breaks]:
    """Return what takes a function down among rules, by its name and with its statement."""

    def take_down(breaks: Breaks) -> Breaks:
        rules[breaks.__name__.strip("_").replace("_", "-")] = Rule(statement, breaks)
        return breaks

    return take_down


def places(value: Any, place: str = "") -> Iterator[tuple[str, Any]]:
    """Yield each value of a result with its place, as in ``gap.held_out.0.before``."""
    yield place, value
    if isinstance(value, Mapping):
        for key, part in value.items():
            yield from places(part, f"{place}.{key}" if place else str(key))
    elif isinstance(value, list | tuple):
        for number, part in enumerate(value):
            yield from places(part, f"{place}.{number}")


COMMON: dict[str, Rule] = {}
"""Rules for every file, by name."""


@rule(COMMON, "No number is NaN or infinite.")
def _finite(record: Mapping[str, Any]) -> list[str]:
    return [
        f"{place} is {value}"
        for place, value in places(record)
        if isinstance(value, float) and not math.isfinite(value)
    ]


@rule(COMMON, "The quantiles of an interval ascend, and its standard deviation is not negative.")
def intervals_ordered(record: Mapping[str, Any]) -> list[str]:
    """Return each interval whose quantiles are not in their order, in words."""
    wrong = []
    for place, value in places(record):
        if not (isinstance(value, Mapping) and all(key in value for key in INTERVAL)):
            continue
        low, middle, high = (float(value[key]) for key in INTERVAL)
        slack = ROUNDING * max(abs(low), abs(middle), abs(high))
        if low > middle + slack or middle > high + slack or float(value.get("sd", 0.0)) < 0:
            wrong.append(
                f"{place} has quantiles {low:.4g}, {middle:.4g}, {high:.4g} and a standard "
                f"deviation of {value.get('sd', 0.0):.4g}"
            )
    return wrong


@rule(COMMON, "Every probability lies between 0 and 1.")
def _probabilities_within_0_and_1(record: Mapping[str, Any]) -> list[str]:
    wrong = []
    for place, value in places(record):
        name = place.rsplit(".", 1)[-1]
        if isinstance(value, bool) or not isinstance(value, int | float):
            continue
        is_one = PROBABILITY.search(name) and not NOT_ONE.search(name)
        if is_one and not 0 <= value <= 1:
            wrong.append(f"{place} is {value!r}")
    return wrong


@rule(COMMON, "Every null has its reason beside it, and no other value has one.")
def _nulls_explained(record: Mapping[str, Any]) -> list[str]:
    wrong = []
    for place, value in places(record):
        if not isinstance(value, Mapping):
            continue
        for key in value:
            why = f"{key}_why"
            if why not in value:
                continue
            missing = value[key] is None or value[key] in ([], ())
            if value[key] is None and not value[why]:
                wrong.append(f"{place}.{key} is null without a reason".lstrip("."))
            elif not missing and value[why]:
                wrong.append(f"{place}.{key} is there and has a reason why not".lstrip("."))
    return wrong
