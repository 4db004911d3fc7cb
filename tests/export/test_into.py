"""A user's own model with what a diagnosis found: MuJoCo loads it, and the truth comes back."""

import ast
import csv
import json
import re
import sys
from dataclasses import replace
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from export.entered import number
from export.hinge import Hinge, drawn_hinge, recording
from report.diagnosis_sample import diagnosis
from typer.testing import CliRunner

import bayesfric as bf
from bayesfric.cli import app
from bayesfric.export.into import filled_model, own_numbers
from bayesfric.export.joints import ExportedJoint, joints_of
from bayesfric.export.of_joints import TEXTS_OF_JOINTS, draws_table, load_friction_text
from bayesfric.robots.setting import model_text

mujoco = pytest.importorskip("mujoco")
OWN = Hinge(frictionloss=0.2, damping=0.05, armature=0.01)  # what the user's simulator has
NUMBERS = {"coulomb": "frictionloss", "viscous": "damping", "armature": "armature"}


def diagnosed(folder, seed):
    """Diagnose a hinge beside a model with other numbers; return the truth and the joint."""
    truth = drawn_hinge(seed)
    diagnosed_joint = bf.diagnose(recording(truth, seed, own=OWN))
    diagnosed_joint.write(folder / "out")
    (folder / "one.xml").write_text(OWN.model())
    (folder / "one.urdf").write_text(OWN.urdf())
    return truth, diagnosed_joint.summary


def exported(folder, *arguments):
    done = CliRunner().invoke(app, ["export", str(folder / "out"), *map(str, arguments)])
    assert done.exit_code == 0, done.output
    return done.stdout


def joint(*numbers, name="elbow", in_model=None, turns=True, draws=None):
    named = {entered.parameter: entered for entered in numbers}
    return ExportedJoint(name, in_model, turns, named, draws or {})


@pytest.fixture(scope="module")
def hinge(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hinge")
    truth, summary = diagnosed(folder, 1)
    return SimpleNamespace(folder=folder, truth=truth, summary=summary)


def test_the_diagnosis_says_what_the_model_has_and_what_to_enter(hinge):
    entered = {entry.parameter: entry for entry in hinge.summary.enter}
    entered |= {"armature": entered.get("armature", entered.get("inertia"))}
    assert hinge.summary.joint_in_model == "hinge"
    for name, field in NUMBERS.items():
        assert entered[name].in_your_simulator == getattr(OWN, field)
        truth = getattr(hinge.truth, field)
        assert entered[name].value.q05 < truth < entered[name].value.q95


@pytest.mark.parametrize(("to", "file"), [("mjcf", "law.xml"), ("urdf", "law.urdf")])
def test_a_model_of_the_joint_alone_has_the_numbers_to_enter(hinge, to, file):
    """Friction of each window at its own speed: those of the whole run are another law."""
    exported(hinge.folder, "--to", to)
    alone = mujoco.MjModel.from_xml_string((hinge.folder / "out" / file).read_text())
    entered = {number.parameter: number.value for number in hinge.summary.enter}
    for name, made in (("coulomb", alone.dof_frictionloss), ("viscous", alone.dof_damping)):
        assert made[0] == pytest.approx(entered[name].mean, abs=0.06 * entered[name].sd)
        assert abs(made[0] - getattr(hinge.truth, NUMBERS[name])) < 4 * entered[name].sd


def test_python_of_the_joint_alone_is_its_friction_at_any_speed(hinge):
    exported(hinge.folder, "--to", "python")
    module: dict = {}
    exec((hinge.folder / "out" / "joints.py").read_text(), module)
    speed = np.array([0.01, 0.3, 20.0])
    truth = hinge.truth.frictionloss + hinge.truth.damping * speed
    assert module["friction"]("joint", speed) == pytest.approx(truth, rel=0.02)


def test_numbers_that_are_not_to_be_relied_on_say_so_wherever_they_go(tmp_path, monkeypatch):
    warned = replace(joint(number("coulomb", 0.6, 0.01)), warning="Do not enter these numbers yet")
    for to in ("json", "python", "isaaclab"):
        assert warned.warning in TEXTS_OF_JOINTS[to][1]([warned], "log")
    assert warned.warning in warned.said
    stand_in(monkeypatch, tmp_path / "out", warned)
    (tmp_path / "one.xml").write_text(OWN.model())
    command = ["export", str(tmp_path / "out"), "--to", "mjcf", "--into", str(tmp_path / "one.xml")]
    assert warned.warning in CliRunner().invoke(app, command).output


def test_a_number_that_the_recording_does_not_tell_leaves_what_the_model_has(tmp_path):
    """An armature of 0.05 ± 4, beside 0.01 in the model, would be written as 0.0."""
    (tmp_path / "one.xml").write_text(OWN.model())
    untold = number("armature", 0.05, 4.0, "kg·m²", in_your_simulator=0.01)
    wrong = number("viscous", 0.001, 0.002, "N·m s/rad", in_your_simulator=0.05)
    given = joint(number("coulomb", 0.6, 0.01), untold, wrong, in_model="hinge")
    filled = filled_model(tmp_path / "one.xml", "mjcf", [given], {})
    model = mujoco.MjModel.from_xml_string(filled.content.decode())
    assert model.dof_armature[0] == OWN.armature
    assert model.dof_frictionloss[0] == 0.6
    assert model.dof_damping[0] == 0.001  # as uncertain, and surely not what the model has
    assert "armature is left as it is (0.01)" in " ".join(filled.remarks)


def test_what_the_file_has_decides_and_not_what_the_recordings_model_had(tmp_path):
    """Coulomb friction of 0.001 ± 0.002 is surely not the 0.2 of this file."""
    (tmp_path / "one.xml").write_text(OWN.model())
    (tmp_path / "one.urdf").write_text(OWN.urdf())
    small = number("coulomb", 0.001, 0.002, in_your_simulator=0.0)
    right = number("viscous", 0.01, 0.04, "N·m s/rad", in_your_simulator=3.0)
    for to, file in (("mjcf", "one.xml"), ("urdf", "one.urdf")):
        filled = filled_model(tmp_path / file, to, [joint(small, right, name="hinge")], {})
        compiled = mujoco.MjModel.from_xml_string(filled.content.decode())
        assert compiled.dof_frictionloss[0] == pytest.approx(0.001)
        assert compiled.dof_damping[0] == OWN.damping
        assert "viscous is left as it is (0.05)" in " ".join(filled.remarks)


@pytest.mark.parametrize(
    ("dynamics", "has"),
    [
        ('<dynamics damping="0.05" friction="0.2"/>', {"viscous": 0.05, "coulomb": 0.2}),
        ('<dynamics damping="0.05"/>', {"viscous": 0.05, "coulomb": 0.0}),
        ("", {"viscous": 0.0, "coulomb": 0.0}),
        ('<dynamics damping="${d}" friction="nan"/>', {}),
    ],
    ids=["both", "one", "none", "macro and nan"],
)
def test_a_urdf_has_what_it_says_and_nothing_where_it_says_nothing(tmp_path, dynamics, has):
    text = OWN.urdf().replace('<dynamics damping="0.05" friction="0.2"/>', dynamics)
    path = tmp_path / "one.urdf"
    path.write_text(text)
    assert own_numbers(path, model_text(text.encode(), path.name), "hinge", None) == has


def test_damping_that_was_not_found_is_that_of_the_file_beside_drag(tmp_path):
    """A class of defaults has 0.5; what was found is drag alone."""
    text = (
        OWN.model()
        .replace('damping="0.05"', "")
        .replace("<worldbody>", '<default><joint damping="0.5"/></default><worldbody>')
    )
    (tmp_path / "one.xml").write_text(text)
    drag = number("air-drag.coefficient", 0.02, 0.001, "N·m s²/rad²")
    left = number("viscous", 0.1, 0.3, "N·m s/rad")
    for numbers in ([COULOMB, drag], [COULOMB, left, drag]):
        filled = filled_model(tmp_path / "one.xml", "mjcf", [joint(*numbers, name="hinge")], {})
        compiled = mujoco.MjModel.from_xml_string(filled.content.decode())
        assert (compiled.dof_damping[0], *compiled.dof_dampingpoly[0]) == (0.5, 0.02, 0.0)
        assert "viscous was not found: 0.5 is entered" in " ".join(filled.remarks)


def test_drag_of_the_file_is_not_lost_without_a_word(tmp_path):
    (tmp_path / "one.xml").write_text(OWN.model().replace('"0.05"', '"0.05 0.02 0.003"'))
    filled = filled_model(tmp_path / "one.xml", "mjcf", [joint(VISCOUS, name="hinge")], {})
    compiled = mujoco.MjModel.from_xml_string(filled.content.decode())
    assert (compiled.dof_damping[0], *compiled.dof_dampingpoly[0]) == (0.3, 0.0, 0.0)
    remarks = " ".join(filled.remarks)
    assert "air-drag.coefficient of this file, 0.02, is set to 0" in remarks
    assert "cubic-drag.coefficient of this file, 0.003, is set to 0" in remarks


def test_mujoco_loads_the_users_model_with_the_numbers(hinge):
    said = exported(hinge.folder, "--to", "mjcf", "--into", hinge.folder / "one.xml")
    written = float(re.search(r"hinge: frictionloss ([\d.]+), damping", said).group(1))
    assert written == pytest.approx(hinge.truth.frictionloss, rel=0.005)
    text = (hinge.folder / "out" / "one.xml").read_text()
    assert "<!-- a rod -->" in text
    compiled = mujoco.MjModel.from_xml_string(text)
    assert compiled.dof_frictionloss[0] == pytest.approx(hinge.truth.frictionloss, rel=0.005)
    assert compiled.dof_damping[0] == pytest.approx(hinge.truth.damping, rel=0.005)
    assert compiled.dof_armature[0] == pytest.approx(hinge.truth.armature, abs=0.01)


def test_mujoco_loads_the_users_urdf_with_the_numbers(hinge):
    said = exported(hinge.folder, "--to", "urdf", "--into", hinge.folder / "one.urdf")
    compiled = mujoco.MjModel.from_xml_string((hinge.folder / "out" / "one.urdf").read_text())
    assert compiled.dof_frictionloss[0] == pytest.approx(hinge.truth.frictionloss, rel=0.005)
    assert compiled.dof_damping[0] == pytest.approx(hinge.truth.damping, rel=0.005)
    assert "no field for" in said  # of the armature


def test_a_row_of_draws_is_one_draw_of_all_numbers(hinge):
    """What Coulomb and viscous friction of one log have in common, they have in the table."""
    exported(hinge.folder, "--to", "mjcf", "--into", hinge.folder / "one.xml", "--draws", "200")
    with (hinge.folder / "out" / "joint-draws.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 200
    drawn = {name: np.array([float(row[name]) for row in rows]) for name in NUMBERS}
    (read,) = joints_of(hinge.summary, bf.results.read_tree(hinge.folder / "out/diagnosis.nc"))
    difference = np.abs(np.subtract.outer(drawn["coulomb"], read.draws["coulomb"]))
    place = difference.argmin(axis=1)
    assert np.unique(place).size > 100  # no value comes so often that it could be any draw
    for name in ("coulomb", "viscous"):
        np.testing.assert_allclose(drawn[name], read.draws[name][place], rtol=1e-4)
    assert {row["joint"] for row in rows} == {"hinge"}
    assert np.mean(drawn["armature"]) == pytest.approx(hinge.truth.armature, abs=0.01)


@pytest.mark.nightly
def test_the_truth_of_twenty_hinges_lies_in_their_intervals(tmp_path):
    """Of 60 numbers 90 % are expected inside; with 48 or fewer the intervals are too narrow."""
    inside = []
    for seed in range(2, 22):
        folder = tmp_path / str(seed)
        folder.mkdir()
        truth, summary = diagnosed(folder, seed)
        for entry in summary.enter:
            name = {"inertia": "armature"}.get(entry.parameter, entry.parameter)
            if name in NUMBERS:
                inside.append(entry.value.q05 <= getattr(truth, NUMBERS[name]) <= entry.value.q95)
    assert len(inside) == 60
    assert sum(inside) > 48


def stand_in(monkeypatch, folder, *joints):
    """Stand in for a folder with a diagnosis of joints."""
    from bayesfric.cli import export as verb
    from bayesfric.export import joints as read

    folder.mkdir()
    block = diagnosis()
    several = block.model_copy(update={"joints": (block,) * len(joints)})
    monkeypatch.setattr(read, "read_diagnosis", lambda _: several)
    monkeypatch.setattr(verb, "_joints", lambda *_: joints)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--to", "mjcf"), "--into MODEL: your MJCF file, since there are 2 joints"),
        (("--to", "json", "--into", "arm.xml"), "--to with one of mjcf, urdf, sdf"),
        (("--to", "mjcf", "--into", "arm.xml", "--joint", "a"), "LOG=MODEL, where there are"),
        (("--to", "mjcf", "--into", "none.xml"), "none.xml"),
        (("--to", "usd"), "one of json, python, mjcf, urdf, sdf, isaaclab"),
    ],
)
def test_a_slip_of_the_command_line_is_one_line(tmp_path, monkeypatch, arguments, said):
    both = (joint(COULOMB, name="shoulder"), joint(COULOMB, name="elbow"))
    stand_in(monkeypatch, tmp_path / "out", *both)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.xml").write_text(OWN.model())
    done = CliRunner().invoke(app, ["export", "out", *arguments])
    assert done.exit_code == 2
    assert said in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not [file for file in (tmp_path / "out").iterdir() if not file.name.startswith(".")]


COULOMB, VISCOUS = number("coulomb", 0.61, 0.01), number("viscous", 0.3, 0.01, "N·m s/rad")


def test_inertia_without_a_model_is_that_of_the_links_too(tmp_path):
    """0.081 kg·m² in all; the rod of 1.2 kg has 0.0365 about its end: the rest is the rotor's."""
    path = tmp_path / "one.xml"
    path.write_text(OWN.model())
    whole = number("inertia", 0.081, 0.002, "kg·m²")
    filled = filled_model(path, "mjcf", [joint(COULOMB, VISCOUS, whole, name="")], {})
    compiled = mujoco.MjModel.from_xml_string(filled.content.decode())
    data = mujoco.MjData(compiled)
    mujoco.mj_forward(compiled, data)
    inertia = np.zeros((1, 1))
    mujoco.mj_fullM(compiled, data, inertia)
    assert inertia[0, 0] == pytest.approx(0.081, abs=0.0005)
    assert "0.0810 kg·m² in all" in filled.remarks[0]
    light = number("inertia", 0.01, 0.001, "kg·m²")
    filled = filled_model(path, "mjcf", [joint(light, name="")], {})
    assert 'armature="0"' in filled.content.decode()
    assert "their masses are too large" in " ".join(filled.remarks)


def test_powers_of_speed_are_a_polynomial_and_what_is_below_zero_is_zero(tmp_path):
    path = tmp_path / "one.xml"
    path.write_text(OWN.model(joint="elbow"))
    drag = number("air-drag.coefficient", 0.02, 0.001, "N·m s²/rad²")
    negative = number("viscous", -0.05, 0.01, "N·m s/rad")
    filled = filled_model(path, "mjcf", [joint(COULOMB, negative, drag)], {})
    assert 'damping="0 0.0200 0"' in filled.content.decode()
    assert "viscous is below zero (-0.050): 0 is entered" in " ".join(filled.remarks)


def test_what_has_a_field_and_is_not_set_is_told(tmp_path):
    path = tmp_path / "one.xml"
    path.write_text(OWN.model(joint="elbow"))
    spring = number("spring.stiffness", 4.21, 0.05, "N·m/rad")
    filled = filled_model(path, "mjcf", [joint(COULOMB, spring)], {})
    remark = "elbow: not set: spring.stiffness 4.210 N·m/rad (joint/@stiffness)"
    assert remark in filled.remarks
    assert "stiffness" not in filled.content.decode()


def test_the_only_joint_of_a_model_is_taken_and_it_is_said(tmp_path):
    path = tmp_path / "one.urdf"
    path.write_text(OWN.urdf())
    filled = filled_model(path, "urdf", [joint(COULOMB, in_model="knee")], {})
    assert 'friction="0.610"' in filled.content.decode()
    assert filled.remarks[0] == "hinge: taken for knee, as the only joint of one.urdf"
    unnamed = filled_model(path, "urdf", [joint(COULOMB, name="")], {})
    assert "taken for" not in " ".join(unnamed.remarks)


@pytest.mark.parametrize(
    ("change", "to", "named", "said"),
    [
        ({"turns": False}, "mjcf", {}, "a joint that slides, in N and m"),
        ({}, "urdf", {}, "--to: found 'urdf', expected mjcf, which one.xml is"),
        ({}, "mjcf", {"elbow": "knee"}, "one of hinge"),
        ({}, "mjcf", {"shoulder": "hinge"}, "one of elbow"),
    ],
)
def test_what_does_not_fit_is_one_clear_line(tmp_path, change, to, named, said):
    path = tmp_path / "one.xml"
    path.write_text(OWN.model())
    with pytest.raises(bf.InputError) as raised:
        filled_model(path, to, [joint(COULOMB, **change)], named)
    assert said in str(raised.value)


def test_a_callback_has_the_friction_of_the_load(monkeypatch):
    """A rod held out level: its weight of 1.2 kg at 0.15 m, times a share of 0.1."""
    own = number("load-friction.share", 0.1, 0.005, "1", snippet="load_friction")
    text = load_friction_text({"hinge": joint(own)})
    assert load_friction_text({"hinge": joint(COULOMB)}) is None
    module = {}
    exec(compile(text, "load_friction.py", "exec"), module)
    bare = Hinge(frictionloss=0, damping=0, armature=0.02)
    compiled = mujoco.MjModel.from_xml_string(bare.model())
    module["install"](compiled)
    try:
        data = mujoco.MjData(compiled)
        data.qvel[0] = 1.0
        mujoco.mj_forward(compiled, data)
    finally:
        mujoco.set_mjcb_passive(None)
    assert data.qfrc_passive[0] == pytest.approx(-0.1 * 1.2 * 9.81 * 0.15, rel=1e-6)


def test_isaac_lab_reads_a_configuration_of_its_own(monkeypatch):
    text = TEXTS_OF_JOINTS["isaaclab"][1]([joint(COULOMB, VISCOUS, in_model="j2")], "log")
    ast.parse(text)
    actuators = ModuleType("isaaclab.actuators")
    actuators.ImplicitActuatorCfg = SimpleNamespace
    monkeypatch.setitem(sys.modules, "isaaclab", ModuleType("isaaclab"))
    monkeypatch.setitem(sys.modules, "isaaclab.actuators", actuators)
    module = {}
    exec(compile(text, "isaaclab_actuators.py", "exec"), module)
    group = module["ACTUATORS"]["j2"]
    assert group.joint_names_expr == ["j2"]
    assert (group.friction, group.dynamic_friction, group.viscous_friction) == (0.61, 0.61, 0.3)
    assert group.stiffness is None


def test_python_and_json_have_all_joints():
    joints = [joint(COULOMB, VISCOUS), joint(COULOMB, name='a "b"\\n')]
    module = {}
    exec(compile(TEXTS_OF_JOINTS["python"][1](joints, 'x"""y'), "joints.py", "exec"), module)
    assert module["friction"]("elbow", -2.0) == pytest.approx(-(0.61 + 0.6))
    record = json.loads(TEXTS_OF_JOINTS["json"][1](joints, "log"))
    assert [entry["joint"] for entry in record["joints"]] == ["elbow", 'a "b"\\n']
    assert record["joints"][0]["enter"][0]["value"]["mean"] == 0.61


def test_draws_below_zero_are_left_out_and_counted():
    draws = {"coulomb": np.linspace(0.5, 0.7, 100), "viscous": np.linspace(-0.0095, 0.0895, 100)}
    text, below = draws_table([joint(COULOMB, VISCOUS, draws=draws)], 10, {})
    assert below == 10
    rows = list(csv.DictReader(text.splitlines()))
    assert len(rows) == 10
    assert min(float(row["viscous"]) for row in rows) >= 0
    with pytest.raises(bf.InputError, match="at most 90 draws"):
        draws_table([joint(COULOMB, VISCOUS, draws=draws)], 91, {})
