"""Page one: what the data are, what must be known first, and the coefficients."""

from collections.abc import Iterator

from bayesfric.paper import table1
from bayesfric.plots.posterior import coefficients_relative_to_paper
from bayesfric.plots.style import to_svg
from bayesfric.report.chapters.symbols import EXPONENTS, symbol, unit_head
from bayesfric.report.content import Block, Code, Column, Figure, Heading, Notice, Paragraph, Table
from bayesfric.report.quantities import MISSING, format_count, format_number, interval_cells
from bayesfric.report.stored import StoredResults
from bayesfric.schemas import DataQuality, ParameterSummary

__all__ = ["front", "summary"]


def front(stored: StoredResults) -> Iterator[Block]:
    """Yield what stands before the table of contents."""
    fit = stored.fit
    quality = fit.data_quality
    yield Paragraph(
        [
            "Recording ",
            Code(fit.recording.name),
            f": {fit.recording.title}. {_entered(quality)}",
        ]
    )
    if fit.converged:
        yield Notice(
            "good",
            "Every R-hat and every effective sample size is within its bound.",
            title="Converged",
        )
    else:
        yield Notice(
            "attention",
            "The draws have not converged: no number below may be used before the sampler has "
            "run longer.",
            title="Unconverged",
        )
    for line in fit.attention:
        yield Notice("attention", line)


def summary(stored: StoredResults) -> Iterator[Block]:
    """Yield the coefficients and the scatter."""
    fit = stored.fit
    yield Heading(1, "Coefficients")
    rows = []
    for size, coefficients in fit.pulleys.items():
        for name, entry in coefficients.items():
            printed = getattr(table1()[size], name).value if size in table1() else None
            point = getattr(fit.paper_estimator.get(size), name, None)
            rows.append(
                [
                    size,
                    symbol(name),
                    unit_head(name, entry.unit),
                    *interval_cells(entry.mean, entry.q05, entry.q95, EXPONENTS[name]),
                    _cell(point, EXPONENTS[name]),
                    _cell(printed, EXPONENTS[name]),
                    _inside(entry, printed),
                ]
            )
    yield Table(
        "Posterior of the friction coefficients, and the paper's Table I.",
        [
            "pulley",
            "",
            "unit",
            Column("mean", align="decimal"),
            Column("5 %", align="decimal"),
            Column("95 %", align="decimal"),
            Column("as the paper", align="decimal"),
            Column("Table I", align="decimal"),
            "inside 90 %",
        ],
        rows,
        label="coefficients",
        note="The interval is equal-tailed. “As the paper” is the paper's own estimator on the "
        "same trials: least squares, slope by slope, without an uncertainty. A coefficient marked "
        "“prior” is driven by its prior: "
        "the recording does not inform it.",
    )
    if "ratio" in stored.predictive["coefficients"].data_vars:
        yield Figure(
            to_svg(coefficients_relative_to_paper(stored.predictive)),
            "Posterior of each coefficient over its value in Table I. A bar that misses the dashed "
            "line at one says that data and paper differ by more than the uncertainty.",
            "Horizontal bars, one for each coefficient and pulley size, of the 50 and 90 percent "
            "intervals relative to the paper's value, which is a dashed vertical line at one.",
            label="relative",
        )
    yield Heading(2, "Scatter and noise")
    rows = [
        [
            symbol(name),
            MEANINGS[name.partition("[")[0]],
            unit_head(name, entry.unit),
            *interval_cells(entry.mean, entry.q05, entry.q95, EXPONENTS.get(_stem(name), 0)),
        ]
        for name, entry in {**fit.scatter, **fit.noise, **fit.parameters}.items()
    ]
    yield Table(
        "How friction scatters around the law, and the noise of the sensors.",
        [
            "",
            "meaning",
            "unit",
            Column("mean", align="decimal"),
            Column("5 %", align="decimal"),
            Column("95 %", align="decimal"),
        ],
        rows,
        label="scatter",
    )


def _entered(quality: DataQuality) -> str:
    """Return what entered the fit, in a sentence."""
    parts = []
    if quality.trials_used:
        parts.append(
            f"{format_count(quality.trials_used)} of {format_count(quality.trials)} gravity trials "
            f"on {format_count(quality.setups)} assemblies, with {format_count(quality.events)} "
            "Hall events"
        )
    if quality.motor_runs:
        parts.append(f"{format_count(quality.motor_runs)} runs of the motor board")
    return f"What enters: {'; '.join(parts)}."


MEANINGS = {
    "tau": "relative scatter of friction from trial to trial",
    "omega": "relative scatter of friction from assembly to assembly",
    "sigma_x": "position error of a Hall event",
    "sigma_t": "clock error of a Hall event",
    "sigma_a": "error of an acceleration without a standard error",
    "tau_motor": "relative scatter of friction from motor run to motor run",
    "omega_motor": "relative scatter of friction between assemblies of the motor board",
    "sigma_current": "noise of a current without load",
    "load_noise": "noise of a current per load current",
    "torque_constant_factor": "torque constant over the specified one",
}


def _stem(name: str) -> str:
    return name.partition("[")[0]


def _cell(value: float | None, exponent: int) -> str:
    """Return a number divided by the power of ten that the unit's cell states."""
    return MISSING if value is None else format_number(value, exponent=exponent).split(" ")[0]


def _inside(entry: ParameterSummary, printed: float | None) -> str:
    if not entry.informed:
        return "prior"
    if printed is None:
        return MISSING
    return "yes" if entry.q05 <= printed <= entry.q95 else "no"
