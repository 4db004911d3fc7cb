"""Outside rigs/, recording/ and physics/ no module names a rig.

What is true of one rig is said by the rig, so that a new one is one new folder. Exempt are
engines of another hand, which record boards as a person would, margins, whose `motor`
and `gravity` are a joint's, and robots, whose `gravity` is what pulls at links.
"""

import ast
from pathlib import Path

import pytest

from bayesfric.rigs import all_rigs

PACKAGE = Path(__file__).parents[2] / "bayesfric"
KNOW_RIGS = ("rigs", "recording", "physics")
EXEMPT = ("blind/engines", "robots", "margins", "plots/margins.py", "report/chapters/margins.py")


def names_of_rigs():
    folders = {rig.__module__.split(".")[2] for rig in map(type, all_rigs().values())}
    return set(all_rigs()) | folders


def naming(source, names):
    """Return what names a rig: identifiers, attributes, whole strings and imports."""
    named = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Name):
            said = [node.id]
        elif isinstance(node, ast.Attribute):
            said = [node.attr]
        elif isinstance(node, ast.arg | ast.keyword):
            said = [node.arg]
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            said = [node.value]
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("bayesfric.rigs"):
            said = [*(node.module or "").split("."), *(alias.name for alias in node.names)]
        elif isinstance(node, ast.Import):
            said = [part for alias in node.names for part in alias.name.split(".")]
        else:
            continue
        named += [f"{node.lineno}: {word}" for word in said if word in names]
    return named


def modules():
    for file in sorted(PACKAGE.rglob("*.py")):
        place = file.relative_to(PACKAGE).as_posix()
        if not place.startswith((*(f"{room}/" for room in KNOW_RIGS), *EXEMPT)):
            yield place, file


def test_no_module_names_a_rig():
    names = names_of_rigs()
    assert {"gravity", "gravity_board", "motor", "motor_board"} <= names
    named = {place: naming(file.read_text("utf-8"), names) for place, file in modules()}
    assert {place: said for place, said in named.items() if said} == {}


@pytest.mark.parametrize(
    "source",
    [
        "recording.gravity",
        "likelihoods['motor']",
        "from bayesfric.rigs.gravity_board.likelihood import GravityModel",
        "import bayesfric.rigs.motor_board",
        "f(gravity=1)",
        "def f(motor): pass",
        "gravity = None",
    ],
)
def test_a_name_is_noticed(source):
    assert naming(source, names_of_rigs())


def test_words_and_units_that_hold_a_name_are_let_be():
    source = "gravity_m_s2 = 9.8\n'the gravity board'\nfrom bayesfric.physics.gravity import x"
    assert naming(source, names_of_rigs()) == []


def test_rigs_do_not_import_each_other():
    folders = [folder for folder in sorted((PACKAGE / "rigs").iterdir()) if folder.is_dir()]
    names = {folder.name for folder in folders}
    wrong = [
        f"{file.relative_to(PACKAGE)}: {said}"
        for folder in folders
        for file in sorted(folder.rglob("*.py"))
        for said in naming(file.read_text("utf-8"), names - {folder.name})
    ]
    assert wrong == []
