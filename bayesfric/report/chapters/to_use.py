"""The numbers to use where a cause is named: the law refitted with it, and the cause itself."""

from collections.abc import Iterator, Mapping, Sequence

from bayesfric.effects import all_effects
from bayesfric.effects.base import REFERENCE_TENSION_N
from bayesfric.plots.labels import ordered_sizes, sizes_of
from bayesfric.report.chapters.symbols import exponent, symbol, unit_head
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
)
from bayesfric.report.diagnosed import has_gap
from bayesfric.report.quantities import MISSING, error_cells
from bayesfric.schemas import (
    Cause,
    DiagnosisFile,
    FitFile,
    Interval,
    LawNumber,
    ParameterSummary,
)


def _acting_causes(diagnosis: DiagnosisFile) -> Sequence[Cause]:
    """Return the named causes that make a gap; none under another verdict."""
    if diagnosis.verdict != "named":
        return ()
    return tuple(cause for cause in diagnosis.causes if cause.makes_a_gap)


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
    Table
        One at most; none for a joint, whose numbers :func:`numbers_to_enter` has.
    """
    causes = _acting_causes(diagnosis)
    if diagnosis.enter:
        return
    if causes:
        yield _with_causes(diagnosis.law, causes)
    if causes or not alone or not diagnosis.law:
        return
    yield Table(
        "Coefficients of the recalibrated law.",
        ["number", "unit", "value"],
        [
            [
                symbol(name),
                unit_head(name, number.unit),
                Strong(_with_error(number.before, exponent(name))),
            ]
            for name, number in _by_size(diagnosis.law)
        ],
        label="use",
        note="Median ± half of the 90 % interval."
        + (" The gap is not in them." if has_gap(diagnosis) else ""),
    )


def _with_causes(law: Mapping[str, LawNumber], causes: Sequence[Cause]) -> Table:
    """Return the law refitted with the causes beside the law alone, and the causes' parameters."""
    names = " and ".join(cause.effect for cause in causes)
    rows: list[list[Text]] = [
        [
            symbol(name),
            unit_head(name, number.unit),
            Strong(_with_error(number.after, exponent(name))),
            _with_error(number.before, exponent(name)),
        ]
        for name, number in _by_size(law)
    ]
    rows += [
        [Code(f"{cause.effect}.{name}"), number.unit, Strong(_with_error(number)), MISSING]
        for cause in causes
        for name, number in cause.parameters.items()
    ]
    return Table(
        f"Use these numbers: the law refitted together with {names}.",
        ["number", "unit", "use", "law alone (biased)"],
        rows,
        label="use",
        note=[
            "Median ± half of the 90 % interval. The law alone takes up a part of the force of "
            f"{names}, so that its coefficients are biased: fit.json, draws.nc and the chapters on "
            "the fit have these. ",
            *_meanings(causes),
            *_dampings(law, causes),
        ],
    )


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
    scale = 10.0**-exponent
    return Strong(" ± ".join(error_cells(scale * entry.mean, scale * (entry.q95 - entry.q05) / 2)))


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


def claims_beside(diagnosis: DiagnosisFile) -> Iterator[Paragraph]:
    """Yield that the claims were judged without the force that the diagnosis found."""
    causes = " and ".join(cause.effect for cause in _acting_causes(diagnosis))
    if causes or diagnosis.verdict == "unknown":
        yield Paragraph(
            f"The claims are judged with laws that lack {causes or 'the unknown force'}: where one "
            "is refuted, that force may be the reason."
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


def _by_size(law: Mapping[str, LawNumber]) -> list[tuple[str, LawNumber]]:
    """Return the numbers of a law, pulley sizes in their usual order, others behind."""
    sizes = ordered_sizes(sizes_of(law))
    places = {f"[{size}]": place for place, size in enumerate(sizes)}
    return sorted(
        law.items(), key=lambda item: places.get(item[0][item[0].find("[") :], len(sizes))
    )


def _meanings(causes: Sequence[Cause]) -> Iterator[Inline]:
    """Yield what each parameter of a cause means, where its effect is known here."""
    examined = all_effects(None)
    for cause in causes:
        effect = examined.get(cause.effect)
        for parameter in () if effect is None else effect.parameters:
            if parameter.name in cause.parameters:
                yield Code(f"{cause.effect}.{parameter.name}")
                yield f": {parameter.meaning}. "


def _dampings(law: Mapping[str, LawNumber], causes: Sequence[Cause]) -> Iterator[str]:
    """Yield viscous friction in the unit that a simulator takes, for each pulley size."""
    for cause in causes:
        slope = cause.parameters.get("slope")
        sizes = [
            size
            for size in ordered_sizes(sizes_of(law))
            if {f"c1[{size}]", f"c2[{size}]"} <= {*law}
        ]
        if cause.effect != "viscous" or cause.law != "constant" or slope is None or not sizes:
            continue
        damping = [f"{_of_a_pulley(law, size) * slope.q50:.2g} ({size})" for size in sizes]
        yield f"As a damping of one pulley: {', '.join(damping)} N·s/m. "


def _of_a_pulley(law: Mapping[str, LawNumber], size: str) -> float:
    """Return the refitted friction of one pulley at 15 N and 85° [N]."""
    return REFERENCE_TENSION_N * law[f"c1[{size}]"].after.q50 + law[f"c2[{size}]"].after.q50


def _with_error(number: Interval, exponent: int = 0) -> str:
    scale = 10.0**-exponent
    half = (number.q95 - number.q05) / 2
    return " ± ".join(error_cells(scale * number.q50, scale * half))
