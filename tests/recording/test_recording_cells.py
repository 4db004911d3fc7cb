"""Every rule of one cell, broken once: the fault names file, row, column and value."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from recording.mini import TABLES, Mini

from bayesfric.errors import InputError
from bayesfric.recording import read_recording
from bayesfric.recording.columns import GRAVITY_EVENTS, Column
from bayesfric.recording.columns import TABLES as FORMATS
from bayesfric.recording.frames import typed
from bayesfric.recording.numbers import to_numbers

CONDITION = ("pulley_size", "n_pulleys", "wrap_angle_deg")
NOT_NUMBERS = (
    "fast",
    "1;5",
    "nan",
    "NaN",
    "inf",
    "-Infinity",
    "1e999",
    "0x10",
    "1_0",
    "١",
)


def wrong_values(column: Column) -> list[str]:
    """Cells that the column must refuse."""
    if column.kind == "choice":
        wrong = ["Left", "both"]
    elif column.kind == "integer":
        wrong = ["9.5", "0", "-1", "99999999999999999999", "nine", "nan", "inf"]
    elif column.kind == "number":
        wrong = list(NOT_NUMBERS)
        wrong += ["0", "-1"] if column.above == 0 else []
        wrong += ["-0.1"] if column.least == 0 else []
        wrong += ["180.1"] if column.most == 180 else []
        wrong += ["0", "0.0", "-0"] if column.nonzero else []
    else:
        wrong = ["a\x1bb"]
    return wrong + ([] if column.may_be_empty else [""])


CASES = [
    (file, column, value)
    for file, table in FORMATS.items()
    for column in table.columns
    for value in wrong_values(column)
]


@pytest.mark.parametrize(
    ("file", "column", "value"), CASES, ids=[f"{f}-{c.name}-{v!r}" for f, c, v in CASES]
)
def test_wrong_cell_is_one_fault(tmp_path: Path, file: str, column: Column, value: str) -> None:
    mini = Mini().keep(file).set(file, 3, column.name, value)
    with pytest.raises(InputError) as caught:
        read_recording(mini.write(tmp_path))
    faults = [f for f in caught.value.faults if (f.row, f.column) == (3, column.name)]
    assert [(f.file, f.row, f.column, f.value) for f in faults] == [(file, 3, column.name, value)]
    assert faults[0].expected.startswith(column.expected)


BOUNDS = [
    ("gravity_trials.csv", "mass_drive_kg", "0", "above 0 in kg"),
    ("gravity_trials.csv", "mass_load_kg", "0", "above 0 in kg"),
    ("gravity_trials.csv", "mass_load_kg", "-0.5", "above 0 in kg"),
    ("gravity_trials.csv", "wrap_angle_deg", "-0.1", "from 0 to 180 in deg"),
    ("gravity_trials.csv", "wrap_angle_deg", "180.1", "from 0 to 180 in deg"),
    ("gravity_trials.csv", "acceleration_sd_m_s2", "1e-12", "of at least 1e-06 in m/s²"),
    ("motor_runs.csv", "hanging_mass_kg", "0", "above 0 in kg"),
    ("motor_runs.csv", "wrap_angle_deg", "200", "from 0 to 180 in deg"),
    ("motor_runs.csv", "velocity_m_s", "0.0", "other than 0 in m/s"),
    ("motor_idle.csv", "velocity_m_s", "0", "other than 0 in m/s"),
    ("steady_friction.csv", "wrap_angle_deg", "-1", "from 0 to 180 in deg"),
    ("steady_friction.csv", "tension_n", "-1", "of at least 0 in N"),
    ("steady_friction.csv", "friction_sd_n", "0", "above 0 in N"),
    ("steady_friction.csv", "friction_n", "-1e13", "in N, of 1e+12 at most in size"),
    ("axis_samples.csv", "time_s", "1793640000000000000", "in s, of 1e+12 at most in size"),
]


@pytest.mark.parametrize(("file", "column", "value", "rule"), BOUNDS)
def test_bounds_of_the_format(
    tmp_path: Path, file: str, column: str, value: str, rule: str
) -> None:
    """The rules themselves, whatever the list of columns says."""
    mini = Mini().kind(file).set(file, 3, column, value)
    with pytest.raises(InputError) as caught:
        read_recording(mini.write(tmp_path))
    fault = next(fault for fault in caught.value.faults if fault.column == column)
    assert (fault.file, fault.row, fault.value) == (file, 3, value)
    assert rule in fault.expected


def test_mini_recording_has_every_column_of_the_format() -> None:
    for file, table in FORMATS.items():
        header = TABLES[file].splitlines()[0].split(",")
        assert {column.name for column in table.columns} <= set(header)


@pytest.mark.parametrize(
    ("file", "column"),
    [
        (file, column.name)
        for file, table in FORMATS.items()
        for column in table.columns
        if column.required
    ],
)
def test_missing_required_column_is_one_fault(tmp_path: Path, file: str, column: str) -> None:
    with pytest.raises(InputError) as caught:
        read_recording(Mini().kind(file).drop(file, column).write(tmp_path))
    (fault,) = caught.value.faults
    assert (fault.file, fault.row, fault.column, fault.value) == (file, 1, column, None)
    assert fault.expected.startswith("this column")


@pytest.mark.parametrize(
    ("file", "column"),
    [
        (file, column.name)
        for file, table in FORMATS.items()
        for column in table.columns
        if not column.required
    ],
)
def test_optional_column_may_be_absent_or_wholly_empty(
    tmp_path: Path, file: str, column: str
) -> None:
    absent = Mini().kind(file).drop(file, column)
    empty = Mini().kind(file)
    for row in range(2, len(empty.rows[file]) + 1):
        empty.set(file, row, column, "")
    if column == "acceleration_m_s2":  # the trial that rests on it
        absent.rows[file].pop()
        empty.rows[file].pop()
    without = read_recording(absent.write(tmp_path / "absent"))
    other = read_recording(empty.write(tmp_path / "empty"))
    frames = [frame_of(recording, file) for recording in (without, other)]
    assert list(frames[0].columns) == list(frames[1].columns)
    filled_in = column == "setup" and file in ("gravity_trials.csv", "motor_runs.csv")
    assert (column in frames[0]) == filled_in


@pytest.mark.parametrize(
    ("file", "row", "column", "written", "read"),
    [
        ("gravity_trials.csv", 2, "n_pulleys", "9.0", 9),
        ("gravity_trials.csv", 2, "n_pulleys", " 9 ", 9),
        ("gravity_trials.csv", 4, "wrap_angle_deg", "0", 0.0),
        ("gravity_trials.csv", 4, "wrap_angle_deg", "180", 180.0),
        ("gravity_trials.csv", 4, "mass_load_kg", "+.5e0", 0.5),
        ("gravity_trials.csv", 4, "pulley_size", "very wide", "very wide"),
        ("gravity_trials.csv", 4, "acceleration_m_s2", "-0.1", -0.1),
        ("steady_friction.csv", 2, "velocity_m_s", "0", 0.0),
        ("steady_friction.csv", 2, "friction_n", "1e-3", 0.001),
        ("motor_idle.csv", 2, "current_a", "0", 0.0),
    ],
)
def test_good_cell_is_taken(
    tmp_path: Path, file: str, row: int, column: str, written: str, read: object
) -> None:
    mini = Mini().kind(file).set(file, row, column, written)
    if column in CONDITION:  # a setup has one condition
        mini.drop(file, "setup")
    recording = read_recording(mini.write(tmp_path))
    assert frame_of(recording, file)[column].iloc[row - 2] == read


def frame_of(recording, file):  # type: ignore[no-untyped-def]
    """Table of a recording by its file name."""
    kind, _, part = file.removesuffix(".csv").partition("_")
    table = getattr(recording, kind)
    return table if kind == "steady" else getattr(table, part)


@pytest.mark.parametrize("wrong", NOT_NUMBERS)
def test_cells_that_repeat_are_the_same_numbers(wrong: str) -> None:
    cells = ["0.0098", "0", wrong, "1e-3"]
    expected = [0.0098, 0.0, np.nan, 0.001]
    np.testing.assert_array_equal(to_numbers(pd.Series(cells)), expected)
    repeated = to_numbers(pd.Series(25 * cells, index=range(7, 107)))
    np.testing.assert_array_equal(repeated, 25 * expected)
    assert list(repeated.index) == list(range(7, 107))


def test_words_of_a_table_are_text_row_by_row() -> None:
    trial = pd.Series(["b", "a", "b", None], dtype="category")
    frame = typed(pd.DataFrame({"trial": trial, "time_s": 0.0}), GRAVITY_EVENTS)
    assert str(frame["trial"].dtype) == "str"
    assert frame["trial"].fillna("-").tolist() == ["b", "a", "b", "-"]
