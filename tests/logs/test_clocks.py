"""Clocks of logs: what they show is known, and so is what has to be said of them."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.errors import InputError
from bayesfric.logs import import_log
from bayesfric.recording import read_recording, write_recording

ROWS = 400
STEP_S = 0.005
TIME = STEP_S * np.arange(ROWS)
PERIODS = {"micros of 32 bits": (2**32, "us", 1e-6), "millis of 16 bits": (2**16, "ms", 1e-3)}


def imported(folder, stamps, unit="s", rows=None, more="", **columns):
    """A log of a swinging joint whose clock shows these stamps, imported."""
    table = pd.DataFrame({"t": stamps, "q": np.sin(TIME), "tau": np.cos(TIME)} | columns)
    table = table if rows is None else table.iloc[rows]
    table.to_csv(folder / "log.csv", index=False)
    mapping = (
        f'[time]\ncolumn = "t"\nunit = "{unit}"\n[position]\ncolumn = "q"\nunit = "rad"\n'
        f'[force]\ncolumn = "tau"\nunit = "N·m"\nforce_is = "motor"\n{more}'
    )
    (folder / "map.toml").write_text(mapping, encoding="utf-8")
    return import_log(folder / "log.csv", "j", mapping=folder / "map.toml")


def times(log):
    return log.recording.axis.samples["time_s"].to_numpy()


@pytest.mark.parametrize(("period", "unit", "second"), PERIODS.values(), ids=PERIODS)
def test_a_counter_that_begins_again_is_unwrapped_and_said(tmp_path, period, unit, second):
    counts = np.round(TIME / second).astype(np.int64)
    log = imported(tmp_path, (counts + period - counts[150]) % period, unit)
    assert times(log) == pytest.approx(TIME, abs=1e-12)
    assert log.recording.axis.samples["position_m"].to_numpy() == pytest.approx(np.sin(TIME))
    assert any("begins again" in note and "once (first at row 152)" in note for note in log.notes)


def test_a_counter_may_begin_again_many_times(tmp_path):
    log = imported(tmp_path, np.round(1e6 * TIME).astype(np.int64) % 2**16, "us")
    assert times(log) == pytest.approx(TIME, abs=1e-12)
    assert any(f"{int(1e6 * TIME[-1]) // 2**16} times" in note for note in log.notes)


def test_rows_out_of_order_about_the_place_where_a_counter_begins_again(tmp_path):
    counts = (np.round(1e6 * TIME).astype(np.int64) + 2**32 - 750_000) % 2**32
    order = np.arange(ROWS)
    order[[149, 150, 151]] = [150, 149, 151]
    log = imported(tmp_path, counts, "us", rows=order)
    assert times(log) == pytest.approx(TIME, abs=1e-12)
    assert any("1 row out of order (first: row 152) sorted" in note for note in log.notes)


def test_what_is_sorted_left_out_and_not_there_is_said_with_counts(tmp_path):
    order = [*range(10), 11, 10, 12, *range(12, 100), *range(300, ROWS)]
    log = imported(tmp_path, TIME, rows=order)
    said = " ".join(log.notes)
    assert "1 row out of order (first: row 13) sorted" in said
    assert "1 row with the time of an earlier row (first: row 15) left out" in said
    assert "more than 3 intervals at 1 place, the longest 1.005 s, 0.495 s after the first" in said
    assert np.all(np.diff(times(log)) > 0)


def test_the_notes_go_with_the_recording_and_validate_says_them(tmp_path):
    log = imported(tmp_path, TIME, rows=[*range(100), *range(300, ROWS)])
    write_recording(log.recording, tmp_path / "made")
    assert any("at 1 place" in note for note in read_recording(tmp_path / "made").notes)
    again = read_recording(tmp_path / "made")
    write_recording(again, tmp_path / "again")
    assert read_recording(tmp_path / "again").notes == again.notes
    said = CliRunner().invoke(app, ["validate", str(tmp_path / "again")])
    assert "at 1 place, the longest 1.005 s" in said.output


def test_a_force_that_stops_for_a_while_is_not_bridged(tmp_path):
    late = TIME.copy()
    late[200:] += 1.0  # the force's clock: nothing from 0.995 s to 2 s
    log = imported(
        tmp_path, 2 * TIME, t2=late, more='time = "t2"\n'
    )  # positions every 10 ms, 4 s; forces to 3 s
    seen = times(log)
    assert not ((seen > 0.996) & (seen < 1.999)).any()
    assert any("100 samples in which no force was logged left out" in note for note in log.notes)


KNOWN = 'time = "t"\n[known_force]\ncolumn = "model"\nunit = "N·m"\ntime = "t2"\n'


def test_a_known_force_is_neither_bridged_nor_held_beyond_what_was_logged(tmp_path):
    """Positions and forces every 5 ms; the model speaks from 0.3 s, and not from 0.8 to 1.2 s."""
    spoken = TIME + 0.3
    spoken[100:] += 0.4
    made = imported(tmp_path, TIME, t2=spoken, model=3 * spoken, more=KNOWN)
    seen = times(made) - TIME[0]
    expected = TIME[(TIME >= 0.2999) & ((TIME < 0.796) | (TIME > 1.199))]
    assert seen == pytest.approx(expected, abs=1e-9)
    model = made.recording.axis.samples["known_force_n"].to_numpy()
    assert model == pytest.approx(3 * expected, abs=1e-8)
    assert any(
        "80 samples in which no known force was logged left out" in note for note in made.notes
    )


def test_a_known_force_of_another_time_is_refused(tmp_path):
    with pytest.raises(InputError, match="position and force and known force that are logged at"):
        imported(tmp_path, TIME, t2=TIME + 5, model=TIME, more=KNOWN)


def test_a_temperature_is_said_to_be_held_beyond_its_samples(tmp_path):
    warm = KNOWN.replace("known_force", "temperature").replace("N·m", "degC")
    made = imported(tmp_path, TIME, t2=TIME / 2 + 0.4, model=20 + TIME, more=warm)
    held = made.recording.axis.samples["temperature_c"]
    assert held.iloc[0] == 20
    assert held.iloc[-1] == pytest.approx(20 + TIME[-1])
    assert any(
        "before its first and after its last, for up to 0.5975 s" in note for note in made.notes
    )


def test_a_clock_that_starts_anew_is_refused_with_its_row(tmp_path):
    stamps = TIME + 3.0
    stamps[250:] -= TIME[250] + 3.0
    with pytest.raises(InputError, match="row 252, t: expected a clock that runs on"):
        imported(tmp_path, stamps)


@pytest.mark.parametrize("restart_s", [2**32 * 1e-9, 2**16 * 1e-3])
def test_a_log_in_seconds_that_starts_anew_is_no_counter(tmp_path, restart_s):
    """It begins again at 0 where a counter of 32 bits of ns, or of 16 of ms, would."""
    stamps = TIME + 0.0004
    stamps[:250] += restart_s - stamps[249] - STEP_S / 2
    stamps[250:] -= TIME[250]
    with pytest.raises(InputError, match="row 252, t: expected a clock that runs on"):
        imported(tmp_path, stamps.round(6))


EPOCH = datetime(2026, 11, 1, 23, 59, 59, tzinfo=UTC)
STAMPS = [EPOCH + timedelta(microseconds=round(1e6 * stamp)) for stamp in TIME]
NANOSECONDS = [round(EPOCH.timestamp()) * 10**9 + 5_000_000 * row + row % 7 for row in range(ROWS)]


@pytest.mark.parametrize(
    ("stamps", "unit"),
    [
        ([f"{stamp:%H:%M:%S.%f}" for stamp in STAMPS], "s"),
        ([f"{stamp:%Y-%m-%dT%H:%M:%S.%f}Z" for stamp in STAMPS], "ms"),
        ([f"{stamp:%Y-%m-%d %H:%M:%S.%f}+0000" for stamp in STAMPS], "s"),
        ([f"{stamp.timestamp():.6f}" for stamp in STAMPS], "s"),
        ([f"{1e3 * stamp.timestamp():.3f}" for stamp in STAMPS], "ms"),
        ([round(1e6 * stamp.timestamp()) for stamp in STAMPS], "us"),
    ],
    ids=["of day", "ISO", "ISO with zone", "epoch s", "epoch ms", "epoch us"],
)
def test_stamps_of_every_form_are_read_over_midnight(tmp_path, stamps, unit):
    assert times(imported(tmp_path, stamps, unit)) == pytest.approx(TIME, abs=1e-9)


def test_nanoseconds_since_1970_lose_nothing(tmp_path):
    since = np.array([(stamp - NANOSECONDS[0]) * 1e-9 for stamp in NANOSECONDS])
    assert times(imported(tmp_path, NANOSECONDS, "ns")) == pytest.approx(since, abs=2e-10)


@pytest.mark.parametrize(
    ("stamps", "unit", "said"),
    [
        (NANOSECONDS, "s", "is ns since 1970 meant?"),
        ([round(stamp / 1e6) for stamp in NANOSECONDS], "ns", "is ms since 1970 meant?"),
        (["14:46:55.1", "14:61:55.2", "14:46:55.3"] + ROWS * ["14:46:56"], "s", "row 3, t"),
        (["5", "noon"] + ROWS * ["6"], "s", "row 3, t: found 'noon', expected a number, a time of"),
    ],
    ids=["ns as s", "ms as ns", "no minute", "no time"],
)
def test_a_clock_that_cannot_be_is_refused(tmp_path, stamps, unit, said):
    with pytest.raises(InputError) as caught:
        imported(tmp_path, stamps[:ROWS], unit)
    assert said in str(caught.value)
