import subprocess
import sys

import pytest
from report.sample import SVG, document

from bayesfric.characters import legible
from bayesfric.report.content import (
    Code,
    Column,
    Document,
    Equation,
    Figure,
    Heading,
    Math,
    Notice,
    Paragraph,
    Reference,
    Strong,
    Table,
    inlines,
    prose,
)
from bayesfric.report.numbering import label_places
from bayesfric.report.words import with_code


def test_a_text_may_be_a_string_an_inline_or_a_sequence_of_both() -> None:
    symbol = Math("c_1")
    assert inlines("plain") == ("plain",)
    assert inlines(symbol) == (symbol,)
    assert inlines(["a", symbol]) == ("a", symbol)


def test_marks_are_read_in_the_words_of_the_report_and_in_no_field() -> None:
    assert prose("See @gap-1, **so** `{}` of $c_1$: {}.", "`$c_1$` @x") == [
        "See ", Reference("gap-1"), ", ", Strong("so"), " ", Code("{}"), " of ", Math("c_1"),
        ": ", "`$c_1$` @x", ".",
    ]  # fmt: skip
    assert prose("{}{}", "", Code("a")) == [Code("a")]
    with pytest.raises(ValueError, match="more fields"):
        prose("{}", "a", "b")


def test_names_in_backticks_of_a_meaning_are_code() -> None:
    assert with_code("in `power`, by T") == ["in ", Code("power"), ", by T"]
    assert with_code("slope") == ["slope"]


def test_blocks_are_numbered_by_kind_and_headings_by_level() -> None:
    names = {label: place.name for label, place in label_places(document()).items()}
    assert names == {
        "first": "Section 1",
        "law": "Equation 1",
        "coefficients": "Table 1",
        "field": "Figure 1",
        "again": "Figure 2",
    }


def test_section_numbers_start_again_under_a_new_chapter() -> None:
    headings = [
        Heading(1, "a"),
        Heading(2, "b"),
        Heading(3, "c"),
        Heading(1, "d"),
        Heading(2, "e", label="e"),
    ]
    assert label_places(Document("t", "", headings))["e"].name == "Section 2.1"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Document("t", "", [Paragraph(Reference("gone"))]), "reference to 'gone'"),
        (
            lambda: Document("t", "", [Heading(1, "a", "x"), Heading(1, "b", "x")]),
            "two blocks have the label 'x'",
        ),
        (lambda: Document("t", "", [Heading(2, "deep")]), "a level of 1 at most, got 2"),
        (lambda: Document("", "", []), "document, title"),
        (lambda: Table("t", ["a", "b"], [["1", "2"], ["1"]]), "row 2: expected 2 cells"),
        (lambda: Table("t", ["a"], ["1"]), "row 1: expected 1 cells"),
        (lambda: Column("t", align="middle"), "'middle'"),  # type: ignore[arg-type]
        (lambda: Figure(lambda: b"PNG", "c", "a").svg, "expected SVG"),
        (lambda: Figure(lambda: SVG, "c", ""), "figure, alt"),
        (lambda: Figure(lambda: SVG, "c", "a", width=1.5), "got 1.5"),
        (lambda: Equation("x"), "formula: expected one of"),
        (lambda: Notice("bad", "t"), "'bad'"),  # type: ignore[arg-type]
        (lambda: Heading(4, "t"), "got 4"),  # type: ignore[arg-type]
    ],
)
def test_what_no_renderer_could_show_is_refused_where_it_is_written(make, message) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_what_no_page_can_hold_is_shown_by_its_code() -> None:
    assert legible("a\x00b\ud800c\u202ed\te\nf") == "a[U+0000]b[U+D800]c[U+202E]d e f"
    assert legible("a\tb\r\nc\x1b", lines=True) == "a   b\nc[U+001B]"


def test_the_tree_is_cheap_to_import() -> None:
    heavy = "{'typst', 'jinja2', 'matplotlib', 'numpy'}"
    code = f"import sys, bayesfric.report.content; sys.exit(str({heavy} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stderr.strip() == "set()"


def test_columns_that_say_nothing_are_left_out() -> None:
    table = Table("t", ["a", "b", "c", "d"], [["", "—", "", "0"], ["", "", "x", "1"]]).filled()
    assert [column.title for column in table.head] == ["a", "c", "d"]
    assert list(table.rows) == [["", "", "0"], ["", "x", "1"]]


def test_stored_sentences_are_set_like_all_others():
    code = Code("12%")
    shown = inlines(["off by 12%, 1.6e-05 kg and 5 % more; ", Strong("2.0%"), code])
    assert shown == (
        "off by 12\u202f%, 1.6 × 10⁻⁵ kg and 5\u202f% more; ",
        Strong("2.0\u202f%"),
        code,
    )
    assert inlines("P > 0.985, a ≤ −2, a < b") == ("P >\u00a00.985, a ≤\u00a0−2, a < b",)
    for name in ("-2", "run-1e5", "g0001", "%d", "abc-1e-05x"):  # a user's own
        assert inlines(name) == (name,)


def test_a_coefficient_has_one_spelling_in_words():
    assert inlines(["c1, c2[small] and c3.", Strong("c1"), Code("c1"), "c10, ac1, run/c1"]) == (
        "c₁, c₂ (small) and c₃.",
        Strong("c₁"),
        Code("c1"),
        "c10, ac1, run/c1",
    )
