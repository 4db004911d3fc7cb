"""Sixty mistakes that people make: each is one line that names it, before any fit."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from recording.mini import Mini, write_files

from bayesfric.errors import InputError
from bayesfric.recording import Recording, read_recording, write_recording

TRIALS, EVENTS, RUNS = "gravity_trials.csv", "gravity_events.csv", "motor_runs.csv"
STEADY, SAMPLES = "steady_friction.csv", "axis_samples.csv"

Files = dict[str, bytes]


def scaled(file: str, *columns: str, by: float) -> Callable[[Mini], Files]:
    """Write a column in another unit."""

    def spoil(mini: Mini) -> Files:
        for row in range(2, len(mini.rows[file]) + 1):
            for column in columns:
                place = mini.rows[file][0].index(column)
                if text := mini.rows[file][row - 1][place]:
                    mini.set(file, row, column, f"{float(text) * by:.10g}")
        return mini.contents()

    return spoil


def rig(**keys: object) -> Callable[[Mini], Files]:
    def spoil(mini: Mini) -> Files:
        mini.package["rig"] |= keys
        return mini.contents()

    return spoil


def as_text(
    file: str, edit: Callable[[str], str], encoding: str = "utf-8"
) -> Callable[[Mini], Files]:
    def spoil(mini: Mini) -> Files:
        files = mini.contents()
        return files | {file: edit(files[file].decode()).encode(encoding)}

    return spoil


def bytes_of(file: str, content: bytes) -> Callable[[Mini], Files]:
    return lambda mini: mini.contents() | {file: content}


def put(file: str, column: str, cell: str) -> Callable[[Mini], Files]:
    """Write one cell, in the row below the header."""
    return lambda mini: mini.set(file, 2, column, cell).contents()


def renamed(file: str, old: str, new: str) -> Callable[[Mini], Files]:
    return as_text(file, lambda text: text.replace(old, new, 1))


def decimal_commas(text: str) -> str:
    head, *rows = text.splitlines()
    return "\n".join([head, *(row.replace(".", ",") for row in rows)]) + "\n"


def quoted_decimal_commas(text: str) -> str:
    head, *rows = text.splitlines()
    cells = [row.split(",") for row in rows]
    quoted = [[f'"{c.replace(".", ",")}"' if "." in c else c for c in row] for row in cells]
    return "\n".join([head, *map(",".join, quoted)]) + "\n"


def with_units(text: str) -> str:
    """Write a row of units under the header, as a spreadsheet often has it."""
    head, *rows = text.splitlines()
    units = [name.rpartition("_")[2] if "_" in name else "-" for name in head.split(",")]
    return "\n".join([head, ",".join(units), *rows]) + "\n"


MISTAKES = {
    "grams on the gravity board": (
        scaled(TRIALS, "mass_drive_kg", "mass_load_kg", by=1000),
        TRIALS,
        "grams",
    ),
    "grams on the motor board": (scaled(RUNS, "hanging_mass_kg", by=1000), RUNS, "grams"),
    "millinewtons": (scaled(STEADY, "tension_n", by=1000), STEADY, "millinewtons"),
    "milliseconds": (scaled(EVENTS, "time_s", by=1000), EVENTS, "milliseconds"),
    "microseconds": (scaled(EVENTS, "time_s", by=1e6), EVENTS, "microseconds"),
    "kiloseconds": (scaled(EVENTS, "time_s", by=1e-3), EVENTS, "a motion that weights can drive"),
    "a spacing in millimetres": (rig(hall_spacing_m=9.8), "datapackage.json", "millimetres"),
    "a radius in millimetres": (rig(capstan_radius_m=6.5), "datapackage.json", "millimetres"),
    "a pulley in millimetres": (
        rig(pulleys={"wide": {"radius_m": 20.0}}),
        "datapackage.json",
        "millimetres",
    ),
    "a pulley in grams": (rig(pulleys={"wide": {"mass_kg": 12.5}}), "datapackage.json", "grams"),
    "a clock in microseconds": (rig(timer_resolution_s=4), "datapackage.json", "microseconds"),
    "gravity in mm/s²": (rig(gravity_m_s2=9810), "datapackage.json", "mm/s²"),
    "radians": (scaled(TRIALS, "wrap_angle_deg", by=np.pi / 180), TRIALS, "radians"),
    "accelerations in mm/s²": (scaled(TRIALS, "acceleration_m_s2", by=1000), TRIALS, "mm/s²"),
    "accelerations ten times too large": (
        scaled(TRIALS, "acceleration_m_s2", by=10),
        TRIALS,
        "1.96 m/s² without any friction",
    ),
    "currents in mA": (scaled(RUNS, "current_a", by=1000), RUNS, "milliamperes"),
    "a torque constant in mN·m/A": (rig(motor_torque_constant_n_m_per_a=25.9), RUNS, "mN·m/A"),
    "idle currents in mA": (
        scaled("motor_idle.csv", "current_a", by=1000),
        RUNS,
        "the unit of motor_idle.csv",
    ),
    "a torque constant in kN·m/A": (
        rig(motor_torque_constant_n_m_per_a=25.9e-6),
        RUNS,
        "holds the weight that it raises",
    ),
    "currents of the other sign": (
        scaled(RUNS, "current_a", by=-1),
        RUNS,
        "the sign of the torque that raises",
    ),
    "friction in mN": (scaled(STEADY, "friction_n", by=1000), STEADY, "millinewtons"),
    "an axis in milliseconds": (scaled(SAMPLES, "time_s", by=1000), SAMPLES, "milliseconds"),
    "an axis in millimetres": (
        lambda mini: scaled(SAMPLES, "position_m", by=1000)(
            mini.set(SAMPLES, 4, "position_m", "0.3")
        ),
        SAMPLES,
        "and not 300 m (is it in millimetres, or in degrees",
    ),
    "points in grams": (scaled(STEADY, "friction_n", "tension_n", by=102), STEADY, "grams"),
    "speeds in mm/s": (scaled(RUNS, "velocity_m_s", by=1000), RUNS, "mm/s"),
    "semicolons": (as_text(TRIALS, lambda text: text.replace(",", ";")), TRIALS, "semicolons"),
    "semicolons, decimal commas and a byte order mark": (
        as_text(TRIALS, lambda text: decimal_commas(text.replace(",", ";")), "utf-8-sig"),
        TRIALS,
        "semicolons",
    ),
    "tabs": (as_text(TRIALS, lambda text: text.replace(",", "\t")), TRIALS, "tabs"),
    "decimal commas": (as_text(EVENTS, decimal_commas), EVENTS, "the decimal mark is a point"),
    "decimal commas in some rows": (
        as_text(EVENTS, lambda text: text.replace("0.", "0,", 1)),
        EVENTS,
        "the decimal mark is a point",
    ),
    "a row of units": (as_text(EVENTS, with_units), EVENTS, "are these units? take the row out"),
    "a row of units above few numbers": (
        as_text(RUNS, with_units),
        RUNS,
        "are these units? take the row out",
    ),
    "another table's content": (
        lambda mini: mini.contents() | {EVENTS: Mini().contents()[RUNS]},
        EVENTS,
        "is this motor_runs.csv?",
    ),
    "no datapackage.json": (
        lambda mini: {k: v for k, v in mini.contents().items() if k != "datapackage.json"},
        "datapackage.json",
        "`bayesfric simulate example` writes one to copy",
    ),
    "quoted decimal commas": (
        as_text("motor_idle.csv", quoted_decimal_commas),
        "motor_idle.csv",
        "a point as the decimal mark",
    ),
    "a misspelt column": (
        renamed(TRIALS, "wrap_angle_deg", "wrap_angel_deg"),
        TRIALS,
        "is 'wrap_angel_deg' meant",
    ),
    "a column named after another unit": (
        renamed(TRIALS, "mass_load_kg", "mass_load_g"),
        TRIALS,
        "is 'mass_load_g' meant",
    ),
    "a spreadsheet's Unicode text": (as_text(TRIALS, str, "utf-16"), TRIALS, "UTF-16"),
    "another encoding": (
        as_text(RUNS, lambda text: text.replace("medium", "größe"), "latin-1"),
        RUNS,
        "saved in another encoding",
    ),
    "a spreadsheet named .csv": (
        bytes_of(TRIALS, b"PK\3\4\x14\x00\x06\x00\xa9\x83"),
        TRIALS,
        "save its sheet as CSV",
    ),
    "an old spreadsheet": (bytes_of(TRIALS, b"\xd0\xcf\x11\xe0\xa1"), TRIALS, "as CSV"),
    "a spreadsheet beside": (
        lambda mini: {
            file.replace(RUNS, "motor_runs.xlsx"): data for file, data in mini.contents().items()
        },
        RUNS,
        "is motor_runs.xlsx meant? save it as CSV",
    ),
    "a file's name in capitals": (
        lambda mini: {
            file.replace(TRIALS, "Gravity_Trials.csv"): data
            for file, data in mini.contents().items()
        },
        TRIALS,
        "is Gravity_Trials.csv meant? capital letters matter",
    ),
    "a table listed in capitals": (
        as_text(
            "datapackage.json",
            lambda text: text.replace("gravity-trials", "Gravity-Trials").replace(
                "gravity_trials", "Gravity_Trials"
            ),
        ),
        "datapackage.json",
        "gravity_trials.csv, in lower case",
    ),
    "a boolean in capitals": (
        as_text("datapackage.json", lambda text: text.replace("{", '{"rotary": TRUE,', 1)),
        "datapackage.json",
        "true, false and null are written in small letters",
    ),
    "a boolean in quotation marks": (
        rig(rotary="TRUE"),
        "datapackage.json",
        "true or false, in small letters without quotation marks",
    ),
    "a boolean in place of a number": (
        put(STEADY, "friction_n", "TRUE"),
        STEADY,
        "a finite number in N (a spreadsheet's TRUE or FALSE is no number)",
    ),
    "an empty file": (bytes_of(TRIALS, b""), TRIALS, "a header in line 1"),
    "a header alone": (
        as_text(RUNS, lambda text: text.splitlines()[0]),
        RUNS,
        "at least one row below the header",
    ),
    "no header": (as_text(RUNS, lambda text: text.split("\n", 1)[1]), RUNS, "(is there none?)"),
    "a header in capitals": (
        as_text(RUNS, lambda text: text.upper()),
        RUNS,
        "column names in lower case",
    ),
    "a comment first": (as_text(TRIALS, lambda text: f"# mine\n{text}"), TRIALS, "not a comment"),
    "a spreadsheet's separator": (
        as_text(TRIALS, lambda text: f"sep=,\n{text}"),
        TRIALS,
        "a spreadsheet's note of its separator",
    ),
    "a comma after each row": (
        as_text(RUNS, lambda text: text.replace("\nm", ",\nm").replace(",\n", "\n", 1) + ","),
        RUNS,
        "a comma too much at the end",
    ),
    "two files joined": (
        as_text(RUNS, lambda text: text + text.replace("\nm", "\nn")),
        RUNS,
        "are two files joined",
    ),
    "typographic quotation marks": (
        put(RUNS, "pulley_size", "“small”"),
        RUNS,
        "these are typographic",
    ),
    "a comment between": (
        as_text(RUNS, lambda text: text.replace("\nm2", "\n# the second day\nm2")),
        RUNS,
        "is no comment here",
    ),
    "a column without its unit": (
        renamed(TRIALS, "mass_load_kg", "mass_load"),
        TRIALS,
        "is 'mass_load' meant",
    ),
    "a cell with its unit": (put(TRIALS, "mass_drive_kg", "1.6 kg"), TRIALS, "above 0 in kg"),
    "a dash for a minus": (put(RUNS, "velocity_m_s", "−0.5"), RUNS, "a hyphen as the minus sign"),
    "a spreadsheet's date": (put(STEADY, "friction_n", "01. Feb"), STEADY, "made a date of it?"),
    "a date in figures": (put(STEADY, "friction_n", "2026-02-01"), STEADY, "made a date of it?"),
    "a negative tension": (put(STEADY, "tension_n", "-15"), STEADY, "at least 0 in N"),
    "a run twice": (put(RUNS, "run", "m2"), RUNS, "a value that no other row has"),
    "times that go back": (put(EVENTS, "time_s", "0.2"), EVENTS, "more than the time_s before it"),
    "pulleys and angles swapped": (
        as_text(
            TRIALS,
            lambda text: text.replace("n_pulleys,wrap_angle_deg", "wrap_angle_deg,n_pulleys"),
        ),
        TRIALS,
        "are n_pulleys and wrap_angle_deg swapped?",
    ),
    "masses swapped": (
        as_text(
            TRIALS,
            lambda text: text.replace("mass_drive_kg,mass_load_kg", "mass_load_kg,mass_drive_kg"),
        ),
        TRIALS,
        "are the columns swapped?",
    ),
    "a comma too much in JSON": (
        bytes_of("datapackage.json", b'{"name": "a",}'),
        "datapackage.json",
        "JSON",
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_one_line_that_names_it(tmp_path: Path, mistake: str) -> None:
    spoil, file, said = MISTAKES[mistake]
    folder = write_files(tmp_path, spoil(Mini().kind(file)))
    with pytest.raises(InputError) as caught:
        read_recording(folder)
    kinds = [fault for fault in caught.value.faults if fault.file == file]
    lines = [str(fault) for fault in kinds if said in fault.expected]
    assert lines, [str(fault) for fault in caught.value.faults]
    assert "\n" not in lines[0]
    if mistake != "quoted decimal commas":  # there two columns are at fault
        assert len(kinds) == 1


@pytest.mark.parametrize("name", ["gravity_trials.csv", "datapackage.json", "data.xlsx"])
def test_a_file_instead_of_its_folder_is_named(tmp_path: Path, name: str) -> None:
    Mini().write(tmp_path)
    (tmp_path / "data.xlsx").write_bytes(b"PK")
    with pytest.raises(InputError, match="is its folder meant") as caught:
        read_recording(tmp_path / name)
    assert len(caught.value.faults) == 1


@pytest.mark.parametrize(("spacing", "refused"), [(1.0, False), (2.0, True)])
def test_weights_that_gain_energy_are_a_fault(
    small_recording: Recording, tmp_path: Path, spacing: float, refused: bool
) -> None:
    """Every second magnet was forgotten: travel, and acceleration, are twice what they were."""
    write_recording(small_recording, tmp_path / "board")
    package = json.loads((tmp_path / "board/datapackage.json").read_text())
    package["rig"]["hall_spacing_m"] *= spacing
    (tmp_path / "board/datapackage.json").write_text(json.dumps(package))
    events = pd.read_csv(tmp_path / "board" / EVENTS)
    events["displacement_m"] = (events["displacement_m"] * spacing).round(6)
    events.to_csv(tmp_path / "board" / EVENTS, index=False)
    if not refused:
        read_recording(tmp_path / "board")
        return
    with pytest.raises(InputError, match="without any friction") as caught:
        read_recording(tmp_path / "board")
    assert len(caught.value.faults) == 1


def test_what_is_wrong_throughout_is_told_in_few_lines(tmp_path: Path) -> None:
    """5,000 rows with one mistake: the first are told, the rest counted."""
    mini = Mini().keep(STEADY).drop(STEADY, "order", "setup", "role")
    header, row, _ = mini.rows[STEADY]
    mini.rows[STEADY] = [header, *([f"r{k}", *row[1:]] for k in range(5000))]
    for line in range(2, 5002):
        mini.set(STEADY, line, "friction_n", "high")
    with pytest.raises(InputError) as caught:
        read_recording(mini.write(tmp_path))
    assert len(caught.value.faults) == 20
    assert str(caught.value.faults[-1]).endswith("; and 4,980 like it")
    assert caught.value.faults[-1].row == 21


def test_sixty_thousand_keys_and_columns_are_told_in_few_lines(tmp_path: Path) -> None:
    mini = Mini().keep(STEADY)
    files = mini.contents()
    keys = ",".join(f'"k{i}":1' for i in range(60_000)).encode()
    write_files(tmp_path / "keys", files | {"datapackage.json": b"{%b,%b}" % (keys, keys)})
    with pytest.raises(InputError) as caught:
        read_recording(tmp_path / "keys")
    repeated = [fault for fault in caught.value.faults if "once only" in fault.expected]
    assert len(repeated) == 20
    assert repeated[-1].like == 59_980
    names = ",".join(f"c{i}" for i in range(60_000)).encode()
    write_files(tmp_path / "columns", files | {STEADY: names + b"\n" + names + b"\n"})
    with pytest.raises(InputError, match="at most 1,000 columns"):
        read_recording(tmp_path / "columns")


def test_individual_angles_that_are_all_wrong_are_told_in_few_lines(tmp_path: Path) -> None:
    mini = Mini().keep(TRIALS)
    mini.drop(TRIALS, "order", "setup", "wrap_angles_deg").add(
        TRIALS, "wrap_angles_deg", ["85", "85", "85"]
    )
    header, *_, row = mini.rows[TRIALS]
    mini.rows[TRIALS] = [header, *([f"g{k}", *row[1:]] for k in range(100))]
    with pytest.raises(InputError) as caught:
        read_recording(mini.write(tmp_path))
    assert len(caught.value.faults) == 20
    assert caught.value.faults[-1].like == 80
