"""The chapters in order."""

from collections.abc import Callable, Iterator
from datetime import datetime
from itertools import chain

from bayesfric.report.chapters.blind import (
    blind,
    blind_chapter,
    scorecard_line,
    scored_from,
)
from bayesfric.report.chapters.checks import checks
from bayesfric.report.chapters.claims import claims, verdicts
from bayesfric.report.chapters.data_quality import data_quality
from bayesfric.report.chapters.diagnosis import diagnosis, diagnosis_chapter, verdict_line
from bayesfric.report.chapters.diagnostics import diagnostics
from bayesfric.report.chapters.margins import gain_lines, margins, margins_chapter
from bayesfric.report.chapters.methods import methods
from bayesfric.report.chapters.posteriors import posteriors
from bayesfric.report.chapters.predictions import predictions
from bayesfric.report.chapters.provenance import made_from, provenance
from bayesfric.report.chapters.summary import front, summary
from bayesfric.report.content import Block, Code, Document, Heading, Paragraph
from bayesfric.report.stored import StoredDiagnosis, StoredResults
from bayesfric.schemas import MarginsFile, ScorecardFile

__all__ = [
    "build_diagnosis_document",
    "build_document",
    "build_margins_document",
    "build_scorecard_document",
]

CHAPTERS: tuple[Callable[[StoredResults], Iterator[Block]], ...] = (
    front,
    verdicts,
    summary,
    diagnosis,
    blind,
    margins,
    claims,
    predictions,
    checks,
    methods,
    posteriors,
    diagnostics,
    data_quality,
    provenance,
)


def build_document(stored: StoredResults) -> Document:
    """Return the report's content.

    Parameters
    ----------
    stored : StoredResults
        Results of the verbs.
    """
    created = stored.fit.created
    return Document(
        title="Cable-pulley friction",
        subtitle=f"Bayesian analysis of {stored.fit.recording.name}",
        blocks=tuple(chain.from_iterable(chapter(stored) for chapter in CHAPTERS)),
        date=None if created is None else datetime.fromisoformat(created),
    )


def build_margins_document(found: MarginsFile) -> Document:
    """Return the content of a report on controller margins alone, without a fit.

    Parameters
    ----------
    found : MarginsFile
        Result of ``bayesfric margins``.
    """
    blocks: list[Block] = [
        Paragraph(["Draws of the recording ", Code(found.recording.name), "."]),
        *gain_lines(found),
        *margins_chapter(found),
        Heading(1, "Provenance"),
        made_from(found),
    ]
    return Document(
        title="Cable-pulley friction",
        subtitle="Controller margins",
        blocks=blocks,
        date=None if found.created is None else datetime.fromisoformat(found.created),
    )


def build_diagnosis_document(
    stored: StoredDiagnosis, card: ScorecardFile | None = None
) -> Document:
    """Return the content of a report on a diagnosis alone, without a fit.

    Parameters
    ----------
    stored : StoredDiagnosis
        Results of ``bayesfric diagnose``.
    card : ScorecardFile or None
        Of ``bayesfric blind``, where it was run into the same folder.
    """
    found = stored.found
    blocks: list[Block] = [
        Paragraph(["Recording ", Code(found.recording.name), f": {found.recording.title}"]),
        verdict_line(found),
        Heading(1, "Provenance"),
        made_from(found),
        *diagnosis_chapter(stored),
        *(() if card is None else blind_chapter(card)),
    ]
    return Document(
        title="Cable-pulley friction",
        subtitle=f"Sim-to-real diagnosis of {found.recording.name}",
        blocks=blocks,
        date=None if found.created is None else datetime.fromisoformat(found.created),
    )


def build_scorecard_document(card: ScorecardFile) -> Document:
    """Return the content of a report on a scorecard alone.

    Parameters
    ----------
    card : ScorecardFile
        Result of ``bayesfric blind``.
    """
    blocks: list[Block] = [
        scorecard_line(card),
        Heading(1, "Provenance"),
        scored_from(card),
        *blind_chapter(card),
    ]
    return Document(
        title="Cable-pulley friction",
        subtitle="The diagnosis on data whose effect is withheld",
        blocks=blocks,
        date=None if card.created is None else datetime.fromisoformat(card.created),
    )
