"""Names, lengths of functions and circles of files, with an open list of what is not yet held.

A room that stands in no list below is held to the rule. A list may only shrink: a test fails
where more breaks a rule than is listed, and where something is listed that breaks none.
`python -m house.source ROOM` prints the places of a room.
"""

import pytest
from house.source import (
    PACKAGE,
    circles,
    empty_names,
    imported_files,
    lines_of_code,
    long_files,
    long_functions,
    measure_rooms,
)

# How many variables of a room are still named by a word that says nothing, and which files import
# each other in a circle.
NOT_YET_NAMED: dict[str, int] = {}
NOT_YET_STRAIGHT: list[set[str]] = []
# Files of more than 400 lines.
NOT_YET_SMALL: set[str] = set()
# End of what is not yet held.


@pytest.fixture(scope="module")
def rooms():
    return measure_rooms(PACKAGE)


def test_variables_are_named_for_what_they_hold(rooms):
    counts = {room: len(measures.empty_names) for room, measures in rooms.items()}
    too_many = {
        room: [str(place) for place in rooms[room].empty_names]
        for room, count in counts.items()
        if count > NOT_YET_NAMED.get(room, 0)
    }
    assert too_many == {}
    assert [room for room in NOT_YET_NAMED if not counts.get(room)] == [], "take these off the list"


def test_functions_are_short(rooms):
    long = {
        f"{place.file} {place.name}"
        for measures in rooms.values()
        for place in measures.long_functions
    }
    assert long == set()


def test_files_are_short():
    long = set(long_files(PACKAGE))
    assert long - NOT_YET_SMALL == set()
    assert NOT_YET_SMALL - long == set(), "take these off the list"


def test_no_files_import_each_other():
    rings = circles(imported_files(PACKAGE))
    listed = set().union(*NOT_YET_STRAIGHT)
    # A ring may lose files, and fall into several; it may gain none.
    assert [
        ring for ring in rings if not any(ring <= allowed for allowed in NOT_YET_STRAIGHT)
    ] == []
    assert listed - set().union(*rings) == set(), "take these off the list"


def test_no_file_lists_its_own_names():
    """An underscore says what is private; what a file hands on, it imports under its own name."""
    files = [file for file in PACKAGE.rglob("*.py") if file.name != "__init__.py"]
    assert [str(file) for file in files if "__all__ = " in file.read_text("utf-8")] == []


def test_lines_of_code_leave_out_what_is_for_readers_only():
    source = '"""A module.\n\nLong.\n"""\n\n# A comment.\nx = [\n    1,  # of two lines\n]\n'
    source += 'def f():\n    """Return.\n\n    Two.\n    """\n    return """a\n\n    b"""\n'
    assert lines_of_code(source) == 3 + 1 + 3


@pytest.mark.parametrize(
    ("source", "name"),
    [
        ("one = 1", "one"),
        ("for each in x: pass", "each"),
        ("y = [here for here in x]", "here"),
        ("def f(told): pass", "told"),
        ("def f(*, many=1): pass", "many"),
        ("lambda found: 1", "found"),
        ("with x as known: pass", "known"),
        ("class A:\n    known: int", "known"),
        ("def told(): pass", "told"),
        ("def _told(): pass", "_told"),
        ("self.found = 1", "found"),
        ("(one := 1)", "one"),
        ("a, (one, b) = x", "one"),
        ("import x as one", "one"),
    ],
)
def test_an_empty_name_is_noticed(source, name):
    (place,) = empty_names(source, "x.py")
    assert place.name == name


def test_a_name_that_only_holds_such_a_word_is_let_be():
    source = "one_trial = x.known\nf(each=2)\nhow_many = one\nfrom x import found\n"
    assert empty_names(source, "x.py") == []


@pytest.mark.parametrize(("statements", "is_long"), [(55, False), (56, True)])
def test_a_long_function_is_noticed(statements, is_long):
    source = 'def f():\n    """A docstring.\n\n    Counts too.\n    """\n'
    source += "    x = 1\n" * statements
    assert bool(long_functions(source, "x.py")) == is_long


def test_circles_are_noticed_inside_functions_and_under_type_checking(tmp_path):
    room = tmp_path / "fitting"
    room.mkdir()
    (room / "__init__.py").write_text("")
    (room / "a.py").write_text("def f():\n    from bayesfric.fitting import b\n")
    (room / "b.py").write_text("if TYPE_CHECKING:\n    from bayesfric.fitting.c import C\n")
    (room / "c.py").write_text("from . import a\n")
    (room / "d.py").write_text("from . import a\n")
    assert circles(imported_files(tmp_path)) == [{f"fitting/{name}.py" for name in "abc"}]
