"""The numbers to use where a cause is named: the law refitted with it, and the cause itself."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence

from bayesfric.attention.diagnosis import APART, biased_numbers
from bayesfric.effects import all_effects
from bayesfric.effects.pulley_count_curvature import MIDDLE_COUNT
from bayesfric.effects.state import REFERENCE_TENSION_N
from bayesfric.plots.labels import ordered_sizes, parts, sizes_of
from bayesfric.report.chapters.symbols import exponent, half_width, plus_minus, symbol, unit_head
from bayesfric.report.content import (
    Block,
    Code,
    Column,
    Inline,
    Notice,
    Paragraph,
    Strong,
    Table,
    Text,
    prose,
)
from bayesfric.report.diagnosed import has_gap
from bayesfric.report.quantities import MISSING, error_cells, format_number, format_unit
from bayesfric.report.words import with_code
from bayesfric.schemas import DiagnosisFile, FitFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import Cause, LawNumber
from bayesfric.schemas.parameter import ParameterSummary

NO_BREAK = "\u00a0"
OF_SPEED = {"constant": "d v", "tension": "d v T/(15 N)", "wrap": "d v θ/85°"}
"""Viscous friction of a pulley by its law, with its damping d at 15 N and 85°."""
COUNTED = "pulley-count-curvature"  # a factor of friction, and not a force beside it
HALF = "Median; ± is half the width of the 90 % interval."


def _acting_causes(diagnosis: DiagnosisFile) -> Sequence[Cause]:
    """Return the causes that make a gap, or would if the law alone did not take it up."""
    if diagnosis.verdict in ("unknown", "unseparated"):
        return ()
    named = diagnosis.verdict == "named"
    return tuple(cause for cause in diagnosis.causes if cause.makes_a_gap or not named)


def papers_law(causes: Sequence[Cause] = ()) -> str:
    """Return the law as a formula, with the terms of the causes, and what its symbols are.

    Parameters
    ----------
    causes : sequence of Cause
        With which it was refitted; viscous friction and a power of the number of pulleys stand
        in the formula, and of all others it is said that their force comes on top.

    Returns
    -------
    str
        Sentences, after a space.
    """
    viscous = next((cause for cause in causes if cause.effect == "viscous"), None)
    by = "" if viscous is None else viscous.law
    term = f" + {OF_SPEED[by]}" if by in OF_SPEED else ""
    factor = " (1 + s v)" if by == "friction" else ""
    curved = any(cause.effect == COUNTED for cause in causes)
    count = f"n (n/{MIDDLE_COUNT:g})ᵏ" if curved else "n"
    formula = f"{count} ((c₁ + c₃ (θ − 85°)) T + c₂{term}){factor}".replace(" ", NO_BREAK)
    symbols = ["T the cable tension", "θ the wrap angle"]
    if term:
        symbols += ["v the cable speed", "d the damping of a pulley"]
    elif factor:
        symbols += ["v the cable speed", "s viscous.slope"]
    if curved:
        symbols += [f"k {COUNTED}.exponent"]
    examined = all_effects(None)
    others = [
        cause.effect
        for cause in causes
        if not (cause is viscous and (term or factor))
        and cause.effect != COUNTED
        and cause.effect in examined
        and examined[cause.effect].acts_on == "friction"
    ]
    beside = f" It lacks {' and '.join(others)}, whose law stands below." if others else ""
    return f" Friction of n pulleys: {formula}, with {', '.join(symbols)}.{beside}"


def numbers_to_use(diagnosis: DiagnosisFile, *, alone: bool = False) -> Iterator[Block]:
    """Yield the numbers of the law to use, and the parameters of the named causes.

    Parameters
    ----------
    diagnosis : DiagnosisFile
        As it is stored.
    alone : bool
        Whether no fit stands beside it. Where no cause is named the fit's own numbers are those
        to use; without a fit, those of the law that the diagnosis recalibrated.

    Yields
    ------
    Table, Paragraph
        One table at most, and what the causes' parameters are; none for a joint, whose numbers
        :func:`numbers_to_enter` has.
    """
    causes = _acting_causes(diagnosis)
    if diagnosis.enter:
        return
    if causes:
        formula = papers_law(causes) if diagnosis.baseline == "paper" else ""
        title = {"named": "Use these numbers", "no-gap": "Use these numbers"}.get(
            diagnosis.verdict, "The best numbers while the verdict is open"
        )
        of_fit = "" if alone else " The chapters on the fit describe the law alone."
        biased = _biased_words(diagnosis, causes)
        yield _with_causes(title, diagnosis.law, causes, f"{biased}{of_fit}", formula)
        if beside := list(_parameters(causes, diagnosis.law)):
            yield Paragraph(beside)
    elif alone and diagnosis.law:
        yield Table(
            "Coefficients of the recalibrated law.",
            ["", *_heads(diagnosis.law)],
            [
                [whose, *map(Strong, cells)]
                for whose, cells in _numbers(diagnosis.law, lambda number: number.before)
            ],
            label="use",
            note=HALF + (" The law leaves the gap unexplained." if has_gap(diagnosis) else ""),
        ).filled()


def _with_causes(
    title: str, law: Mapping[str, LawNumber], causes: Sequence[Cause], of_law: str, formula: str
) -> Table:
    """Return the law refitted with the causes, and below it the law alone.

    `of_law` is what the note says of the law alone, and `formula` ends the note.
    """
    names = " and ".join(cause.effect for cause in causes)
    dampings = _dampings(law, causes)
    damping = [Column("damping of a pulley", "N·s/m")] if dampings else []
    slope = f" {_slope_of(causes)}" if dampings else ""
    rows: list[list[Text]] = [
        [whose or "law", *map(Strong, cells), *map(Strong, dampings.get(whose, []))]
        for whose, cells in _numbers(law, lambda number: number.after)
    ]
    rows += [
        [f"{whose}, law alone".removeprefix(", "), *cells, *([""] if dampings else [])]
        for whose, cells in _numbers(law, lambda number: number.before)
    ]
    return Table(
        f"{title}: the law refitted together with {names}.",
        ["", *_heads(law), *damping],
        rows,
        label="use",
        note=f"{HALF} {of_law}{slope}{formula}",
    ).filled()


def _biased_words(diagnosis: DiagnosisFile, causes: Sequence[Cause]) -> str:
    """Return how many coefficients the law alone has wrong; the attention list names them."""
    biased = len(biased_numbers(diagnosis))
    names = " and ".join(cause.effect for cause in causes)
    alone = f"Law alone: fitted without {names}, so its coefficients absorb part of that force"
    lacking = ""
    if all(_is_force(cause) for cause in causes):  # a simulator has no errors of readings
        gap = format_number(diagnosis.gap.systematic.q50, 2, unit=diagnosis.gap.unit)
        lacking = f" A simulator without {names} needs the law alone, and is then off by {gap} rms."
    if not biased:
        return f"{alone}; none is biased beyond its error.{lacking}"
    return (
        f"{alone}; {biased} of {len(diagnosis.law)} {'is' if biased == 1 else 'are'} biased by "
        f"more than {APART:g} combined standard deviations.{lacking}"
    )


def _is_force(cause: Cause) -> bool:
    """Return whether a cause is a force of the machine, and not an error of its measurement."""
    effect = all_effects(None).get(cause.effect)
    return effect is not None and effect.acts_on in ("friction", "drive")


def _slope_of(causes: Sequence[Cause]) -> str:
    """Return how damping follows from the slope that the diagnosis estimates."""
    slope = next(cause for cause in causes if cause.effect == "viscous").parameters["slope"]
    return (
        "Damping d is viscous.slope, "
        f"{plus_minus(slope)} {format_unit(slope.unit)}, times the friction of a pulley at "
        f"{REFERENCE_TENSION_N:g} N and 85°; its error takes the errors of both as independent."
    )


def _heads(law: Mapping[str, LawNumber]) -> list[Column]:
    """Return a column for each coefficient of a law, with its unit and power of ten."""
    units = {parts(name)[0]: number.unit for name, number in law.items()}
    return [Column(symbol(stem), unit_head(stem, unit)) for stem, unit in units.items()]


def _numbers(
    law: Mapping[str, LawNumber], chosen: Callable[[LawNumber], Interval]
) -> Iterator[tuple[str, list[str]]]:
    """Yield each pulley size, in their usual order, with the numbers that it has."""
    stems = dict.fromkeys(parts(name)[0] for name in law)
    for size in ordered_sizes({parts(name)[1] for name in law}):
        names = [f"{stem}[{size}]" if size else stem for stem in stems]
        yield (
            size,
            [
                plus_minus(chosen(law[name]), exponent(name)) if name in law else MISSING
                for name in names
            ],
        )


def _parameters(causes: Sequence[Cause], law: Mapping[str, LawNumber]) -> Iterator[Inline]:
    """Yield each parameter of the causes that no column has, with its value and its meaning."""
    examined = all_effects(None)
    for cause in causes:
        if cause.effect == "viscous" and _dampings(law, (cause,)):
            continue
        effect = examined.get(cause.effect)
        parameters = () if effect is None else effect.parameters
        meanings = {p.name: p.meaning_in(cause.law) for p in parameters}
        for name, number in cause.parameters.items():
            yield from (Code(f"{cause.effect}.{name}"), " ")
            yield Strong(f"{plus_minus(number)}\u202f{format_unit(number.unit)}".rstrip())
            if name in meanings:
                yield from (": ", *with_code(meanings[name]))
            yield ". "


def fitted_numbers(fit: FitFile) -> dict[str, list[Text]]:
    """Return the fitted coefficients of each pulley size, each with its error.

    Parameters
    ----------
    fit : FitFile
        As it is stored.

    Returns
    -------
    dict of str to list
        By size, in the order of :func:`coefficient_heads`; "prior" where the recording does
        not inform a number.
    """
    return {
        size: [_coefficient(entry, exponent(name)) for name, entry in coefficients.items()]
        for size, coefficients in fit.pulleys.items()
    }


def coefficient_heads(fit: FitFile) -> list[Column]:
    """Return a column for each coefficient of a pulley size, with its unit and power of ten."""
    coefficients = next(iter(fit.pulleys.values()), {})
    return [
        Column(symbol(name), unit_head(name, entry.unit)) for name, entry in coefficients.items()
    ]


def _coefficient(entry: ParameterSummary, exponent: int) -> Text:
    """Return a coefficient with its error, divided by its power of ten."""
    if not entry.informed:
        return "prior"
    return Strong(plus_minus(entry, exponent, of_mean=True))


def refitted_coefficients(diagnosis: DiagnosisFile) -> dict[str, tuple[float, float, float]]:
    """Return the law that was refitted with the named causes; empty without a cause.

    Parameters
    ----------
    diagnosis : DiagnosisFile
        As it is stored.

    Returns
    -------
    dict of str to tuple of float
        5 %, 50 % and 95 % quantile of each number, such as ``c2[small]``.
    """
    if not _acting_causes(diagnosis):
        return {}
    return {
        name: (number.after.q05, number.after.q50, number.after.q95)
        for name, number in diagnosis.law.items()
    }


def lacking_force(diagnosis: DiagnosisFile) -> str:
    """Return which force the laws of the claims lack: the causes, an unknown one, or none."""
    if diagnosis.verdict == "unknown":
        return "the unknown force"
    return " and ".join(cause.effect for cause in _acting_causes(diagnosis))


def biased(diagnosis: DiagnosisFile) -> Iterator[Notice]:
    """Yield a warning beside numbers of a law that lacks a named cause."""
    causes = _acting_causes(diagnosis)
    if causes:
        yield Notice(
            "attention",
            prose(
                "The law was fitted without {}, so its coefficients absorb part of that force.",
                Code(", ".join(cause.effect for cause in causes)),
            ),
            title="These coefficients are biased",
        )


def _dampings(law: Mapping[str, LawNumber], causes: Sequence[Cause]) -> dict[str, list[str]]:
    """Return viscous friction in the unit that a simulator takes, for each pulley size."""
    for cause in causes:
        slope = cause.parameters.get("slope")
        if cause.effect == "viscous" and cause.law in OF_SPEED and slope is not None:
            return {
                size: [_damping(law[f"c1[{size}]"].after, law[f"c2[{size}]"].after, slope)]
                for size in sizes_of(law)
                if {f"c1[{size}]", f"c2[{size}]"} <= {*law}
            }
    return {}


def _damping(c1: Interval, c2: Interval, slope: Interval) -> str:
    """Return the slope times the friction of a pulley at 15 N and 85°, with its error [N·s/m]."""
    friction = REFERENCE_TENSION_N * c1.q50 + c2.q50
    parts = (
        slope.q50 * REFERENCE_TENSION_N * half_width(c1),
        slope.q50 * half_width(c2),
        friction * half_width(slope),
    )
    return " ± ".join(error_cells(friction * slope.q50, math.hypot(*parts)))
