"""Logs with a row for each joint at each time: the recording is that of a column a joint."""

import tomllib

import numpy as np
import pytest
from logs.written import JOINTS, motion

from bayesfric.errors import InputError
from bayesfric.logs import import_log, propose_mapping

MAPPING = """joint_column = "name"
[time]
column = "time"
[position]
column = "position"
unit = "rad"
[force]
column = "effort"
unit = "N·m"
force_is = "motor"
"""


def long_log(folder, header="time,name,position,effort", names=JOINTS):
    """Write the motion with a row for each joint at each time."""
    time, position, torque = motion()
    rows = [
        f"{at!r},{name},{q!r},{tau!r}"
        for at, both_q, both_tau in zip(
            time.tolist(), position.tolist(), torque.tolist(), strict=True
        )
        for name, q, tau in zip(names, both_q, both_tau, strict=True)
    ]
    (folder / "log.csv").write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return folder / "log.csv"


def made(folder, mapping=MAPPING, joint="all", log=None):
    (folder / "map.toml").write_text(mapping, encoding="utf-8")
    return import_log(log or long_log(folder), joint, mapping=folder / "map.toml")


def test_each_joint_has_its_own_rows(tmp_path):
    time, position, torque = motion()
    imported = made(tmp_path)
    samples = imported.recording.axis.samples
    for place, joint in enumerate(JOINTS):
        own = samples[samples["joint"] == joint]
        assert np.array_equal(own["time_s"], time.round(9))
        assert np.array_equal(own["position_m"], position[:, place].round(9))
        assert np.array_equal(own["force_n"], torque[:, place].round(9))
    assert "Rows are of the joints that name names: shoulder, elbow." in imported.notes


def test_one_joint_by_numbers_of_columns_with_a_sign_of_its_own(tmp_path):
    numbered = MAPPING.replace('"name"', "2").replace('"position"', "3").replace('"effort"', "4")
    numbered = numbered.replace('column = "time"', "column = 1")
    samples = made(
        tmp_path, f"{numbered}[joints.elbow.force]\nsign = -1\n", "elbow"
    ).recording.axis.samples
    assert np.array_equal(samples["force_n"], -motion()[2][:, 1])


def test_a_joint_that_no_row_is_of_is_told_with_those_that_are(tmp_path):
    with pytest.raises(InputError, match=r"'elbwo', expected all, or one of its joints \(shoulder"):
        made(tmp_path, joint="elbwo")


@pytest.mark.parametrize(
    ("mapping", "said"),
    [
        (
            MAPPING.replace('joint_column = "name"\n', ""),
            "position: expected rows of one joint, and",
        ),
        (MAPPING.replace('"name"', '"nmae"'), "nmae: expected one of time, name, position, effort"),
        (
            MAPPING.replace('"position"', '"q_{joint}"'),
            "position.column: expected a column that all",
        ),
        (
            MAPPING + '[joints.elbow.force]\ncolumn = "tau"\n',
            "joints.elbow.force.column: expected a column that all joints share",
        ),
    ],
    ids=["mixed", "misspelt", "a place for joints", "a column of its own"],
)
def test_joints_are_not_mixed(tmp_path, mapping, said):
    with pytest.raises(InputError, match=said):
        made(tmp_path, mapping, joint=None if "joint_column" not in mapping else "elbow")


def test_a_cell_that_is_no_number_has_its_row_in_the_file(tmp_path):
    log = long_log(tmp_path)
    lines = log.read_text("utf-8").splitlines()
    lines[7] += "x"  # row 8 of the file, and the fourth of the shoulder
    log.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(InputError, match="row 8, effort: found"):
        made(tmp_path, log=log)


def test_two_readings_of_one_joint_at_a_time_are_no_two_joints(tmp_path):
    log = tmp_path / "log.csv"
    rows = "".join(f"{k // 2 / 100},a,{float(np.sin(k / 20))!r},1\n" for k in range(200))
    log.write_text(f"time,name,position,effort\n{rows}", encoding="utf-8")
    imported = made(tmp_path, MAPPING.replace('joint_column = "name"\n', ""), None, log)
    assert len(imported.recording.axis.samples) == 100


@pytest.mark.parametrize(
    ("header", "names"),
    [("time,name,position,effort", JOINTS), ("time,motor_id,position,effort", (11, 12))],
)
def test_the_column_is_proposed_with_the_joints(tmp_path, header, names):
    proposal = propose_mapping(long_log(tmp_path, header, names))
    assert tomllib.loads(proposal.toml)["joint_column"] == header.split(",")[1]
    assert proposal.joints == tuple(map(str, names))
    edited = proposal.toml.replace('unit = "SAY"', 'unit = "N·m"')
    edited = edited.replace('force_is = "SAY"', 'force_is = "motor"')
    samples = made(tmp_path, edited, log=tmp_path / "log.csv").recording.axis.samples
    own = samples[samples["joint"] == str(names[1])]
    assert np.array_equal(own["position_m"], motion()[1][:, 1].round(9))
