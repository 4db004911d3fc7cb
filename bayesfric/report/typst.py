"""The content tree as a PDF for print, archives and screen readers, by Typst.

The PDF conforms to PDF/A-2a and PDF/UA-1 and holds the fonts that come with
Typst, whatever the machine has. The template is fixed; a document reaches it as
JSON alone, so no text of a document can be read as Typst.
"""

import json
import warnings
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from importlib import resources
from typing import Any

import typst

from bayesfric.report import content
from bayesfric.report.characters import printable
from bayesfric.report.formulas import FORMULAS
from bayesfric.report.numbering import Place, label_places, number_blocks

# PDF/A demands a date; this one stands for "none" where a result has none.
_NO_DATE = datetime(1970, 1, 1, tzinfo=UTC)


def render_pdf(document: content.Document) -> bytes:
    """Set a document as PDF/A-2a with PDF/UA-1.

    Parameters
    ----------
    document : Document

    Returns
    -------
    bytes
        The same for the same document. Where the document has no date, no date is
        printed, and the creation date in its metadata is 1970-01-01.

    Raises
    ------
    typst.TypstError
        If the document cannot be set, say for a figure that is not well-formed SVG.
    """
    template = resources.files(__package__).joinpath("template.typ").read_bytes()
    files = {
        "main.typ": template,
        "document.json": json.dumps(_document(document)).encode(),
    }
    for block, place in _on_paper(document):
        if isinstance(block, content.Figure) and place is not None:
            files[f"{place.anchor}.svg"] = block.svg
    # The package's stub leaves out files in memory by name.
    compile_files: Any = typst.compile_with_warnings
    pdf, remarks = compile_files(
        files, format="pdf", ignore_system_fonts=True, pdf_standards=["a-2a", "ua-1"]
    )
    for remark in remarks:
        warnings.warn(remark, stacklevel=2)
    return bytes(pdf)


def _on_paper(document: content.Document) -> Iterator[tuple[content.Block, Place | None]]:
    """Return the blocks without the details, each with its number."""
    return zip(document.blocks, number_blocks(document), strict=False)


def _document(document: content.Document) -> dict[str, object]:
    places = label_places(document)
    date = document.date
    moment = (date if date is None or date.tzinfo else date.replace(tzinfo=UTC)) or _NO_DATE
    moment = moment.astimezone(UTC)
    return {
        "title": printable(document.title),
        "subtitle": printable(document.subtitle),
        "day": None if date is None else date.date().isoformat(),
        "moment": moment.timetuple()[:6],
        "contents": bool(document.listed),
        "blocks": [_block(block, place, places) for block, place in _on_paper(document)],
    }


def _block(
    block: content.Block, place: Place | None, places: Mapping[str, Place]
) -> dict[str, object]:
    def text(value: content.Text) -> list[list[object]]:
        return [_inline(inline, places) for inline in content.inlines(value)]

    data: dict[str, object] = {"kind": type(block).__name__.lower()}
    if place is not None:
        data["anchor"] = place.anchor
    match block:
        case content.Heading(level, words):
            data |= {"level": level, "text": printable(words)}
        case content.Paragraph(words):
            data |= {"text": text(words)}
        case content.BulletList(items):
            data |= {"items": [text(item) for item in items]}
        case content.Notice():
            data |= {
                "sort": block.kind,
                "title": printable(block.title),
                "text": text(block.text),
                "points": [text(point) for point in block.points],
            }
        case content.Listing(words):
            data |= {"text": printable(words, lines=True)}
        case content.Equation(source):
            data |= {"formula": FORMULAS[source].typst, "alt": FORMULAS[source].spoken}
        case content.Table():
            data |= {
                "caption": text(block.caption),
                "note": text(block.note) if block.note else None,
                "columns": [
                    {"title": text(c.title), "unit": printable(c.unit), "align": c.align}
                    for c in block.head
                ],
                "rows": [[text(cell) for cell in row] for row in block.rows],
            }
        case content.Figure():
            data |= {
                "caption": text(block.caption),
                "alt": printable(block.alt),
                "share": block.width,
                "floats": block.floats,
            }
    return data


def _inline(inline: content.Inline, places: Mapping[str, Place]) -> list[object]:
    match inline:
        case str():
            return ["text", printable(inline)]
        case content.Emphasis(text) | content.Strong(text) | content.Code(text):
            return [type(inline).__name__.lower(), printable(text)]
        case content.Math(source):
            return ["math", FORMULAS[source].typst, FORMULAS[source].spoken]
        case content.Reference(label):
            return ["reference", places[label].kind, places[label].anchor]
