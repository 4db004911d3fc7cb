"""What changed since another run: verdicts, settings, and numbers in their standard deviations."""

from collections.abc import Iterator

from bayesfric.report.content import (
    Block,
    Code,
    Heading,
    Notice,
    Paragraph,
    Table,
    prose,
    right_columns,
)
from bayesfric.report.quantities import MISSING, format_count, format_interval, format_shift
from bayesfric.schemas import ComparisonFile
from bayesfric.schemas.comparison import Shift

SHOWN = 12  # numbers, those that moved furthest


def comparison_line(compared: ComparisonFile) -> Notice:
    """Return what changed, for a report's first page."""
    title = "Compared with the earlier run"
    if compared.same:
        return Notice("good", "No result of the two runs differs.", title=title)
    flips = prose("{}. See @comparison.", _differ(len(compared.flips), "verdict").capitalize())
    return Notice("attention" if compared.flips else "info", flips, title=title)


def comparison(compared: ComparisonFile) -> Iterator[Block]:
    """Yield the verdicts that differ, what went in, and how far numbers moved."""
    yield Heading(1, "What changed since another run", label="comparison")
    yield Paragraph(
        prose(
            "“Before” is the earlier run, “now” the one that this report describes. {}; {}; {} of "
            "{} numbers with an uncertainty moved. In both are {}.",
            _differ(len(compared.flips), "verdict").capitalize(),
            _differ(len(compared.settings), "setting"),
            format_count(len(moved(compared))),
            format_count(len(compared.shifts)),
            Code(", ".join(compared.run_ids)),
        )
    )
    yield from _of_one_run_alone(compared)
    if compared.flips:
        yield Table(
            "Verdicts that differ.",
            ["of", "before", "now", "result"],
            [
                [Code(changed.name), changed.a, changed.b, Code(changed.file)]
                for changed in compared.flips
            ],
            label="flips",
        )
    if compared.settings:
        yield Table(
            "Inputs and settings that differ.",
            ["setting", "before", "now", "result"],
            [
                [Code(changed.key), changed.a or MISSING, changed.b or MISSING, Code(changed.file)]
                for changed in compared.settings
            ],
            label="settings-changed",
        )
    if furthest := moved(compared)[:SHOWN]:
        yield Table(
            "Numbers that moved, the furthest first: mean, and one standard deviation to either "
            "side. A shift is in standard deviations, the root of the mean square of both.",
            ["number", *right_columns("before", "now", "shift"), "result"],
            [
                [
                    Code(changed.name),
                    *(
                        format_interval(mean, mean - sd, mean + sd, changed.unit)
                        for mean, sd in ((changed.a, changed.sd_a), (changed.b, changed.sd_b))
                    ),
                    format_shift(changed.shift),
                    Code(changed.file),
                ]
                for changed in furthest
            ],
            label="shifts",
        )


def _of_one_run_alone(compared: ComparisonFile) -> Iterator[Block]:
    """Yield the results, numbers and verdicts that one of the runs lacks."""
    alone = (
        ("earlier", (*compared.only_in_a, *compared.keys_only_in_a)),
        ("later", (*compared.only_in_b, *compared.keys_only_in_b)),
    )
    for whose, names in alone:
        if names:
            more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
            listed = Code(", ".join(names[:SHOWN]))
            yield Paragraph(prose("The {} run alone has {}{}.", whose, listed, more))


def moved(compared: ComparisonFile) -> list[Shift]:
    """Return the numbers that are not the same in both runs."""
    return [shift for shift in compared.shifts if (shift.a, shift.sd_a) != (shift.b, shift.sd_b)]


def _differ(count: int, what: str) -> str:
    """Return how many verdicts or settings differ."""
    if count > 1:
        return f"{format_count(count)} {what}s differ"
    return f"{'one' if count else 'no'} {what} differs"
