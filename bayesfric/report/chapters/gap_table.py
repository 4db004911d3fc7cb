"""The gap on data that the fit has not seen: every figure, and how each differs."""

import re
from collections.abc import Iterator, Sequence

from bayesfric.probabilities import ALL_BUT, PAST_ALL
from bayesfric.report.chapters.plain_law import own_law
from bayesfric.report.content import Paragraph, Table, prose
from bayesfric.report.quantities import MISSING, error_cells, interval_cells
from bayesfric.report.rig_words import group_words
from bayesfric.rigs.base import Words
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.gap import Gap, GapRow

NUMBER = re.compile(r"\d+\.\d+")


def gap_words() -> Paragraph:
    """Return where every figure of the gap stands."""
    return Paragraph(
        prose(
            "@gap has the error on held-out data, which includes scatter. All parameters are "
            "refitted without these data, with and without the causes. The systematic gap of "
            "@glance is the part of the error at the recorded conditions that scatter does not "
            "explain. Its interval is narrower, since it does not depend on which data are held "
            "out."
        )
    )


def gap_table(diagnosis: DiagnosisFile) -> Table:
    """Return every figure of the gap on data that the fit has not seen."""
    gap, groups = diagnosis.gap, group_words(diagnosis.rigs)[1]
    rows: list[tuple[str, int, Gap | GapRow]] = [
        *((_held_out_words(row.name, groups), 0, row) for row in gap.held_out),
        ("not held out: the data of the fit", 0, gap.in_sample),
    ]
    if gap.trajectory is not None:
        rows.append(("free-running trajectory [mm]", -3, gap.trajectory))
    return Table(
        f"Error on held-out data as root mean square [{gap.unit}], with 90 % intervals.",
        ["held out", "as shipped", "recalibrated", "with the causes", "floor", "shrink, %"],
        [
            [
                name,
                _cells(row.as_shipped, exponent),
                _cells(row.before, exponent),
                _cells(row.after, exponent) if diagnosis.causes else MISSING,
                _cells(row.floor, exponent),
                _shrink(row.shrink),
            ]
            for name, exponent, row in rows
        ],
        label="gap",
        note=[
            "Medians. Recalibrated: all parameters refitted. Floor: the error that scatter alone "
            "makes. ",
            "Shrink: (before² − after²) / (before² − floor²). " if diagnosis.causes else "",
            *_denser(gap, diagnosis),
            *_reasons(gap, rows, boards=not own_law(diagnosis.rigs)),
        ],
    ).filled()


def _denser(gap: Gap, diagnosis: DiagnosisFile) -> Iterator[str]:
    """Yield how much better held-out data are predicted with what was named or considered."""
    density = gap.held_out_log_density
    effects = diagnosis.causes or diagnosis.considered
    if density is None or not effects:
        return
    rise, error = error_cells(density.difference, density.error)
    yield (
        f"The log predictive density of held-out data is higher by {rise} ± {error} nat "
        f"with {' and '.join(effect.effect for effect in effects)}. "
    )


def _held_out_words(name: str, groups: str) -> str:
    """Return what was held out in words of the report."""
    said = name.replace(Words.groups, groups).replace("folds over", "cross-validation over")
    return said.replace(", from the rest", ", predicted from the others")


def _reasons(gap: Gap, rows: Sequence[tuple[str, int, Gap | GapRow]], *, boards: bool) -> list[str]:
    """Return why figures are missing, each reason once; with its rows, where not all lack it.

    Reasons that differ in one number are one reason, with the range of the number.
    """
    said: dict[str, list[tuple[str, str]]] = {}
    for name, _, row in rows:
        for what, why in (("as shipped", row.as_shipped_why), ("shrink", row.shrink_why)):
            if why is not None:
                reason = f"No number for {what}: {why}"
                said.setdefault(NUMBER.sub("#", reason, count=1), []).append((name, reason))
    lines = []
    for pattern, reasons_of_rows in said.items():
        reasons = sorted({reason for _, reason in reasons_of_rows})
        numbers = [number[0] for reason in reasons if (number := NUMBER.search(reason))]
        why = reasons[0]
        if len(reasons) > 1:
            why = pattern.replace("#", f"{min(numbers, key=float)} to {max(numbers, key=float)}")
        names = [name for name, _ in reasons_of_rows]
        lines.append(f"{why}. " if len(names) == len(rows) else f"{why} ({', '.join(names)}). ")
    if gap.trajectory is None and boards:
        lines.append(f"No trajectory: {gap.trajectory_why}. ")
    return lines


def _shrink(share: Interval | None) -> str:
    """Return a share in per cent; one that is all but certainly the whole is a bound."""
    if share is not None and share.q05 >= ALL_BUT and share.q95 <= PAST_ALL:
        return f"> {100 * ALL_BUT:.1f}"
    return _cells(share, -2)


def _cells(number: Interval | None, exponent: int) -> str:
    if number is None:
        return MISSING
    mean, low, high = interval_cells(number.q50, number.q05, number.q95, exponent)
    return f"{mean} [{low},\u00a0{high}]"
