import base64
import re
from html.parser import HTMLParser

import pytest
from report.sample import SVG, document

from bayesfric.report import content
from bayesfric.report.content import Document, Heading, Table
from bayesfric.report.formulas import FORMULAS, LAW
from bayesfric.report.html import render_html

VOID = {"meta", "img", "br"}


class Page(HTMLParser):
    """What a page holds: its elements, its text, and whether tags match."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.texts: list[str] = []
        self.feed(html)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if not {"style", "script"} & set(self.open):
            self.texts.append(data)

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.elements if name == tag]


@pytest.fixture(scope="module")
def html() -> str:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(content, "SHORT", 0)  # of few headings, and yet with its contents
        return render_html(document())


@pytest.fixture(scope="module")
def page(html: str) -> Page:
    return Page(html)


def test_every_element_is_closed(page: Page) -> None:
    assert page.open == []


def test_language_title_and_landmarks(page: Page) -> None:
    assert page.all("html") == [{"lang": "en"}]
    assert [len(page.all(tag)) for tag in ("title", "h1", "header", "main", "nav")] == [1] * 5
    assert page.all("time") == [{"datetime": "2026-03-04"}]


def test_every_picture_is_inside_the_file_and_described(page: Page) -> None:
    pictures = page.all("img")
    assert [p["alt"] for p in pictures] == ["A rectangle filled with blue.", "The same rectangle."]
    for picture in pictures:
        head, data = str(picture["src"]).split(",")
        assert head == "data:image/svg+xml;base64"
        assert base64.b64decode(data) == SVG
    assert pictures[0]["style"] == "width: 50%"


def test_nothing_is_fetched(html: str, page: Page) -> None:
    assert all(str(a["href"]).startswith("#") for a in page.all("a"))
    assert not {"link", "iframe", "object"} & {tag for tag, _ in page.elements}
    assert page.all("script") == [{}]  # the template's own, without a source
    assert "http" not in html
    assert "url(" not in html


def test_identifiers_are_unique_and_every_link_arrives(page: Page) -> None:
    ids = [str(a["id"]) for _, a in page.elements if "id" in a]
    assert len(ids) == len(set(ids))
    targets = {str(a["href"])[1:] for a in page.all("a") if str(a["href"]).startswith("#")}
    assert targets <= set(ids)
    assert {"section-1", "section-1-1", "section-2", "equation-1", "table-1"} <= targets


def test_tables_have_captions_and_scopes(page: Page) -> None:
    assert len(page.all("caption")) == len(page.all("table")) == 1
    scopes = [a.get("scope") for a in page.all("th")]
    assert scopes.count("col") == 3
    assert scopes.count("row") == 3
    assert None not in scopes


def test_what_scrolls_can_be_scrolled_by_the_keyboard(page: Page) -> None:
    regions = [element for element in page.all("div") if element.get("role") == "region"]
    scrolling = [*page.all("figure"), *page.all("pre"), *regions]
    assert len(scrolling) == 3 + len(page.all("table")) == 4
    assert all(element.get("tabindex") == "0" for element in scrolling)


def test_a_column_without_a_title_has_no_empty_head() -> None:
    html = render_html(Document("title", "", [Table("Words.", ["", "value"], [["a", "b"]])]))
    assert '<tr><td class="left"></td><th scope="col" class="left">value</th></tr>' in html


def test_decimal_points_stand_in_line(html: str) -> None:
    assert '0<span class="tail" style="min-width: 4.6ch">.0128</span>' in html
    assert '12<span class="tail" style="min-width: 4.6ch">.5</span>' in html
    assert '<td class="decimal">—</td>' in html


def test_a_short_document_has_no_table_of_contents() -> None:
    assert not Page(render_html(document())).all("nav")
    long = [Heading(1, f"Part {number}") for number in range(content.SHORT + 1)]
    assert len(Page(render_html(Document("title", "", long))).all("nav")) == 1


def test_formulas_are_mathml_with_words(page: Page) -> None:
    assert [m["alttext"] for m in page.all("math")] == ["c_1", FORMULAS[LAW].spoken, "c_1"]
    symbol = '<math alttext="c_1" aria-label="c_1"><msub><mi>c</mi><mn>1</mn></msub></math>'
    assert symbol in render_html(document())


def test_text_stands_out_in_both_modes() -> None:
    style = re.search("<style>(.*)</style>", render_html(Document("t", "", [])), re.DOTALL)
    assert style is not None

    def luminance(color: str) -> float:
        digits = color * 2 if len(color) == 3 else color
        parts = [int(digits[i : i + 2], 16) / 255 for i in (0, 2, 4)]
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    modes = [
        dict(re.findall(r"--([\w-]+): #(\w+);", block))
        for block in re.findall(r":root \{([^}]*)\}", style[1])
    ]
    assert [set(mode) for mode in modes] == [set(modes[0])] * 2
    for mode in modes:
        for ink in ("ink", "faint", "link"):
            for paper in ("paper", "info", "attention", "good", "code"):
                light, dark = sorted((luminance(mode[ink]), luminance(mode[paper])), reverse=True)
                # WCAG AA asks 4.5 of text.
                assert (light + 0.05) / (dark + 0.05) > 4.5
    assert luminance(modes[0]["paper"]) > 0.9
    assert luminance(modes[1]["paper"]) < 0.02
    assert not re.findall(
        r"[ {;](?:color|background): #", style[1].replace("background: #fff; pa", "")
    )
