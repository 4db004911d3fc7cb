"""Page one: the verdict on the gap, which numbers to use, and what to worry about."""

import re
from collections.abc import Iterator
from functools import partial

import numpy as np
import xarray as xr

from bayesfric.attention.together import attention_of_all, by_weight
from bayesfric.observation.coefficients import NO_PULLEY
from bayesfric.plots.labels import ordered_sizes
from bayesfric.plots.posterior import (
    Quantiles,
    coefficients_relative_to_paper,
    ratio_charts,
)
from bayesfric.plots.rig_tables import RigTable, rig_tables
from bayesfric.plots.style import svg_of
from bayesfric.report.chapters.blind import scorecard_line
from bayesfric.report.chapters.boards import population
from bayesfric.report.chapters.calibration import calibration_line
from bayesfric.report.chapters.claims import fallen, untestable
from bayesfric.report.chapters.comparison import comparison_line
from bayesfric.report.chapters.entering import numbers_to_enter, told_at_numbers
from bayesfric.report.chapters.faults import faults
from bayesfric.report.chapters.gain import gain_figures, gain_lines
from bayesfric.report.chapters.plain_law import force_unit, in_a_sentence
from bayesfric.report.chapters.summary import meaning
from bayesfric.report.chapters.to_use import (
    coefficient_heads,
    fitted_numbers,
    lacking_force,
    numbers_to_use,
    papers_law,
    refitted_coefficients,
)
from bayesfric.report.chapters.verdict import is_sound, verdict_line
from bayesfric.report.content import (
    Block,
    Code,
    Column,
    Figure,
    Inline,
    Notice,
    Paragraph,
    Strong,
    Table,
    Text,
)
from bayesfric.report.quantities import error_cells, format_count, format_unit, interval_cells
from bayesfric.report.rig_words import counted
from bayesfric.report.stored import StoredFit, StoredResults
from bayesfric.schemas import FitFile
from bayesfric.schemas.base import RecordingId

CONDITION = ("pulley_size", "n_pulleys", "wrap_angle_deg")
USE = "Coefficients to use"
OF_THE_LAW_ALONE = "These figures include the force of the named causes in these runs. "
WORDS = ("wander", "latency")  # parameters whose names a sentence may have as words


def page_one(stored: StoredResults) -> Iterator[Block]:
    """Yield what stands before the table of contents: the answer first, then the worries."""
    for record in list(stored.records.values())[:1]:
        yield from recorded(record.recording, stored.fitted)
    fitted, diagnosed = stored.fitted, stored.diagnosis
    refitted = {} if diagnosed is None else refitted_coefficients(diagnosed.record)
    if fitted is not None:
        yield from convergence(fitted.fit)
    if diagnosed is not None:
        yield verdict_line(diagnosed.record)
        alone = fitted is None and stored.pooled is None
        yield from numbers_to_use(diagnosed.record, alone=alone)
        yield from numbers_to_enter(diagnosed.record)
    if fitted is not None:
        if diagnosed is None or not diagnosed.record.enter:
            yield from in_a_sentence(fitted.fit)
        unknown = diagnosed is not None and diagnosed.record.verdict == "unknown"
        if not refitted:
            yield from expected(fitted, coefficients=True, unknown_force=unknown)
    pooled = stored.pooled
    if pooled is not None and pooled.pooled is not None:
        yield from convergence(pooled)
        yield population(pooled, pooled.pooled)
    yield from faults(stored)
    if fitted is not None or pooled is not None or diagnosed is not None:
        yield from worries(stored)
    alone = fitted is None and diagnosed is None
    if stored.claims is not None and (alone or not untestable(stored.claims.record)):
        lacking = "" if diagnosed is None else lacking_force(diagnosed.record)
        yield fallen(stored.claims.record, lacking)
    if stored.margins is not None:
        yield from gain_lines(stored.margins, alone=fitted is None)
    if fitted is None and pooled is None and diagnosed is None:  # the answer stands first
        yield from worries(stored)
    yield from notes(stored)
    if stored.margins is not None and fitted is None:
        yield from gain_figures(stored.margins)
    if stored.scorecard is not None and fitted is None:
        yield scorecard_line(stored.scorecard)
    if stored.calibration is not None and fitted is None:
        yield calibration_line(stored.calibration)
    if stored.comparison is not None:
        yield comparison_line(stored.comparison)
    if fitted is not None and not refitted:  # beside refitted numbers it opens their chapter
        yield from coefficients_figure(fitted, {})


def recorded(recording: RecordingId, fitted: StoredFit | None) -> Iterator[Paragraph]:
    """Yield which recording it is, and what of it enters; nothing beyond the report's own title."""
    title = "" if recording.title == recording.name else recording.title
    if not title and fitted is None and not _synthetic(recording.name):
        return
    yield Paragraph(
        [
            "Recording ",
            Code(recording.name),
            f": {title}." if title else ".",
            *([f" {_entered(fitted)}"] if fitted is not None else []),
            *_synthetic(f"{title} {recording.name}"),
        ]
    )


def _entered(stored: StoredFit) -> str:
    said = [counted(rig) for rig in rig_tables(stored.predictive)]
    events = stored.fit.data_quality.events
    if events:
        said.append(f"{format_count(events)} Hall events")
    return f"Data used: {'; '.join(said)}."


def _synthetic(called: str) -> tuple[Inline, ...]:
    """Return a warning where the recording calls itself simulated."""
    if not any(word in called.casefold() for word in ("synthetic", "simulat")):
        return ()
    return (" ", Strong("Synthetic data:"), " simulated, not measured.")


def convergence(fit: FitFile) -> Iterator[Notice]:
    """Yield a warning before all numbers, where the draws cannot be used."""
    if not fit.converged:
        yield Notice(
            "attention",
            "The draws have not converged. Use no number below; run the sampler longer.",
            title="Unconverged",
        )


def expected(
    stored: StoredFit, *, coefficients: bool, unknown_force: bool = False
) -> Iterator[Block]:
    """Yield the coefficients of each pulley size, and friction of a run of usual conditions.

    Parameters
    ----------
    stored : StoredFit
        Whose numbers they are.
    coefficients : bool
        Whether they may be used: a law without a force that acts has biased ones.
    unknown_force : bool
        Whether a force acts that no effect explains, so that nobody knows what it does to them.
    """
    fit = stored.fit
    unit = force_unit(fit)
    runs = dict(
        pair for rig in rig_tables(stored.predictive)[:1] for pair in _conditions(rig, unit)
    )
    numbers = fitted_numbers(fit) if coefficients else {}
    sizes = ordered_sizes([*runs, *numbers])
    if not sizes:
        return
    of_size: list[Column | str] = ["pulley", *coefficient_heads(fit)] if numbers else []
    of_run: list[Column | str] = ["condition", "mean friction", "friction of one run"]
    no_numbers, no_run = [""] * (len(of_size) - 1), [""] * len(of_run)
    title = "Friction to expect at the recording's own conditions."
    if numbers:
        use = "Coefficients of the law, which lacks the unknown force" if unknown_force else USE
        title = f"{use}, and the friction to expect."
    yield Table(
        title,
        [*of_size, *of_run],
        [
            [
                *([size, *numbers.get(size, no_numbers)] if numbers else []),
                *runs.get(size, no_run),
            ]
            for size in sizes
        ],
        label="expected",
        note="± is half the width of the 90 % interval. "
        + ("Coefficients: posterior means. " if numbers else OF_THE_LAW_ALONE)
        + "Mean friction: at the most frequent condition and its median tension. Friction of one "
        "run: 90 % predictive interval of a run on a new assembly, scatter included."
        + (papers_law() if fit.pulleys and fit.baseline == "paper" else ""),
    ).filled()


def _conditions(rig: RigTable, unit: str) -> Iterator[tuple[str, list[Text]]]:
    """Yield, of each size, the measured trial in the middle of its most frequent condition."""
    if not {*CONDITION, "tension_n", "law_n", "predicted_n"} <= set(rig.table.data_vars):
        return
    columns = [rig.table[name].to_numpy() for name in CONDITION]
    for size in ordered_sizes(rig.sizes):
        keys = [key for key in zip(*columns, strict=True) if key[0] == size]
        usual = max(sorted(set(keys)), key=keys.count)
        at_usual = np.all([c == v for c, v in zip(columns, usual, strict=True)], axis=0)
        tension = np.abs(rig.table["tension_n"].to_numpy())
        middle = np.quantile(tension[at_usual], 0.5, method="nearest")
        row = rig.table.isel({rig.id: int(np.flatnonzero(at_usual & (tension == middle))[0])})
        _, n, angle = usual
        yield (
            size,
            [
                _condition(int(n), size, angle, float(middle), unit),
                f"{_plus_minus(row['law_n'])}\u202f{format_unit(unit)}",
                Strong(f"{_range(row['predicted_n'])}\u202f{format_unit(unit)}"),
            ],
        )


def _condition(n: int, size: str, angle: float, tension: float, unit: str) -> str:
    """Return a condition in words; a machine may have no pulleys, or no tension."""
    at = f"at {tension:.3g}\u202f{format_unit(unit)}"
    if size == NO_PULLEY:
        return at if tension else "as recorded"
    return f"{format_count(n)} {size} {'pulley' if n == 1 else 'pulleys'}, {angle:g}°, {at}"


def _plus_minus(quantiles: xr.DataArray) -> str:
    low, middle, high = sorted(abs(float(value)) for value in quantiles)
    return " ± ".join(error_cells(middle, (high - low) / 2))


def _range(quantiles: xr.DataArray) -> str:
    low, middle, high = sorted(abs(float(value)) for value in quantiles)
    _, low_shown, high_shown = interval_cells(middle, low, high)
    return f"{low_shown} to {high_shown}"


def coefficients_figure(stored: StoredFit, refitted: Quantiles) -> Iterator[Figure]:
    """Yield the coefficients beside the paper's, those refitted with named causes first."""
    if "ratio" not in stored.predictive["coefficients"].data_vars:
        return
    uninformed = _uninformed(stored.fit)
    biased = (
        " In colour: refitted with the named causes (90 %). Grey: the law alone, which is biased."
    )
    yield Figure(
        svg_of(coefficients_relative_to_paper, stored.predictive, uninformed, refitted),
        "Each coefficient over its value in Table I of the paper (Miyasaka et al. 2015): median, "
        "50 % and 90 % intervals. Where a thin bar misses the dashed line, data and paper differ "
        "by more than the uncertainty." + (biased if refitted else ""),
        "Horizontal bars, one for each coefficient and pulley size, of the 50 and 90 percent "
        "intervals relative to the paper's value, which is a dashed vertical line at one.",
        label="relative",
        charts=partial(ratio_charts, stored.predictive, uninformed, refitted),
    )


def _uninformed(fit: FitFile) -> tuple[str, ...]:
    return tuple(
        f"{name}[{size}]"
        for size, coefficients in fit.pulleys.items()
        for name, entry in coefficients.items()
        if not entry.informed
    )


def _remark(line: str, fit: FitFile) -> str:
    """Return a remark as a sentence, with scatter and noise parameters named in words."""
    for name in sorted({**fit.scatter, **fit.noise}, key=len, reverse=True):
        if name not in WORDS:
            said = meaning(name, fit.rigs)
            line = re.sub(rf"\b{re.escape(name)}\b", f"the {said}", line)
            line = line.replace(f"Parameter the {said}", f"The {said}")
    return line if line.endswith((".", ":")) else f"{line}."


def _capital(line: str) -> str:
    return line[:1].upper() + line[1:]


def _remarks(stored: StoredResults) -> tuple[list[str], list[str]]:
    """Return the remarks of all results as sentences: those to heed, and the harmless ones."""
    fit = stored.pooled if stored.fitted is None else stored.fitted.fit
    diagnosed = stored.diagnosis
    at_numbers = set() if diagnosed is None else told_at_numbers(diagnosed.record)
    why = None if diagnosed is None or diagnosed.record.joints else diagnosed.record.overruled_by
    remarks = [
        line
        for _, line in attention_of_all(stored.records)
        if line not in at_numbers and not (why is not None and why in line)  # the verdict says why
    ]
    lines = [
        line.removesuffix(".") + "." if fit is None else _remark(line, fit) for line in remarks
    ]
    if stored.margins is not None and len(stored.margins.loops) == 1:
        name = f"{stored.margins.loops[0].name}: "  # of one loop, which the answer names
        lines = [_capital(line.removeprefix(name)) for line in lines]
    if fit is not None and diagnosed is not None and diagnosed.record.verdict == "unknown":
        lines.append(
            "A force of unknown cause acts, and the laws behind coefficients and claims lack it: "
            "friction computed from these coefficients may be wrong by as much as the gap, on top "
            "of the errors stated."
        )
    return by_weight(lines)


def worries(stored: StoredResults) -> Iterator[Notice]:
    """Yield what must be kept in mind when the numbers are used, or that every check passed."""
    heeded, harmless = _remarks(stored)
    if len(heeded) > 1:
        yield Notice("attention", f"{len(heeded)} remarks on these numbers:", points=heeded)
    elif heeded:
        yield Notice("attention", *heeded)
    if heeded or harmless:
        return
    fit = stored.pooled if stored.fitted is None else stored.fitted.fit
    diagnosed = stored.diagnosis
    if fit is None and diagnosed is not None and is_sound(diagnosed.record):
        yield Notice(
            "good",
            "With these numbers the error on held-out data is no larger than scatter makes it, and "
            "every check passed.",
            title="Confirmed by held-out data",
        )
    if fit is not None and fit.converged:
        yield Notice(
            "good",
            "Every R-hat and every effective sample size is within its bound, and every check "
            "passed.",
            title="The fit passes its checks",
        )


def notes(stored: StoredResults) -> Iterator[Notice]:
    """Yield the remarks that ask for nothing, which may go on to page two."""
    heeded, harmless = _remarks(stored)
    fit = stored.pooled if stored.fitted is None else stored.fitted.fit
    passed = fit is not None and fit.converged and not heeded
    rest = ["Every other check passed."] if passed else []
    if len(harmless) == 1:
        yield Notice("info", " ".join([*harmless, *rest]))
    elif harmless:
        begun = f"{len(harmless)} remarks, of which none asks for action."
        yield Notice("info", " ".join([begun, *rest]), points=harmless)
