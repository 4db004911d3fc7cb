"""The numbers to use where a cause is named: the law refitted with it, and the cause itself."""

from collections.abc import Iterator, Sequence

from bayesfric.report.content import Block, Code, Inline, Notice, Strong, Table
from bayesfric.report.quantities import MISSING, error_cells
from bayesfric.schemas import Cause, DiagnosisFile, Interval


def _acting_causes(diagnosis: DiagnosisFile) -> Sequence[Cause]:
    """Return the named causes that make a gap; none under another verdict."""
    if diagnosis.verdict != "named":
        return ()
    return tuple(cause for cause in diagnosis.causes if cause.makes_a_gap)


def numbers_to_use(diagnosis: DiagnosisFile) -> Iterator[Block]:
    """Yield the refitted law beside the law alone, and the parameters of the named causes.

    Nothing is yielded where no cause is named: the fit's own numbers are those to use.
    """
    causes = _acting_causes(diagnosis)
    if not causes or diagnosis.enter:
        return
    names = ", ".join(cause.effect for cause in causes)
    rows: list[list[Inline]] = [
        [
            Code(name),
            number.unit,
            Strong(_with_error(number.after)),
            _with_error(number.before),
        ]
        for name, number in diagnosis.law.items()
    ]
    rows += [
        [Code(f"{cause.effect}.{name}"), number.unit, Strong(_with_error(number)), MISSING]
        for cause in causes
        for name, number in cause.parameters.items()
    ]
    yield Table(
        f"Use these numbers: the law refitted together with {names}.",
        ["number", "unit", "use", "law alone (biased)"],
        rows,
        label="use",
        note="Median ± half of the 90 % interval. The law alone takes up a part of the force of "
        f"{names}, so that its coefficients are biased.",
    )


def biased(diagnosis: DiagnosisFile) -> Iterator[Notice]:
    """Yield a warning beside numbers of a law that lacks a named cause."""
    causes = _acting_causes(diagnosis)
    if causes:
        yield Notice(
            "attention",
            [
                "The law was fitted alone, and a part of the force of ",
                Code(", ".join(cause.effect for cause in causes)),
                " has gone into its coefficients.",
            ],
            title="These coefficients are biased",
        )


def _with_error(number: Interval) -> str:
    return " ± ".join(error_cells(number.q50, (number.q95 - number.q05) / 2))
