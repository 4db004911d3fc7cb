import pytest
from markdown_it import MarkdownIt
from markdown_it.token import Token
from report.sample import document

from bayesfric.report.content import (
    Code,
    Document,
    Emphasis,
    Heading,
    Link,
    Listing,
    Math,
    Paragraph,
    Strong,
    Table,
)
from bayesfric.report.markdown import render_markdown


def tokens(text: str) -> list[Token]:
    return MarkdownIt("commonmark").enable(["table", "strikethrough"]).parse(text)


def inline_texts(text: str) -> list[str]:
    """The text of each paragraph, heading or cell, as a reader sees it."""
    return [
        "".join(child.content for child in token.children or [])
        for token in tokens(text)
        if token.type == "inline"
    ]


@pytest.fixture(scope="module")
def markdown() -> str:
    return render_markdown(document())


def test_headings_captions_and_references_carry_the_same_numbers(markdown: str) -> None:
    lines = markdown.splitlines()
    for line in (
        "# A sample report",
        "A. Author, 2026-03-04",
        "> **Unconverged.** See Equation 1.",
        "## 1 First chapter",
        "### 1.1 Numbers",
        "#### 1.1.1 Details",
        "**Figure 1.** A blue field. *(A rectangle filled with blue.)*",
        "**Table 1.** Coefficients.",
        "- two: Table 1",
        "Plain, *slanted*, **bold**, `a.toml`.",
        "[the paper](https://example.org/paper) has $`c_1`$.",
    ):
        assert line in lines
    assert markdown.endswith("\n")
    assert not markdown.endswith("\n\n")


def test_a_table_is_a_table(markdown: str) -> None:
    assert (
        "| Pulley | $`c_1`$ [N] | Informed |\n"
        "| --- | --: | :-: |\n"
        "| small | 0.0128 | yes |\n"
        "| large | 12.5 | no |\n"
    ) in markdown


def test_pipes_stay_inside_their_cell() -> None:
    cells = [["a | b", Code("c | d `e`"), Math("c_1"), "end"]]
    text = render_markdown(Document("t", "", [Table("c", list("wxyz"), cells)]))
    row = inline_texts(text)[-4:]
    assert row[0] == "a | b"
    assert row[1] == "c | d `e`"
    assert row[2] == "$c_1$"
    assert row[3] == "end"


def test_ticks_and_line_ends_cannot_end_what_holds_them() -> None:
    blocks = [
        Heading(1, "a\nb"),
        Listing("```\n# no heading"),
        Paragraph([Code("`"), " ", Link("x", "https://example.org/a b)c")]),
        Paragraph("12) a\n# b"),
    ]
    text = render_markdown(Document("t", "", blocks))
    assert [t.tag for t in tokens(text) if t.type == "heading_open"] == ["h1", "h2"]
    assert [t.content for t in tokens(text) if t.type == "fence"] == ["```\n# no heading\n"]
    assert inline_texts(text)[-2:] == ["` x", "12) a # b"]
    assert "(https://example.org/a%20b%29c)" in text


def test_bold_words_with_blanks_at_their_ends_are_bold() -> None:
    blocks = [Paragraph([Strong("Where. "), "Here", Emphasis(" or there")])]
    assert "**Where.** Here *or there*" in render_markdown(Document("t", "", blocks))
