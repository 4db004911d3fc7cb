"""The coefficients, the scatter and the noise of the sensors."""

from collections.abc import Iterable, Iterator, Sequence

from bayesfric.paper import table1
from bayesfric.plots.labels import parts
from bayesfric.report.chapters.plain_law import plain_coefficients, plain_table
from bayesfric.report.chapters.symbols import (
    EXPONENTS,
    coefficient_cells,
    estimate_cells,
    exponent,
    scaled,
    symbol,
    unit_head,
)
from bayesfric.report.content import Block, Heading, Paragraph, Table, decimal_columns
from bayesfric.report.quantities import MISSING
from bayesfric.report.rig_words import group_words, rig_words
from bayesfric.report.stored import StoredFit
from bayesfric.schemas import FitFile
from bayesfric.schemas.parameter import ParameterSummary


def summary(stored: StoredFit, warnings: Iterable[Block] = ()) -> Iterator[Block]:
    """Yield the coefficients and the scatter.

    Parameters
    ----------
    stored : StoredFit
        Whose numbers they are.
    warnings : iterable of blocks
        That stand before them.
    """
    fit = stored.fit
    yield Heading(1, "Coefficients")
    yield from warnings
    if fit.pulleys:
        yield _of_pulleys(fit)
        yield from _not_estimated(fit)
    plain = plain_coefficients(fit)
    if plain:
        yield plain_table(fit)
    yield Heading(2, "Scatter and noise")
    rows = [
        [
            symbol(name),
            meaning(name, fit.rigs),
            unit_head(name, entry.unit),
            *estimate_cells(entry, exponent(name)),
        ]
        for name, entry in {**fit.scatter, **fit.noise, **fit.parameters}.items()
        if name not in plain
    ]
    yield Table(
        "How friction scatters around the law, and the noise of the sensors.",
        ["", "meaning", "unit", *decimal_columns("mean", "sd", "5 %", "95 %")],
        rows,
        label="scatter",
    )


def _of_pulleys(fit: FitFile) -> Table:
    """Return the coefficients of each pulley size beside the paper's."""
    rows = []
    for size, coefficients in fit.pulleys.items():
        for name, entry in coefficients.items():
            printed = getattr(table1()[size], name).value if size in table1() else None
            point = getattr(fit.paper_estimator.get(size), name, None)
            rows.append(
                [
                    *coefficient_cells(size, name, entry.unit),
                    *estimate_cells(entry, EXPONENTS[name]),
                    scaled(point, EXPONENTS[name]),
                    scaled(printed, EXPONENTS[name]),
                    _inside(entry, printed),
                ]
            )
    return Table(
        "Posterior of the friction coefficients, beside the paper's values.",
        [
            "pulley",
            "coefficient",
            *decimal_columns("mean", "sd", "5 %", "95 %", "paper's estimator", "paper"),
            "inside 90 %",
        ],
        rows,
        label="coefficients",
        note="Paper's estimator: the paper's least-squares fits of straight lines, on these "
        "trials; they give no uncertainty. Paper: as printed in its Table I. Inside: whether the "
        "paper's value lies in the 90 % interval; “prior”: the recording does not inform the "
        "number, its prior decides it.",
    )


def _not_estimated(fit: FitFile) -> Iterator[Paragraph]:
    """Yield why the paper's own estimator has no value, where it has none."""
    reasons = [
        f"{name} of {size} ({why})"
        for size, point in fit.paper_estimator.items()
        for name in ("c1", "c2", "c3")
        if (why := getattr(point, f"{name}_why")) is not None
    ]
    if reasons:
        yield Paragraph(f"The paper's own estimator has no {'; no '.join(reasons)}.")


MEANINGS = {
    "tau": "relative scatter of friction from trial to trial",
    "omega": "relative scatter of friction from {group} to {group}",
    "omega_intercept": "relative scatter of c2 alone from {group} to {group}",
    "wander": "relative rms of the friction that varies along the travel of a trial",
    "wander_length": "correlation length of friction along the travel of a trial",
    "sigma_x": "position error of a Hall event",
    "sigma_t": "clock error of a Hall event",
    "sigma_a": "error of an acceleration that has no standard error",
    "sigma_friction": "noise of a measured friction",
    "sigma_current": "noise of a current without load",
    "load_noise": "noise of a current per load current",
    "row_error": "error of a window's force over what the sensors' noise predicts",
    "latency": "time by which the clock of the force is ahead of that of the position",
    "torque_constant_factor": "torque constant over the specified one",
}


def meaning(name: str, rigs: Sequence[str]) -> str:
    """Return what a parameter of scatter or noise is; its name, where a rig brought its own.

    Parameters
    ----------
    name : str
        Of the parameter, as stored.
    rigs : sequence of str
        Of the fit.
    """
    stem, whose = parts(name)
    rig = whose.partition(" ")[0] if "_" in name else ""
    said = MEANINGS.get(stem, stem).format(group=group_words(rigs)[0])
    return said + (f", {rig_words(rig).rig}" if rig else "")


def _inside(entry: ParameterSummary, printed: float | None) -> str:
    if not entry.informed:
        return "prior"
    if printed is None:
        return MISSING
    return "yes" if entry.q05 <= printed <= entry.q95 else "no"
