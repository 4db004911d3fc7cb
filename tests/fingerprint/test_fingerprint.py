"""The numbers are those that are kept, and what moves on purpose says why."""

import json

import numpy as np
import pytest
from fingerprint import __main__ as command
from fingerprint import stored
from fingerprint.numbers import Number, closed, drawn, farthest, integrated, moved, text
from fingerprint.parts import PARTS
from threadpoolctl import threadpool_limits


@pytest.mark.parametrize("part", PARTS)
def test_the_numbers_of_a_part_hold(part):
    """Where one moves on purpose: ``make fingerprint MOVE=… WHY=…``."""
    with threadpool_limits(limits=1):
        assert moved(stored.numbers_of(part), PARTS[part]()) == {}


def test_each_part_is_kept_and_no_other():
    assert set(stored.parts()) == set(PARTS)
    assert all(stored.read().values())


def test_a_number_that_was_changed_comes_with_its_reason():
    assert stored.unexplained() == []


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """A fingerprint of one part elsewhere, with a changelog of two versions."""
    for name in ("NUMBERS", "MOVES", "CHANGELOG"):
        monkeypatch.setattr(stored, name, tmp_path / name)
    numbers = {"steady": closed(2.0), "moving": integrated([1.0, 3.0]), "drawn": drawn(5.0, 0.1)}
    monkeypatch.setitem(PARTS, "small", lambda: dict(numbers))
    for part in set(PARTS) - {"small"}:
        monkeypatch.delitem(PARTS, part)
    lines = [
        "# Changelog",
        "",
        "## Unreleased",
        "",
        "### Changed",
        "",
        "- Old.",
        "",
        "## 0.1.0",
        "",
    ]
    stored.CHANGELOG.write_text("\n".join(lines))
    stored.NUMBERS.write_text("{}")
    monkeypatch.setattr(command, "ProcessPoolExecutor", _here)
    assert command.main(["--anew"]) == 0
    return numbers


class _here:  # noqa: N801 — in the place of an executor, whose processes know of no other paths
    def __init__(self, workers):
        self.map = map

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None


def test_a_move_is_written_with_its_reason_and_leaves_what_holds(kept, capsys):
    assert stored.unexplained() == []
    first = stored.digest("small")
    kept["steady"] = closed(2.0 + 1e-9)  # within its bound
    assert command.main([]) == 0
    assert "3 numbers in 1 parts hold" in capsys.readouterr().out
    kept["moving"] = integrated([1.0, 3.001])
    assert command.main([]) == 1
    printed = capsys.readouterr().out
    assert "moving" in printed
    assert "33.3 × bound" in printed
    assert "steady" not in printed
    assert stored.digest("small") == first
    assert command.main(["--move", "small", "--why", "three was not enough"]) == 0
    assert stored.read()["small"]["steady"]["value"] == 2.0
    assert stored.read()["small"]["moving"]["value"] == [1.0, 3.001]
    assert stored.digest("small") != first
    line = "- Fingerprint: `small` moved: three was not enough\n"
    assert f"### Changed\n\n{line}- Old." in stored.CHANGELOG.read_text()
    assert stored.unexplained() == []


def test_a_move_without_a_reason_is_refused(kept, capsys):
    kept["steady"] = closed(3.0)
    with pytest.raises(SystemExit):
        command.main(["--move", "small"])
    assert "--why" in capsys.readouterr().err


def test_a_number_that_is_changed_by_hand_is_told(kept):
    rows = stored.read()
    rows["small"]["steady"]["value"] = 2.1
    stored.NUMBERS.write_text(json.dumps(rows))
    (complaint,) = stored.unexplained()
    assert "small: numbers.json was changed without a move" in complaint


def test_a_reason_that_the_changelog_lacks_is_told(kept):
    kept["steady"] = closed(3.0)
    command.main(["--move", "small", "--why", "it was a third off"])
    words = stored.CHANGELOG.read_text().replace("a third off", "a\n  third off")
    stored.CHANGELOG.write_text(words)  # a long line may be broken
    assert stored.unexplained() == []
    stored.CHANGELOG.write_text(words.replace("third", "half"))
    (complaint,) = stored.unexplained()
    assert "CHANGELOG.md lacks" in complaint


@pytest.mark.parametrize(
    ("kept_number", "new", "share"),
    [
        (closed(100.0), closed(100.0 + 5e-7), 0.5),
        (integrated(100.0), integrated(100.002), 2.0),
        (drawn(5.0, 0.1), drawn(5.2, 0.12), 0.5),
        # A hundredth of the largest is the least that a small one is held by.
        (closed([1e6, 1.0]), closed([1e6, 1.0 + 5e-5]), 0.5),
        (text("named"), text("named"), 0.0),
        (text("named"), text("unknown"), np.inf),
        (closed([1.0, 2.0]), closed([1.0]), np.inf),
        (closed(0.0), closed(0.0), 0.0),
        (closed(0.0), closed(1e-300), np.inf),
        (drawn(5.0, 0.1), drawn(5.0, 0.01), np.inf),
    ],
)
def test_a_move_is_counted_in_bounds(kept_number, new, share):
    assert farthest(kept_number, new) == pytest.approx(share, rel=1e-3)


def test_what_is_no_number_is_refused():
    with pytest.raises(ValueError, match="not finite"):
        closed([1.0, np.nan])
    with pytest.raises(ValueError, match="error above zero"):
        Number(1.0, "draws")


def test_numbers_come_and_go():
    before, after = {"a": closed(1.0), "b": closed(2.0)}, {"b": closed(2.0), "c": closed(3.0)}
    assert moved(before, after) == {"a": np.inf, "c": np.inf}
