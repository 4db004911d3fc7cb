"""Controller margins: which compensation gain to set, and what else is left."""

from collections.abc import Iterator

from bayesfric.margins.terms import (
    certificate_sentence,
    chance_of_missing,
    in_degrees_or_decibels,
    tuning_sentence,
)
from bayesfric.plots.margins import errors_over_time
from bayesfric.plots.style import svg_of
from bayesfric.report.chapters.gain import (
    ASSUMED,
    LAW,
    gain_figures,
    key_words,
)
from bayesfric.report.chapters.margins_figures import over_frequency, over_speed
from bayesfric.report.chapters.specs import SHOWN_UNITS, WORDS
from bayesfric.report.content import (
    Block,
    BulletList,
    Code,
    Column,
    Emphasis,
    Figure,
    Heading,
    Inline,
    Notice,
    Paragraph,
    Strong,
    Table,
    decimal_columns,
    from_file,
    right_columns,
)
from bayesfric.report.quantities import (
    MISSING,
    format_count,
    format_number,
    format_share,
    interval_cells,
)
from bayesfric.report.words import sentences
from bayesfric.schemas import MarginsFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.loop_runs import Held
from bayesfric.schemas.margins import LoopMargins, Metric

SMALL_SHARE = 0.02  # of a variance, not worth a column


def margins(record: MarginsFile, *, alone: bool) -> Iterator[Block]:
    """Yield the chapter on ``margins.json``.

    Parameters
    ----------
    record : MarginsFile
        What ``bayesfric margins`` wrote.
    alone : bool
        Whether its figures stand on page one.
    """
    yield Heading(1, "Controller margins", label="margins")
    for loop in record.loops:
        verdict, *rest = sentences(loop.answer)
        yield Paragraph([Code(loop.name), ": ", Strong(verdict)])
        yield BulletList(rest)
    if record.law is not None:
        yield Paragraph(record.law.sentence)
    yield Paragraph(
        f"All metrics are over {format_count(record.draws)} draws of a new assembly. They include "
        "the posterior of the friction law, the scatter between assemblies, and a difference "
        f"between rigs of {format_share(record.rig_discrepancy)} "
        f"(sd; {record.rig_discrepancy_source}). "
        "P(violates) is the share of the draws that miss the spec, with its Monte Carlo error. "
        "Angles and torques at the motor are those of its shaft."
    )
    if not alone:
        yield from gain_figures(record)
    for loop in record.loops:
        yield from _loop(loop, assumed=not alone)


def _loop(loop: LoopMargins, *, assumed: bool) -> Iterator[Block]:
    """Yield all of a loop; what it assumes only if page one has not said it."""
    yield Heading(2, f"Loop {loop.name}")
    if loop.title:
        yield Paragraph(f"{loop.title}.")
    if loop.plant is not None:
        yield Paragraph(loop.plant.sentence)
    warnings = [line for line in loop.warnings if assumed or not line.startswith(ASSUMED)]
    if warnings:
        yield Notice(
            "attention",
            f"{len(warnings)} {'remark' if len(warnings) == 1 else 'remarks'} on these numbers:",
            points=[_sentence(warning) for warning in warnings],
        )
    yield Table(
        ["Metrics of ", Code(loop.name), " over the draws."],
        [
            "metric",
            "unit",
            "at",
            *decimal_columns("median", "5 %", "95 %"),
            *right_columns("spec", "P(violates)", "±"),
        ],
        [
            _row(row)
            for metric in loop.metrics
            for row in (metric, in_degrees_or_decibels(metric))
            if row is not None and (row.interval is not None or row.spec is not None)
        ]
        + _certified(loop),
        label=f"margins-{loop.name}",
        note="A dash: the metric does not exist; the reason is below the table.",
    ).filled()
    yield BulletList(list(_remarks(loop)))
    if (certificate := certificate_sentence(loop)) is not None:
        covers = loop.certificate and f" It holds {loop.certificate.covers}."
        yield Paragraph([certificate, covers or ""])
    if loop.tuning is not None:
        yield Paragraph(tuning_sentence(loop.tuning))
    yield from over_speed(loop)
    yield from _following(loop)
    yield from _shares(loop)
    yield from _verification(loop)
    yield from _before_and_after(loop)
    yield from over_frequency(loop)


def _sentence(text: str) -> str:
    """Return a remark with a capital, unless it begins with a symbol, and a full stop."""
    first = text.partition(" ")[0]
    begun = text[:1].upper() + text[1:] if first.isalpha() else text
    return begun if begun.endswith(".") else f"{begun}."


def _following(loop: LoopMargins) -> Iterator[Block]:
    """Yield how the joint follows references that move."""
    following = loop.following
    if following is None:
        yield Paragraph(f"No tracking errors on moving references: {loop.following_why}.")
        return
    yield Paragraph(following.answer)
    yield BulletList(
        [
            [Emphasis(trajectory.name), f": {trajectory.sentence}."]
            for trajectory in following.trajectories
        ]
    )
    yield Figure(
        svg_of(errors_over_time, following),
        from_file(
            "margins.json",
            f"Tracking error at the tool tip over {format_count(following.draws)} draws: the "
            "median with each compensator, and 5 % to 95 % with none and with the best. Grey: the "
            "time that is judged.",
        ),
        "Four panels of bands over time: ramp, reversal, sine and step, a colour a compensator.",
        label=f"following-{loop.name}",
    )
    yield Table(
        ["Tracking error of ", Code(loop.name), " at the tool tip on moving references [mm]."],
        [
            "trajectory",
            "compensator",
            *decimal_columns("rms", "5 %", "95 %"),
            *decimal_columns("peak", "5 %", "95 %"),
            Column("least", align="right"),
        ],
        [
            [
                trajectory.name,
                followed.compensator,
                *_cells(followed.rms_m, 1e3),
                *_cells(followed.peak_m, 1e3),
                format_share(followed.least),
            ]
            for trajectory in following.trajectories
            for followed in trajectory.compensators
        ],
        label=f"followed-{loop.name}",
        note="Reference minus joint, with the load and the stretch of the cable; judged for "
        f"{format_number(following.settling_s, 3)} s once the loop has settled, of a reversal "
        "from the turn on. Compensators have the file's γ and F̂; the sign of the error is linear "
        f"within ± {format_number(following.error_band_rad, 3)} rad of the motor, over which, or "
        "over 2γF̂/kp, the LuGre observer's friction builds up; the disturbance observer's "
        "low-pass has its corner at "
        f"{format_number(following.disturbance_cutoff_rad_s, 3)} rad/s; neither observer is "
        "examined for hunting. Least: share of the draws in "
        "which the rms error is within 2 % of the least.",
    )


def _row(metric: Metric) -> list[str]:
    unit, scale = SHOWN_UNITS.get(metric.unit, (metric.unit, 1.0))
    name = WORDS.get(metric.name, metric.name)
    if metric.direction is not None:
        name += f", {metric.direction}"
    judged = ["", "", ""]
    if metric.spec is not None:
        chance = metric.probability_of_violation
        judged = [
            f"{'≥' if metric.sense == 'at least' else '≤'} {format_number(scale * metric.spec, 3)}",
            chance_of_missing(metric) or MISSING,
            MISSING if chance is None else format_number(metric.monte_carlo_se, 1),
        ]
    return [name, unit, metric.place, *_cells(metric.interval, scale), *judged]


def _certified(loop: LoopMargins) -> list[list[str]]:
    """Return the row of the largest certified gain, where there is one."""
    certificate = loop.certificate
    if certificate is None or certificate.gamma is None:
        return []
    return [
        [
            "certified γ (circle criterion)",
            "",
            "loop",
            *_cells(certificate.gamma, 1.0),
            *["", "", ""],  # a draw that is not certified violates nothing
        ]
    ]


def _cells(interval: Interval | None, scale: float) -> tuple[str, str, str]:
    if interval is None:
        return MISSING, MISSING, MISSING
    return interval_cells(scale * interval.q50, scale * interval.q05, scale * interval.q95)


def _remarks(loop: LoopMargins) -> Iterator[list[Inline]]:
    """Yield what is said of the figures, figures of one remark together."""
    said: dict[str, list[str]] = {}
    for metric in loop.metrics:
        name = WORDS.get(metric.name, metric.name)
        text = metric.interval_why if metric.interval is None else metric.note
        if text and name not in said.setdefault(text, []):
            said[text].append(name)
    for text, names in said.items():
        yield [Emphasis("; ".join(names)), f": {text}."]


def _shares(loop: LoopMargins) -> Iterator[Block]:
    """Yield what explains the variance, where anything varies."""
    if not loop.variance_share:
        return
    groups = [
        group
        for group in next(iter(loop.variance_share.values()))
        if group == LAW
        or any(shares[group] >= SMALL_SHARE for shares in loop.variance_share.values())
    ]
    shown = [
        (name, shares)
        for name, shares in loop.variance_share.items()
        if name.partition(" ")[0] in WORDS
    ]
    yield Table(
        ["Sources of the spread of ", Code(loop.name), ": first-order shares of variance."],
        ["metric", *(Column(key_words(group), align="right") for group in groups)],
        [
            [_worded(name), *(_shown_share(shares[group]) for group in groups)]
            for name, shares in shown
        ],
        label=f"shares-{loop.name}",
        note="c1, c2 and c3 are correlated and count as one; a dot is less than 2 %. What is "
        "missing to 100 % comes from interactions of these numbers.",
    )


def _shown_share(share: float) -> str:
    return format_share(share) if share >= SMALL_SHARE else "·"


def _worded(label: str) -> str:
    name, _, direction = label.partition(" ")
    return WORDS[name] + (f" {direction}" if direction else "")


def _before_and_after(loop: LoopMargins) -> Iterator[Block]:
    """Yield the margins with the effects of a diagnosis, beside those without."""
    after = loop.with_effects
    if after is None:
        return
    yield Paragraph(
        [
            Strong(f"With {', '.join(after.effects) or 'the law refitted'}, as diagnosed. "),
            after.answer,
            *(f" Left out: {text}." for text in after.left_out),
        ]
    )
    rows = []
    for before, now in zip(loop.metrics, after.metrics, strict=True):
        if before.interval != now.interval:
            name, unit, place, *left, _, left_chance, _ = _row(before)
            _, _, _, *right, _, right_chance, _ = _row(now)
            rows.append([name, unit, place, *left, *right, left_chance, right_chance])
    if rows:
        yield Table(
            ["Before and after the diagnosed effects: ", Code(loop.name), "."],
            [
                "metric",
                "unit",
                "at",
                *decimal_columns("before", "5 %", "95 %"),
                *decimal_columns("after", "5 %", "95 %"),
                *right_columns("P before", "P after"),
            ],
            rows,
            label=f"effects-{loop.name}",
            note="Medians with 5 % and 95 %, and P(violates); metrics that do not change are left "
            "out.",
        )


def _verification(loop: LoopMargins) -> Iterator[Block]:
    """Yield how the figures hold where motor and joint are on an elastic cable."""
    verified = loop.verification
    if verified is None:
        yield Paragraph(
            "Not compared with a simulation of motor and joint on an elastic cable: "
            f"{loop.verification_why}."
        )
        return
    yield Table(
        [
            f"Metrics of {format_count(verified.draws)} draws of ",
            Code(loop.name),
            ", compared with a simulation of motor and joint on an elastic cable that has friction "
            "along its run, with the whole load.",
        ],
        [
            "metric",
            *right_columns("draws", "agrees in", "95 % interval"),
            *decimal_columns("simulated / reported", "5 %", "95 %"),
        ],
        [_held(figure) for figure in verified.held],
        label=f"verified-{loop.name}",
        note=f"Agrees: within {format_share(verified.tolerance)}. Errors at rest are upper bounds, "
        "and their ratio says how near the largest simulated one came. The draws were kicked by "
        f"{format_number(verified.kick.q50)} rad at the motor (median).",
    )
    missing = [
        f"{figure.what}: {figure.share_why}" for figure in verified.held if figure.share is None
    ]
    if missing:
        yield BulletList([f"Not compared: {text}." for text in missing])


def _held(figure: Held) -> list[str]:
    if figure.share is None:
        return [figure.what, format_count(0), *[MISSING] * 5]
    return [
        figure.what,
        format_count(figure.draws),
        format_share(figure.share),
        f"{format_share(figure.low)} to {format_share(figure.high)}",
        *_cells(figure.ratio, 1.0),
    ]
