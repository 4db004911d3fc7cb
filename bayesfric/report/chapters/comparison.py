"""What changed since another run: verdicts, settings, and numbers in their standard deviations."""

from collections.abc import Iterator

from bayesfric.report.content import (
    Block,
    Code,
    Column,
    Heading,
    Inline,
    Notice,
    Paragraph,
    Reference,
    Table,
)
from bayesfric.report.quantities import MISSING, format_count, format_interval, format_shift
from bayesfric.schemas import ComparisonFile, Shift

SHOWN = 12  # numbers, those that moved furthest


def comparison_line(found: ComparisonFile) -> Notice:
    """Return what changed, for a report's first page."""
    title = "Since the run that this one is compared with"
    if found.same:
        return Notice("good", "No result of the two runs differs.", title=title)
    flips: list[Inline] = [f"{_verdicts(len(found.flips))}. See ", Reference("comparison"), "."]
    return Notice("attention" if found.flips else "info", flips, title=title)


def comparison(found: ComparisonFile) -> Iterator[Block]:
    """Yield the verdicts that differ, what went in, and how far numbers moved."""
    yield Heading(1, "What changed since another run", label="comparison")
    yield Paragraph(
        [
            "Before is the run that this report is compared with, now the one that it describes. "
            f"{_verdicts(len(found.flips))}; {_settings(len(found.settings))}; "
            f"{format_count(len(moved(found)))} of {format_count(len(found.shifts))} numbers with "
            "an uncertainty moved. In both are ",
            Code(", ".join(found.run_ids)),
            ".",
        ]
    )
    for names, whose in ((found.only_in_a, "earlier"), (found.only_in_b, "later")):
        if names:
            yield Paragraph(["The ", whose, " run alone has ", Code(", ".join(names)), "."])
    if found.flips:
        yield Table(
            "Verdicts that differ.",
            ["of", "before", "now", "result"],
            [[Code(one.name), one.a, one.b, Code(one.file)] for one in found.flips],
            label="flips",
        )
    if found.settings:
        yield Table(
            "What went in and differs.",
            ["setting", "before", "now", "result"],
            [
                [Code(one.key), one.a or MISSING, one.b or MISSING, Code(one.file)]
                for one in found.settings
            ],
            label="settings-changed",
        )
    if furthest := moved(found)[:SHOWN]:
        yield Table(
            "Numbers that moved, the furthest first: mean, and one standard deviation to either "
            "side. A shift is in standard deviations, the root of the mean square of both.",
            [
                "number",
                *(Column(title, align="right") for title in ("before", "now", "shift")),
                "result",
            ],
            [
                [
                    Code(one.name),
                    format_interval(one.a, one.a - one.sd_a, one.a + one.sd_a, one.unit),
                    format_interval(one.b, one.b - one.sd_b, one.b + one.sd_b, one.unit),
                    format_shift(one.shift),
                    Code(one.file),
                ]
                for one in furthest
            ],
            label="shifts",
        )


def moved(found: ComparisonFile) -> list[Shift]:
    """Return the numbers that are not the same in both runs."""
    return [one for one in found.shifts if (one.a, one.sd_a) != (one.b, one.sd_b)]


def _verdicts(count: int) -> str:
    if count == 0:
        return "No verdict differs"
    return "One verdict differs" if count == 1 else f"{format_count(count)} verdicts differ"


def _settings(count: int) -> str:
    if count == 0:
        return "no setting differs"
    return "one setting differs" if count == 1 else f"{format_count(count)} settings differ"
