"""A fit that is killed goes on, when it is called again, to the same bytes."""

import hashlib
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
import pytest
from altered import by_acceleration
from numpy.typing import NDArray
from typer.testing import CliRunner
from typing_extensions import TypeAliasType

from bayesfric import checkpoint
from bayesfric.checkpoint import Checkpoint
from bayesfric.cli import app
from bayesfric.recording import write_recording

KILLS = 4
# Steps enough that a fit does not end before the signal on a busy machine.
SETTINGS = "seed = 5\n[sampler]\nburn = 10\nsteps = 200\nthin = 2\nextensions = 0\n"
FILES = ("fit.json", "draws.nc", "predictive.nc")


@pytest.fixture(scope="module")
def board(small_recording, tmp_path_factory):
    folder = tmp_path_factory.mktemp("resume")
    write_recording(by_acceleration(small_recording), folder / "board")
    (folder / "analysis.toml").write_text(SETTINGS)
    return folder


def start(board, output):
    command = [Path(sys.executable).with_name("bayesfric"), "fit", "board"]
    environment = {k: v for k, v in os.environ.items() if k != "SOURCE_DATE_EPOCH"}
    return subprocess.Popen(
        [*command, "--config", "analysis.toml", "-o", output, "--quiet"],
        cwd=board,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        # A run in the background of a shell ignores interrupts, and so would its children.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )


def run(arguments):
    done = CliRunner().invoke(app, ["fit", "board", "--config", "analysis.toml", *arguments])
    assert done.exit_code == 0, done.stderr


@pytest.mark.nightly
def test_what_was_finished_is_kept_and_leads_to_the_same_bytes(board, monkeypatch):
    """An interrupt, which exits with 3, then SIGKILL, then the rest."""
    checkpoint = board / "stopped" / ".checkpoint"
    kept = 0
    for sent, status in ((signal.SIGINT, 3), (signal.SIGKILL, -signal.SIGKILL)):
        process = start(board, "stopped")
        while len(list(checkpoint.glob("*.npz"))) <= kept:
            assert process.poll() is None
            time.sleep(0.01)
        process.send_signal(sent)
        assert process.wait() == status
        kept = len(list(checkpoint.glob("*.npz")))
        assert not (board / "stopped" / "fit.json").exists()
    monkeypatch.chdir(board)
    run(["-o", "stopped", "--quiet"])
    run(["-o", "at-one-go", "--quiet"])
    for name in FILES:
        at_one_go = (board / "at-one-go" / name).read_bytes()
        assert (board / "stopped" / name).read_bytes() == at_one_go
    names = {path.name for path in (board / "stopped").iterdir()}
    assert names == {*FILES, "timings.json"}


@pytest.mark.nightly
def test_kills_change_nothing(board):
    """SIGKILL at random moments, each followed by a new start of what is left."""
    began = time.monotonic()
    assert start(board, "unbroken").wait() == 0
    whole = time.monotonic() - began
    moments = random.Random(20260101)
    for _ in range(KILLS):
        process = start(board, "broken")
        time.sleep(moments.uniform(0.1, 1.0) * whole)
        process.send_signal(signal.SIGKILL)
        process.wait()
        names = {path.name for path in (board / "broken").glob("*")}
        assert names - {".checkpoint", ".writing"} in (set(), {*FILES, "timings.json"})
    assert start(board, "broken").wait() == 0
    for name in FILES:
        assert (board / "broken" / name).read_bytes() == (board / "unbroken" / name).read_bytes()
    names = {path.name for path in (board / "broken").iterdir()}
    assert names == {*FILES, "timings.json"}


def test_pieces_are_computed_once_and_exactly_kept(tmp_path):
    calls = []

    def compute():
        calls.append(1)
        return {"x": np.array([0.1, 1e-300])}

    first = Checkpoint(tmp_path / "c", "key").piece("a", compute)
    again = Checkpoint(tmp_path / "c", "key").piece("a", compute)
    assert (first["x"] == again["x"]).all()
    assert calls == [1]


def test_pieces_of_another_computation_are_not_used(tmp_path):
    Checkpoint(tmp_path / "c", "seed 1").piece("a", lambda: {"x": np.array(1.0)})
    other = Checkpoint(tmp_path / "c", "seed 2").piece("a", lambda: {"x": np.array(2.0)})
    assert other["x"] == 2.0


def test_a_piece_that_was_cut_short_is_not_trusted(tmp_path):
    checkpoint = Checkpoint(tmp_path / "c", "key")
    (tmp_path / "c" / "a.partial").write_bytes(b"half")
    assert checkpoint.piece("a", lambda: {"x": np.array(3.0)})["x"] == 3.0


Number = TypeVar("Number", bound=np.generic)
# As NumPy writes NDArray itself from 2.5 on.
Aliased = TypeAliasType(
    "Aliased", np.ndarray[tuple[Any, ...], np.dtype[Number]], type_params=(Number,)
)


class Named(NamedTuple):
    values: Mapping[str, NDArray[np.float64]]
    place: float
    named: Aliased[np.float64]


@dataclass(frozen=True)
class Part:
    name: str
    several: tuple[Named, ...]
    none: Named | None
    single: Named | None
    flag: bool
    texts: dict[str, str]


def test_a_record_comes_back_as_it_was(tmp_path):
    """Numbers to the last bit, what is not finite among them; arrays with their order."""
    columns, alias = np.arange(6.0).reshape(2, 3).T, np.array([1.5])
    named = Named({"a": columns, "b": np.array([np.nan, 0.1])}, np.float64(0.1) + 0.2, alias)
    part = Part("π", (named, named), None, Named({}, np.inf, alias), np.bool_(True), {"k": "v"})
    keeping = Checkpoint(tmp_path / "c", "key")
    keeping.record("a", Part | None, lambda: part)
    kept = keeping.record("a", Part | None, lambda: pytest.fail("it is kept"))
    assert kept.several[1].values["a"].flags.f_contiguous
    np.testing.assert_array_equal(kept.several[1].values["a"], columns)
    np.testing.assert_array_equal(kept.several[0].values["b"], [np.nan, 0.1])
    assert kept.several[0].place == 0.30000000000000004
    assert kept.single.named == kept.several[0].named == alias
    assert replace(kept, several=()) == replace(part, several=())
    assert keeping.record("n", Part | None, lambda: None) is None
    assert keeping.record("n", Part | None, lambda: pytest.fail("it is kept")) is None


def test_calls_are_pieces_by_their_places(tmp_path):
    calls = []

    def square(x):
        calls.append(x)
        return x * x

    for _ in range(2):
        kept = Checkpoint(tmp_path / "c", "key").keep_each_call("square", float, square)
        assert [kept(x) for x in (3.0, 4.0)] == [9.0, 16.0]
    assert calls == [3.0, 4.0]


def test_the_code_is_known_by_its_bytes(tmp_path, monkeypatch):
    for text in ("x = 1", "x = 2", "x = 1"):
        (tmp_path / "a.py").write_text(text)
        monkeypatch.setattr(checkpoint, "__file__", str(tmp_path / "checkpoint.py"))
        checkpoint.code_sha256.cache_clear()
        digest = hashlib.sha256(text.encode()).hexdigest()
        assert checkpoint.code_sha256() == digest
    checkpoint.code_sha256.cache_clear()
