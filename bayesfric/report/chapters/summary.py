"""Page one: what the data are, what must be known first, and the coefficients."""

from collections.abc import Iterator

from bayesfric.paper import table1
from bayesfric.plots.labels import parts
from bayesfric.plots.posterior import coefficients_relative_to_paper
from bayesfric.plots.rig_tables import rig_tables
from bayesfric.plots.style import to_svg
from bayesfric.report.chapters.symbols import EXPONENTS, exponent, symbol, unit_head
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
from bayesfric.report.rig_words import rig_words
from bayesfric.report.stored import StoredFit
from bayesfric.schemas import FitFile, ParameterSummary, RecordingId

__all__ = ["convergence", "front", "recorded", "summary"]

BOXES = 3  # remarks; more of them as boxes would fill page one


def recorded(recording: RecordingId, fitted: StoredFit | None) -> Paragraph:
    """Return which recording it is, and what of it enters the fit."""
    title = recording.title
    return Paragraph(
        [
            "Recording ",
            Code(recording.name),
            f": {title}. " if title else ". ",
            *([_entered(fitted)] if fitted is not None else []),
            *_synthetic(f"{title} {recording.name}"),
        ]
    )


def convergence(fit: FitFile) -> Notice:
    """Return whether the draws can be used."""
    if fit.converged:
        return Notice(
            "good",
            "Every R-hat and every effective sample size is within its bound.",
            title="Converged",
        )
    return Notice(
        "attention",
        "The draws have not converged: no number below may be used before the sampler has run "
        "longer.",
        title="Unconverged",
    )


def front(fit: FitFile) -> Iterator[Block]:
    """Yield what must be read before the numbers."""
    if len(fit.attention) <= BOXES:
        for line in fit.attention:
            yield Notice("attention", line)
    else:
        count = len(fit.attention)
        yield Notice("attention", f"{count} remarks must be read before the numbers:")
        yield BulletList(fit.attention)


def summary(stored: StoredFit) -> Iterator[Block]:
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
            meaning(name),
            unit_head(name, entry.unit),
            *_cells(entry, exponent(name)),
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


def _entered(stored: StoredFit) -> str:
    """Return what entered the fit, in a sentence."""
    quality = stored.fit.data_quality
    said = [
        f"{format_count(one.count)} {one.trials} of the {one.title}"
        for one in rig_tables(stored.predictive)
    ]
    if quality.events:
        said.append(f"{format_count(quality.events)} Hall events")
    return f"What enters: {'; '.join(said)}."


MEANINGS = {
    "tau": "relative scatter of friction from trial to trial",
    "omega": "relative scatter of friction from assembly to assembly",
    "sigma_x": "position error of a Hall event",
    "sigma_t": "clock error of a Hall event",
    "sigma_a": "error of an acceleration without a standard error",
    "sigma_current": "noise of a current without load",
    "load_noise": "noise of a current per load current",
    "torque_constant_factor": "torque constant over the specified one",
}


def meaning(name: str) -> str:
    """Return what a parameter of scatter or noise is; its name, where a rig brought its own."""
    stem, whose = parts(name)
    rig = whose.partition(" ")[0] if "_" in name else ""
    return MEANINGS.get(stem, stem) + (f", {rig_words(rig).rig}" if rig else "")


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


def _cell(value: float | None, exponent: int, digits: int = 3) -> str:
    """Return a number divided by the power of ten that stands beside it."""
    return MISSING if value is None else format_number(value, digits, None, exponent).split(" ")[0]


def _inside(entry: ParameterSummary, printed: float | None) -> str:
    if not entry.informed:
        return "prior"
    if printed is None:
        return MISSING
    return "yes" if entry.q05 <= printed <= entry.q95 else "no"
