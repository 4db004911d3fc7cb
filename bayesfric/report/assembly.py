"""The chapters in order, as far as there are results for them."""

from collections.abc import Iterable, Iterator, Sequence
from datetime import datetime

from bayesfric.report.chapters.blind import blind_chapter, scored_from
from bayesfric.report.chapters.boards import boards
from bayesfric.report.chapters.calibration import calibrated_from, calibration
from bayesfric.report.chapters.checks import checks
from bayesfric.report.chapters.claims import claims, further_claims
from bayesfric.report.chapters.comparison import comparison
from bayesfric.report.chapters.data_quality import data_quality
from bayesfric.report.chapters.diagnosis import diagnosis
from bayesfric.report.chapters.diagnosis_details import appendix as diagnosis_tables
from bayesfric.report.chapters.diagnostics import diagnostics, further_diagnostics
from bayesfric.report.chapters.margins import margins
from bayesfric.report.chapters.methods import methods, thresholds
from bayesfric.report.chapters.one_left_out import further_left_out
from bayesfric.report.chapters.page_one import coefficients_figure, expected, page_one
from bayesfric.report.chapters.plain_law import own_law
from bayesfric.report.chapters.posteriors import further_posteriors, posteriors
from bayesfric.report.chapters.predictions import further_predictions, predictions
from bayesfric.report.chapters.provenance import made_from, provenance
from bayesfric.report.chapters.summary import summary
from bayesfric.report.chapters.to_use import biased, refitted_coefficients
from bayesfric.report.content import Block, Code, Document, Heading, Paragraph
from bayesfric.report.rig_words import rig_words
from bayesfric.report.stored import StoredDiagnosis, StoredFit, StoredResults

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
    subtitle = "Blind test of the diagnosis: the true effect is hidden from it"
    created = None if stored.scorecard is None else stored.scorecard.created
    if stored.scorecard is None and stored.calibration is not None:
        subtitle, created = "Simulation-based calibration", stored.calibration.created
    for file, record in list(stored.records.items())[:1]:
        subtitle, created = f"{SUBTITLES[file]} {record.recording.name}", record.created
    pulleys = stored.pooled is not None or (
        stored.fitted is not None and bool(stored.fitted.fit.pulleys)
    )
    law = "" if pulleys else own_law(_rigs(stored))
    details = tuple(_details(stored))
    return Document(
        title=f"Friction measured on a {rig_words(_rigs(stored)[0]).rig}"
        if law
        else "Cable-pulley friction",
        subtitle=subtitle,
        blocks=(*without_empty_chapters(_blocks(stored)), *_mentioned(details)),
        details=details,
        date=None if created is None else datetime.fromisoformat(created),
    )


def without_empty_chapters(blocks: Iterable[Block]) -> Iterator[Block]:
    """Yield the blocks without chapters of which there is nothing but the heading."""
    heading: Heading | None = None
    for block in blocks:
        if isinstance(block, Heading) and block.level == 1:
            heading = block
            continue
        if heading is not None:
            yield heading
            heading = None
        yield block


def _rigs(stored: StoredResults) -> tuple[str, ...]:
    """Return the rigs of the fit; where there is none, those of the diagnosis."""
    if stored.fitted is not None:
        return stored.fitted.fit.rigs
    if stored.pooled is not None:
        return stored.pooled.rigs
    return () if stored.diagnosis is None else stored.diagnosis.record.rigs


def _blocks(stored: StoredResults) -> Iterator[Block]:
    """Yield page one, results, evidence, method, and where all is from."""
    yield from page_one(stored)
    fitted, pooled = stored.fitted, stored.pooled
    if fitted is not None:
        diagnosed = stored.diagnosis
        yield from summary(fitted, () if diagnosed is None else _biased(fitted, diagnosed))
    if pooled is not None and pooled.pooled is not None:
        yield from boards(pooled, pooled.pooled)
    if stored.diagnosis is not None:
        alone = fitted is None and pooled is None
        yield from diagnosis(stored.diagnosis, alone=alone)
    if stored.claims is not None:
        yield from claims(stored.claims)
    if stored.margins is not None:
        yield from margins(stored.margins, alone=fitted is None)
    if fitted is not None:
        yield from predictions(fitted)
        yield from checks(fitted)
        yield from posteriors(fitted)
        yield from data_quality(fitted)
    if stored.scorecard is not None:
        yield from blind_chapter(stored.scorecard)
    if stored.calibration is not None:
        yield from calibration(stored.calibration)
    if stored.comparison is not None:
        yield from comparison(stored.comparison)
    yield from methods(stored)
    if fitted is not None:
        yield from diagnostics(fitted)
        yield from provenance(fitted)
    else:
        yield Heading(1, "Provenance")
        for record in list(stored.records.values())[:1]:
            yield made_from(record)
        if not stored.records and stored.scorecard is not None:
            yield scored_from(stored.scorecard)
        elif not stored.records and stored.calibration is not None:
            yield calibrated_from(stored.calibration)


def _biased(fitted: StoredFit, diagnosed: StoredDiagnosis) -> Iterator[Block]:
    """Yield that a law alone is biased, and by how much; nothing where no cause is named."""
    yield from biased(diagnosed.record)
    if refitted := refitted_coefficients(diagnosed.record):
        yield from coefficients_figure(fitted, refitted)
        yield from expected(fitted, coefficients=False)


def _mentioned(details: Sequence[Block]) -> Iterator[Paragraph]:
    """Yield a sentence that lists the details of the HTML page by their headings."""
    headings = [block.text for block in details if isinstance(block, Heading) and block.level > 1]
    if headings:
        yield Paragraph(
            ["Further details are in ", Code("report.html"), f": {'; '.join(headings)}."]
        )


def _details(stored: StoredResults) -> Iterator[Block]:
    """Yield the details, which stand at the end of the HTML page and not in the PDF."""
    chapters: list[Block] = []
    if stored.diagnosis is not None:
        chapters += diagnosis_tables(stored.diagnosis.record)
    if stored.claims is not None:
        chapters += further_claims(stored.claims)
    if stored.fitted is not None:
        chapters += further_predictions(stored.fitted)
        chapters += further_posteriors(stored.fitted)
        chapters += further_diagnostics(stored.fitted)
        chapters += further_left_out(stored.fitted)
    chapters += thresholds(stored)
    if chapters:
        yield Heading(1, "Details")
        yield from chapters
