"""``comparison.json``: what changed between two runs."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Number, Record, Why


class Setting(Record):
    """An input or setting that differs between the runs.

    Fields
    ------
    file: The result file that has it, such as fit.json.
    key: Its dotted key, such as analysis.priors.c1.scale.
    a: Value in the first run; null if it has none.
    b: Value in the second run; null if it has none.
    """

    file: str
    key: str
    a: str | None
    a_why: Annotated[Why, Because("the first run has none")] = None
    b: str | None
    b_why: Annotated[Why, Because("the second run has none")] = None


class Shift(Record):
    """A number with an uncertainty that both runs have.

    Fields
    ------
    file: The result file that has it.
    name: Name of the number, such as pulleys.small.c1.
    unit: SI unit; degrees for angles; 1 for a ratio.
    a: Mean in the first run.
    b: Mean in the second run.
    sd_a: Standard deviation in the first run; for a Bayes factor, its standard error.
    sd_b: The same in the second run.
    shift: b less a, over the root mean square of the two standard deviations.
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
    """A verdict that differs between the runs.

    Fields
    ------
    file: The result file that has it.
    name: Name of a claim, or of what the verdict is about.
    a: Verdict in the first run.
    b: Verdict in the second run.
    """

    file: str
    name: str
    a: str
    b: str


class ComparisonFile(Record):
    """``comparison.json``: two folders of results, compared by their files.

    Fields
    ------
    run_ids: Run id of each result that both folders have; equal if the results are identical.
    only_in_a: Results that the second folder lacks.
    only_in_b: Results that the first folder lacks.
    same: Whether all results are identical.
    settings: Inputs and settings that differ.
    flips: Verdicts that differ.
    shifts: Every number that both runs have, the largest shift first.
    keys_only_in_a: Numbers and verdicts, each after its file, that the second run lacks.
    keys_only_in_b: Numbers and verdicts, each after its file, that the first run lacks.
    """

    schema_: Literal["bayesfric.comparison/1"] = Field("bayesfric.comparison/1", alias="schema")
    run_ids: dict[str, tuple[str, str]]
    only_in_a: tuple[str, ...]
    only_in_b: tuple[str, ...]
    same: bool
    settings: tuple[Setting, ...]
    flips: tuple[Flip, ...]
    shifts: tuple[Shift, ...]
    keys_only_in_a: tuple[str, ...] = ()
    keys_only_in_b: tuple[str, ...] = ()
