"""What was wrong with the recording, and what was done about it."""

from collections.abc import Iterator

from bayesfric.report.chapters.symbols import EXPONENTS, coefficient_cells, scaled
from bayesfric.report.content import (
    Block,
    BulletList,
    Code,
    Column,
    Heading,
    Inline,
    Paragraph,
    Table,
    decimal_columns,
    right_columns,
)
from bayesfric.report.quantities import (
    MISSING,
    error_cells,
    format_count,
    format_number,
    format_share,
)
from bayesfric.report.stored import StoredFit
from bayesfric.schemas import FitFile
from bayesfric.schemas.fit import DataQuality, WithoutExclusions

SHOWN = 30  # rows of a table; a recording that is worse is read in fit.json


def data_quality(stored: StoredFit) -> Iterator[Block]:
    """Yield trials left out, repaired events, agreement of the sensors, and stalls."""
    quality = stored.fit.data_quality
    yield Heading(1, "Data quality")
    if quality.trials:
        yield Paragraph(" ".join(_clean(quality)))
        yield from _left_out(quality)
        yield from _other_fits(stored.fit)
        yield from _repairs(quality)
        yield from _agreement(quality)
    for note in quality.notes:
        yield Paragraph(note)


def _clean(quality: DataQuality) -> Iterator[str]:
    """Yield a sentence for each kind of fault that does not occur."""
    if not quality.excluded:
        yield "No trial was left out."
    if not quality.repaired:
        yield "No Hall event was found missed or doubled."
    if quality.agreement is None or not quality.agreement.trials:
        yield "No trial has two sensors to compare."
    if quality.stalled:
        yield f"Trials that stop before the end of their travel: {', '.join(quality.stalled)}."
    else:
        yield "No trial stops before the end of its travel."
    if quality.did_not_move:
        yield (
            f"Trials that did not move: {', '.join(quality.did_not_move)}. In each of them "
            "static friction was at least as large as the driving force, which the fit and the "
            "claims use. The diagnosis uses neither these trials nor those that stop."
        )


def _left_out(quality: DataQuality) -> Iterator[Block]:
    if quality.excluded:
        yield Table(
            "Trials left out.",
            ["trial", "rule", "reason"],
            [[entry.trial, entry.rule, entry.reason] for entry in quality.excluded],
            label="excluded",
        )
        selects = {entry.rule: entry.selects_on for entry in quality.excluded if entry.selects_on}
        if selects:
            yield Paragraph("What each rule selects on:")
            yield BulletList([[Code(rule), f": {what}."] for rule, what in selects.items()])


def _other_fits(fit: FitFile) -> Iterator[Block]:
    """Yield the coefficients beside those of fits to more and to fewer trials."""
    if fit.without_exclusions is not None:
        yield _beside(
            fit,
            fit.without_exclusions,
            "Coefficients with the rules, and with all "
            f"{format_count(fit.without_exclusions.trials_used)} trials that can be computed.",
            ("with the rules", "all trials"),
            "all-trials",
        )
    if fit.without_stalls is not None:
        yield _beside(
            fit,
            fit.without_stalls,
            "Coefficients of all trials used, and without those that did not move or stopped "
            f"early: {format_count(fit.without_stalls.trials_used)} trials, a selection biased to "
            "low friction.",
            ("with stalls", "without"),
            "without-stalls",
        )


def _beside(
    fit: FitFile, other: WithoutExclusions, caption: str, heads: tuple[str, str], label: str
) -> Table:
    """Return the coefficients of two fits."""
    rows = []
    for size, coefficients in other.pulleys.items():
        for name, interval in coefficients.items():
            entry = fit.pulleys[size][name]
            rows.append(
                [
                    *coefficient_cells(size, name, entry.unit),
                    *(
                        scaled(value, EXPONENTS[name], digits)
                        for estimate in (entry, interval)
                        for value, digits in ((estimate.mean, 3), (estimate.sd, 2))
                    ),
                ]
            )
    first, second = heads
    return Table(
        caption,
        ["pulley", "coefficient", *decimal_columns(first, "sd", second, "sd")],
        rows,
        label=label,
        note="" if other.converged else "The second fit has not converged.",
    )


def _repairs(quality: DataQuality) -> Iterator[Block]:
    if not quality.repaired:
        return
    count = len(quality.repaired)
    more: list[Inline] = []
    if count > SHOWN:
        more = [f" The first {SHOWN} of {format_count(count)}; all are in ", Code("fit.json"), "."]
    yield Table(
        "Sensors of trials whose Hall events were not clean.",
        ["trial", "sensor", *right_columns("missed", "doubled", "removed"), "used"],
        [
            [
                entry.trial,
                entry.sensor,
                format_count(entry.missed),
                format_count(entry.doubled),
                format_count(entry.removed),
                "yes" if entry.used else "no",
            ]
            for entry in quality.repaired[:SHOWN]
        ],
        label="repairs",
        note=[
            "Missed events leave a gap, and later ones keep their true displacement; doubled and "
            "stray ones are removed. Not used: beyond repair, so all events of the sensor are "
            "removed.",
            *more,
        ],
    )


def _agreement(quality: DataQuality) -> Iterator[Block]:
    agreement = quality.agreement
    if agreement is None or not agreement.trials:
        return
    yield Table(
        "Agreement of the two sensors of a trial on its acceleration.",
        ["", Column("value", align="right")],
        [
            ["trials with two sensors", format_count(agreement.trials)],
            ["95 % quantile of |z|, 1.96 by noise alone", _z(agreement.z_q95)],
            ["largest |z|", _z(agreement.largest_z)],
            ["limit of |z|", _z(agreement.limit_z)],
            ["trials that disagree", format_count(len(agreement.disagreeing))],
            *_clocks(quality),
        ],
        label="agreement",
        note=[
            "z: difference of the two accelerations over its standard error. A trial disagrees if "
            "|z| is above the limit and its friction by the two sensors differs by more than "
            f"{format_share(agreement.limit_friction_share)}.",
            *([f" They are: {', '.join(agreement.disagreeing)}."] if agreement.disagreeing else []),
        ],
    )


def _clocks(quality: DataQuality) -> list[list[str]]:
    """Return the row of the offset between the sensors' clocks, in milliseconds."""
    clocks = quality.clocks
    if clocks is None or clocks.late_s is None or clocks.sd_s is None:
        return []
    value, error = error_cells(1e3 * clocks.late_s, 1e3 * clocks.sd_s)
    return [["delay of the load sensor's clock, ms", f"{value} ± {error}"]]


def _z(value: float | None) -> str:
    return MISSING if value is None else format_number(value, 3)
