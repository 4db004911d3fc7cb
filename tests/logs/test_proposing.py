"""A log without a mapping: what is proposed, why, and that it imports once a user has said."""

import re
import tomllib

import numpy as np
import pytest
from logs.written import ENDS, RATE_HZ, motion, write
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.errors import InputError
from bayesfric.logs import import_log, propose_mapping
from bayesfric.logs.looking import believed, csv_form, name_of_joint
from bayesfric.logs.table import Log
from bayesfric.recording import read_recording

SAID = {
    "force_is": '"motor"',
    "unit": '"N·m"',
    "rate_hz": f"{RATE_HZ}",
}


def edited(toml, **said):
    """A proposal in which a user has said what was asked."""
    for key, value in (SAID | said).items():
        toml = re.sub(rf'^{key} = "SAY"', f"{key} = {value}", toml, flags=re.MULTILINE)
    return toml


@pytest.mark.parametrize("end", ENDS[1:])
def test_a_proposal_imports_once_the_force_is_said(tmp_path, end):
    time, position, torque = motion()
    log = write(tmp_path, end)
    proposal = propose_mapping(log)
    (tmp_path / "map.toml").write_text(proposal.toml, encoding="utf-8")
    joint = "elbow" if "elbow" in proposal.toml else "1"
    with pytest.raises(InputError, match="SAY"):  # nothing is guessed in silence
        import_log(log, joint, mapping=tmp_path / "map.toml")
    (tmp_path / "map.toml").write_text(edited(proposal.toml), encoding="utf-8")
    samples = import_log(log, joint, mapping=tmp_path / "map.toml").recording.axis.samples
    assert np.array_equal(samples["time_s"], time.round(9))
    assert np.array_equal(samples["position_m"], position[:, 1].round(9))
    assert np.array_equal(samples["force_n"], torque[:, 1].round(9))


def proposed(folder, text, name="log.csv"):
    (folder / name).write_text(text, encoding="utf-8")
    return propose_mapping(folder / name)


def table(separator, *columns):
    rows = np.stack(columns, axis=1).tolist()
    return "".join(separator.join(map(repr, row)) + "\n" for row in rows)


TIME = np.arange(100) / 250
ANGLE = np.sin(8 * TIME)
SPEED = 8 * np.cos(8 * TIME)
CURRENT = np.cos(3 * TIME) + 0.1


def test_columns_without_names_say_what_they_are_of_each_other(tmp_path):
    proposal = proposed(tmp_path, table(",", CURRENT, SPEED, ANGLE))
    assert "header = false" in proposal.toml
    assert "[position]\n# as it changes from row to row, so is column 2" in proposal.toml
    assert re.search(r"\[position\]\n.*\ncolumn = 3\n", proposal.toml)
    assert re.search(r"\[velocity\]\n.*\ncolumn = 2\n", proposal.toml)
    assert re.search(r"\[force\]\n# it is the one that is left\ncolumn = 1\n", proposal.toml)
    assert re.search(r"there are (249|25[01])(\.\d)? rows a second", proposal.toml)
    assert 'rate_hz = "SAY"' in proposal.toml
    assert "which column is the clock" in proposal.open


@pytest.mark.parametrize(
    ("scale", "unit"), [(1.0, "rad/s"), (180 / np.pi, "deg/s"), (30 / np.pi, "rpm")]
)
def test_the_unit_of_a_velocity_is_that_in_which_the_position_changes(tmp_path, scale, unit):
    text = "time,pos_rad,vel,iq\n" + table(",", TIME, ANGLE, scale * SPEED, CURRENT)
    proposal = proposed(tmp_path, text)
    assert f'column = "vel"\nunit = "{unit}"' in proposal.toml
    assert 'unit = "A"\nfactor = "SAY"  # N·m for 1 A' in proposal.toml


@pytest.mark.parametrize(
    ("name", "first", "step", "unit"),
    [
        ("stamp", 1.78e9, 0.004, "s"),
        ("stamp", 1.78e12, 4, "ms"),
        ("t", 0, 4000, "us"),
        ("t_ms", 0, 4, "ms"),
        ("time", 0, 0.004, "s"),
        ("time", 0, 4_000_000, "ns"),
    ],
)
def test_the_unit_of_a_clock_is_said_with_the_reason(tmp_path, name, first, step, unit):
    clock = first + step * np.arange(100)
    proposal = proposed(tmp_path, f"{name},q,tau\n" + table(",", clock, ANGLE, CURRENT))
    assert f'column = "{name}"\nunit = "{unit}"' in proposal.toml
    line = next(line for line in proposal.toml.splitlines() if line.startswith("# 1. "))
    assert "since 1970" in line or "Hz" in line


FORMS = {
    "usual": ("a,b\n1,2\n3,4\n", {}),
    "no header": ("1,2\n3,4\n5,6\n", {"header": False}),
    "semicolons and commas": ("a;b\n1,5;2,5\n3,5;4,5\n", {"separator": ";", "decimal": ","}),
    "tabs": ("a\tb\n1\t2\n3\t4\n", {"separator": "tab"}),
    "blanks": ("a  b\n 1.0   2.0\n 3.0  4.0\n", {"separator": "space"}),
    "preamble": ("Logger\nserial: 7\na,b\n1,2\n3,4\n5,6\n", {"preamble": 2}),
    "units": ("a,b\ns,rad\n1,2\n3,4\n", {"unit_rows": 1}),
    "preamble and no header": ("# made by hand\n1 2\n3 4\n", {
        "separator": "space", "preamble": 1, "header": False,
    }),
}  # fmt: skip


@pytest.mark.parametrize(("text", "form"), FORMS.values(), ids=FORMS)
def test_how_a_csv_is_written_is_seen(text, form):
    seen, why = csv_form(text)
    assert seen.model_dump(exclude_defaults=True) == form
    assert why


@pytest.mark.parametrize("text", ["", "\n", "\n\n\n"])
def test_a_csv_with_nothing_in_it_is_refused(tmp_path, text):
    with pytest.raises(InputError, match=r"log\.csv"):
        proposed(tmp_path, text)


def test_nothing_is_imported_and_a_proposal_is_never_written_over(tmp_path):
    log, file = tmp_path / "log.csv", tmp_path / "log.csv.mapping.toml"
    log.write_text("t,q1,q2,tau1,tau2\n" + table(",", TIME, ANGLE, TIME, CURRENT, TIME), "utf-8")
    done = CliRunner().invoke(app, ["import", str(log), "-o", str(tmp_path / "made")])
    assert done.exit_code == 0
    assert not (tmp_path / "made").exists()
    assert "Nothing is imported" in done.stderr
    assert file.read_text(encoding="utf-8") == done.stdout
    assert "--joint all" in done.stderr
    file.write_text(edited(done.stdout), encoding="utf-8")
    again = CliRunner().invoke(app, ["import", str(log)])
    assert again.stdout == done.stdout
    assert "is left as it is" in again.stderr
    assert file.read_text(encoding="utf-8") == edited(done.stdout)
    call = ["import", str(log), "-o", str(tmp_path / "made"), "--joint", "all", "--map", str(file)]
    assert CliRunner().invoke(app, call).exit_code == 0
    samples = read_recording(tmp_path / "made").axis.samples
    assert set(samples["joint"]) == {"1", "2"}
    assert samples.loc[samples["joint"] == "1", "position_m"].to_numpy() == pytest.approx(
        ANGLE, abs=1e-9
    )


def test_a_unit_in_brackets_is_no_joint(tmp_path):
    log = tmp_path / "log.csv"
    names = "stamp;ang_1 [deg];ang_2 [deg];tq_1 [N·m];tq_2 [N·m];vbus [V]\n"
    log.write_text(names + table(";", TIME, ANGLE, TIME, CURRENT, TIME, TIME), "utf-8")
    proposal = propose_mapping(log)
    assert proposal.joints == ("1", "2")
    said = tomllib.loads(proposal.toml)
    assert said["position"]["column"] == "ang_{joint} [deg]"
    assert said["force"]["column"] == "tq_{joint} [N·m]"
    assert '# joints = {1 = "its name there", 2 = "its name there"}' in proposal.toml


def test_a_joint_may_have_a_name_of_several_words(tmp_path):
    log = tmp_path / "log.csv"
    names = "t,left_hip_deg,left_knee_deg,left_hip_Nm,left_knee_Nm,spare\n"
    log.write_text(names + table(",", TIME, ANGLE, TIME, CURRENT, TIME, TIME), "utf-8")
    proposal = propose_mapping(log)
    assert proposal.joints == ("left_hip", "left_knee")
    assert tomllib.loads(proposal.toml)["force"]["column"] == "{joint}_Nm"


def test_names_of_columns_cannot_leave_their_line(tmp_path):
    names = ['q"\u2028\x0c[csv]', "tau\\"]
    head = ",".join('"' + name.replace('"', '""') + '"' for name in names) + "\n"
    keys = tomllib.loads(proposed(tmp_path, head + table(",", ANGLE, TIME)).toml)
    assert keys["position"]["column"] == names[0]
    assert keys["force"]["column"] == names[1]
    assert "csv" not in keys


def test_a_recording_needs_its_place(tmp_path):
    (tmp_path / "map.toml").write_text("", encoding="utf-8")
    done = CliRunner().invoke(app, ["import", "log.csv", "--map", str(tmp_path / "map.toml")])
    assert done.exit_code == 2
    assert "-o: expected the folder of the recording" in done.stderr


WRITTEN_UNITS = [
    ("torque_mNm", "force", "mN·m"),
    ("torque_mnm_filtered", "force", "mN·m"),
    ("torque_N_m", "force", "N·m"),
    ("torque (N·mm)", "force", "N·mm"),
    ("torque_kNm", "force", "kN·m"),
    ("torque_Ncm", "force", "N·cm"),
    ("motorTorqueNm", "force", "N·m"),
    ("current_mA", "force", "mA"),
    ("Current [mA]", "force", "mA"),
    ("mA_current", "force", "mA"),
    ("current_a_1", "force", "A"),
    ("current", "force", "A"),
    ("voltage_mV", "force", "mV"),
    ("duty_cycle_%", "force", "%"),
    ("force_kN", "force", "kN"),
    ("pos_mrad", "position", "mrad"),
    ("position_cm", "position", "cm"),
    ("position_um", "position", "um"),
    ("position [\u00b5m]", "position", "um"),
    ("position [\u03bcm]", "position", "um"),
    ("enc_deg", "position", "deg"),
]
UNKNOWN_PREFIXES = [
    ("torque_uNm", "force"),
    ("torqueMotormNm", "force"),
    ("current_kA", "force"),
    ("current_uA_filtered", "force"),
    ("pos_urad", "position"),
    ("position_nm", "position"),
]


@pytest.mark.parametrize(
    ("name", "key", "unit"),
    [*WRITTEN_UNITS, *((*row, "SAY") for row in UNKNOWN_PREFIXES)],
    ids=lambda given: given,
)
def test_a_unit_is_proposed_with_its_prefix(tmp_path, name, key, unit):
    other = {"force": "q_rad", "position": "tau_nm"}[key]
    proposal = proposed(tmp_path, f"t,{name},{other}\n" + table(",", TIME, ANGLE, CURRENT))
    section = tomllib.loads(proposal.toml)[key]
    assert section["column"] == name
    assert section["unit"] == unit


@pytest.mark.parametrize(("size", "unit"), [(0.8, "share"), (80.0, "SAY")])
def test_a_duty_beyond_1_is_no_share(tmp_path, size, unit):
    duty = size * CURRENT / np.abs(CURRENT).max()
    proposal = proposed(tmp_path, "t,q_rad,pwm\n" + table(",", TIME, ANGLE, duty))
    assert tomllib.loads(proposal.toml)["force"]["unit"] == unit


def test_a_row_of_units_has_its_prefix(tmp_path):
    head = "t,q,tau\ns,mrad,mNm\n"
    keys = tomllib.loads(proposed(tmp_path, head + table(",", TIME, ANGLE, CURRENT)).toml)
    assert keys["position"]["unit"] == "mrad"
    assert keys["force"]["unit"] == "mN·m"


@pytest.mark.parametrize("unit", ["mN·m", "kNm", "mA", "kA", "rad/s", "%"])
def test_a_unit_with_a_prefix_in_brackets_is_no_joint(unit):
    assert name_of_joint(f"torque [{unit}]") == ""


KINDS = {
    "command_m": "command", "target_q_0": "command", "current_velocity": "velocity",
    "load_velocity": "velocity", "velocity_m_s": "velocity", "target_qd_0": "velocity",
    "current_temperature": "temperature", "motor_temp": "temperature",
    "current_position": "position", "load_position": "position", "load_mm": "position",
    "actual_q_0": "position", "force_x": "force", "tau_cmd": "force", "target_current_0": "force",
    "load_left": "force", "i_q": "force", "iQ": "force", "actual_current_0": "force", "m": "force",
    "axis (N\u00b7mm)": "force", "axis (rad/s)": "velocity", "acc_x": None, "i_d": None,
    "left_mA": "force", "battery_mV": None, "battery_percent": None, "sensor_raw": None,
}  # fmt: skip


@pytest.mark.parametrize(("name", "kind"), KINDS.items(), ids=str)
def test_what_a_column_is_goes_by_the_word_that_can_mean_one_thing(name, kind):
    (belief,) = believed(Log("log.csv", {name: CURRENT}))
    assert belief.kind == kind


def test_a_current_of_the_torque_axis_is_in_amperes(tmp_path):
    proposal = proposed(tmp_path, "t,q_rad,i_q\n" + table(",", TIME, ANGLE, CURRENT))
    assert tomllib.loads(proposal.toml)["force"]["unit"] == "A"


@pytest.mark.parametrize("force", ["load", "current", "i", "m", "f"])
def test_a_word_for_a_force_is_no_part_of_a_joint(tmp_path, force):
    names = f"t,left_q,right_q,left_{force},right_{force}\n"
    proposal = proposed(tmp_path, names + table(",", TIME, ANGLE, TIME, CURRENT, TIME))
    assert proposal.joints == ("left", "right")
    assert tomllib.loads(proposal.toml)["force"]["column"] == "{joint}_" + force


def test_a_torque_is_proposed_before_a_current_which_needs_a_factor(tmp_path):
    rows = [f"{k / 100},{np.sin(k / 9):.4f},{np.cos(k / 9):.4f},{k % 7}.5" for k in range(200)]
    text = "\n".join(["time_s,pos_rad,current_a,torque_nm", *rows])
    proposal = proposed(tmp_path, text)
    assert tomllib.loads(proposal.toml.replace("SAY", "1"))["force"]["column"] == "torque_nm"


def test_a_column_that_counts_rows_is_no_force(tmp_path):
    text = "i,time,q,tau\n" + table(",", np.arange(100.0), TIME, ANGLE, CURRENT)
    assert tomllib.loads(proposed(tmp_path, text).toml)["force"]["column"] == "tau"
    assert "# 1. i: not used (it counts the rows)" in proposed(tmp_path, text).toml


@pytest.mark.parametrize(
    ("behind", "before"),
    [
        ("position_error", "position_rad"),
        ("q_limit", "q"),
        ("pos_min", "pos"),
        ("angle_max_deg", "angle_deg"),
    ],
)
def test_a_limit_or_an_error_stands_behind_the_position(tmp_path, behind, before):
    text = f"t,{behind},{before},tau\n" + table(",", TIME, ANGLE, 2 * ANGLE, CURRENT)
    assert tomllib.loads(proposed(tmp_path, text).toml)["position"]["column"] == before


def test_of_a_robot_what_acts_is_proposed_and_not_its_target(tmp_path):
    head = [
        f"{name}_{joint}"
        for name in (
            "target_q",
            "target_qd",
            "target_current",
            "actual_q",
            "actual_qd",
            "actual_current",
        )
        for joint in range(2)
    ]
    columns = [ANGLE, TIME, SPEED, TIME, CURRENT, TIME, ANGLE, TIME, SPEED, TIME, CURRENT, TIME]
    proposal = proposed(
        tmp_path, ",".join(["timestamp", *head]) + "\n" + table(",", TIME, *columns)
    )
    keys = tomllib.loads(proposal.toml)
    assert proposal.joints == ("0", "1")
    for key, column in {
        "position": "actual_q_{joint}", "velocity": "actual_qd_{joint}",
        "force": "actual_current_{joint}", "command": "target_q_{joint}",
    }.items():  # fmt: skip
        assert keys[key]["column"] == column
