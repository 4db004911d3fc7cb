"""The chapters in order, as far as there are results for them."""

from collections.abc import Iterator
from datetime import datetime

from bayesfric.report.chapters.blind import blind_chapter, scorecard_line, scored_from
from bayesfric.report.chapters.checks import checks
from bayesfric.report.chapters.claims import claims, verdicts
from bayesfric.report.chapters.data_quality import data_quality
from bayesfric.report.chapters.diagnosis import diagnosis, verdict_line
from bayesfric.report.chapters.diagnostics import diagnostics
from bayesfric.report.chapters.margins import gain_lines, margins
from bayesfric.report.chapters.methods import methods
from bayesfric.report.chapters.posteriors import posteriors
from bayesfric.report.chapters.predictions import predictions
from bayesfric.report.chapters.provenance import made_from, provenance
from bayesfric.report.chapters.summary import convergence, front, recorded, summary
from bayesfric.report.content import Block, Document, Heading
from bayesfric.report.stored import StoredResults

__all__ = ["build_document"]

SUBTITLES = {
    "fit.json": "Bayesian analysis of",
    "diagnosis.json": "Sim-to-real diagnosis of",
    "claims.json": "The paper's claims on",
    "margins.json": "Controller margins over the draws of",
}


def build_document(stored: StoredResults) -> Document:
    """Return the report's content.

    Parameters
    ----------
    stored : StoredResults
        Results of the verbs, of one at least.
    """
    subtitle = "The diagnosis on data whose effect is withheld"
    created = None if stored.scorecard is None else stored.scorecard.created
    for file, record in list(stored.records.items())[:1]:
        subtitle, created = f"{SUBTITLES[file]} {record.recording.name}", record.created
    return Document(
        title="Cable-pulley friction",
        subtitle=subtitle,
        blocks=tuple(_blocks(stored)),
        date=None if created is None else datetime.fromisoformat(created),
    )


def _blocks(stored: StoredResults) -> Iterator[Block]:
    """Yield page one, results, evidence, method and where all is from."""
    yield from _page_one(stored)
    fitted = stored.fitted
    if fitted is not None:
        yield from summary(fitted)
    if stored.diagnosis is not None:
        yield from diagnosis(stored.diagnosis)
    if stored.scorecard is not None:
        yield from blind_chapter(stored.scorecard)
    if stored.margins is not None:
        yield from margins(stored.margins)
    if stored.claims is not None:
        yield from claims(stored.claims)
    if fitted is not None:
        yield from predictions(fitted)
        yield from checks(fitted)
        yield from methods(fitted)
        yield from posteriors(fitted)
        yield from diagnostics(fitted)
        yield from data_quality(fitted)
        yield from provenance(fitted)
        return
    yield Heading(1, "Provenance")
    for record in list(stored.records.values())[:1]:
        yield made_from(record)
    if not stored.records and stored.scorecard is not None:
        yield scored_from(stored.scorecard)


def _page_one(stored: StoredResults) -> Iterator[Block]:
    """Yield what stands before the table of contents."""
    for record in list(stored.records.values())[:1]:
        yield recorded(record.recording, stored.fitted)
    if stored.fitted is not None:
        yield convergence(stored.fitted.fit)
    if stored.diagnosis is not None:
        yield verdict_line(stored.diagnosis.found)
    if stored.scorecard is not None and stored.fitted is None:
        yield scorecard_line(stored.scorecard)
    if stored.margins is not None:
        yield from gain_lines(stored.margins)
    if stored.fitted is not None:
        yield from front(stored.fitted.fit)
    if stored.claims is not None:
        yield from verdicts(stored.claims.found)
