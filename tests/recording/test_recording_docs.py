"""The page on the format names all that the reader knows."""

import re
from dataclasses import fields
from pathlib import Path

import pytest

from bayesfric.recording import RigConstants, read_recording
from bayesfric.recording.columns import TABLES

PAGE = Path(__file__).parents[2] / "docs" / "recording.md"
NAMES = [
    *TABLES,
    *(column.name for table in TABLES.values() for column in table.columns),
    *(field.name for field in fields(RigConstants)),
]


@pytest.mark.parametrize("name", sorted(set(NAMES)))
def test_page_names(name: str) -> None:
    assert f"`{name}`" in PAGE.read_text("utf-8")


def test_example_on_the_page_is_a_recording(tmp_path: Path) -> None:
    examples = re.findall(r"`([\w.]+)`[^\n]*:\n\n```\w*\n(.*?)```", PAGE.read_text("utf-8"), re.S)
    for name, text in examples:
        (tmp_path / name).write_text(text, encoding="utf-8")
    gravity = read_recording(tmp_path).gravity
    assert gravity is not None
    assert len(gravity.events) == 10
