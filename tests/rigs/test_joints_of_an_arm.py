"""An arm of three joints whose truth is known: each joint's friction beside what moves it."""

from dataclasses import replace
from itertools import product

import numpy as np
import pandas as pd
import pytest
from rigs import arm
from scipy.signal import savgol_filter

from bayesfric.diagnosis import diagnose
from bayesfric.physics.laws import BASELINES
from bayesfric.recording.joints import joints_of, parted_by_joint
from bayesfric.rigs.single_axis import RIG
from bayesfric.rigs.single_axis.other_joints import machine_of
from bayesfric.rigs.single_axis.period import strongest_wave
from bayesfric.rigs.single_axis.simulated import log_of

pytest.importorskip("mujoco")
HEAVY = tuple(1.1 * mass for mass in arm.MASSES)
TRUTH = dict(
    zip(arm.JOINTS, zip(arm.ARMATURE, arm.FRICTIONLOSS, arm.DAMPING, strict=True), strict=True)
)


def runs_of(recording, joint):
    return RIG.trials(parted_by_joint(recording)[joint]).under(BASELINES["coulomb-viscous"])


@pytest.fixture(scope="module")
def heavy():
    """The arm beside a model whose every mass is 10 % too large."""
    set_up = {"frictionloss": 0.7, "damping": 0.4, "armature": 0.05}
    return diagnose(
        arm.recording(model_of=arm.robot(HEAVY, joints=[set_up] * 3)), baseline="viscous"
    ).summary


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_log_is_parted_with_the_motion_of_all_other_joints():
    recording = arm.recording()
    parted = parted_by_joint(recording)
    assert joints_of(recording.axis) == tuple(parted) == arm.JOINTS
    for place, (joint, own) in enumerate(parted.items()):
        assert set(own.axis.samples["joint"]) == {joint}
        assert set(own.axis.others) == set(arm.JOINTS) - {joint}
        assert own.axis.place == place
    assert parted_by_joint(parted["base"]) == {}


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_pull_of_other_joints_is_no_slow_wave_along_this_one():
    """Without a model two waves over the stroke of an elbow are what the base and it pull with."""
    rows = runs_of(arm.recording(), "elbow")
    stroke = np.ptp(rows.readings.position)
    assert stroke / strongest_wave(rows.readings).period < 3
    assert stroke / rows.measures.wave.period > 4.99


KINDS = ("model", "model that is off", "known force")
BY_DAY = [*zip(KINDS, arm.JOINTS, strict=True)]
BY_NIGHT = [pair for pair in product(KINDS, arm.JOINTS) if pair not in BY_DAY]


@pytest.mark.usefixtures("lengths_not_searched")
@pytest.mark.parametrize(
    ("kind", "joint"), [*BY_DAY, *(pytest.param(*p, marks=pytest.mark.nightly) for p in BY_NIGHT)]
)
def test_friction_and_armature_come_back_beside_what_is_known(kind, joint):
    given = {
        "model": {"model_of": arm.robot()},
        "model that is off": {"model_of": arm.robot(HEAVY)},
        "known force": {"known": True},
    }[kind]
    rough = runs_of(arm.recording(**given), joint)._rough
    armature, coulomb, viscous = TRUTH[joint]
    assert rough.coulomb == pytest.approx(coulomb, rel=0.02)
    assert rough.viscous == pytest.approx(viscous, rel=0.02)
    assert rough.mass == pytest.approx(armature, rel=0.1)


@pytest.mark.usefixtures("lengths_not_searched")
def test_inertia_is_told_beside_joints_that_are_logged_without_a_model():
    """Gravity may take all of the force, and what moves no more than gravity and friction leave."""
    import mujoco

    compiled = mujoco.MjModel.from_xml_string(arm.model(arm.MASSES))
    reach = float(compiled.body_ipos[3] @ compiled.body_ipos[3])
    of_link = compiled.body_inertia[3].max() + arm.MASSES[2] * reach
    rough = runs_of(arm.recording(), "elbow")._rough
    assert rough.mass == pytest.approx(arm.ARMATURE[2] + of_link, rel=0.1)
    assert rough.coulomb == pytest.approx(arm.FRICTIONLOSS[2], rel=0.02)


@pytest.mark.usefixtures("lengths_not_searched")
def test_counts_in_a_controllers_damping_make_no_delay():
    """The force answers each count; where it acts at once it does not act later."""
    rows = runs_of(arm.recording(), "base").readings
    speed = rows.speed @ rows.weights
    law = [rows.force_rate, rows.acceleration, np.ones(rows.count), speed, rows.way]
    columns = np.column_stack([*law, rows.beside])
    shrunk = 0.003 * np.eye(columns.shape[1])[len(law) :]  # an error over amounts of N(0, 1)
    goal = np.append(rows.force, np.zeros(len(shrunk)))
    late_s, *_ = np.linalg.lstsq(np.vstack([columns, shrunk]), goal, rcond=1e-12)[0]
    assert abs(late_s) < 5e-4


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_known_force_of_one_joint_is_taken_off_its_drive_force():
    """Without it a pendulum's joint has the weight of its arm in its force."""
    known, unknown = (arm.recording(known=known, only="elbow") for known in (True, False))
    rows, whole = (
        RIG.trials(one).under(BASELINES["coulomb-viscous"]).readings for one in (known, unknown)
    )
    friction = arm.FRICTIONLOSS[2] + arm.DAMPING[2] * (rows.speed @ rows.weights)
    left = rows.force - friction - arm.ARMATURE[2] * rows.acceleration
    assert np.sqrt(np.mean(left**2)) < 0.02 * np.sqrt(np.mean(rows.force**2))
    assert np.sqrt(np.mean(whole.force**2)) > 1.2 * np.sqrt(np.mean(rows.force**2))


LOADED = 0.12  # of what the gear carries, that it rubs more


def rubbing_by_load(**given):
    """Return a log whose gears rub by their load: what the motion takes, they take more.

    The path is what it is, so that the force may have what moves along it takes besides.
    """
    recording = arm.recording(**given)
    samples = recording.axis.samples.copy()
    carried = arm.torque_of_model() + np.array(arm.ARMATURE) * accelerations()
    way = np.sign(np.gradient(arm.log_of_arm(1)[:, 1:4], axis=0))
    for place, joint in enumerate(arm.JOINTS):
        mine = samples["joint"] == joint
        samples.loc[mine, "force_n"] += (LOADED * np.abs(carried) * way)[:, place]
    return replace(recording, axis=replace(recording.axis, samples=samples))


def accelerations():
    place = arm.log_of_arm(1)[:, 1:4]
    return savgol_filter(place, 21, 3, deriv=2, delta=1 / arm.RATE_HZ, axis=0)


@pytest.mark.nightly
@pytest.mark.parametrize("given", [{"model_of": arm.robot()}, {"known": True}, {}])
@pytest.mark.parametrize("joint", ["shoulder", "elbow"])
def test_a_gear_carries_what_is_known_beside_what_the_rows_tell(given, joint):
    """With a model, with what it says computed elsewhere, or with logged joints alone."""
    runs = runs_of(rubbing_by_load(**given), joint)
    place = arm.JOINTS.index(joint)
    whole = arm.torque_of_model()[:, place] + arm.ARMATURE[place] * accelerations()[:, place]
    time = arm.log_of_arm(1)[:, 0]
    held, moved = runs.measures.carried.at(runs.readings, runs.table)
    found = (held + moved) @ runs.readings.weights
    exact = np.interp(runs.readings.time_s, time, whole)
    size = np.sqrt(np.mean(exact**2))
    assert np.sqrt(np.mean((found - exact) ** 2)) < 0.05 * size
    assert "load-both-ways" in runs.offers


@pytest.mark.nightly
@pytest.mark.parametrize("given", [{"model_of": arm.robot()}, {"known": True}])
def test_friction_by_the_load_is_named_beside_a_model(given):
    recording = parted_by_joint(rubbing_by_load(**given))["shoulder"]
    found = diagnose(recording).summary
    (cause,) = found.causes
    assert cause.effect == "load-friction"
    assert cause.parameters["share"].mean == pytest.approx(LOADED, rel=0.05)
    assert found.law["coulomb"].after.mean == pytest.approx(arm.FRICTIONLOSS[1], rel=0.05)


@pytest.mark.nightly
def test_errors_of_the_model_come_back_and_are_told(heavy):
    """A tenth of every mass: of the last link its moment and inertia are told, each within 2 %."""
    lower = {one.number: one for one in heavy.model_error if one.link == "lower"}
    for number in ("hx", "iyy"):
        off = lower[number].error
        assert off.mean == pytest.approx(-lower[number].in_your_model / 11, rel=0.02)
        assert lower[number].significant
    assert "hx of lower" in heavy.sentence
    told = {(one.link, one.number) for one in heavy.model_error if one.significant}
    assert {link for link, _ in told} <= {"upper", "lower"}


@pytest.mark.nightly
def test_a_diagnosis_of_all_joints_says_what_to_enter_in_each(heavy):
    assert [one.joint for one in heavy.joints] == list(arm.JOINTS)
    for one in heavy.joints:
        armature, coulomb, viscous = TRUTH[one.joint]
        assert one.verdict == "no-gap"
        assert not one.causes
        enter = {number.parameter: number for number in one.enter}
        for name, truth, has in (
            ("armature", armature, 0.05),
            ("coulomb", coulomb, 0.7),
            ("viscous", viscous, 0.4),
        ):
            assert enter[name].in_your_simulator == pytest.approx(has)
            assert abs(enter[name].value.mean - truth) < max(3 * enter[name].value.sd, 0.02 * truth)
    assert heavy.verdict == "no-gap"
    assert all(check.holds for one in heavy.joints for check in one.checks)


@pytest.mark.nightly
@pytest.mark.parametrize("joint", arm.JOINTS)
def test_logged_joints_without_a_model_make_no_cause(joint):
    found = diagnose(parted_by_joint(arm.recording())[joint]).summary
    assert not found.causes, found.sentence
    assert found.other_joints == "logged"
    _, coulomb, viscous = TRUTH[joint]
    assert found.law["coulomb"].after.mean == pytest.approx(coulomb, rel=0.01)
    assert found.law["viscous"].after.mean == pytest.approx(viscous, rel=0.05)


@pytest.mark.nightly
@pytest.mark.parametrize("joint", ["base", "shoulder"])
def test_a_joint_alone_names_no_cause_where_others_moved(joint):
    recording = arm.recording(only=joint, other_joints="moving")
    found = diagnose(recording, baseline="viscous").summary
    assert found.other_joints == "moving"
    wrong = {cause.effect for cause in found.causes}
    assert not wrong, found.sentence
    if found.considered:
        assert found.verdict == "unknown"


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_joint_that_lacks_a_run_of_another_does_not_enter():
    recording = arm.recording()
    samples = recording.axis.samples
    kept = samples[(samples["joint"] != "base") | (samples["time_s"] < 0.01)]
    recording = replace(recording, axis=replace(recording.axis, samples=kept))
    assert RIG.trials(parted_by_joint(recording)["elbow"]) is None


@pytest.mark.usefixtures("lengths_not_searched")
def test_an_amount_is_one_force_whatever_run_it_is_of():
    """Other joints may rest in a run, and drives give less in one: the columns are the same."""
    recording = arm.recording()
    samples = recording.axis.samples
    again = samples.assign(run="b", force_n=0.1 * samples["force_n"])
    still = again["joint"] != "shoulder"
    again.loc[still, "position_m"] = again[still].groupby("joint")["position_m"].transform("first")
    runs = pd.DataFrame({"run": ["a", "b"]})
    both = replace(recording.axis, runs=runs, samples=pd.concat([samples, again]))
    own = parted_by_joint(replace(recording, axis=both))["shoulder"]
    machine = machine_of(own.axis, own.rig)
    first, second = (
        machine.around(log_of(part.reset_index(drop=True), own.rig), run)
        for run, part in own.axis.samples.groupby("run", sort=False)
    )
    assert len(first.beside) == len(second.beside) > 20
    alone = samples[samples["joint"] == "shoulder"]["position_m"].to_numpy()
    resting = [one.value for one in second.beside if np.ptp(one.value) > 0]
    size = np.sqrt(np.mean(np.concatenate([log.force for log in (first, second)]) ** 2))
    closest = min(np.abs(one - size * np.cos(alone)).max() for one in resting)
    assert closest < 0.02 * size


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_known_force_may_be_wrong_by_as_much_as_is_stated():
    """Of one joint: by a share of itself, which then is no friction and no other pull."""
    wrong = arm.recording(known=True, only="elbow", known_force_sd=0.3)
    samples = wrong.axis.samples.copy()
    samples["known_force_n"] *= 0.8
    rough = {}
    for stated in (True, False):
        rig = wrong.rig if stated else replace(wrong.rig, known_force_sd=None)
        recording = replace(wrong, rig=rig, axis=replace(wrong.axis, samples=samples))
        rough[stated] = RIG.trials(recording)._rough
    assert rough[True].mass == pytest.approx(arm.ARMATURE[2], rel=0.1)
    assert rough[True].coulomb == pytest.approx(arm.FRICTIONLOSS[2], rel=0.02)
    assert rough[False].mass > 1.15 * arm.ARMATURE[2]
