"""One slip is one line that names its cause, and a long cell holds nobody up."""

import time
from collections.abc import Callable
from pathlib import Path

import pytest
from recording.mini import Mini, write_files

from bayesfric.errors import Fault, InputError
from bayesfric.recording import read_recording
from bayesfric.recording.numbers import cause_of, is_decimal, to_numbers_apart

TRIALS, EVENTS = "gravity_trials.csv", "gravity_events.csv"
STEADY, SAMPLES = "steady_friction.csv", "axis_samples.csv"


def faults_after(tmp_path: Path, file: str, edit: Callable[[str], str]) -> tuple[Fault, ...]:
    files = Mini().kind(file).contents()
    folder = write_files(tmp_path, files | {file: edit(files[file].decode()).encode()})
    with pytest.raises(InputError) as caught:
        read_recording(folder)
    return caught.value.faults


def with_line(line: str, place: int = 1) -> Callable[[str], str]:
    def edit(text: str) -> str:
        lines = text.splitlines()
        return "\n".join([*lines[:place], line, *lines[place:], ""])

    return edit


def stamped(text: str) -> str:
    head, *rows = text.splitlines()
    cells = [row.split(",") for row in rows]
    place = head.split(",").index("time_s")
    for row in cells:
        row[place] = f"2026-01-01T10:00:0{float(row[place]):.3f}Z"
    return "\n".join([head, *map(",".join, cells), ""])


def decimal_commas(quote: str) -> Callable[[str], str]:
    """Write a log of five columns, some of whose numbers are whole, with decimal commas."""

    def edit(text: str) -> str:
        rows = ["run,time_s,position_m,force_n,sim_force_n"]
        for run in ("r1", "r2"):
            for i in range(50):
                cells = [run, *(f"{i * step:g}" for step in (0.1, 0.01, 0.25, 0.5))]
                written = [c.replace(".", ",") for c in cells]
                rows.append(",".join(f"{quote}{c}{quote}" if "," in c else c for c in written))
        return "\n".join([*rows, ""])

    return edit


SLIPS = {
    "a comment": (TRIALS, with_line("# note"), "no comment here"),
    "a comment in a spreadsheet": (TRIALS, with_line("# note" + 13 * ","), "no comment here"),
    "a comment with a comma": (TRIALS, with_line("# note, more"), "no comment here"),
    "a comment among events": (EVENTS, with_line("# note", 4), "no comment here"),
    "a missing cell": (TRIALS, lambda t: t.replace("medium,9,85,1.60", "medium,85,1.60"), "cells"),
    "a missing sensor": (EVENTS, lambda t: t.replace("g1,drive,0.0098", "g1,0.0098"), "4 cells"),
    "a wrong sensor": (EVENTS, lambda t: t.replace("g1,drive,0.0098", "g1,middle,0.0098"), "load"),
    "a first sensor": (EVENTS, lambda t: t.replace("g1,drive", "g1,left", 1), "drive or load"),
    "a mistyped trial": (
        EVENTS,
        lambda t: t.replace("g1,drive", "g9,drive", 1),
        "a trial of gravity_tr",
    ),
    "thousands": (STEADY, lambda t: t.replace("15.5", '"1,015.5"'), "separator of thousands"),
    "thousands by a blank": (SAMPLES, lambda t: t.replace("0.02,", "1 000.02,"), "of thousands"),
    "thousands by a thin blank": (STEADY, lambda t: t.replace("15.5", "1\u2009015.5"), "thousands"),
    "thousands, unquoted": (STEADY, lambda t: t.replace("15.5", "1,015.5"), "decimal mark is a po"),
    "stamps of ISO 8601": (SAMPLES, stamped, "time of day, or a date"),
    "decimal commas in five columns": (SAMPLES, decimal_commas(""), "the decimal mark is a point"),
    "the same, quoted": (SAMPLES, decimal_commas('"'), "a point as the decimal mark"),
    "a unit behind a number": (STEADY, lambda t: t.replace("15.5", "15.5 N"), "without its unit"),
    "a mark of direction": (TRIALS, lambda t: t.replace("g3", "g\u202e3"), "U+202E cannot be"),
    "a second byte order mark": (TRIALS, lambda t: 2 * "\ufeff" + t, "U+FEFF cannot be"),
    "no width": (STEADY, lambda t: t.replace("medium", "med\u200bium"), "U+200B cannot be"),
    "a long name": (STEADY, lambda t: t.replace("medium", 240 * "m"), "100 characters"),
    "a long column": (STEADY, lambda t: t.replace("role", 240 * "m"), "not 240"),
    "other digits in angles": (
        TRIALS,
        lambda t: t.replace("110,0.90,0.60,,,false,", "110,0.90,0.60,,,false,1_10 110 110 110 110"),
        "numbers from 0 to 180",
    ),
    "Arabic digits in angles": (
        TRIALS,
        lambda t: t.replace("110,0.90,0.60,,,false,", "110,0.90,0.60,,,false,١١٠ 110 110 110 110"),
        "numbers from 0 to 180",
    ),
}


@pytest.mark.parametrize("slip", SLIPS)
def test_a_slip_is_one_line_that_names_it(tmp_path: Path, slip: str) -> None:
    file, edit, said = SLIPS[slip]
    faults = faults_after(tmp_path, file, edit)
    assert [fault.file for fault in faults] == [file], [str(fault) for fault in faults]
    assert said in faults[0].expected


def test_a_spacing_that_no_event_has_is_one_line(tmp_path: Path) -> None:
    mini = Mini()
    mini.package["rig"]["hall_spacing_m"] = 0.0099
    with pytest.raises(InputError, match="is that the spacing of these events") as caught:
        read_recording(mini.write(tmp_path))
    assert len(caught.value.faults) == 1
    assert caught.value.faults[0].like == 11


def test_a_unit_of_the_spacing_is_told_once(tmp_path: Path) -> None:
    """Displacements in the same wrong unit are no second fault."""
    mini = Mini()
    mini.package["rig"]["hall_spacing_m"] = 9.8
    for line, row in enumerate(mini.rows[EVENTS][1:], start=2):
        mini.set(EVENTS, line, "displacement_m", f"{1000 * float(row[2]):g}")
    with pytest.raises(InputError, match="millimetres") as caught:
        read_recording(mini.write(tmp_path))
    assert len(caught.value.faults) == 1


def test_two_causes_are_two_lines(tmp_path: Path) -> None:
    edit = lambda t: t.replace("15.5", '"15,5"').replace("20.5", "20.5 N")  # noqa: E731
    assert len(faults_after(tmp_path, STEADY, edit)) == 2


@pytest.mark.parametrize(
    "cell",
    [
        40_000 * "9" + "x",
        40_000 * ",",
        20_000 * "1,",
        10_000 * "jan ",
        40_000 * "1" + "e" + 9 * "1",
    ],
)
def test_a_long_cell_is_read_in_no_time(tmp_path: Path, cell: str) -> None:
    """A pattern that may split digits in many ways took 20 s for the first of them."""
    start = time.process_time()
    is_decimal(cell)
    cause_of(cell)
    faults = faults_after(tmp_path, SAMPLES, lambda t: t.replace("1.2,", f'"{cell}",', 1))
    assert len(faults) == 1
    assert time.process_time() - start < 2.0


def test_numbers_apart_obey_the_rule_of_all_numbers() -> None:
    assert to_numbers_apart("85 8.5e1").tolist() == [85.0, 85.0]
    for cell in ("8_5", "٨٥", "inf", "0x55", "85,0"):
        assert to_numbers_apart(cell).tolist() != to_numbers_apart(cell).tolist()  # NaN
