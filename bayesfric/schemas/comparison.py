"""``comparison.json``: what changed between two runs."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Number, Record, Why


class Setting(Record):
    """Something that went into both runs and is not the same.

    Fields
    ------
    file: Result that says so, such as fit.json.
    key: Dotted key, such as analysis.priors.c1.scale.
    a: In the first run; null where it has none.
    b: In the second run; null where it has none.
    """

    file: str
    key: str
    a: str | None
    a_why: Annotated[Why, Because("the first run has none")] = None
    b: str | None
    b_why: Annotated[Why, Because("the second run has none")] = None


class Shift(Record):
    """A number with an uncertainty, in both runs.

    Fields
    ------
    file: Result that it is of.
    name: Such as pulleys.small.c1.
    unit: SI, degrees for angles; 1 for none.
    a: Mean in the first run.
    b: Likewise in the second.
    sd_a: Standard deviation in the first run; of a Bayes factor, its standard error.
    sd_b: Likewise in the second.
    shift: b less a, in standard deviations (the root of their mean square).
    """

    file: str
    name: str
    unit: str
    a: Number
    b: Number
    sd_a: Number
    sd_b: Number
    shift: Number | None
    shift_why: Annotated[Why, Because("it has no uncertainty in either run")] = None


class Flip(Record):
    """A verdict that is not the same.

    Fields
    ------
    file: Result that it is of.
    name: Id of a claim, or what the verdict is about.
    a: In the first run.
    b: In the second run.
    """

    file: str
    name: str
    a: str
    b: str


class ComparisonFile(Record):
    """``comparison.json``: two folders of results, by their stored files.

    Fields
    ------
    run_ids: Of each result that is in both; equal where nothing at all differs.
    only_in_a: Results that the second folder lacks.
    only_in_b: Results that the first folder lacks.
    same: Whether no result differs in anything.
    settings: What went in.
    flips: What is concluded.
    shifts: Every number that is in both, largest first.
    """

    schema_: Literal["bayesfric.comparison/1"] = Field("bayesfric.comparison/1", alias="schema")
    run_ids: dict[str, tuple[str, str]]
    only_in_a: tuple[str, ...]
    only_in_b: tuple[str, ...]
    same: bool
    settings: tuple[Setting, ...]
    flips: tuple[Flip, ...]
    shifts: tuple[Shift, ...]
