"""Logs of commands alone: friction over the servo's stiffness, or in newtons where that is told."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pyarrow
import pyarrow.parquet
import pytest
from rigs.servos import Servo
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.export.entered import entered_remarks
from bayesfric.recording import RigConstants
from bayesfric.results import read_json
from bayesfric.rigs import all_rigs
from bayesfric.rigs.rotary import is_relative, over_stiffness, turns
from bayesfric.rigs.single_axis.run_rows import rows_of_run
from bayesfric.rigs.single_axis.servo import with_open_delay
from bayesfric.rigs.single_axis.simulated import log_of
from bayesfric.rigs.single_axis.weak_form import test_function as window_function
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.diagnosis import Enter

AXIS = all_rigs()["single-axis"]
SERVO = Servo(seconds=15.0, uneven=0.0)


def opened(servo=SERVO, seed=1, payloads=(0.0, 0.0), **rig):
    return AXIS.trials(servo.recording(seed, payloads, **rig))


@pytest.mark.usefixtures("lengths_not_searched")
def test_without_anything_in_newtons_all_is_over_the_stiffness():
    runs = opened(moving_mass_kg=None)
    assert runs.servo.is_relative
    assert runs.unit == "N·m per K"
    rough = runs._rough
    assert rough.coulomb == pytest.approx(SERVO.coulomb / SERVO.stiffness, rel=0.01)
    assert rough.viscous == pytest.approx(SERVO.damping / SERVO.stiffness, rel=0.15)
    assert rough.mass == pytest.approx(SERVO.inertia / SERVO.stiffness, rel=0.1)
    assert runs.servo.constants.latency_s == pytest.approx(SERVO.late_s, abs=5e-3)
    said = " ".join(runs.doubts({}))
    assert "1 N·m per K is 1 rad of distance between the joint and its command" in said
    assert "damping and back-EMF of its servo together" in said
    assert runs.scale_share == 0.0


TELLS = {
    "a payload on rig.payload_arm_m": {"payload_arm_m": SERVO.arm},
    "rig.moving_mass_kg": {"moving_mass_kg": SERVO.inertia, "mass_sd_kg": 0.01 * SERVO.inertia},
    "rig.command_gain": {"command_gain": SERVO.stiffness},
}


@pytest.mark.usefixtures("lengths_not_searched")
@pytest.mark.parametrize("known_by", TELLS)
def test_what_is_known_in_newtons_tells_the_stiffness(known_by):
    payloads = (0.0, 0.3) if "payload" in known_by else (0.0, 0.0)
    runs = opened(payloads=payloads, **TELLS[known_by])
    assert runs.servo.known_by == known_by
    assert runs.unit == "N·m"
    assert abs(runs.servo.stiffness - SERVO.stiffness) < 3 * runs.servo.stiffness_sd + 1e-9
    assert runs.servo.stiffness_sd < 0.11 * SERVO.stiffness
    share = runs.scale_share
    assert runs._rough.coulomb == pytest.approx(SERVO.coulomb, rel=max(0.02, 3 * share))
    assert f", from {known_by}" in " ".join(runs.doubts({}))


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_known_force_tells_the_stiffness():
    servo = Servo(gravity=1.5, seconds=15.0, uneven=0.0)
    recording = servo.recording()
    samples = recording.axis.samples
    samples["known_force_n"] = servo.gravity * np.sin(samples["position_m"] - servo.hangs)
    runs = AXIS.trials(recording)
    assert runs.servo.known_by == "known_force_n"
    assert runs.servo.stiffness == pytest.approx(servo.stiffness, rel=0.02)
    # A known force that has nothing to do with the joint tells none.
    samples["known_force_n"] = np.random.default_rng(1).standard_normal(len(samples))
    assert AXIS.trials(recording).servo.is_relative


@pytest.mark.usefixtures("lengths_not_searched")
def test_inertia_of_a_log_that_is_too_slow_is_refused_by_name():
    quick = Servo(seconds=20.0, rate_hz=30.0, band_hz=1.4)
    runs = opened(quick)
    assert runs.servo.samples_a_period < 30
    assert set(runs.untold) == {"mass"}
    assert "samples, and 30 are needed" in runs.untold["mass"]
    assert runs._rough.coulomb == pytest.approx(quick.coulomb / quick.stiffness, rel=0.1)
    assert not opened().untold


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_declared_delay_is_held():
    taken = opened(latency_s=0.015).servo
    assert taken.late_sd_s < 0.01
    assert taken.constants.latency_s == pytest.approx(0.015, abs=0.005)


@pytest.mark.usefixtures("lengths_not_searched")
def test_the_delay_is_as_open_as_the_pilot_fit_left_it():
    """A servo at 30 Hz whose delay was 16 ms off had an inertia of a third, by 2.7 sd."""
    runs = opened()
    rows, servo = runs.readings, runs.servo
    assert 0 < servo.late_error_s < 0.01
    least = with_open_delay(rows, servo._replace(late_error_s=0.0)).beside[:, -1]
    wide = with_open_delay(rows, servo._replace(late_error_s=0.004)).beside[:, -1]
    np.testing.assert_allclose(wide, 4.0 * least)


@pytest.mark.usefixtures("lengths_not_searched")
def test_an_error_of_the_position_is_one_of_the_force_too():
    """Rows hang together as answers to an error of each sample do, one after another."""
    runs = opened()
    rows, mass, damping = runs.readings, 0.0017, 0.033
    log = log_of(runs.source.samples[runs.source.samples["run"] == "r0"], runs.servo.constants)
    half = round(rows.half_s / log.interval_s)
    test, step = window_function(half, log.interval_s), max(1, round(rows.hop * half))
    stroke = float(np.ptp(log.position))

    def left(error):
        """Return what rows with an error of the positions leave of law and force."""
        off = replace(log, position=log.position + error, force=log.force - error)
        windows = rows_of_run(off, test, step, rows.position_sd, stroke)
        speed = windows["way"] * test.over(-off.position, test.slope, windows["centre"].astype(int))
        inertial = mass * windows["acceleration"]
        return windows["centre"], windows["force"] - inertial - damping * speed

    tiny = 1e-9
    centre, exact = left(0.0)
    first = int(np.flatnonzero(np.diff(centre) == step)[0])
    answers = [
        (left(tiny * (np.arange(log.position.size) == sample))[1] - exact)[first : first + 2] / tiny
        for sample in range(int(centre[first]) - half, int(centre[first]) + step + half + 1)
    ]
    expected = np.transpose(answers) @ answers
    assert rows.lag_of_positions(mass, damping)[0, :2] == pytest.approx(expected[0], rel=1e-4)
    assert expected[0, 1] > 0  # by the mass alone neighbours err against each other
    assert rows.position_lag[0, 1] < 0


@pytest.mark.usefixtures("lengths_not_searched")
def test_no_window_has_a_stop_in_it_that_a_held_command_makes():
    """A joint that goes on the same way stands for five samples, whose friction is anything."""
    count = 2 * np.pi / 4096
    moved = np.full(120, 8.0)
    moved[60:65] = 0.0
    position = count * np.cumsum(moved)
    times = np.arange(120) / 30
    samples = pd.DataFrame({"time_s": times, "position_m": position, "command_m": position + 0.1})
    constants = RigConstants(rotary=True, encoder_resolution=count)
    log, test = log_of(samples, constants), window_function(4, 1 / 30)
    noise = count / 12**0.5
    rows = rows_of_run(log, test, 1, noise, 1.0)
    reached = {int(centre) for centre in rows["centre"]}
    assert not reached & set(range(59, 66))
    assert {50, 75} < reached
    # Nor has a log of forces: windows of four samples on either side reach it from 56 to 68.
    of_forces = set(map(int, rows_of_run(replace(log, sent=None), test, 1, noise, 1.0)["centre"]))
    assert not of_forces & set(range(56, 69))
    assert {54, 69} < of_forces


@pytest.mark.usefixtures("lengths_not_searched")
def test_units_over_the_stiffness():
    assert over_stiffness("N·m s/rad") == "N·m s/rad per K"
    assert over_stiffness("kg·m²") == "kg·m² per K"
    assert over_stiffness("s/rad") == "s/rad"
    assert is_relative("N per K")
    assert not is_relative("N·m")
    assert [turns(unit) for unit in ("N·m per K", "N·m", "N per K")] == [True, True, False]


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_reader_is_told_to_multiply():
    value = Interval(mean=0.0213, sd=0.0004, q05=0.0206, q50=0.0213, q95=0.022)
    number = Enter(parameter="coulomb", unit="N·m per K", value=value, fields={"mujoco": None})
    (remark,) = entered_remarks([number])
    assert "Coulomb friction is 0.02130 rad of position error" in remark
    assert "Multiply each by K [N·m/rad]" in remark


def parquet(path, servos):
    """Write an episode as LeRobot does: degrees, in lists of all joints."""
    runs = [servo.run(place + 1) for place, servo in enumerate(servos)]
    actions = np.rad2deg([commands for _, commands, _ in runs]).astype(np.float32).T
    read = np.rad2deg([places for _, _, places in runs]).astype(np.float32).T
    columns = {
        "action": pyarrow.array(actions.tolist()),
        "observation.state": pyarrow.array(read.tolist()),
        "timestamp": runs[0][0].astype(np.float32),
        "episode_index": np.zeros(len(actions), dtype=np.int64),
    }
    pyarrow.parquet.write_table(pyarrow.table(columns), path)


@pytest.mark.nightly
def test_from_a_parquet_of_commands_to_the_report(tmp_path):
    """Without a scale every number is over K, and no simulator's model is written."""
    arm = Servo(gravity=1.0, rate_hz=30.0)
    parquet(tmp_path / "episode.parquet", [arm, Servo(stiffness=12.0, rate_hz=30.0)])

    def verb(*arguments, status=0):
        done = CliRunner().invoke(app, [*map(str, arguments)])
        assert done.exit_code == status, done.output
        return done.output

    made, out = tmp_path / "made", tmp_path / "out"
    verb("import", tmp_path / "episode.parquet", "-o", made)
    mapping = tmp_path / "episode.parquet.mapping.toml"
    assert 'column = "action[{joint}]"' in mapping.read_text()
    verb("import", tmp_path / "episode.parquet", "-o", made, "--map", mapping, "--joint", "0")
    assert "1 N·m per K is 1 rad" in verb("check", made)
    verb("run", made, "-o", out, "--quiet")
    diagnosis = read_json(DiagnosisFile, out / "diagnosis.json")
    truths = {"coulomb": arm.coulomb, "viscous": arm.damping, "inertia": arm.inertia}
    for name, truth in truths.items():
        number = diagnosis.law[name]
        assert number.unit.endswith(" per K")
        assert number.after.q05 < truth / arm.stiffness < number.after.q95, name
    (gravity,) = diagnosis.causes
    assert gravity.parameters["torque"].mean == pytest.approx(arm.gravity / arm.stiffness, rel=0.02)
    assert all(field is None for number in diagnosis.enter for field in number.fields.values())
    summary = (out / "summary.md").read_text()
    assert "rad of position error" in summary
    assert (out / "report.pdf").is_file()
    assert "over the stiffness K of a servo" in verb("export", out, "--to", "mjcf", status=2)
    verb("export", out, "--to", "json")
    refused = verb("diagnose", made, "-o", tmp_path / "again", "--replay", status=2)
    assert "rig.robot" in refused


@pytest.mark.nightly
def test_a_payload_makes_numbers_that_are_exported(tmp_path):
    from bayesfric.diagnosis import diagnose

    recording = SERVO.recording(3, (0.0, 0.3, 0.0, 0.3), payload_arm_m=SERVO.arm)
    summary = diagnose(recording).summary
    coulomb = summary.law["coulomb"]
    assert coulomb.unit == "N·m"
    # One seed: three errors. How often 90 % intervals hold is for the campaign `servos` to say.
    assert coulomb.after.mean == pytest.approx(SERVO.coulomb, abs=3 * coulomb.after.sd)
    fields = {number.parameter: number.fields["mujoco"] for number in summary.enter}
    assert fields["coulomb"].field == "joint/@frictionloss"
