"""The chapters in order."""

from collections.abc import Callable, Iterator
from datetime import datetime
from itertools import chain

from bayesfric.report.chapters.checks import checks
from bayesfric.report.chapters.claims import claims, verdicts
from bayesfric.report.chapters.data_quality import data_quality
from bayesfric.report.chapters.diagnostics import diagnostics
from bayesfric.report.chapters.methods import methods
from bayesfric.report.chapters.posteriors import posteriors
from bayesfric.report.chapters.predictions import predictions
from bayesfric.report.chapters.provenance import provenance
from bayesfric.report.chapters.summary import front, summary
from bayesfric.report.content import Block, Document
from bayesfric.report.stored import StoredResults

__all__ = ["build_document"]

CHAPTERS: tuple[Callable[[StoredResults], Iterator[Block]], ...] = (
    front,
    verdicts,
    summary,
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
