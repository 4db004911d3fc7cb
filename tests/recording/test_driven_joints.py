"""Columns and keys of driven joints are read, checked and carried; what no model takes is said."""

import json
from pathlib import Path
from typing import Any

import pytest
from recording.mini import Mini, write_files

from bayesfric.errors import InputError
from bayesfric.recording import Recording, read_recording, write_recording

RUNS, SAMPLES = "axis_runs.csv", "axis_samples.csv"
URDF = """<robot name="arm"><link name="a"/><link name="b"/>
<joint name="joint_1" type="revolute"/><joint name="joint_2" type="revolute"/></robot>"""
MJCF = (
    """<mujoco><worldbody><body><joint name="joint_2" axis="0 0 1"/></body></worldbody></mujoco>"""
)
KEYS: dict[str, Any] = {
    "force_is": "motor",
    "other_joints": "logged",
    "mass_sd_kg": 0.02,
    "force_gain_sd": 0.05,
    "known_force_sd": 0.3,
    "command_gain": 250.0,
    "force_limit_n": 40.0,
    "sample_hold_s": 0.01,
    "latency_s": 0.0,
}


def joints(**rig: Any) -> Mini:
    mini = Mini().keep(RUNS, SAMPLES)
    mini.package["rig"] |= rig
    return mini


def fault_of(folder: Path) -> str:
    with pytest.raises(InputError) as caught:
        read_recording(folder)
    (fault,) = caught.value.faults
    return str(fault)


def round_trip(recording: Recording, folder: Path) -> Recording:
    write_recording(recording, folder)
    return read_recording(folder)


def test_all_keys_are_carried_there_and_back(tmp_path: Path) -> None:
    recording = read_recording(joints(**KEYS).write(tmp_path / "a"))
    assert {key: getattr(recording.rig, key) for key in KEYS} == KEYS
    assert round_trip(recording, tmp_path / "b").rig == recording.rig
    (_, note) = recording.notes
    assert note.startswith("datapackage.json: rig.sample_hold_s, rig.command_gain")


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("force_is", "guessed", "'commanded', 'motor', 'link', 'measured' or 'unknown'"),
        ("other_joints", True, "'still', 'logged', 'moving' or 'unknown'"),
        ("mass_sd_kg", 0, "above 0"),
        ("mass_sd_kg", 20, "at most moving_mass_kg, 0.4 (is it in grams, or percent?)"),
        ("moving_mass_kg", None, "this key, whose error mass_sd_kg is"),
        ("force_gain_sd", 5, "at most 1 times the force (is it in percent?)"),
        ("known_force_sd", -1, "above 0"),
        ("command_gain", "high", "a number"),
        ("force_limit_n", 0, "above 0"),
        ("sample_hold_s", 10, "milliseconds"),
        ("latency_s", -0.1, "at least 0"),
        ("latency_s", 20, "milliseconds"),
        ("robot", "arm.urdf", "an object"),
        ("robot", {"model": "arm.urdf"}, "this key"),
        ("robot", {"model": "../arm.urdf", "joints": {"q1": "a"}}, "stays in the folder"),
        ("robot", {"model": "arm.txt", "joints": {"q1": "a"}}, "URDF or MJCF"),
        ("robot", {"model": "none.urdf", "joints": {"q1": "a"}}, "a file of this name"),
    ],
)
def test_a_wrong_key_is_one_fault(tmp_path: Path, key: str, value: Any, said: str) -> None:
    assert said in fault_of(joints(**(KEYS | {key: value})).write(tmp_path))


def test_a_mass_that_a_run_carries_is_no_less_than_nothing(tmp_path: Path) -> None:
    mini = Mini().set("axis_runs.csv", 3, "payload_kg", "-1")
    said = fault_of(mini.write(tmp_path))
    assert "row 3, payload_kg: found '-1', expected a mass that the run carries, 0 at least" in said


@pytest.mark.parametrize(("file", "text"), [("arm.urdf", URDF), ("models/arm.xml", MJCF)])
def test_a_robot_is_read_and_written_with_its_file(tmp_path: Path, file: str, text: str) -> None:
    mini = joints(robot={"model": file, "joints": {"q1": "joint_2"}})
    (tmp_path / "a" / file).parent.mkdir(parents=True)
    folder = write_files(tmp_path / "a", mini.contents() | {file: text.encode()})
    recording = read_recording(folder)
    assert recording.rig.robot is not None
    assert recording.rig.robot.content == text.encode()
    assert round_trip(recording, tmp_path / "b").rig == recording.rig


def including(file: str) -> str:
    return f'<mujoco><worldbody><include file="{file}"/></worldbody></mujoco>'


def test_what_a_model_includes_is_carried_with_it(tmp_path: Path) -> None:
    """Included files are beside the model, in whatever folder of the recording that is."""
    part = '<mujocoinclude><body><joint name="joint_2"/></body></mujocoinclude>'
    mini = joints(robot={"model": "models/arm.xml", "joints": {"q1": "joint_2"}})
    (tmp_path / "a/models").mkdir(parents=True)
    texts = {"models/arm.xml": including("part.xml"), "models/part.xml": part}
    contents = {name: text.encode() for name, text in texts.items()}
    recording = read_recording(write_files(tmp_path / "a", mini.contents() | contents))
    assert recording.rig.robot is not None
    assert dict(recording.rig.robot.files) == {"models/part.xml": part.encode()}
    assert round_trip(recording, tmp_path / "b").rig == recording.rig


@pytest.mark.parametrize(
    ("file", "said"),
    [
        ("../part.xml", "expected a file inside the recording's folder"),
        ("/etc/passwd", "expected a file inside the recording's folder"),
        ("none.xml", "none.xml: expected a file of this name"),
        ("empty.xml", "expected a joint of arm.xml (it has none)"),
    ],
)
def test_an_include_is_a_file_of_the_recording_and_has_the_joints(
    tmp_path: Path, file: str, said: str
) -> None:
    mini = joints(robot={"model": "arm.xml", "joints": {"q1": "joint_2"}})
    texts = {"arm.xml": including(file), "empty.xml": "<mujocoinclude/>"}
    contents = {name: text.encode() for name, text in texts.items()}
    assert said in fault_of(write_files(tmp_path, mini.contents() | contents))


@pytest.mark.parametrize(
    ("names", "content", "said"),
    [
        (
            {"q1": "joint_3"},
            URDF,
            "found 'joint_3', expected a joint of arm.urdf (joint_1, joint_2",
        ),
        ({"q2": "joint_2"}, URDF, "rig.robot.joints.q1: expected this joint's name in the model"),
        ({"q1": "joint_1"}, "<robot", "XML that parses"),
        ({"q1": "joint_1"}, "<sdf/>", "found 'sdf', expected URDF"),
        ({"q1": "joint_1"}, '<!DOCTYPE r [<!ENTITY a "b">]><robot/>', "entities"),
    ],
)
def test_a_wrong_model_is_one_fault(
    tmp_path: Path, names: dict[str, str], content: str, said: str
) -> None:
    mini = joints(robot={"model": "arm.urdf", "joints": names})
    assert said in fault_of(write_files(tmp_path, mini.contents() | {"arm.urdf": content.encode()}))


def test_each_joint_has_a_clock_of_its_own(tmp_path: Path) -> None:
    mini = joints()
    for line, joint in ((3, "q2"), (5, "q1"), (6, "q2")):
        mini.set(SAMPLES, line, "joint", joint)
    mini.set(SAMPLES, 3, "time_s", "0.00").set(SAMPLES, 6, "time_s", "0.00")
    recording = read_recording(mini.write(tmp_path / "a"))
    assert recording.axis is not None
    assert recording.axis.samples["joint"].tolist() == ["q1", "q2", "q1", "q1", "q2"]
    mini.set(SAMPLES, 4, "time_s", "0.00")
    assert "row 4, time_s" in fault_of(mini.write(tmp_path / "b"))


def test_clocks_of_channels_hold_and_do_not_go_backwards(tmp_path: Path) -> None:
    mini = joints()
    read_recording(mini.write(tmp_path / "held"))
    mini.set(SAMPLES, 4, "force_time_s", "4.9")
    assert "at least the force_time_s before it" in fault_of(mini.write(tmp_path / "back"))


def test_a_temperature_in_kelvin_is_named(tmp_path: Path) -> None:
    mini = joints()
    for line in range(2, 7):
        mini.set(SAMPLES, line, "temperature_c", "294.5")
    fault = fault_of(mini.write(tmp_path))
    assert "is it in kelvin?" in fault
    assert fault.endswith("and 4 like it")


def test_commands_alone_are_a_log(tmp_path: Path) -> None:
    mini = joints(rotary=True).drop(SAMPLES, "force_n", "force_time_s", "command_m")
    assert "or command_m where only" in fault_of(mini.write(tmp_path / "none"))
    mini.add(SAMPLES, "command_rad", ["0", "0.1", "0.2", "0", "0.1"])
    recording = read_recording(mini.write(tmp_path / "rad"))
    assert recording.axis is not None
    assert recording.axis.samples["command_m"].tolist() == [0.0, 0.1, 0.2, 0.0, 0.1]
    mini.set(SAMPLES, 3, "command_rad", "x")
    assert "row 3, command_rad: found 'x'" in fault_of(mini.write(tmp_path / "cell"))
    mini.set(SAMPLES, 3, "command_rad", "0.1")
    mini.package["rig"]["rotary"] = False
    assert "rig.rotary" in fault_of(mini.write(tmp_path / "slides"))
    mini.add(SAMPLES, "command_m", ["0"] * 5)
    assert "command_m or command_rad, not both" in fault_of(mini.write(tmp_path / "both"))


def test_a_schema_says_the_units_of_new_columns(tmp_path: Path) -> None:
    write_recording(read_recording(joints(rotary=True).write(tmp_path / "a")), tmp_path / "b")
    package = json.loads((tmp_path / "b/datapackage.json").read_text())
    fields = package["resources"][-1]["schema"]["fields"]
    units = {field["name"]: field.get("unit") for field in fields}
    assert (units["known_force_n"], units["command_m"], units["temperature_c"]) == (
        "N·m",
        "rad",
        "°C",
    )
