"""Pages on the house name files and functions that are there, and the index has every page."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DECISIONS = ROOT / "docs" / "decisions"
PAGES = sorted(page for page in DECISIONS.glob("*.md") if page.name != "README.md")
FILES = {
    f"/{path.relative_to(ROOT).as_posix()}": path
    for folder in ("bayesfric", "tests", "docs", "data", "reports")
    for path in [ROOT / folder, *(ROOT / folder).rglob("*")]
    if "__pycache__" not in path.parts
}


def missing(text):
    """Return the files, folders and names that a page speaks of and that are not there."""
    wrong = []
    for place in re.findall(r"`([\w/]+(?:\.py|/))`", text):
        if not any(path.endswith(f"/{place.rstrip('/')}") for path in FILES):
            wrong.append(place)
    for place, names in re.findall(r"`([\w/]+\.py)`\s\(([^)]*)\)", text):
        sources = [file.read_text() for path, file in FILES.items() if path.endswith(f"/{place}")]
        for name in re.findall(r"`(?:\w+\.)?(\w+)`", names):
            if not any(re.search(rf"\b{name}\b", source) for source in sources):
                wrong.append(f"{place} ({name})")
    return wrong


@pytest.mark.parametrize(
    "page", [ROOT / "ARCHITECTURE.md", ROOT / "CONTRIBUTING.md", *PAGES], ids=lambda page: page.stem
)
def test_what_a_page_names_is_there(page):
    assert missing(page.read_text(encoding="utf-8")) == []


def test_what_is_not_there_is_noticed():
    text = "`rigs/nowhere.py`, `gap/`, `results.py` (`nothing_of_the_kind`, `json_bytes`)"
    assert missing(text) == ["rigs/nowhere.py", "gap/", "results.py (nothing_of_the_kind)"]


def test_the_index_has_each_page_by_its_title():
    index = (DECISIONS / "README.md").read_text(encoding="utf-8")
    listed = re.findall(r"^- \[([\w.-]+)\]\(\1\): (.+)$", index, flags=re.MULTILINE)
    titles = [(page.name, page.read_text(encoding="utf-8").splitlines()[0]) for page in PAGES]
    assert sorted(listed) == [(name, title.removeprefix("# ")) for name, title in titles]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_has_context_decision_and_consequence(page):
    """As headings, or in bold where a page has several decisions."""
    text = page.read_text(encoding="utf-8")
    headings = re.findall(r"^(?:## |- \*\*)([\w ]+)", text, flags=re.MULTILINE)
    assert {"Context", "Decision", "Consequence", "Where"} <= set(headings)
