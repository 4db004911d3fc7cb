"""Evidence that is older than the code that it speaks of is told."""

from pathlib import Path

import pytest
from campaigns import evidence

MADE = {
    "bayesfric/__init__.py": "",
    "bayesfric/physics/__init__.py": "",
    "bayesfric/physics/law.py": "from bayesfric.paper import g",
    "bayesfric/paper.py": "g = 9.81",
    "bayesfric/schemas/fit.py": "from bayesfric.margins import nothing",
    "bayesfric/rigs/__init__.py": "from bayesfric.schemas import fit",
    "bayesfric/rigs/board.py": "def f():\n    from bayesfric import physics",
    "bayesfric/margins/__init__.py": "",
    "data/paper/paper.toml": "g = 9.81",
    "tests/campaigns/falls.py": (
        "import bayesfric as bf\nfrom campaigns import evidence\nfrom physics import balls\n"
        "from bayesfric.rigs import board"
    ),
    "tests/campaigns/evidence.py": "",
    "tests/physics/balls.py": "",
}


@pytest.fixture
def tree(tmp_path):
    for name, text in MADE.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    evidence.digest.cache_clear()
    return tmp_path


def record_of(root):
    paths = evidence.code_of(root / "tests" / "campaigns" / "falls.py", root)
    return {"code": {path: evidence.digest(path, root) for path in paths}}


def test_code_is_every_room_that_makes_a_number(tree):
    """Rooms of rooms too, with their data, and helpers; no room that a schema alone reads."""
    assert list(record_of(tree)["code"]) == [
        "bayesfric/paper.py",
        "bayesfric/physics",
        "bayesfric/rigs",
        "data/paper",
        "tests/campaigns/falls.py",
        "tests/physics/balls.py",
    ]


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("bayesfric/physics/law.py", "from bayesfric.paper import g  # other", "bayesfric/physics"),
        ("bayesfric/physics/new.py", "", "bayesfric/physics"),
        ("bayesfric/paper.py", "g = 9.82", "bayesfric/paper.py"),
        ("data/paper/paper.toml", "g = 9.82", "data/paper"),
        ("tests/campaigns/falls.py", "", "tests/campaigns/falls.py"),
        ("bayesfric/margins/__init__.py", "other", None),
        ("bayesfric/physics/__pycache__/law.pyc", "compiled", None),
    ],
)
def test_a_change_of_its_code_makes_evidence_stale(tree, name, text, expected):
    record = record_of(tree)
    assert evidence.changed(record, tree) == []
    (tree / name).parent.mkdir(exist_ok=True)
    (tree / name).write_text(text)
    evidence.digest.cache_clear()
    assert evidence.changed(record, tree) == ([expected] if expected else [])


def test_of_the_rigs_those_that_a_campaign_names_count(tree):
    """What all rigs share counts too, another rig's folder does not."""
    campaign = tree / "tests/campaigns/falls.py"
    campaign.write_text(MADE["tests/campaigns/falls.py"] + '\nRIGS = ("one",)')
    for rig in ("one", "other"):
        (tree / "bayesfric/rigs" / rig).mkdir()
        (tree / "bayesfric/rigs" / rig / "rows.py").write_text("")
    record = record_of(tree)
    for changed, expected in [("other/rows.py", []), ("one/rows.py", ["bayesfric/rigs/one"])]:
        (tree / "bayesfric/rigs" / changed).write_text("n = 1")
        evidence.digest.cache_clear()
        assert evidence.changed(record, tree) == expected
    (tree / "bayesfric/rigs/board.py").write_text("")
    evidence.digest.cache_clear()
    assert evidence.changed(record, tree) == ["bayesfric/rigs/board.py", "bayesfric/rigs/one"]


def test_a_file_of_another_name_or_gone_makes_it_stale(tree):
    record = record_of(tree)
    (tree / "bayesfric/physics/law.py").rename(tree / "bayesfric/physics/laws.py")
    (tree / "bayesfric/paper.py").unlink()
    evidence.digest.cache_clear()
    assert evidence.changed(record, tree) == ["bayesfric/paper.py", "bayesfric/physics"]


def test_evidence_that_names_no_code_is_stale():
    assert evidence.changed({"name": "old"}) == ["bayesfric"]


def test_a_campaign_writes_what_is_read_back_as_fresh(tmp_path, monkeypatch):
    from campaigns import wander

    monkeypatch.setattr(evidence, "EVIDENCE", tmp_path)
    evidence.write("wander", wander, seeds=[0, 1], figures={"n": 2}, cases=[])
    record = evidence.read("wander")
    assert evidence.names() == ["wander"]
    rooms = {"analysis.py", "effects", "fitting", "inference", "physics", "simulate"}
    assert {f"bayesfric/{room}" for room in rooms} <= set(record["code"])
    assert not {"bayesfric/diagnosis", "bayesfric/schemas"} & set(record["code"])
    assert evidence.changed(record) == []
    assert evidence.age(record).endswith("of this code")
    record["code"]["bayesfric/physics"] = "0" * evidence.DIGITS
    assert evidence.age(record).endswith("older than bayesfric/physics")


def test_cases_of_other_code_are_no_cases_of_a_campaign(tmp_path, monkeypatch):
    from campaigns import wander

    monkeypatch.setattr(evidence, "WORK", tmp_path)
    here = evidence.work("wander", wander)
    assert here.parent == tmp_path
    assert here == evidence.work("wander", wander)
    digests = {path: evidence.digest(path) for path in evidence.code_of(Path(wander.__file__))}
    digests["bayesfric/physics"] = "0" * evidence.DIGITS
    monkeypatch.setattr(evidence, "digest", digests.__getitem__)
    assert evidence.work("wander", wander) != here


@pytest.mark.nightly
@pytest.mark.parametrize("name", evidence.names())
def test_no_evidence_is_older_than_its_code(name):
    """`make test-long` makes it anew; what it no longer speaks of is not evidence."""
    stale = evidence.changed(evidence.read(name))
    assert not stale, f"{name}: changed since it was made: {', '.join(stale)}"
