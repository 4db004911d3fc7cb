import re

import pytest
from markdown_it import MarkdownIt
from markdown_it.token import Token
from report.sample import document

from bayesfric.report.content import (
    BulletList,
    Code,
    Document,
    Emphasis,
    Figure,
    Listing,
    Math,
    Notice,
    Paragraph,
    Strong,
    Table,
)
from bayesfric.report.html import render_html
from bayesfric.report.markdown import render_summary


def tokens(text: str) -> list[Token]:
    return MarkdownIt("commonmark").enable(["table", "strikethrough"]).parse(text)


def inline_texts(text: str) -> list[str]:
    """The text of each paragraph, heading or cell, as a reader sees it."""
    return [
        "".join(child.content for child in token.children or [])
        for token in tokens(text)
        if token.type == "inline"
    ]


def test_page_one_ends_at_the_first_heading() -> None:
    assert render_summary(document()) == (
        "# A sample report\n\n"
        "With everything in it\n\n"
        "2026-03-04\n\n"
        "> **Unconverged.** See Equation 1.\n\n"
        "> **In order.** All is well.\n\n"
        "> **Note.** Synthetic data.\n"
    )


def test_blocks_of_page_one() -> None:
    kinds = Paragraph | BulletList | Table | Figure
    shown = [block for block in document().blocks if isinstance(block, kinds)]
    markdown = render_summary(Document("t", "", shown[:-1]))
    lines = markdown.splitlines()
    for line in (
        "**Table 1.** Coefficients.",
        "- two: Table 1",
        "Plain, *slanted*, **bold**, `a.toml`.",
        "The paper has $`c_1`$.",
    ):
        assert line in lines
    assert "field" not in markdown
    assert markdown.endswith("\n")
    assert not markdown.endswith("\n\n")
    assert (
        "| Pulley | $`c_1`$ [N] | Informed |\n"
        "| --- | --: | :-: |\n"
        "| small | 0.0128 | yes |\n"
        "| large | 12.5 | no |\n"
    ) in markdown


def test_pipes_stay_inside_their_cell() -> None:
    cells = [["a | b", Code("c | d `e`"), Math("c_1"), "end"]]
    text = render_summary(Document("t", "", [Table("c", list("wxyz"), cells)]))
    row = inline_texts(text)[-4:]
    assert row[0] == "a | b"
    assert row[1] == "c | d `e`"
    assert row[2] == "$c_1$"
    assert row[3] == "end"


def test_ticks_and_line_ends_cannot_end_what_holds_them() -> None:
    blocks = [
        Paragraph([Code("`"), " x"]),
        Paragraph("12) a\n# b"),
    ]
    text = render_summary(Document("a\nb", "", blocks))
    assert [t.tag for t in tokens(text) if t.type == "heading_open"] == ["h1"]
    assert inline_texts(text)[-2:] == ["` x", "12) a # b"]


def test_what_page_one_cannot_hold_is_an_error_not_a_gap() -> None:
    with pytest.raises(TypeError, match="page one"):
        render_summary(Document("t", "", [Listing("x")]))


def test_bold_words_with_blanks_at_their_ends_are_bold() -> None:
    blocks = [Paragraph([Strong("Where. "), "Here", Emphasis(" or there")])]
    assert "**Where.** Here *or there*" in render_summary(Document("t", "", blocks))


def test_points_of_a_notice_stand_inside_of_its_box():
    notice = Notice("attention", "2 remarks:", points=["c2 is biased.", "1 trial left out."])
    page = Document("Page one", "", (notice, Paragraph("After it.")))
    assert (
        "> **Attention.** 2 remarks:\n> \n> - c₂ is biased.\n> - 1 trial left out.\n\nAfter it."
    ) in render_summary(page)
    box = re.search(r'<div class="notice attention".*?</div>', render_html(page), re.DOTALL)
    assert box is not None
    assert box[0].count("<li>") == 2
