import hashlib
import io
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from importlib import resources
from typing import Any

import pytest
import typst
from pypdf import PdfReader
from report.sample import SVG, document

from bayesfric.report.content import (
    Code,
    Document,
    Emphasis,
    Figure,
    Heading,
    Paragraph,
    Reference,
    Strong,
    Table,
)
from bayesfric.report.formulas import FORMULAS, LAW
from bayesfric.report.html import render_html
from bayesfric.report.typst import render_pdf

FONTS = ("LibertinusSerif-", "NewCM", "DejaVuSansMono")


@pytest.fixture(scope="module")
def pdf() -> PdfReader:
    return PdfReader(io.BytesIO(render_pdf(document())))


def words(reader: PdfReader) -> str:
    return " ".join(" ".join(page.extract_text() for page in reader.pages).split())


def elements(reader: PdfReader, tag: str) -> list[Any]:
    def walk(node: Any) -> Iterator[Any]:
        node = node.get_object()
        if hasattr(node, "get"):
            yield node
            children = node.get("/K", [])
            for child in children if isinstance(children, list) else [children]:
                yield from walk(child) if hasattr(child, "get_object") else ()

    root = reader.trailer["/Root"]["/StructTreeRoot"]
    return [node for node in walk(root) if node.get("/S") == tag]


def test_metadata_and_conformance(pdf: PdfReader) -> None:
    root = pdf.trailer["/Root"]
    assert pdf.metadata is not None
    assert pdf.metadata.title == "A sample report"
    assert pdf.metadata["/CreationDate"] == "D:20260304050607Z"
    assert root["/Lang"] == "en"
    assert root["/MarkInfo"]["/Marked"] == True  # noqa: E712
    assert root["/ViewerPreferences"]["/DisplayDocTitle"] == True  # noqa: E712
    xmp = root["/Metadata"].get_data().decode()
    declared = dict(re.findall(r"<(pdf(?:ua|a)id:\w+)>(\w+)<", xmp))
    assert declared == {"pdfaid:part": "2", "pdfaid:conformance": "A", "pdfuaid:part": "1"}


def test_structure_is_tagged_with_heads_and_alternative_text(pdf: PdfReader) -> None:
    assert [e["/Alt"] for e in elements(pdf, "/Figure")] == [
        "A rectangle filled with blue.",
        "The same rectangle.",
    ]
    assert [e["/Alt"] for e in elements(pdf, "/Formula")] == ["c_1", FORMULAS[LAW].spoken, "c_1"]
    assert len(elements(pdf, "/Table")) == 1
    assert len(elements(pdf, "/TH")) == 3
    assert len(elements(pdf, "/TD")) == 9
    assert len(elements(pdf, "/Caption")) == 3
    assert len(elements(pdf, "/LI")) == 3


def test_outline_holds_the_numbered_headings(pdf: PdfReader) -> None:
    def titles(items: Any) -> list[Any]:
        return [titles(item) if isinstance(item, list) else item.title for item in items]

    assert titles(pdf.outline) == [
        "1 First chapter",
        ["1.1 Numbers", ["1.1.1 Details"]],
        "2 Second chapter",
    ]


def test_numbers_agree_with_those_of_the_other_formats(pdf: PdfReader) -> None:
    text = words(pdf)
    for expected in (
        "Unconverged. See Equation 1.",
        "two: Table 1",
        "• Figure 2",
        "Back to Section 1.",
        "Table 1. Coefficients.",
        "Figure 2. The same field.",
    ):
        assert expected in text


def test_only_embedded_fonts_that_come_with_typst(pdf: PdfReader) -> None:
    embedded = {}
    for page in pdf.pages:
        for font in page["/Resources"]["/Font"].values():
            inner = font.get_object()["/DescendantFonts"][0].get_object()
            name = inner["/BaseFont"].split("+")[1]
            embedded[name] = any(key.startswith("/FontFile") for key in inner["/FontDescriptor"])
    assert embedded
    assert all(embedded.values())
    assert [name for name in embedded if not name.startswith(FONTS)] == []


def test_right_to_left_letters_and_those_without_a_glyph() -> None:
    blocks = [
        Paragraph("שלום"),
        Paragraph("pulley 小 😀 \x07\u202e\ue000\ufeff"),
        Paragraph("x\u0304 e\u0301 ]\u0304"),
    ]
    text = words(PdfReader(io.BytesIO(render_pdf(Document("t", "", blocks)))))
    assert "שלום" in text
    assert "pulley [U+5C0F] [U+1F600] [U+0007][U+202E][U+E000][U+FEFF]" in text
    assert "é ][U+0304]" in text


def test_every_glyph_that_is_counted_on_is_there() -> None:
    listed = resources.files("bayesfric.report").joinpath("glyphs.txt").read_text(encoding="utf-8")
    ranges = [part.split("-") for part in listed.split("\n", 1)[1].split()]
    letters = [chr(c) for r in ranges for c in range(int(r[0], 16), int(r[-1], 16) + 1)]
    assert len(letters) > 7000
    # One missing glyph would make the standard refuse the document.
    letters += [f"{letter}{chr(mark)}" for letter in "aθRΩ" for mark in range(0x300, 0x370)]
    lines = [" ".join(letters[i : i + 100]) for i in range(0, len(letters), 100)]
    blocks = [Paragraph([f(line)]) for f in (str, Strong, Emphasis, Code) for line in lines]
    assert render_pdf(Document("t", "", blocks)).startswith(b"%PDF-1.7")


def test_a_long_run_breaks_and_stays_whole_when_copied() -> None:
    checksum = hashlib.sha256(b"").hexdigest() * 3
    cells = [[Code(checksum), checksum]]
    reader = PdfReader(io.BytesIO(render_pdf(Document("t", "", [Table("c", ["a", "b"], cells)]))))
    right = []
    reader.pages[0].extract_text(visitor_text=lambda t, cm, tm, fd, size: right.append(tm[4]))
    assert max(right) < 595 - 70
    assert checksum in "".join(words(reader).split())


def test_a_sign_stays_with_its_number() -> None:
    # Of many lengths, so that line ends come to lie everywhere.
    blocks = [Paragraph("i" * k + " words" * 14 + " p > 0.999 or p ≤ 0.05") for k in range(60)]
    reader = PdfReader(io.BytesIO(render_pdf(Document("t", "", blocks))))
    lines = "\n".join(page.extract_text() for page in reader.pages).splitlines()
    assert [line for line in lines if line.rstrip().endswith((">", "≤"))] == []
    assert words(reader).count("> 0.999 or p ≤ 0.05") == 60


def test_decimal_points_stand_in_line(pdf: PdfReader) -> None:
    places = {}

    def visit(text: str, cm: Any, tm: list[float], font: Any, size: float) -> None:
        places[text.strip()] = tm[4]

    for page in pdf.pages:
        page.extract_text(visitor_text=visit)
    assert places[".0128"] == pytest.approx(places[".5"], abs=0.01)


def test_a_narrow_table_is_set_as_two_halves() -> None:
    rows = [[f"row {i}", "1.0"] for i in range(50)]
    reader = PdfReader(io.BytesIO(render_pdf(Document("t", "", [Table("c", ["Name", "Q"], rows)]))))
    (page,) = reader.pages  # of more than a page in one column
    text = page.extract_text()
    assert text.count("Name") == 2
    assert all(f"row {i}" in text for i in range(50))


def test_a_table_begins_only_where_rows_have_room() -> None:
    filler = [Paragraph("Words. " * 90)] * 8
    for count in range(1, 9):  # wherever the page ends, the head is not alone at its foot
        rows = [[f"row {i}", "1.0", "x" * 30, "y" * 30] for i in range(40)]
        table = Table("A caption.", ["Name", "Q", "X", "Y"], rows)
        pdf = render_pdf(Document("t", "", [*filler[:count], table]))
        pages = [page.extract_text() for page in PdfReader(io.BytesIO(pdf)).pages]
        (first,) = [page for page in pages if "A caption." in page]
        assert "row 2" in first


def test_a_long_table_repeats_its_head_on_every_page() -> None:
    rows = [[f"row {i}", "1.0"] for i in range(120)]
    reader = PdfReader(io.BytesIO(render_pdf(Document("t", "", [Table("c", ["Name", "Q"], rows)]))))
    assert len(reader.pages) >= 3
    assert all("Name" in page.extract_text() for page in reader.pages)
    assert f"2 / {len(reader.pages)}" in reader.pages[1].extract_text()


def test_a_heading_stays_with_what_follows_and_a_figure_with_its_caption() -> None:
    figure = document().blocks[9]
    assert isinstance(figure, Figure)
    for lines in range(30, 44):
        blocks = [
            Heading(1, "Start"),
            Paragraph("word " * 15 * lines),
            Heading(1, "Orphan"),
            figure,
        ]
        reader = PdfReader(io.BytesIO(render_pdf(Document("t", "", blocks))))
        pages = [page.extract_text() for page in reader.pages]
        # After the contents and without the running header.
        heads = [i for i, text in enumerate(pages) if re.search(r"^2 Orphan$", text, re.M)]
        captions = [i for i, text in enumerate(pages) if "A blue field." in text]
        assert heads[-1:] == captions


def test_contents_stand_at_the_foot_of_page_one() -> None:
    """The chapters alone; front matter that fills the page goes on to page two."""
    sections = [
        head for k in range(14) for head in (Heading(1, f"Chapter{k}"), Heading(2, f"Section{k}"))
    ]
    for lines in (0, 3, 60):
        front = [Paragraph(f"line {k}") for k in range(lines)]
        first, second, *_ = PdfReader(
            io.BytesIO(render_pdf(Document("t", "", [*front, *sections])))
        ).pages
        contents = first.extract_text()
        assert "Contents" in contents
        assert "Chapter13" in contents
        assert "Contents" not in second.extract_text()
        assert ("line 59" in second.extract_text()) == (lines == 60)
    assert "Section13" not in contents


def test_a_figure_stands_between_its_heading_and_the_text_after_it() -> None:
    # Two of them do not fit on a page, and neither fits under the title.
    square = SVG.replace(b'height="50" viewBox="0 0 100 50"', b'height="80" viewBox="0 0 100 80"')
    blocks = [
        Heading(1, "One"),
        Figure(lambda: square, "First.", "a"),
        Paragraph("text between"),
        Figure(lambda: square, "Second.", "a"),
        Heading(1, "Two"),
        Paragraph("later text"),
    ]
    reader = PdfReader(io.BytesIO(render_pdf(Document("t", "", blocks))))
    text = "".join(page.extract_text() for page in reader.pages)
    places = [text.index(part) for part in ("First.", "text between", "Second.", "later text")]
    assert places == sorted(places)
    with_first = next(page for page in reader.pages if "First." in page.extract_text())
    assert "One" in with_first.extract_text().replace("One ..", "")


def test_a_tall_figure_fits_on_the_page() -> None:
    svg = (
        b'<svg xmlns="http://www.w3.org/2000/svg" width="10" height="90" viewBox="0 0 10 90">'
        b'<rect width="10" height="90"/></svg>'
    )
    reader = PdfReader(
        io.BytesIO(render_pdf(Document("t", "", [Figure(lambda: svg, "Tall.", "a")])))
    )
    box = elements(reader, "/Figure")[0]["/A"][0]["/BBox"]
    assert len(reader.pages) <= 2
    assert float(box[3]) - float(box[1]) == pytest.approx(195 / 25.4 * 72, abs=1)


def test_without_a_date_none_is_printed() -> None:
    reader = PdfReader(io.BytesIO(render_pdf(document(date=None))))
    assert reader.metadata is not None
    assert reader.metadata["/CreationDate"] == "D:19700101000000Z"
    assert "1970" not in words(reader)
    assert "2026-03-04" not in words(reader)


def test_a_broken_picture_is_an_error_not_a_gap() -> None:
    with pytest.raises(typst.TypstError, match="SVG"):
        render_pdf(Document("t", "", [Figure(lambda: b"<svg <", "c", "a")]))


def test_two_processes_write_the_same_bytes() -> None:
    code = (
        "import hashlib, json; from report.sample import document;"
        "from bayesfric.report.typst import render_pdf;"
        "from bayesfric.report.html import render_html;"
        "from bayesfric.report.markdown import render_summary;"
        "d = document(); texts = [render_html(d).encode(), render_summary(d).encode()];"
        "print(json.dumps([hashlib.sha256(b).hexdigest() for b in [render_pdf(d), *texts]]))"
    )
    tests = str(resources.files("report").joinpath(".."))
    first, second = (
        json.loads(
            subprocess.run(
                [sys.executable, "-c", f"import sys; sys.path.insert(0, {tests!r}); {code}"],
                capture_output=True,
                text=True,
                check=True,
            ).stdout
        )
        for _ in range(2)
    )
    assert first == second


def test_figures_that_float_stay_in_their_chapter() -> None:
    tall = b'<svg xmlns="http://www.w3.org/2000/svg" width="160mm" height="150mm"/>'
    blocks = [
        Heading(1, "First"),
        *(Figure(lambda: tall, f"Picture {k}", "A.", floats=True) for k in range(4)),
        Paragraph("Words."),
        Heading(1, "Second"),
        Paragraph("More words."),
    ]
    pages = PdfReader(io.BytesIO(render_pdf(Document("Title", "", blocks)))).pages
    at = {name: next(k for k, page in enumerate(pages) if name in page.extract_text())
          for name in ("Picture 3", "2 Second")}  # fmt: skip
    assert at["2 Second"] >= at["Picture 3"]


def test_details_stand_on_the_html_page_alone_under_numbers_that_go_on() -> None:
    table = Table("On paper.", ["Name", "Q"], [["a", "1"]], label="paper")
    detail = Table("In the details.", ["Name", "Q"], [["b", "2"]])
    both = Document("t", "", [Heading(1, "First"), table], details=[Heading(1, "More"), detail])
    pdf = PdfReader(io.BytesIO(render_pdf(both))).pages[0].extract_text()
    html = render_html(both)
    assert "Table 1. On paper." in pdf
    assert "In the details." not in pdf
    assert "Table 2" in html
    assert "In the details." in html
    with pytest.raises(ValueError, match="reference to 'there'"):
        Document(
            "t",
            "",
            [Paragraph(Reference("there"))],
            details=[Table("c", ["Q"], [["1"]], label="there")],
        )
