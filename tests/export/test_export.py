"""The law for other simulators: read back by them, it is the diagnosed one to the stated error."""

import json
from types import SimpleNamespace
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
from export.laws import axis_law
from report.diagnosis_sample import cause, diagnosis, interval
from rigs.friction_points import joint, recorded
from typer.testing import CliRunner

import bayesfric as bf
from bayesfric.analysis import Analysis, Sampler
from bayesfric.cli import app
from bayesfric.export import FORMATS, export_text, read_law
from bayesfric.export.joint_friction import joint_friction
from bayesfric.export.stored_law import law_said, numbers_of
from bayesfric.resources import reference_folder
from bayesfric.results import read_json
from bayesfric.schemas import DiagnosisFile, FitFile
from bayesfric.schemas.causes import LawNumber

SHORT = Analysis(seed=3, sampler=Sampler(burn=10, steps=60, thin=3))
SPEEDS = np.array([0.1, 0.5, 1.0, 2.0])


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """A joint with 8 N m and 3 N m s/rad, of whose points some only show the gap."""
    folder = tmp_path_factory.mktemp("export")
    table = joint(3.0) | {"role": np.where(np.arange(60) % 4, "calibrate", "test").tolist()}
    recording = recorded(folder / "joint", table, rotary=True)
    bf.fit(recording, SHORT).write(folder / "results")
    bf.diagnose(recording, SHORT).write(folder / "results")
    return SimpleNamespace(folder=folder / "results", points=recording.steady)


def test_constant_and_damping_are_those_of_the_machine(stored):
    friction = joint_friction(read_law(stored.folder))
    assert friction.frictionloss == pytest.approx(8, rel=0.01)
    assert friction.damping == pytest.approx(3, rel=0.02)
    assert friction.error_max < 0.001 * friction.friction_rms


def test_mujoco_reproduces_the_points_that_were_held_back(stored):
    law = read_law(stored.folder)
    model = mujoco.MjModel.from_xml_string(export_text(law, "mjcf"))
    assert model.jnt_type[0] == mujoco.mjtJoint.mjJNT_HINGE
    data, off = mujoco.MjData(model), []
    for _, point in stored.points[stored.points["role"] == "test"].iterrows():
        data.qvel[0], data.qacc[0] = point["velocity_m_s"], 0.0
        mujoco.mj_inverse(model, data)
        off.append(data.qfrc_inverse[0] - point["friction_n"])
    stated = np.hypot(law.noise, joint_friction(law).error_rms)
    assert np.sqrt(np.mean(np.square(off))) < 1.5 * stated
    assert stated < 0.03 * 11  # a per cent of scatter, and 0.03 N m


@pytest.mark.parametrize("to", ["mjcf", "urdf"])
@pytest.mark.parametrize(
    ("unit", "mass", "kind"),
    [
        ("N", (2.0, 0.1), mujoco.mjtJoint.mjJNT_SLIDE),
        ("N·m", (0.05, 0.0005), mujoco.mjtJoint.mjJNT_HINGE),
    ],
    ids=["slides", "turns"],
)
def test_mujoco_moves_an_axis_as_its_law_does(to, unit, mass, kind):
    """1.5 N and 0.8 N s/m under 4 N, with 2 kg or 0.05 kg m²: by a closed form."""
    model = mujoco.MjModel.from_xml_string(export_text(axis_law(unit=unit, mass=mass), to))
    assert model.jnt_type[0] == kind
    model.opt.timestep, model.opt.gravity = 1e-4, np.zeros(3)
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = 4.0
    while data.time < 0.25 * mass[0]:
        mujoco.mj_step(model, data)
    expected = (4.0 - 1.5) / 0.8 * -np.expm1(-0.8 / mass[0] * data.time)
    assert data.qvel[0] == pytest.approx(expected, rel=5e-3)


def test_an_inertia_is_no_mass():
    """Of a joint that turns: armature in MJCF, an inertia about the axis elsewhere."""
    law = axis_law(unit="N·m", mass=(0.0500312876, 0.00052))
    joint = ElementTree.fromstring(export_text(law, "mjcf")).find("worldbody/body/joint")
    assert joint.get("armature") == "0.05003"
    link = ElementTree.fromstring(export_text(law, "urdf")).find("link[@name='moving']/inertial")
    assert link.find("inertia").get("izz") == "0.05003"
    assert link.find("mass").get("value") == "1"
    sdf = ElementTree.fromstring(export_text(law, "sdf")).find("model")
    assert sdf.find("link[@name='moving']/inertial/inertia/izz").text == "0.05003"
    assert sdf.find("joint").get("type") == "revolute"
    assert sdf.find("joint/axis/dynamics/friction").text == "1.500"
    slide = ElementTree.fromstring(export_text(axis_law(), "mjcf"))
    assert slide.find("worldbody/body/joint").get("armature") is None
    assert slide.find("worldbody/body/inertial").get("mass") == "2.00"


SDF_NUMBERS = {
    "inertial": ("mass",),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "dynamics": ("damping", "friction", "spring_reference", "spring_stiffness"),
    "limit": ("lower", "upper"),
}
"""What SDFormat 1.9 asks for in these elements (sdf/1.9/joint.sdf, inertial.sdf), as numbers."""
SDF_PARTS = {
    "model": {"link", "joint"},
    "link": {"inertial"},
    "joint": {"parent", "child", "axis"},
    "axis": {"xyz", "dynamics", "limit"},
    "inertial": {"mass", "inertia"},
}
"""Children that they may have, of those that are written."""


@pytest.mark.parametrize("unit", ["N", "N·m"])
def test_sdf_has_what_its_schema_asks_for(unit):
    root = ElementTree.fromstring(export_text(axis_law(unit=unit), "sdf"))
    assert (root.tag, root.get("version"), len(root.findall("model"))) == ("sdf", "1.9", 1)
    links = [link.get("name") for link in root.iter("link")]
    assert len(set(links)) == len(links)
    for pivot in root.iter("joint"):
        assert pivot.get("name")
        assert pivot.get("type") in {"revolute", "prismatic"}
        assert {pivot.findtext("parent"), pivot.findtext("child")} == set(links)
        assert (
            np.linalg.norm([float(component) for component in pivot.findtext("axis/xyz").split()])
            == 1
        )
        assert {part.tag for part in pivot.find("axis")} == SDF_PARTS["axis"]
    for element in root.iter():
        if element.tag in SDF_NUMBERS:
            tags = [part.tag for part in element]
            assert {*SDF_NUMBERS[element.tag]} <= {*tags}
            assert len(set(tags)) == len(tags)
            assert np.isfinite([float(element.findtext(t)) for t in SDF_NUMBERS[element.tag]]).all()
        if element.tag in SDF_PARTS:
            assert {part.tag for part in element} <= SDF_PARTS[element.tag]


def test_numbers_are_those_of_the_refit_where_a_cause_is_named():
    """0.0522 alone, 0.0500 fitted with what acts: the latter, and that it is, in every format."""
    refit = LawNumber(unit="1", before=interval(0.0522, 5e-4), after=interval(0.05, 5e-4))
    law = {"c1[small]": refit}
    fit = read_json(FitFile, reference_folder() / "fit.json")
    alone = fit.pulleys["small"]["c1"].model_copy(update={"mean": 0.0522})
    fit = fit.model_copy(update={"pulleys": {"small": {"c1": alone}}, "parameters": {}})
    named = diagnosis(causes=(cause("viscous"),), law=law)
    numbers = numbers_of(fit, named)
    assert numbers["c1[small]"].value.mean == 0.05
    assert numbers_of(fit, diagnosis(causes=(), law=law))["c1[small]"].value.mean == 0.0522
    refitted_law = axis_law(numbers=numbers, said=law_said(fit, named), causes=named.causes)
    for to in FORMATS:
        text = export_text(refitted_law, to)
        assert "refitted with what diagnosis.json names: viscous" in text
        assert "0.0522" not in text


def test_points_without_a_load_have_the_constant_of_the_refit(stored):
    """8 N·m and 3 N·m s/rad: alone the constant takes up a part of the second, 11 N·m in all."""
    law = read_law(stored.folder)
    constant = law.numbers["c2"].value
    assert constant == read_json(DiagnosisFile, stored.folder / "diagnosis.json").law["c2"].after
    assert abs(constant.mean - 8.0) < 4 * constant.sd
    assert read_json(FitFile, stored.folder / "fit.json").parameters["c2"].mean > 10
    assert "does not tell" not in law.said


@pytest.mark.nightly
def test_a_joint_comes_back_with_the_numbers_of_the_refit(tmp_path):
    """A simulated axis that a spring holds: the law alone takes part of the spring for mass."""
    recording = bf.simulate_recording("axis", seed=5, effects={"spring": 2.0})
    bf.fit(recording, SHORT).write(tmp_path)
    bf.diagnose(recording, SHORT).write(tmp_path)
    refit = read_json(DiagnosisFile, tmp_path / "diagnosis.json")
    assert [cause.effect for cause in refit.causes] == ["spring"]
    law = read_law(tmp_path)
    mass = law.numbers["mass"].value
    assert mass == refit.law["mass"].after
    assert abs(mass.mean - 2.0) < 3 * mass.sd
    assert np.mean(law.draws["mass"]) == pytest.approx(mass.mean, abs=mass.sd / 3)
    written = ElementTree.fromstring(export_text(law, "mjcf"))
    shown = written.find("worldbody/body/inertial").get("mass")
    assert float(shown) == pytest.approx(mass.mean, abs=0.05 * mass.sd)
    assert len(shown) <= 8


def test_the_python_file_is_the_law_and_stands_alone(stored):
    space: dict = {}
    text = export_text(read_law(stored.folder), "python")
    assert "bayesfric" not in text.split('"""')[2]
    exec(text, space)
    assert space["friction"](SPEEDS) == pytest.approx(8 + 3 * SPEEDS, rel=0.01)


def test_the_urdf_says_the_same(stored):
    law = read_law(stored.folder)
    dynamics = ElementTree.fromstring(export_text(law, "urdf")).find("joint/dynamics")
    friction = joint_friction(law)
    for name, value, error in (
        ("friction", friction.frictionloss, friction.frictionloss_sd),
        ("damping", friction.damping, friction.damping_sd),
    ):
        assert float(dynamics.get(name)) == pytest.approx(value, abs=0.05 * error)
        assert 1e-4 < error / value < 0.05


def test_json_has_draws_of_the_posterior_in_step(stored):
    record = json.loads(export_text(read_law(stored.folder), "json"))
    draws = np.array(record["draws"]["c2"])
    assert {len(values) for values in record["draws"].values()} == {len(draws)}
    assert len(draws) >= 200
    assert draws.mean() == pytest.approx(record["coefficients"][""]["c2"], rel=0.01)


def test_what_is_missing_is_told_and_nothing_written(tmp_path):
    done = CliRunner().invoke(app, ["export", str(tmp_path), "--to", "mjcf"])
    assert done.exit_code == 2
    assert "bayesfric diagnose" in done.output
    assert not (tmp_path / "law.xml").exists()
    assert CliRunner().invoke(app, ["export", str(tmp_path), "--to", "usd"]).exit_code == 2
