"""``comparison.json``: what changed between two runs."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Number, Record, Why


class Setting(Record):
    """Something that went into both runs and is not the same."""

    file: str = Field(description="Result that says so, such as fit.json.")
    key: str = Field(description="Dotted key, such as analysis.priors.c1.scale.")
    a: str | None = Field(description="In the first run; null where it has none.")
    a_why: Annotated[Why, Because("the first run has none")] = None
    b: str | None = Field(description="In the second run; null where it has none.")
    b_why: Annotated[Why, Because("the second run has none")] = None


class Shift(Record):
    """A number with an uncertainty, in both runs."""

    file: str = Field(description="Result that it is of.")
    name: str = Field(description="Such as pulleys.small.c1.")
    unit: str = Field(description="SI, degrees for angles; 1 for none.")
    a: Number = Field(description="Mean in the first run.")
    b: Number = Field(description="Likewise in the second.")
    sd_a: Number = Field(
        description="Standard deviation in the first run; of a Bayes factor, its standard error."
    )
    sd_b: Number = Field(description="Likewise in the second.")
    shift: Number | None = Field(
        description="b less a, in standard deviations (the root of their mean square)."
    )
    shift_why: Annotated[Why, Because("it has no uncertainty in either run")] = None


class Flip(Record):
    """A verdict that is not the same."""

    file: str = Field(description="Result that it is of.")
    name: str = Field(description="Id of a claim, or what the verdict is about.")
    a: str = Field(description="In the first run.")
    b: str = Field(description="In the second run.")


class ComparisonFile(Record):
    """``comparison.json``: two folders of results, by their stored files."""

    schema_: Literal["bayesfric.comparison/1"] = Field("bayesfric.comparison/1", alias="schema")
    run_ids: dict[str, tuple[str, str]] = Field(
        description="Of each result that is in both; equal where nothing at all differs."
    )
    only_in_a: tuple[str, ...] = Field(description="Results that the second folder lacks.")
    only_in_b: tuple[str, ...] = Field(description="Results that the first folder lacks.")
    same: bool = Field(description="Whether no result differs in anything.")
    settings: tuple[Setting, ...] = Field(description="What went in.")
    flips: tuple[Flip, ...] = Field(description="What is concluded.")
    shifts: tuple[Shift, ...] = Field(description="Every number that is in both, largest first.")
