"""Plain tables are read in columns, and hold what the reader of single cells finds in them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bayesfric.errors import InputError
from bayesfric.recording.csv_text import LONGEST, _in_columns, _split

CELL = st.text(alphabet='ab1.5e-# \t\x0b\xa0ü\ufeff"', max_size=3)
END = st.sampled_from(["\n", "\n", "\n", "\r\n", "\r", "\n\n"])


@st.composite
def tables(draw):
    """Draw a text of few rows that is nearly a table: blanks, quotes, odd ends and rows."""
    width = draw(st.integers(1, 3))
    rows = []
    for _ in range(draw(st.integers(1, 5))):
        of_row = width if draw(st.integers(0, 9)) else draw(st.integers(1, 4))
        rows.append(",".join(draw(st.lists(CELL, min_size=of_row, max_size=of_row))))
    return "".join(row + draw(END) for row in rows) + draw(st.sampled_from(["", rows[0]]))


def read(how, text):
    """Return what is found, in lists, or the faults."""
    try:
        parsed = how(text)
    except InputError as error:
        return error.faults
    header, columns, lines, ragged = parsed
    return header, [list(column) for column in columns], list(lines), ragged


@given(tables())
def test_plain_tables_are_read_as_cell_by_cell(text):
    try:
        plain = _in_columns("t.csv", text.encode(), text)
    except InputError:
        plain = ()
    if plain is not None:
        columns = read(lambda text: _in_columns("t.csv", text.encode(), text), text)
        assert columns == read(lambda text: _split("t.csv", text), text)


@pytest.mark.parametrize("end", ["\n", "\r\n"])
@pytest.mark.parametrize("last", ["", "end"])
def test_a_plain_table_needs_no_second_look(end, last):
    text = end.join(["run, x ", "a, 1.50", " b ü,", "NA,nan"]) + (end if last else "")
    header, columns, lines, ragged = _in_columns("t.csv", text.encode(), text)
    assert (header, list(lines), ragged) == (["run", "x"], [2, 3, 4], {})
    assert [list(column) for column in columns] == [["a", "b ü", "NA"], ["1.50", "", "nan"]]


@pytest.mark.parametrize(
    "text",
    [
        "run,x\n",
        "run,x",
        "run\n1\n",
        'run,x\na,"1"\n',
        "run,x\na,1,2\nb\n",
        "run,x\na\nb,1,2\n",
        "run,x\na,1\n\nb,2\n",
        "run,x\na,1\rb,2\n",
        "run,x\n\ra,1\n",
        "run,x\n ,\n",
        "run,x\na,1\nrun,x\n",
        "\nrun,x\na,1\n",
        "run,x\na," + "1" * LONGEST + "\n",
    ],
)
def test_what_is_odd_is_looked_at_cell_by_cell(text):
    assert _in_columns("t.csv", text.encode(), text) is None


def test_a_blank_that_is_not_of_ascii_is_stripped():
    text = "run,x\n\xa0a,1\n"
    assert _in_columns("t.csv", text.encode(), text)[1][0].tolist() == ["a"]


def test_a_mark_of_byte_order_is_no_cell():
    text = "run,x\na,1\n"
    _, columns, _, _ = _in_columns("t.csv", b"\xef\xbb\xbf" + text.encode(), text)
    assert np.array_equal(columns, [["a"], ["1"]])
