"""Whole diagnoses: what must be found, and what must not be."""

from dataclasses import replace

import numpy as np
import pytest

from bayesfric.analysis import Analysis
from bayesfric.diagnosis import diagnose
from bayesfric.errors import InputError
from bayesfric.physics.friction import Coefficients
from bayesfric.recording.tables import Gravity
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

MINE = '''
"""An effect of a user's own."""

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.effects import Effect, EffectParameter


def _stick(p, state):
    return p["share"] * state.friction_n * np.exp(-((np.asarray(state.travel_m) - 0.3) / 0.05) ** 2)


EFFECT = Effect(
    name="sticky-spot",
    acts_on="friction",
    sentence="the cable has a spot that rubs in the middle of its travel",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="friction that the spot adds, as a share",
        prior=HalfNormal(scale=0.5),
        plausible=(0.0, 1.0),
        reference="argued: a kink",
    ),
    laws={"bump": _stick},
    along_path=True,
)
'''


@pytest.fixture(scope="module")
def nothing():
    """A recording of the paper's law."""
    return simulate_recording("quick", seed=3)


@pytest.fixture(scope="module")
def named():
    """The diagnosis of a recording with viscous friction, and the slope it has."""
    recording = simulate_recording("quick", seed=1, effects={"viscous": 1.0})
    (truth,) = recording.metadata["simulation"]["truth"]["effects"]
    return diagnose(recording), truth["parameters"]["slope"]


def test_a_cause_is_named_with_its_size(named):
    (cause,) = named[0].summary.causes
    assert named[0].summary.verdict == "named"
    assert cause.effect == "viscous"
    slope = cause.parameters["slope"]
    # Five standard deviations: a wrong unit or a lost factor is a hundred of them.
    assert abs(slope.mean - named[1]) < 5 * slope.sd
    assert not cause.below_floor
    # What an effect changes in many trials is no reason to leave one out.
    assert named[0].summary.stray_trials == ()


def test_where_it_lies(named):
    axes = {axis.axis: axis for axis in named[0].summary.where}
    assert named[0].summary.where[0].axis == "velocity"
    assert axes["velocity"].p_value < 0.01
    # Viscous friction: less than the law's at the slowest, more at the fastest.
    shape = axes["velocity"].shape
    assert shape.high_n[0] < 0 < shape.low_n[-1]


def test_the_gap_shrinks_to_the_floor(named):
    """Before: what a straight recalibration leaves of a force of 10 % rms of friction."""
    gap = named[0].summary.gap
    assert 0.02 * gap.friction_rms < gap.before.q50 < 0.12 * gap.friction_rms
    assert gap.before.q50 > gap.floor.q50
    assert gap.shrink.q05 > 0.7
    assert gap.trajectory.after.q50 < 0.5 * gap.trajectory.before.q50
    assert gap.after.q50 == pytest.approx(gap.floor.q50, rel=0.3)


def test_probabilities_add_up_and_effects_are_all_told(named):
    summary = named[0].summary
    assert sum(summary.probabilities.values()) == pytest.approx(1.0)
    for entry in summary.effects:
        assert (entry.log10_bayes_factor is None) == (entry.log10_bayes_factor_why is not None)


def test_same_recording_same_bytes(named, tmp_path):
    again = diagnose(simulate_recording("quick", seed=1, effects={"viscous": 1.0}))
    for name, one in (("first", named[0]), ("second", again)):
        one.write(tmp_path / name)
    for name in ("diagnosis.json", "diagnosis.nc"):
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "second" / name).read_bytes()


def test_no_effect_no_gap(nothing):
    found = diagnose(nothing).summary
    assert found.verdict == "no-gap"
    assert found.causes == ()
    assert found.gap.shrink is None
    assert found.gap.after == found.gap.before
    assert not found.remainder.significant


def test_what_was_shipped_wrong_is_tuning_and_no_gap():
    """Every coefficient a fifth above Table I: recalibration takes it all."""
    laws = {
        size: Coefficients(*(1.2 * value for value in law))
        for size, law in table1_coefficients().items()
    }
    recording = simulate_recording("quick", seed=4, truth=Truth(coefficients=laws))
    gap = diagnose(recording).summary
    assert gap.verdict == "no-gap"
    # A fifth of friction is shipped wrong: 1 − 1/1.2 of what there is.
    assert gap.gap.as_shipped.q50 == pytest.approx(gap.gap.friction_rms / 6, rel=0.1)
    assert gap.gap.before.q50 < 0.2 * gap.gap.as_shipped.q50


def test_without_a_motor_board_its_effects_are_absent():
    recording = simulate_recording("quick", seed=5, rigs=("gravity",))
    found = diagnose(recording).summary
    why = {one.effect: one.log10_bayes_factor_why for one in found.effects}
    for name in ("torque-constant", "current-offset"):
        assert why[name].startswith("absent from these data")
    assert found.rigs == ("gravity",)
    assert found.verdict == "no-gap"


def test_one_angle_makes_its_axis_blind():
    design = Protocol({(5, 85.0): 1, (9, 85.0): 2, (15, 85.0): 2}, (6.0, 16.0, 30.0), (), 2)
    recording = simulate_recording(design, seed=6, rigs=("gravity",))
    axes = {axis.axis: axis for axis in diagnose(recording).summary.where}
    assert axes["wrap_angle"].blind
    assert axes["wrap_angle"].share is None
    assert not axes["n_pulleys"].blind


def test_a_trial_that_nearly_stalls_does_no_harm(nothing):
    """Half of its events come late by what a friction 30 % higher would do."""
    trials, events = nothing.gravity.trials, nothing.gravity.events.copy()
    slowest = trials["trial"].iloc[
        int(np.argmin((trials["mass_drive_kg"] - trials["mass_load_kg"]).to_numpy()))
    ]
    own = (events["trial"] == slowest).to_numpy()
    events.loc[own, "time_s"] *= 1.3
    recording = replace(nothing, gravity=Gravity(trials, events))
    found = diagnose(recording).summary
    assert found.verdict == "no-gap"
    assert found.stray_trials == (slowest,)


def test_an_effect_of_a_users_own_is_named(tmp_path):
    from bayesfric.effects import effect_of_file
    from bayesfric.simulate import AppliedEffect

    (tmp_path / "mine.py").write_text(MINE)
    effect = effect_of_file(tmp_path / "mine.py")
    truth = Truth(effects=(AppliedEffect(effect, "bump", {"share": 0.15}),))
    recording = simulate_recording("quick", seed=7, truth=truth)
    found = diagnose(recording, effects=[effect]).summary
    assert [cause.effect for cause in found.causes] == ["sticky-spot"]
    # Without the file it is nothing that anybody described.
    alone = diagnose(recording).summary
    assert alone.verdict in ("unknown", "unseparated") or alone.remainder.significant


def test_a_coefficient_can_be_held(nothing):
    """c3 held at Table I: its axis cannot be refitted, and is not."""
    found = diagnose(nothing, fixed=["c3"]).summary
    assert found.fixed == ("c3",)
    assert found.verdict == "no-gap"


@pytest.mark.parametrize("name", ["c4", "c1[huge]"])
def test_an_unknown_coefficient_is_refused(nothing, name):
    with pytest.raises(InputError, match="--fixed"):
        diagnose(nothing, fixed=[name])


def test_practical_share_decides_what_counts():
    """Were a gap of a tenth of friction none, a tenth would be no gap."""
    small = Protocol({(9, 85.0): 2, (15, 50.0): 2, (5, 135.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
    recording = simulate_recording(small, seed=1, effects={"viscous": 1.0})
    assert diagnose(recording).summary.verdict == "named"
    rules = Analysis().diagnosis.model_copy(update={"practical_share": 0.1})
    found = diagnose(recording, Analysis().model_copy(update={"diagnosis": rules})).summary
    assert found.verdict == "no-gap"


def test_one_assembly_is_diagnosed():
    """Nothing is left to be fitted to where its only assembly is held out but the prior."""
    alone = Protocol({(9, 85.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
    recording = simulate_recording(alone, seed=3, rigs=("gravity",))
    trials, events = recording.gravity.trials, recording.gravity.events
    trials = trials[trials["pulley_size"] == "small"].reset_index(drop=True)
    events = events[events["trial"].isin(trials["trial"])].reset_index(drop=True)
    found = diagnose(replace(recording, gravity=Gravity(trials, events))).summary
    assert trials["setup"].nunique() == 1
    # The law's own prior is what is compared, which is as wide as friction itself.
    assert found.gap.before.q50 > 10 * found.gap.in_sample.before.q50
    assert found.verdict == "no-gap"


def test_accelerations_alone_are_diagnosed():
    """Without events a trial is one row; without an effect there is no gap."""
    recording = simulate_recording("quick", seed=3, rigs=("gravity",))
    trials, events = recording.gravity.trials.copy(), recording.gravity.events
    own = events[events["sensor"] == "drive"].groupby("trial")
    trials["acceleration_m_s2"] = [
        2 * np.polyfit(one["time_s"] - one["time_s"].iloc[0], one["displacement_m"], 2)[0]
        for _, one in own
    ]
    trials["acceleration_sd_m_s2"] = 1e-3
    alone = replace(recording, gravity=Gravity(trials, events.iloc[:0]))
    found = diagnose(alone).summary
    assert found.verdict == "no-gap"
    assert found.gap.trajectory is None
    assert found.gap.floor.q50 < 0.05 * found.gap.friction_rms
