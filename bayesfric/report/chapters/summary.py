"""Page one: what the data are, what must be known first, and the coefficients."""

from collections.abc import Iterator

from bayesfric.paper import table1
from bayesfric.plots.posterior import coefficients_relative_to_paper
from bayesfric.plots.style import to_svg
from bayesfric.report.chapters.diagnosis import verdict_line
from bayesfric.report.chapters.margins import gain_lines
from bayesfric.report.chapters.symbols import EXPONENTS, symbol, unit_head
from bayesfric.report.content import (
    Block,
    BulletList,
    Code,
    Column,
    Figure,
    Heading,
    Inline,
    Notice,
    Paragraph,
    Strong,
    Table,
)
from bayesfric.report.quantities import MISSING, format_count, format_number, interval_cells
from bayesfric.report.stored import StoredResults
from bayesfric.schemas import DataQuality, FitFile, ParameterSummary

__all__ = ["front", "summary"]

BOXES = 3  # remarks; more of them as boxes would fill page one


def front(stored: StoredResults) -> Iterator[Block]:
    """Yield what stands before the table of contents."""
    fit = stored.fit
    quality = fit.data_quality
    title = fit.recording.title
    yield Paragraph(
        [
            "Recording ",
            Code(fit.recording.name),
            f": {title}. " if title else ". ",
            _entered(quality),
            *_synthetic(f"{title} {fit.recording.name}"),
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
    if stored.diagnosis is not None:
        yield verdict_line(stored.diagnosis.found)
    if stored.margins is not None:
        yield from gain_lines(stored.margins)
    if len(fit.attention) <= BOXES:
        for line in fit.attention:
            yield Notice("attention", line)
    else:
        count = len(fit.attention)
        yield Notice("attention", f"{count} remarks must be read before the numbers:")
        yield BulletList(fit.attention)


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
                    (*symbol(name), f" [{unit_head(name, entry.unit)}]"),
                    *_cells(entry, EXPONENTS[name]),
                    _cell(point, EXPONENTS[name]),
                    _cell(printed, EXPONENTS[name]),
                    _inside(entry, printed),
                ]
            )
    yield Table(
        "Posterior of the friction coefficients, and the paper's Table I.",
        [
            "pulley",
            "coefficient",
            Column("mean", align="decimal"),
            Column("sd", align="decimal"),
            Column("5 %", align="decimal"),
            Column("95 %", align="decimal"),
            Column("as the paper", align="decimal"),
            Column("Table I", align="decimal"),
            "inside 90 %",
        ],
        rows,
        label="coefficients",
        note="As the paper: its own estimator on the same trials, least squares slope by slope, "
        "without an uncertainty. Inside: whether Table I lies in the 90 % interval; “prior” where "
        "the recording does not inform the coefficient, so that its prior drives it.",
    )
    yield from _not_estimated(fit)
    if "ratio" in stored.predictive["coefficients"].data_vars:
        yield Figure(
            to_svg(coefficients_relative_to_paper(stored.predictive, _uninformed(fit))),
            [
                "Posterior of each coefficient over its value in Table I: median and the 50 % and "
                "90 % intervals. A bar that misses the dashed line at one says that data and paper "
                "differ by more than the uncertainty. From ",
                Code("predictive.nc"),
                ".",
            ],
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
            *_cells(entry, EXPONENTS.get(_stem(name), 0)),
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
            Column("sd", align="decimal"),
            Column("5 %", align="decimal"),
            Column("95 %", align="decimal"),
        ],
        rows,
        label="scatter",
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
    "omega_intercept": "relative scatter of c2 from assembly to assembly, beside that",
    "wander": "relative rms of friction that wanders along the travel of a trial",
    "wander_length": "correlation length of the wander",
    "sigma_x": "position error of a Hall event",
    "sigma_t": "clock error of a Hall event",
    "sigma_a": "error of an acceleration without a standard error",
    "tau_motor": "relative scatter of friction from motor run to motor run",
    "omega_motor": "relative scatter of friction between assemblies of the motor board",
    "omega_intercept_motor": "relative scatter of c2 between assemblies of the motor board",
    "sigma_current": "noise of a current without load",
    "load_noise": "noise of a current per load current",
    "torque_constant_factor": "torque constant over the specified one",
}


def _cells(entry: ParameterSummary, exponent: int) -> tuple[str, str, str, str]:
    """Return mean, sd, 5 % and 95 % quantile."""
    mean, q05, q95 = interval_cells(entry.mean, entry.q05, entry.q95, exponent)
    return mean, _cell(entry.sd, exponent, digits=2), q05, q95


def _uninformed(fit: FitFile) -> tuple[str, ...]:
    return tuple(
        f"{name}[{size}]"
        for size, coefficients in fit.pulleys.items()
        for name, entry in coefficients.items()
        if not entry.informed
    )


def _synthetic(called: str) -> tuple[Inline, ...]:
    """Return a warning where the recording calls itself simulated."""
    if not any(word in called.casefold() for word in ("synthetic", "simulat")):
        return ()
    return (
        " ",
        Strong("Synthetic data:"),
        " simulated, not measured.",
    )


def _stem(name: str) -> str:
    return name.partition("[")[0]


def _cell(value: float | None, exponent: int, digits: int = 3) -> str:
    """Return a number divided by the power of ten that stands beside it."""
    return MISSING if value is None else format_number(value, digits, None, exponent).split(" ")[0]


def _inside(entry: ParameterSummary, printed: float | None) -> str:
    if not entry.informed:
        return "prior"
    if printed is None:
        return MISSING
    return "yes" if entry.q05 <= printed <= entry.q95 else "no"
