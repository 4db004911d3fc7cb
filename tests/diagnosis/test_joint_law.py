"""A joint's law is what every simulator has, and what its friction does beside it is named.

Joints whose truth is known; their simulation shares nothing with the package.
"""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from rigs.joints import Joint, recording_of
from rigs.loaded_joints import LoadedJoint

import bayesfric as bf
from bayesfric.diagnosis import answer
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.errors import InputError
from bayesfric.rigs import all_rigs

AXIS = all_rigs()["single-axis"]
SMALL = {"runs": 2, "seconds": 12.0, "sampled_hz": 100.0}
SHORT = {"runs": 1, "seconds": 1.2, "sampled_hz": 250.0, "gravity": 0.0}


def causes_of(summary):
    return {cause.effect: cause for cause in summary.causes}


def test_inertia_friction_and_offset_are_the_law_and_no_cause():
    joint = LoadedJoint(**SMALL, gravity=0.0, offset=0.07, viscous=0.12)
    summary = bf.diagnose(joint.recording()).summary
    assert (summary.baseline, summary.verdict, summary.causes) == ("coulomb-viscous", "no-gap", ())
    truth = {"inertia": 0.06, "coulomb": 0.18, "viscous": 0.12, "offset": 0.07}
    units = {"inertia": "kg·m²", "coulomb": "N·m", "viscous": "N·m s/rad", "offset": "N·m"}
    assert {name: number.unit for name, number in summary.law.items()} == units
    for name, number in summary.law.items():
        for value in (number.before, number.after):
            assert value.mean == pytest.approx(truth[name], rel=0.02)
            assert abs(value.mean - truth[name]) < 4 * value.sd + 2e-3 * truth[name]
    left_out = {tested.effect: tested.needs for tested in summary.effects if tested.needs}
    assert "law-without-offset" in left_out["axis-bias"]
    assert "law-without-coulomb" in left_out["coulomb-missing"]
    assert [
        (absorption.effect, absorption.by)
        for absorption in summary.absorbed
        if absorption.effect == "viscous"
    ] == [("viscous", "viscous")]
    why = {tested.effect: tested.log10_bayes_factor_why for tested in summary.effects}
    assert "rig.other_joints" in why["coupling"]
    assert "model_error" in why["model-error"]
    assert "a mass that is declared" in why["torque-gain"]


@pytest.mark.parametrize(
    ("gravity", "noise", "seed"),
    [(1.0, 0.02, 1), pytest.param(0.5, 0.05, 2, marks=pytest.mark.nightly)],
)
def test_on_a_small_stroke_a_weight_is_no_spring(gravity, noise, seed):
    """On ± 0.25 rad the two differ by less than what is measured: it is said, or it is a weight."""
    joint = Joint(gravity=gravity, strokes_rad=(0.2, 0.05), noise=noise, resolution=1e-4, seed=seed)
    summary = bf.diagnose(joint.recording()).summary
    rivals = {name for group in summary.unseparated for name in group.effects}
    weighed = list(causes_of(summary)) == ["gravity-torque"]
    assert weighed or {"gravity-torque", "spring"} <= rivals
    assert summary.verdict in ("named", "unseparated")
    assert summary.law["inertia"].after.mean == pytest.approx(joint.inertia, rel=0.06)


def test_a_weight_on_a_long_swing_of_one_frequency_is_told_beside_the_inertia():
    """Its law is exact: one that may vary with speed took most of the inertia, 0.013 for 0.060."""
    joint = Joint(
        gravity=0.5, rates_hz=(0.31,), strokes_rad=(1.5,), noise=0.02, resolution=1e-4,
        sampled_hz=100.0,
    )  # fmt: skip
    diagnosed = bf.diagnose(joint.recording()).summary
    (cause,) = diagnosed.causes
    assert cause.parameters["torque"].mean == pytest.approx(0.5, rel=0.03)
    number = diagnosed.law["inertia"].after
    assert number.mean == pytest.approx(0.06, rel=0.05)
    assert number.q05 - number.sd < 0.06 < number.q95 + number.sd
    assert not any("do not separate inertia" in line for line in diagnosed.attention)


def test_every_place_of_a_weight_lies_within_the_angles_that_are_tried():
    """An encoder's zero is often where the link is level: a quarter turn from where it hangs."""
    angles = [candidate.shape for candidate in candidates_of(all_effects(None)["gravity-torque"])]
    assert min(angles) < -np.pi / 2
    assert max(angles) > np.pi / 2


@pytest.mark.nightly
def test_a_link_that_is_level_at_zero_has_a_weight_and_no_offset():
    joint = LoadedJoint(**SMALL, gravity=3.0, noise=0.002)
    recording = joint.recording()
    samples = recording.axis.samples
    level = samples.assign(position_m=samples["position_m"] + np.pi / 2)
    axis = replace(recording.axis, samples=level)
    summary = bf.diagnose(replace(recording, axis=axis)).summary
    (cause,) = summary.causes
    assert cause.effect == "gravity-torque"
    assert abs(cause.parameters["torque"].q50) == pytest.approx(3.0, rel=2e-3)
    assert abs(cause.parameters["angle"].q50) == pytest.approx(np.pi / 2, abs=3e-3)
    assert abs(summary.law["offset"].after.q50) < 0.005
    assert summary.law["viscous"].after.q50 == pytest.approx(joint.viscous, rel=0.03)


@pytest.mark.nightly
def test_a_drag_that_takes_more_than_friction_is_itself_and_no_stribeck_curve():
    """With a prior of a third of friction, a cube and a Stribeck curve took its place."""
    joint = Joint(gravity=0.0, drag=0.02, noise=0.02, seed=10)
    summary = bf.diagnose(joint.recording()).summary
    causes = causes_of(summary)
    assert list(causes) == ["air-drag"]
    assert causes["air-drag"].parameters["coefficient"].mean == pytest.approx(0.02, rel=0.1)
    assert summary.law["viscous"].after.mean == pytest.approx(joint.viscous, rel=0.15)


def test_an_inertia_that_data_have_below_zero_is_not_told_as_known():
    """Something beside the joint pulls it along as it accelerates, a hundred standard errors."""
    samples = Joint(inertia=-0.3, coulomb=0.2, gravity=0.0, seconds=12.0).samples()
    inertia = bf.diagnose(recording_of(samples, force_is="motor")).summary.law["inertia"]
    for number in (inertia.before, inertia.after):
        assert number.q05 > 0
        assert number.sd > 0.01
        assert number.q95 - number.q05 > 0.03


def test_a_motor_that_is_off_for_half_of_the_log_does_not_silence_the_rest():
    """Where nothing drives, the force is told without any error, and all could be zero there."""
    summary = bf.diagnose(recording_of(switched_off(), force_is="motor")).summary
    for name, truth in {"inertia": 0.06, "coulomb": 0.03, "viscous": 0.01}.items():
        assert summary.law[name].after.mean == pytest.approx(truth, rel=0.1)
    assert list(causes_of(summary)) == ["gravity-torque"]


def switched_off():
    """Return samples of a pendulum that is driven for 9 s and swings freely for 11 s more."""
    rng, step = np.random.default_rng(4), 2.5e-4
    time = step * np.arange(round(20 / step))
    drive = np.where(time < 9, 0.9 * np.sin(2 * np.pi * 0.37 * time) + 0.4 * np.sin(7 * time), 0.0)
    place = speed = 0.0
    places = np.empty(time.size)
    for at, push in enumerate(drive.tolist()):
        places[at] = place
        speed += step * (push - np.sin(place) - 0.01 * speed) / 0.06
        speed = np.sign(speed) * max(abs(speed) - step * 0.03 / 0.06, 0.0)
        place += step * speed
    logged = slice(None, None, 40)
    force = drive[logged] + np.where(drive != 0, 0.1, 0.0)[logged] * rng.standard_normal(2000)
    position = 1e-3 * np.round(places[logged] / 1e-3)
    return pd.DataFrame(
        {"run": "a", "time_s": time[logged], "position_m": position, "force_n": force}
    )


@pytest.mark.usefixtures("lengths_not_searched")
@pytest.mark.parametrize(
    ("baseline", "called", "lacks"),
    [
        ("paper", "coulomb-viscous", set()),
        ("viscous", "coulomb-viscous", set()),
        ("coulomb", "coulomb", {"viscous"}),
        ("none", "none", {"viscous", "coulomb-missing"}),
    ],
)
def test_a_law_that_says_less_leaves_an_effect_to_be_examined(baseline, called, lacks):
    from bayesfric.diagnosis.baseline import data_of

    data, law = data_of(LoadedJoint(**SMALL, gravity=0.0).recording(), baseline, None)
    assert law.name == called
    (rig,) = data.rigs
    names = [name for name, _ in rig.law_numbers("axis")]
    assert names == ["mass", "coulomb", "viscous"][: 3 - len(lacks)]
    missing = all_effects(None)["coulomb-missing"]
    assert (missing.needs <= rig.offers) == ("coulomb-missing" in lacks)


def test_a_law_of_cables_is_none_of_a_joint():
    with pytest.raises(InputError, match="inertia, Coulomb and viscous friction and an offset"):
        bf.diagnose(LoadedJoint(**SMALL).recording(), baseline="recursive")


def test_friction_that_grows_with_the_load_is_named_for_a_force_that_was_measured():
    """A measured force cannot saturate: of old it was lost beyond a limit below friction."""
    joint = LoadedJoint(**SMALL, load=0.15)
    summary = bf.diagnose(joint.recording()).summary
    named = causes_of(summary)
    assert set(named) == {"gravity-torque", "load-friction"}
    assert named["load-friction"].parameters["share"].mean == pytest.approx(0.15, rel=0.05)
    assert named["load-friction"].plausible
    assert summary.law["coulomb"].after.mean == pytest.approx(0.18, rel=0.03)
    assert "torque-saturation" in {tested.effect for tested in summary.effects if tested.needs}


@pytest.mark.nightly
def test_gravity_of_forty_times_friction_on_a_small_swing_is_itself():
    """On ± 20° a sine is nearly a line: no spring, and no tenth of the weight."""
    joint = LoadedJoint(**SMALL, gravity=8.0, stroke_rad=0.35, viscous=0.047)
    summary = bf.diagnose(joint.recording()).summary
    named = causes_of(summary)
    assert set(named) == {"gravity-torque"}
    assert named["gravity-torque"].parameters["torque"].mean == pytest.approx(8.0, rel=0.02)
    assert named["gravity-torque"].plausible
    assert summary.law["inertia"].after.mean == pytest.approx(0.06, rel=0.05)


@pytest.mark.nightly
def test_a_simulator_without_friction_lacks_coulomb_and_viscous_friction():
    joint = LoadedJoint(**SMALL)
    recording = joint.recording()
    samples = recording.axis.samples
    rigid = []
    for number in range(joint.runs):
        _, position, _, acceleration, _ = joint.run(number)
        rigid.append(joint.inertia * acceleration + joint.gravity * np.sin(position))
    samples = samples.assign(sim_force_n=np.concatenate(rigid))
    recording = recording_of(samples, recording.axis.runs, force_is="motor")
    summary = bf.diagnose(recording).summary
    named = causes_of(summary)
    assert set(named) == {"coulomb-missing", "viscous"}
    force = named["coulomb-missing"].parameters["force"]
    assert (force.mean, force.unit) == (pytest.approx(0.18, rel=0.05), "N·m")
    # Damping that is right for a geared joint is no fault: 0.28 of Coulomb friction at 1 rad/s.
    assert named["viscous"].plausible
    assert not any("plausible" in line for line in summary.attention)


def test_what_is_declared_is_held_and_what_contradicts_it_comes_first():
    declared = {"force_is": "link", "moving_mass_kg": 0.06, "mass_sd_kg": 0.0006}
    runs = AXIS.trials(LoadedJoint(**SHORT, constants=declared).recording())
    prior = runs.own_priors["axis"].c1
    # A force sensor is good to 2 %, and one axis cannot tell its scale from the mass.
    assert (prior.mean, prior.sd) == (0.06, pytest.approx(np.hypot(0.0006, 0.0012)))
    heavy = LoadedJoint(**SMALL, gravity=0.0, constants=declared | {"moving_mass_kg": 0.02})
    summary = bf.diagnose(heavy.recording()).summary
    assert summary.attention[0].startswith("The data contradict what is declared: rig.moving_mass")
    assert "0.02 ±" in summary.attention[0]
    assert "friction before the sensor" in summary.attention[1]


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_measured_force_neither_saturates_nor_lags():
    offers = {
        kind: AXIS.trials(LoadedJoint(**SHORT, constants={"force_is": kind}).recording()).offers
        for kind in ("commanded", "motor", "link", "measured", "unknown")
    }
    lags = {kind for kind, offered in offers.items() if "commanded-force" in offered}
    assert lags == {"commanded", "unknown"}


@pytest.mark.usefixtures("lengths_not_searched")
@pytest.mark.parametrize(
    ("seen", "offered"),
    [("one way", False), ("both ways", True)],
)
def test_load_friction_wants_lifting_and_lowering_at_one_pose(seen, offered):
    samples = Joint(seconds=10.0, sampled_hz=100.0).samples()
    if seen == "one way":
        time = samples["time_s"].to_numpy()
        turned = 0.4 * time + 0.05 * np.sin(2 * np.pi * 0.8 * time)
        samples = pd.DataFrame(
            {"run": "a", "time_s": time, "position_m": turned, "force_n": 1 + np.sin(turned)}
        )
    runs = AXIS.trials(recording_of(samples, force_is="motor"))
    assert ("load-both-ways" in runs.offers) == offered


@pytest.mark.usefixtures("lengths_not_searched")
@pytest.mark.parametrize("both_ways", [True, False])
def test_one_load_one_way_says_that_it_cannot_tell(both_ways):
    """A winch that only lifts: what it loses by the load may be Coulomb friction, or a gain."""
    joint = LoadedJoint(**SMALL, load=0.15)
    recording = joint.recording()
    samples = recording.axis.samples
    if not both_ways:
        samples = samples[np.gradient(samples["position_m"]) > 0].copy()
        turned = (samples["position_m"].diff().abs() > 0.1).cumsum()
        samples["run"] = samples["run"] + turned.map("-{}".format)
        long = samples.groupby("run")["run"].transform("size") > 60
        samples = samples[long].reset_index(drop=True)
    runs = pd.DataFrame({"run": samples["run"].unique()})
    recording = recording_of(samples, runs, force_is="motor")
    lines = AXIS.trials(recording).doubts({})
    assert any("Lift and lower at one pose" in line for line in lines) != both_ways


@pytest.mark.usefixtures("lengths_not_searched")
@pytest.mark.parametrize("gravity", [0.0, 0.8])
def test_a_lift_of_which_little_varies_says_that_it_cannot_tell(gravity):
    """What is constant of the load is Coulomb friction there, so that the load seems small."""
    lift = {"runs": 3, "seconds": 8.0, "lifts_alone": True, "coulomb": 0.25, "gravity": gravity}
    lines = AXIS.trials(LoadedJoint(**lift).recording()).doubts({})
    assert any("Lift and lower at one pose" in line for line in lines) == bool(gravity)


LADDER = {
    "M2": ({"stribeck": (0.4, 0.5)}, {"stribeck"}),
    "M4": ({"load_at_rest": (0.2, 0.5)}, {"load-stribeck"}),
    "M6": ({"load_square": 0.08}, {"load-quadratic"}),
    "other directions": ({"viscous_more": 0.02}, {"viscous-asymmetry"}),
    "cubic": ({"cubic": 0.01}, {"cubic-drag"}),
    "warm": ({"warm": 0.4}, {"thermal"}),
    # Driving alone: half of it is friction by the load, half a gain of the force.
    "M5": ({"driving": 0.3}, {"load-friction"}),
}


@pytest.mark.nightly
@pytest.mark.parametrize(("machine", "expected"), LADDER.values(), ids=LADDER)
def test_the_rung_that_made_it_is_named(machine, expected):
    summary = bf.diagnose(LoadedJoint(**machine).recording()).summary
    assert set(causes_of(summary)) == {"gravity-torque"} | expected


def test_numbers_are_as_wide_as_parts_of_the_log_where_nothing_is_decided(monkeypatch):
    """However likely a gap is: three seconds with much noise show none, and tell no number well."""
    fitted = {}

    def seven_times(law, *_):
        fitted.update(law)
        return dict.fromkeys(law, (7.0, 7.0))

    monkeypatch.setattr(answer, "by_parts", seven_times)
    summary = bf.diagnose(Joint(seconds=3.0, gravity=0.0, noise=0.1).recording()).summary
    assert summary.verdict == "undecided"
    assert summary.gap.probability_above_practical < 0.5
    wide = summary.law["viscous"].after.sd
    assert wide == pytest.approx(7 * fitted["viscous"].after.sd, rel=0.02)
