"""Friction at conditions that somebody asked for."""

from collections.abc import Iterator

from bayesfric.report.chapters.diagnosis_details import condition_words
from bayesfric.report.content import Block, Column, Heading, Paragraph, Table
from bayesfric.report.quantities import format_number, format_probability
from bayesfric.schemas import FrictionAsked

__all__ = ["asked"]


def asked(found: FrictionAsked | None) -> Iterator[Block]:
    """Yield friction at conditions of the reader's own; nothing where none were asked about."""
    if found is None:
        return
    yield Heading(2, "At your own conditions")
    unit = format_number(1.0, unit=found.unit).partition("\u202f")[2] or found.unit
    yield Table(
        f"Friction at the conditions asked for, and what a simulator misses of it [{unit}].",
        [
            "condition",
            Column("friction (90 %)", align="left"),
            Column("missed without the causes", align="decimal"),
            Column("missed with them", align="decimal"),
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
            for row in found.rows
        ],
        label="asked",
    ).filled()
    stays = "; ".join(f"{name} {why}" for name, why in found.stays_behind.items())
    if stays:
        yield Paragraph(f"Some causes stay behind: {stays}.")
    if found.unknown_probability > 0:
        chance = format_probability(found.unknown_probability)
        yield Paragraph(
            f"An unknown force, of probability {chance}, is carried to no other condition."
        )
