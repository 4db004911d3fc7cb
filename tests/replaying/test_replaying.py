"""Replay in MuJoCo: better values are promoted, and right ones are left where they are."""

import numpy as np
import pandas as pd
import pytest
from export.hinge import Hinge, drawn_hinge, recording
from typer.testing import CliRunner

import bayesfric as bf
from bayesfric.cli import app
from bayesfric.export.joints import ExportedJoint
from bayesfric.recording import write_recording
from bayesfric.recording.tables import Robot
from bayesfric.replaying import _pieces, _proposed, held_out_parts, replay, with_replay
from bayesfric.results import read_json
from bayesfric.robots import JointSettings, RigidBodies, robot_of_bytes
from bayesfric.robots.replaying import Motion, inverse_torques, replayed
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.diagnosis import Enter

mujoco = pytest.importorskip("mujoco")
TRUTH = Hinge()
WRONG = Hinge(frictionloss=0.2, damping=0.05, armature=0.01)


def hinge_with(values):
    """Return a joint with values to enter."""
    numbers = {
        name: Enter(
            parameter=name,
            unit="1",
            value=Interval(mean=mean, sd=0.01, q05=mean, q50=mean, q95=mean),
            fields={},
        )
        for name, mean in values.items()
    }
    return ExportedJoint("", "hinge", True, numbers, {})


def proposing(hinge):
    """Return a joint with the numbers of a hinge to enter."""
    values = {"coulomb": hinge.frictionloss, "viscous": hinge.damping, "armature": hinge.armature}
    return hinge_with(values)


def replayed_hinge(model, proposed):
    """Return the replay of 30 s of the true hinge beside a model, with proposed values."""
    log = recording(TRUTH, 5, own=model, seconds=30.0)
    return replay(log, "all of it", [proposing(proposed)], 1).joints[""]


@pytest.fixture(scope="module")
def better():
    return replayed_hinge(WRONG, TRUTH)


def test_right_values_in_the_place_of_wrong_ones_are_promoted(better):
    """A fiftieth is left: noise, and that friction of MuJoCo's default gives way at low speed."""
    assert better.promoted
    assert better.torque.as_is > 0.1
    assert better.torque.proposed < 0.1 * better.torque.as_is
    assert better.torque.difference.q95 < -0.1
    assert better.torque.difference.q50 == pytest.approx(
        better.torque.proposed - better.torque.as_is, abs=0.01
    )
    assert better.trajectory.proposed < 0.2 * better.trajectory.as_is
    assert better.sentence.startswith("Promoted: the proposed values are better; the torque error")


def test_values_that_are_hardly_others_are_not_promoted():
    near = Hinge(TRUTH.frictionloss * 1.002, TRUTH.damping * 0.998, TRUTH.armature * 1.01)
    replayed_log = replayed_hinge(TRUTH, near)
    assert not replayed_log.promoted
    assert "Not promoted: the 90 % interval does not show" in replayed_log.sentence


def test_wrong_values_in_the_place_of_right_ones_are_not_promoted():
    replayed_log = replayed_hinge(TRUTH, WRONG)
    assert not replayed_log.promoted
    assert replayed_log.torque.difference.q05 > 0.1


def test_torques_are_those_of_the_law():
    """A rod that swings about level: weight, inertia of rod and rotor, and friction."""
    robot = robot_of_bytes("one.xml", WRONG.model().encode(), {"swing": "hinge"})
    q, v, a = (np.array([[0.0], [0.0]]), np.array([[1.0], [-2.0]]), np.array([[3.0], [0.0]]))
    motion = Motion(0.004, q, v, a, np.zeros((2, 1)))
    joint = JointSettings(0.6, 0.05, (0.3, 0.02, 0.0))
    torques = inverse_torques(robot, [joint], motion)
    inertia = mujoco.MjModel.from_xml_string(WRONG.model()).body_inertia[1][1] + 1.2 * 0.15**2
    weight = -1.2 * 9.81 * 0.15
    expected = [
        (inertia + 0.05) * 3 + 0.3 + 0.02 + 0.6 + weight,
        -(0.3 * 2 + 0.02 * 4 + 0.6) + weight,
    ]
    assert torques[:, 0] == pytest.approx(expected, rel=0.01)


def test_stops_and_contacts_of_the_model_do_not_act():
    """A rod beyond its stop and inside another shape: torques and paths are the law's."""
    stopped = WRONG.model('range="-0.1 0.1" limited="true"').replace(
        "</worldbody>", '<body><geom size="0.2" pos="0.3 0 0"/></body></worldbody>'
    )
    free, held = (
        robot_of_bytes("one.xml", text.encode(), {"swing": "hinge"})
        for text in (WRONG.model(), stopped)
    )
    q, v, a = np.full((12, 1), 0.4), np.full((12, 1), 1.0), np.full((12, 1), 2.0)
    motion = Motion(0.004, q, v, a, np.full((12, 1), 3.0))
    joint = JointSettings(0.6, 0.05)
    computed, expected = (inverse_torques(robot, [joint], motion) for robot in (held, free))
    assert computed == pytest.approx(expected, rel=1e-9)
    computed, expected = (replayed(robot, [joint], motion, [0], 10) for robot in (held, free))
    assert computed == pytest.approx(expected, rel=1e-9)


def test_a_spring_pulls_to_where_it_is_at_rest():
    """Of the model and of a proposal: 4 N·m/rad, 0.5 rad from its rest at 0.2 rad."""
    sprung = WRONG.model('stiffness="4" springref="0.2"')
    robot = robot_of_bytes("one.xml", sprung.encode(), {"swing": "hinge"})
    (own,) = robot.settings
    assert (own.stiffness, own.spring_rest) == (4.0, 0.2)
    still = np.zeros((1, 1))
    motion = Motion(0.004, still + 0.7, still, still, still)
    loose = JointSettings(0.0, 0.05)
    for rest in (own.spring_rest, -0.3):
        held = JointSettings(0.0, 0.05, stiffness=4.0, spring_rest=rest)
        pulls = inverse_torques(robot, [held], motion) - inverse_torques(robot, [loose], motion)
        assert pulls == pytest.approx(4.0 * (0.7 - rest), rel=1e-6)
    spring = hinge_with({"spring.stiffness": 3.0, "spring.rest": -0.25})
    proposed = _proposed(spring, own)
    assert (proposed.stiffness, proposed.spring_rest) == (3.0, -0.25)


def test_a_run_without_one_of_the_joints_is_not_replayed():
    """Else the other joint's positions would stand for those of the one that is lacking."""
    two = WRONG.model().replace(
        "</body>",
        """<body name="tip" pos="0.3 0 0">
    <joint name="tip" axis="0 1 0"/><geom size="0.02" mass="0.1"/></body></body>""",
    )
    robot = robot_of_bytes("one.xml", two.encode(), {"swing": "hinge", "nod": "tip"})
    log = recording(TRUTH, 5, own=WRONG, seconds=12.0)
    swing = log.axis.samples.assign(joint="swing")
    nod = swing.assign(joint="nod", position_m=0.0, force_n=0.0)
    runs = pd.DataFrame({"run": ["a", "b"]})
    samples = pd.concat([swing, nod, swing.assign(run="b")], ignore_index=True)
    pieces = _pieces(with_tables(log, runs, samples), robot)
    assert len(pieces) == 1
    assert not pieces[0].motion.position[:, 1].any()


def test_a_drive_carries_the_weight_that_a_program_compensates():
    """In a replay as in a diagnosis: the log's force has the compensation in it."""
    text = WRONG.model().replace('<body name="rod">', '<body name="rod" gravcomp="1">')
    robot = robot_of_bytes("one.xml", text.encode(), {"swing": "hinge"})
    still = np.zeros((1, 1))
    motion = Motion(0.004, still, still, still, still)
    torque = inverse_torques(robot, [JointSettings(0.0, 0.05)], motion)
    assert torque == pytest.approx(-1.2 * 9.81 * 0.15, rel=1e-6)
    assert RigidBodies(robot).momentum_and_pull(still, still)[1] == pytest.approx(-torque)


def test_a_window_follows_the_closed_form():
    """Without gravity: friction and a constant torque on rod and rotor."""
    model = WRONG.model().replace("<option ", '<option gravity="0 0 0" ')
    robot = robot_of_bytes("one.xml", model.encode(), {"swing": "hinge"})
    still = np.zeros((60, 1))
    motion = Motion(0.005, still, still + 1.0, still, np.full((60, 1), 2.0))
    path = replayed(robot, [JointSettings(0.0, 0.05, (0.5, 0.0, 0.0))], motion, [0], 50)
    inertia = mujoco.MjModel.from_xml_string(model).body_inertia[1][1] + 1.2 * 0.15**2 + 0.05
    t, rate, top = 0.005 * np.arange(50), 0.5 / inertia, 2.0 / 0.5
    expected = top * t + (1.0 - top) * (1 - np.exp(-rate * t)) / rate
    assert path[0, :, 0] == pytest.approx(expected, abs=2e-3)


def test_the_last_third_is_held_out_where_no_run_is_a_test():
    log = recording(TRUTH, 5, own=WRONG)
    seen, late, what = held_out_parts(log)
    assert what.startswith("the unseen last third")
    assert seen.axis.samples["time_s"].max() == pytest.approx(8.0, abs=0.01)
    assert late.axis.samples["time_s"].min() > 8.0 - 0.01
    assert len(seen.axis.samples) + len(late.axis.samples) == len(log.axis.samples)


def test_runs_of_role_test_are_held_out_where_there_are_any():
    log = recording(TRUTH, 5, own=WRONG)
    runs = pd.DataFrame({"run": ["a", "b"], "role": ["calibrate", "test"]})
    both = pd.concat([log.axis.samples, log.axis.samples.assign(run="b")], ignore_index=True)
    seen, late, what = held_out_parts(with_tables(log, runs, both))
    assert what == "the runs of role test"
    assert set(late.axis.samples["run"]) == {"b"}
    assert set(seen.axis.samples["run"]) == {"a", "b"}


def with_tables(log, runs, samples):
    axis = type(log.axis)(runs, samples)
    return type(log)(log.name, log.title, log.rig, axis=axis)


def test_what_cannot_be_replayed_is_one_clear_line(tmp_path):
    write_recording(recording(TRUTH, 5), tmp_path / "bare")
    done = CliRunner().invoke(
        app, ["diagnose", str(tmp_path / "bare"), "-o", str(tmp_path / "out"), "--replay"]
    )
    assert done.exit_code == 2
    assert "--replay: expected a robot's model (rig.robot)" in done.stderr
    short = recording(TRUTH, 5, own=WRONG, seconds=6.0)
    with pytest.raises(bf.InputError, match="at least 10 s of all joints"):
        replay(short, "it", [proposing(TRUTH)], 1)


def test_the_same_seed_gives_the_same_interval(better):
    assert replayed_hinge(WRONG, TRUTH) == better


@pytest.mark.nightly
@pytest.mark.parametrize("own", [WRONG, TRUTH], ids=["wrong", "right"])
def test_a_diagnosis_with_replay_says_whether_its_numbers_are_better(tmp_path, own):
    write_recording(recording(TRUTH, 5, own=own, seconds=36.0), tmp_path / "hinge")
    done = CliRunner().invoke(
        app, ["diagnose", str(tmp_path / "hinge"), "-o", str(tmp_path / "out"), "--replay"]
    )
    assert done.exit_code == 0, done.output
    stored = read_json(DiagnosisFile, tmp_path / "out" / "diagnosis.json")
    assert stored.replay.promoted == (own is WRONG)
    assert stored.replay.sentence in done.stdout


@pytest.mark.nightly
def test_of_twelve_hinges_those_with_wrong_values_are_promoted_and_no_other():
    for seed in range(12):
        truth = drawn_hinge(seed)
        own = truth if seed % 2 else WRONG
        log = recording(truth, seed, own=own, seconds=36.0)
        seen, late, what = held_out_parts(log)
        replayed_log = with_replay(bf.diagnose(seen), late, what, 1).summary.replay
        assert replayed_log.promoted == (own is WRONG), (seed, replayed_log.sentence)


def test_a_robot_is_named_by_its_own_joint():
    """A recording of one joint without a name takes the model's."""
    log = recording(TRUTH, 5, own=WRONG, seconds=30.0)
    assert isinstance(log.rig.robot, Robot)
    done = replay(log, "it", [proposing(TRUTH)], 1)
    assert list(done.joints) == [""]
    assert list(done.traces["joint"].to_numpy()) == ["swing"]
    off = {
        name: float(np.abs(done.traces[name] - done.traces["measured_n"]).median())
        for name in ("as_is_n", "proposed_n")
    }
    assert off["proposed_n"] < 0.1 * off["as_is_n"]
