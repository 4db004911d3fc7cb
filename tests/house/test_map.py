"""The map in ARCHITECTURE.md is the territory."""

import re
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[2]


def read_map():
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```map\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL)
    return [line for line in block.splitlines() if line.strip()]


def listed():
    return [line.split()[0] for line in read_map()]


def test_each_line_is_a_path_and_a_sentence():
    assert [line for line in read_map() if not re.fullmatch(r"\S+ +— \S.*\S", line)] == []


def test_each_path_exists():
    def exists(path):
        there = ROOT / path
        return there.is_dir() if path.endswith("/") else there.is_file()

    assert [path for path in listed() if not exists(path)] == []


def test_each_room_is_listed():
    package = ROOT / "bayesfric"
    rooms = {f"bayesfric/{file.name}" for file in package.glob("*.py")}
    rooms |= {f"bayesfric/{file.relative_to(package).parts[0]}/" for file in package.glob("*/*.py")}
    assert rooms - set(listed()) == set()


def test_nothing_is_listed_twice():
    assert [path for path, times in Counter(listed()).items() if times > 1] == []
