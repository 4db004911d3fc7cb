"""The law for other simulators: read back by them, it is the diagnosed one to the stated error."""

import json
from types import SimpleNamespace
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
from rigs.friction_points import joint, recorded
from typer.testing import CliRunner

import bayesfric as bf
from bayesfric.analysis import Analysis, Sampler
from bayesfric.cli import app
from bayesfric.export import export_text, read_law
from bayesfric.export.joint_friction import joint_friction
from bayesfric.export.stored_law import StoredLaw

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
    found = joint_friction(read_law(stored.folder))
    assert found.frictionloss == pytest.approx(8, rel=0.01)
    assert found.damping == pytest.approx(3, rel=0.02)
    assert found.error_max < 0.001 * found.friction_rms


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


def test_mujoco_moves_an_axis_as_its_law_does():
    """A mass of 2 kg, 1.5 N and 0.8 N s/m under 4 N: what the law would be, by a closed form."""
    speed = np.linspace(0.05, 0.6, 40)
    places = {"velocity": speed}
    law = StoredLaw(
        "axis", "paper", "N", {}, {"mass": [1.9, 2.1]}, (), places, 1.5 + 0.8 * speed, 0.01
    )
    model = mujoco.MjModel.from_xml_string(export_text(law, "mjcf"))
    assert model.jnt_type[0] == mujoco.mjtJoint.mjJNT_SLIDE
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = 4.0
    while data.time < 0.5:
        mujoco.mj_step(model, data)
    expected = (4.0 - 1.5) / 0.8 * -np.expm1(-0.8 / 2.0 * data.time)
    assert data.qvel[0] == pytest.approx(expected, rel=2e-3)
    assert "placeholder" not in export_text(law, "mjcf")


def test_the_python_file_is_the_law_and_stands_alone(stored):
    space: dict = {}
    text = export_text(read_law(stored.folder), "python")
    assert "bayesfric" not in text.split('"""')[2]
    exec(text, space)
    assert space["friction"](SPEEDS) == pytest.approx(8 + 3 * SPEEDS, rel=0.01)


def test_the_urdf_says_the_same(stored):
    law = read_law(stored.folder)
    dynamics = ElementTree.fromstring(export_text(law, "urdf")).find("joint/dynamics")
    assert float(dynamics.get("friction")) == pytest.approx(joint_friction(law).frictionloss)
    assert float(dynamics.get("damping")) == pytest.approx(joint_friction(law).damping)


def test_json_has_draws_of_the_posterior_in_step(stored):
    record = json.loads(export_text(read_law(stored.folder), "json"))
    draws = np.array(record["draws"]["c2"])
    assert len(draws) == len(record["draws"]["tau_steady-points"]) == 200
    assert draws.mean() == pytest.approx(record["coefficients"][""]["c2"], rel=0.01)


def test_what_is_missing_is_told_and_nothing_written(tmp_path):
    found = CliRunner().invoke(app, ["export", str(tmp_path), "--to", "mjcf"])
    assert found.exit_code == 2
    assert "bayesfric fit" in found.output
    assert not (tmp_path / "law.xml").exists()
    assert CliRunner().invoke(app, ["export", str(tmp_path), "--to", "sdf"]).exit_code == 2
