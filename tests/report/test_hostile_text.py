"""A hundred strings through every field of a report, in each form: all are text, and none acts.

What a form makes of them is held against what it makes of as many harmless words.
"""

import io
import re
from collections import Counter
from collections.abc import Sequence

import pytest
from markdown_it import MarkdownIt
from pypdf import PdfReader
from report.hostile import HOSTILE
from report.sample import SVG
from report.test_report_html import Page
from report.test_report_typst import elements

from bayesfric.characters import legible
from bayesfric.report.characters import printable
from bayesfric.report.content import (
    Block,
    BulletList,
    Code,
    Column,
    Document,
    Emphasis,
    Figure,
    Heading,
    Listing,
    Notice,
    Paragraph,
    Strong,
    Table,
)
from bayesfric.report.html import render_html
from bayesfric.report.markdown import render_summary
from bayesfric.report.typst import render_pdf

HARMLESS = tuple(f"name{i}" for i in range(len(HOSTILE)))
TIMES = 15  # that each text stands in a block or another
ON_PAGE_ONE = 11  # in those that page one may hold


def fields(text: str) -> list[Block]:
    """One text wherever a chapter may put one."""
    return [
        Heading(1, text),
        Notice("info", text, title=text),
        Paragraph([text, " ", Emphasis(text), " ", Strong(text), " ", Code(text)]),
        BulletList([text]),
        Listing(text),
        Table(text, [Column(text, text)], [[text], [Code(text)]], note=text),
        Figure(lambda: SVG, text, text),
    ]


def report(texts: Sequence[str]) -> Document:
    blocks = [block for text in texts for block in fields(text)]
    return Document(texts[0], texts[1], blocks)


def structure(page: Page) -> list[tuple[str, list[str]]]:
    return [(tag, sorted(attributes)) for tag, attributes in page.elements]


def test_html_has_no_element_or_attribute_more() -> None:
    hostile, harmless = (render_html(report(texts)) for texts in (HOSTILE, HARMLESS))
    page, plain = Page(hostile), Page(harmless)
    assert page.open == []
    assert structure(page) == structure(plain)
    assert hostile[hostile.rindex("<script>") :] == harmless[harmless.rindex("<script>") :]
    for element, other in zip(page.elements, plain.elements, strict=True):
        differs = {key for key in element[1] if element[1][key] != other[1][key]}
        assert differs <= {"alt", "content"}
    hostile.encode("utf-8")
    assert unseen(hostile) == set()


def test_html_shows_each_as_it_was_written() -> None:
    page = Page(render_html(report(HOSTILE)))
    shown = "\n".join(page.texts)
    alternatives = [picture["alt"] for picture in page.all("img")]
    assert alternatives == [legible(text) for text in HOSTILE]
    assert [t for t in HOSTILE if shown.count(legible(t)) < TIMES - 1] == []


def kinds(text: str) -> Counter[str]:
    tokens = MarkdownIt("commonmark").enable(["table", "strikethrough"]).parse(text)
    inner = [child for token in tokens for child in token.children or ()]
    # How a line of text is cut into tokens differs, and only there may it.
    return Counter(token.type for token in (*tokens, *inner) if token.type != "text")


def page_one(texts: Sequence[str]) -> str:
    """What page one may hold, as Markdown."""
    blocks = [block for text in texts for block in fields(text)]
    kept = [block for block in blocks if not isinstance(block, Heading | Listing | Figure)]
    return render_summary(Document(texts[0], texts[1], kept))


def test_markdown_has_no_markup_more() -> None:
    hostile, harmless = page_one(HOSTILE), page_one(HARMLESS)
    assert kinds(hostile) == kinds(harmless)
    assert unseen(hostile) <= {"\u2060"}


def seen(markdown: str) -> list[str]:
    """The text of each paragraph, heading or cell, as a reader sees it."""
    tokens = MarkdownIt("commonmark").enable(["table", "strikethrough"]).parse(markdown)
    inline = [token.children or [] for token in tokens if token.type == "inline"]
    blocks = [token.content for token in tokens if token.type == "fence"]
    return ["".join(child.content for child in line) for line in inline] + blocks


def test_markdown_shows_each_as_it_was_written() -> None:
    shown = "\n".join(seen(page_one(HOSTILE))).replace("\u2060", "")
    assert [t for t in HOSTILE if shown.count(legible(t)) < ON_PAGE_ONE] == []


def test_a_site_that_links_bare_addresses_and_calls_people_finds_none() -> None:
    """What is no code: there sites link nothing, and the source stands as it was written."""
    markdown = render_summary(
        Document("t", "", [Paragraph([text, " ", Strong(text)]) for text in HOSTILE])
    )
    assert "www" in markdown
    assert re.findall(r"\w://|www\.|@\w", markdown) == []


def printed(texts: Sequence[str]) -> Document:
    """Each text in a paragraph, a cell and, in turn, one kind of block: typesetting takes time."""
    blocks: list[Block] = [Heading(1, "One"), Heading(2, "Two")]
    for i, text in enumerate(texts):
        block = fields(text)[i % len(fields(text))]
        blocks += [Heading(3, text) if isinstance(block, Heading) else block, Paragraph(text)]
    cells = [[text] for text in texts if len(text) < 100]
    return Document("t", "", [*blocks, Table("Cells.", ["Cell"], cells)])


@pytest.fixture(scope="module")
def pdf() -> PdfReader:
    return PdfReader(io.BytesIO(render_pdf(printed(HOSTILE))))


def test_pdf_has_no_element_more_and_no_action(pdf: PdfReader) -> None:
    plain = PdfReader(io.BytesIO(render_pdf(printed(HARMLESS))))
    long = sum(len(text) >= 100 for text in HOSTILE)  # in no cell
    for tag in ("/Table", "/TD", "/TH", "/Figure", "/Caption", "/H3", "/LI", "/Link", "/Formula"):
        extra = long if tag == "/TD" else 0
        assert len(elements(pdf, tag)) == len(elements(plain, tag)) - extra, tag
    assert elements(pdf, "/H3") != []
    assert not {"/AA", "/OpenAction", "/AcroForm"} & set(pdf.trailer["/Root"])
    assert "/JavaScript" not in pdf.trailer["/Root"].get("/Names", {})
    for page in pdf.pages:
        for link in page.get("/Annots", ()):
            action = link.get_object().get("/A", {})
            assert "/URI" not in action
            assert action.get("/S", "/GoTo") == "/GoTo"


def test_pdf_shows_each_as_it_was_written(pdf: PdfReader) -> None:
    """Blanks aside: lines break within long ones."""
    shown = "".join("".join(page.extract_text() for page in pdf.pages).split())
    bare = ["".join(printable(text).split()) for text in HOSTILE if len(text) < 100]
    assert [text for text in bare if shown.count(text) < 3] == []
    # The longest runs over pages, with what stands at their heads and feet in between.
    assert shown.count("x") >= 10_000


def unseen(text: str) -> set[str]:
    return {char for char in text if not char.isprintable() and legible(char) != " "}


def test_there_are_a_hundred() -> None:
    assert len(set(HOSTILE)) >= 100
