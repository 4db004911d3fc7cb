"""The bundled log that runs, from import to export, against the truth beside it."""

import json
import shutil
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.errors import InputError
from bayesfric.logs import import_log, propose_mapping
from bayesfric.logs.mapping_file import read_mapping
from bayesfric.physics.laws import BASELINES, COULOMB_VISCOUS
from bayesfric.recording import read_recording, write_recording
from bayesfric.recording.joints import parted_by_joint
from bayesfric.resources import data_folder
from bayesfric.results import read_json
from bayesfric.rigs.single_axis import RIG
from bayesfric.schemas import DiagnosisFile

pytestmark = pytest.mark.usefixtures("lengths_not_searched")
mujoco = pytest.importorskip("mujoco")
ARM = data_folder() / "logs" / "two-joint-arm"
TRUTH = json.loads((ARM / "truth.json").read_text("utf-8"))
FIELDS = {"coulomb": "frictionloss", "viscous": "damping", "armature": "armature"}


def true(joint, parameter):
    value = TRUTH[joint][FIELDS[parameter]]
    return value[0] if isinstance(value, list) else value


@pytest.fixture(scope="module")
def recording():
    return import_log(ARM / "log.csv", "all", mapping=ARM / "mapping.toml", name="arm").recording


def test_the_log_and_its_model_are_one_recording(recording, tmp_path):
    write_recording(recording, tmp_path / "arm")
    again = read_recording(tmp_path / "arm")
    assert again.rig.robot.joints == {"shoulder": "shoulder", "elbow": "elbow"}
    assert again.rig.robot.content == (ARM / "arm.xml").read_bytes()
    assert len(again.axis.samples) == 2 * 6000
    assert sum(file.stat().st_size for file in ARM.iterdir()) < 400_000


@pytest.mark.parametrize("joint", list(TRUTH))
def test_its_truth_comes_back_roughly_by_least_squares(recording, joint):
    rough = RIG.trials(parted_by_joint(recording)[joint]).under(BASELINES[COULOMB_VISCOUS])._rough
    assert rough.coulomb == pytest.approx(true(joint, "coulomb"), rel=0.02)
    assert rough.viscous == pytest.approx(true(joint, "viscous"), rel=0.03)
    assert rough.mass == pytest.approx(true(joint, "armature"), rel=0.1)


def test_a_proposal_has_a_place_for_a_model(tmp_path):
    """What is commented out is right once its signs of a comment are gone."""
    proposal = propose_mapping(ARM / "log.csv").toml
    body, own = proposal.split("# [robot]\n")
    own = "\n".join(line.removeprefix("# ") for line in own.splitlines())
    filled = body.replace('force_is = "SAY"', 'force_is = "motor"').replace('"SAY"', '"N·m"')
    (tmp_path / "map.toml").write_text(f"{filled}[robot]\n{own}", encoding="utf-8")
    robot = read_mapping(tmp_path / "map.toml").robot
    assert robot.model == "robot.xml"
    assert robot.joints == dict.fromkeys(("shoulder", "elbow"), "its name there")


@pytest.mark.nightly
def test_its_truth_lies_in_the_intervals_and_goes_into_the_model(recording, tmp_path):
    """Six numbers, nine tenths of which are expected in an interval of 90 %."""
    write_recording(recording, tmp_path / "arm")
    for arguments in (
        ["diagnose", tmp_path / "arm", "-o", tmp_path / "out"],
        ["export", tmp_path / "out", "--to", "mjcf", "--into", ARM / "arm.xml", "--draws", 50],
    ):
        done = CliRunner().invoke(app, [*map(str, arguments)])
        assert done.exit_code == 0, done.output
    inside = []
    for block in read_json(DiagnosisFile, tmp_path / "out" / "diagnosis.json").joints:
        assert block.verdict == "no-gap"
        entered = {number.parameter: number.value for number in block.enter}
        entered |= {"armature": entered.get("armature", entered.get("inertia"))}
        inside += [
            entered[name].q05 <= true(block.joint, name) <= entered[name].q95 for name in FIELDS
        ]
    assert sum(inside) >= 5
    compiled = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "arm.xml"))
    friction = [TRUTH[joint]["frictionloss"] for joint in TRUTH]
    assert compiled.dof_frictionloss == pytest.approx(friction, rel=0.01)


@pytest.mark.nightly
def test_the_script_makes_the_log_again(tmp_path):
    """To the noise of an encoder: versions of MuJoCo differ in their last digits."""
    for name in ("arm.xml", "make.py"):
        shutil.copy(ARM / name, tmp_path / name)
    subprocess.run([sys.executable, tmp_path / "make.py"], check=True)
    made, bundled = (pd.read_csv(folder / "log.csv") for folder in (tmp_path, ARM))
    assert list(made) == list(bundled)
    assert np.abs(made.iloc[:1000, 1:3] - bundled.iloc[:1000, 1:3]).to_numpy().max() < 1e-4
    assert json.loads((tmp_path / "truth.json").read_text()) == TRUTH


@pytest.mark.parametrize(
    ("robot", "said"),
    [
        ('model = "none.xml"', "none.xml"),
        ('model = "../arm.xml"', "a file in the folder of the mapping"),
        (
            'model = "arm.xml"\njoints = {elbow = "knee"}',
            "the mapping, robot.joints.elbow: found 'knee', expected a joint of arm.xml (shoulder, "
            'elbow): under [robot], joints = {elbow = "its name there"}',
        ),
        ('modell = "arm.xml"', "model"),
    ],
)
def test_a_model_that_cannot_be_taken_along_is_one_clear_line(tmp_path, robot, said):
    for name in ("log.csv", "arm.xml"):
        shutil.copy(ARM / name, tmp_path / name)
    mapping = (ARM / "mapping.toml").read_text("utf-8").split("[robot]")[0]
    (tmp_path / "map.toml").write_text(f"{mapping}[robot]\n{robot}\n", encoding="utf-8")
    with pytest.raises(InputError) as raised:
        import_log(tmp_path / "log.csv", "all", mapping=tmp_path / "map.toml")
    assert said in str(raised.value)


def test_a_log_of_one_joint_and_a_model_of_one_need_no_name(tmp_path):
    rows = "".join(f"{k / 100},{k % 50 / 50},{k % 7 / 7}\n" for k in range(200))
    (tmp_path / "bench.csv").write_text(f"t,q,tau\n{rows}", encoding="utf-8")
    model = '<mujoco><worldbody><body><joint name="pivot"/></body></worldbody></mujoco>'
    (tmp_path / "robot.xml").write_text(model, encoding="utf-8")
    mapping = (
        '[time]\ncolumn = "t"\n[position]\ncolumn = "q"\nunit = "rad"\n'
        '[force]\ncolumn = "tau"\nunit = "N·m"\nforce_is = "motor"\n[robot]\nmodel = "robot.xml"\n'
    )
    (tmp_path / "map.toml").write_text(mapping, encoding="utf-8")
    made = import_log(tmp_path / "bench.csv", mapping=tmp_path / "map.toml").recording
    assert made.rig.robot.joints == {"joint": "pivot"}
