"""Conditions: those that somebody asked about, and those that would tell hypotheses apart."""

from collections.abc import Iterator, Mapping

from bayesfric.observation.feasible import name_and_unit
from bayesfric.plots.labels import axis_words
from bayesfric.report.content import Block, Column, Heading, Paragraph, Table, decimal_columns
from bayesfric.report.quantities import (
    format_factor,
    format_number,
    format_probability,
    format_unit,
)
from bayesfric.report.rig_words import rig_words
from bayesfric.report.words import codes
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.diagnosis import FrictionAsked


def asked(friction: FrictionAsked | None) -> Iterator[Block]:
    """Yield friction at conditions of the reader's own; nothing where none were asked about."""
    if friction is None:
        return
    yield Heading(2, "At your own conditions")
    unit = format_number(1.0, unit=friction.unit).partition("\u202f")[2] or friction.unit
    yield Table(
        f"Friction at the conditions of --target, and the error of the simulator there [{unit}].",
        [
            "condition",
            Column("friction (90 %)", align="left"),
            *decimal_columns("error without the causes", "error with them"),
            "beyond the data in",
        ],
        [
            [
                condition_words(row.condition),
                f"{row.written(row.friction.q50)} ({row.written(row.friction.q05)} to "
                f"{row.written(row.friction.q95)})",
                row.written(row.gap_without_causes.q50).replace("-", "−"),
                row.written(row.gap_with_causes.q50).replace("-", "−"),
                ", ".join(row.outside),
            ]
            for row in friction.rows
        ],
        label="asked",
    ).filled()
    stays = "; ".join(f"{name} {why}" for name, why in friction.stays_behind.items())
    if stays:
        yield Paragraph(f"Some causes do not carry over to these conditions: {stays}.")
    if friction.unknown_probability > 0:
        chance = format_probability(friction.unknown_probability)
        yield Paragraph(
            f"An unknown force (probability {chance}) is not extrapolated to these conditions."
        )


def next_experiment(diagnosis: DiagnosisFile) -> Iterator[Block]:
    """Yield conditions that would tell hypotheses apart."""
    if not diagnosis.next_experiment:
        yield Paragraph(f"Nothing to propose: {diagnosis.next_experiment_why}.")
        return
    yield Table(
        "Conditions that would tell hypotheses apart.",
        ["condition", "separates", Column("expected log₁₀ BF", align="decimal")],
        [
            [
                condition_words(proposed.condition),
                codes(proposed.separates),
                format_factor(proposed.log10_bayes_factor),
            ]
            for proposed in diagnosis.next_experiment
        ],
        label="next",
    )


def condition_words(condition: Mapping[str, float | str]) -> str:
    """Write a condition as people say it: 5 large pulleys, wrap angle 50°, mass load 2.552 kg."""
    left = dict(condition)
    said = []
    if "rig" in left:
        said.append(rig_words(str(left.pop("rig"))).rig)
    if {"n_pulleys", "pulley_size"} <= set(left):
        n, size = left.pop("n_pulleys"), left.pop("pulley_size")
        said.append(f"{_value(n)} {size} {'pulley' if n == 1 else 'pulleys'}")
    for name, value in left.items():
        own, unit = name_and_unit(name)
        words, printed = axis_words(own), format_unit(unit) if unit else ""
        space = "" if printed in ("", "°") else "\u202f"
        said.append(f"{words} {_value(value)}{space}{printed}")
    return ", ".join(said)


def _value(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.4g}".replace("-", "−")
