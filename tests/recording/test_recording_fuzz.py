"""Whatever lies on disk, the reader returns a recording or raises InputError.

``BAYESFRIC_HYPOTHESIS_EXAMPLES=2000 pytest tests/recording/test_recording_fuzz.py``
runs the long form, with examples that differ each time; `make test-nightly` does.
"""

import json
import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st
from recording.mini import TABLES, Mini, write_files

from bayesfric.errors import InputError
from bayesfric.recording import (
    Gravity,
    Recording,
    RigConstants,
    describe_recording,
    read_recording,
    write_recording,
)

EXAMPLES = os.environ.get("BAYESFRIC_HYPOTHESIS_EXAMPLES")


def fuzz(share: float) -> settings:
    """Examples of one test, as a share of those that are asked for."""
    return settings(
        max_examples=round(share * int(EXAMPLES or 40)),
        deadline=None,
        derandomize=EXAMPLES is None,
        suppress_health_check=list(HealthCheck),
    )


KINDS = [
    ("gravity_trials.csv", "gravity_events.csv"),
    ("motor_runs.csv", "motor_idle.csv"),
    ("steady_friction.csv",),
    ("axis_runs.csv", "axis_samples.csv"),
]
ODD_NUMBERS = "0 -0.0 -1 9.0 9.5 1e308 -1e308 1e-320 1e999 nan inf 9e999999999 1e-400 0.0098 180"
ODD_WORDS = ("", " ", "g1", "r1", "drive", "load", "left", "test", "a", "=1+1", "9" * 400)
ODD_MARKS = ('"', '""', '"a,b"', "\ufeff", "\u2028", "\x85", "\x0b", "\r")
ODD_CELLS = st.one_of(
    st.sampled_from([*ODD_NUMBERS.split(), *ODD_WORDS, *ODD_MARKS]),
    st.floats().map(repr),
    st.integers().map(str),
    st.text(max_size=5),
)
ODD_JSON = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=5)
    | st.sampled_from([10**400, "steady_friction.csv", "../x", ".", "", "/", "\ud800", "\0"]),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3)
    ),
    max_leaves=5,
)


def odd_value(draw: st.DrawFn, package: dict[str, Any]) -> None:
    """Replace, drop or add a value somewhere in the JSON."""
    place: Any = package
    while True:
        keys = list(place) if isinstance(place, dict) else list(range(len(place)))
        key = draw(st.sampled_from(keys)) if keys else None
        deeper = key is not None and isinstance(place[key], dict | list)
        if not deeper or draw(st.booleans()):
            break
        place = place[key]
    action = draw(st.sampled_from(["replace", "drop", "add"]))
    if action == "add" or key is None:
        if isinstance(place, dict):
            place[draw(st.text(max_size=5))] = draw(ODD_JSON)
        else:
            place.append(draw(ODD_JSON))
    elif action == "drop":
        del place[key]
    else:
        place[key] = draw(ODD_JSON)


def odd_rows(draw: st.DrawFn, rows: list[list[str]]) -> None:
    """Spoil the cells, columns or rows of a table."""
    row = draw(st.integers(0, len(rows) - 1))
    column = draw(st.integers(0, max(len(rows[row]) - 1, 0)))
    action = draw(st.sampled_from(["cell", "cell", "column", "repeat", "drop", "drop column"]))
    if action == "cell" and rows[row]:
        rows[row][column] = draw(ODD_CELLS)
    elif action == "column":
        cell = draw(ODD_CELLS)
        for cells in rows[1:]:
            cells[column : column + 1] = [cell]
    elif action == "repeat":
        rows.insert(draw(st.integers(0, len(rows))), list(rows[row]))
    elif action == "drop":
        del rows[row][column : column + draw(st.sampled_from([1, 99]))]
    else:
        for cells in rows:
            del cells[column : column + 1]


@st.composite
def spoilt_files(draw: st.DrawFn) -> dict[str, bytes]:
    """Files of a recording, spoilt in one to four places."""
    kinds = draw(st.lists(st.sampled_from(KINDS), min_size=1, max_size=2, unique=True))
    mini = Mini().keep(*(file for kind in kinds for file in kind))
    for _ in range(draw(st.integers(0, 3))):
        if draw(st.booleans()):
            odd_rows(draw, mini.rows[draw(st.sampled_from(sorted(mini.rows)))])
        else:
            odd_value(draw, mini.package)
    files = mini.contents()
    name = draw(st.sampled_from(sorted(files)))
    action = draw(st.sampled_from(["none", "none", "insert", "cut", "drop", "replace"]))
    start = draw(st.integers(0, len(files[name])))
    if action == "insert":
        files[name] = files[name][:start] + draw(st.binary(max_size=4)) + files[name][start:]
    elif action == "cut":
        files[name] = files[name][:start]
    elif action == "drop":
        del files[name]
    elif action == "replace":
        files[name] = draw(st.binary() | st.text().map(lambda text: text.encode("utf-8", "ignore")))
    return files


def assert_sound(files: dict[str, bytes]) -> None:
    """Read the files: faults that can be printed, or a recording that can be used."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            recording = read_recording(write_files(Path(folder) / "read", files))
        except InputError as error:
            event("faults")
            assert_printable(error)
            return
        event("recording")
        "\n".join((*recording.notes, *map(str, describe_recording(recording)))).encode()
        write_recording(recording, Path(folder) / "written")
        assert_same(recording, read_recording(Path(folder) / "written"))


def assert_printable(error: InputError) -> None:
    assert error.faults
    for fault in error.faults:
        assert fault.file
        assert fault.expected
        assert fault.row is None or fault.row >= 1
        assert fault.column != ""
    str(error).encode()


def assert_same(recording: Recording, other: Recording) -> None:
    for name in ("name", "title", "rig", "created", "metadata"):
        assert getattr(recording, name) == getattr(other, name)
    for kind in ("gravity", "motor", "axis"):
        tables, others = getattr(recording, kind), getattr(other, kind)
        for part, table in vars(tables).items() if tables else ():
            again = getattr(others, part)
            if isinstance(table, pd.DataFrame):
                pd.testing.assert_frame_equal(table, again, rtol=0, atol=1e-8)
            else:  # a joint of an axis: nothing is parted before it is fitted
                assert table == again
    if recording.steady is not None:
        pd.testing.assert_frame_equal(recording.steady, other.steady)


@fuzz(1)
@given(spoilt_files())
def test_spoilt_recording(files: dict[str, bytes]) -> None:
    assert_sound(files)


@fuzz(0.25)
@given(
    st.sampled_from(["datapackage.json", *TABLES]),
    st.one_of(
        st.binary(max_size=60),
        st.text(max_size=60).map(lambda text: text.encode("utf-8", "ignore")),
        ODD_JSON.map(lambda value: json.dumps(value).encode()),
    ),
)
def test_arbitrary_file(name: str, content: bytes) -> None:
    kind = next((kind for kind in KINDS if name in kind), KINDS[2])
    assert_sound(Mini().keep(*kind).contents() | {name: content})


@st.composite
def gravity_recordings(draw: st.DrawFn) -> Recording:
    """Recordings of up to three trials that keep every rule."""
    names = draw(st.lists(st.text("abcé-1 ,", min_size=1).map(str.strip), min_size=1, max_size=3))
    names = sorted({name for name in names if name}) or ["t"]
    spacing = draw(st.floats(1e-4, 1.0))
    clock = draw(st.sampled_from([1e-6, 4e-6, 1e-3, 0.25, 1e-9]))
    trials, events = [], []
    for name in names:
        load = draw(st.floats(1e-3, 10.0))
        trials.append(
            {
                "trial": name,
                "setup": name,
                "pulley_size": draw(st.sampled_from(["small", "wide, flat", "x"])),
                "n_pulleys": draw(st.integers(1, 30)),
                "wrap_angle_deg": draw(st.floats(4, 180)),
                "mass_drive_kg": load * draw(st.floats(1.01, 3.0)),
                "mass_load_kg": load,
            }
        )
        for sensor in draw(st.sampled_from([("drive",), ("load",), ("drive", "load")])):
            steps = draw(st.lists(st.integers(1, 3), min_size=4, max_size=6))
            # At a constant speed, which weights can drive.
            tick = max(1, round(spacing / draw(st.floats(0.05, 2.0)) / clock))
            ticks = [step * tick for step in steps]
            for travel, at in zip(np.cumsum([0, *steps]), np.cumsum([0, *ticks]), strict=True):
                events.append((name, sensor, travel * spacing, at * clock))
    text = dict.fromkeys(("trial", "setup", "pulley_size"), "str")
    columns = ["trial", "sensor", "displacement_m", "time_s"]
    return Recording(
        name="generated",
        title="Generated",
        rig=RigConstants(
            gravity_m_s2=draw(st.floats(9.7, 9.9)),
            hall_spacing_m=spacing,
            magnets_per_revolution=draw(st.integers(1, 20)),
            timer_resolution_s=clock,
        ),
        gravity=Gravity(
            pd.DataFrame(trials).astype(text),
            pd.DataFrame(events, columns=columns).astype({"trial": "str", "sensor": "str"}),
        ),
    )


@fuzz(0.25)
@given(gravity_recordings())
def test_generated_recording_reads_back(recording: Recording) -> None:
    with tempfile.TemporaryDirectory() as folder:
        write_recording(recording, Path(folder) / "a")
        assert_same(recording, read_recording(Path(folder) / "a"))
