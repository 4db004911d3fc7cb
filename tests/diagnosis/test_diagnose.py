"""Whole diagnoses: what must be found, and what must not be."""

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from altered import by_acceleration, with_trials
from reasons import explained

from bayesfric.analysis import Analysis, Scatter
from bayesfric.blind.engines import reference
from bayesfric.blind.engines.nuisances import Nuisances
from bayesfric.blind.engines.reference import Withheld
from bayesfric.diagnosis import diagnose
from bayesfric.diagnosis.baseline import data_of
from bayesfric.effects import State, all_effects
from bayesfric.errors import InputError
from bayesfric.physics.friction import Coefficients, coulomb_friction
from bayesfric.recording.tables import Gravity
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

SMALL = Protocol({(9, 85.0): 2, (15, 50.0): 2, (5, 135.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)

ASKED = pd.DataFrame(
    {
        "pulley_size": ["medium", "small", "large"],
        "n_pulleys": [9, 5, 25],
        "wrap_angle_deg": [85.0, 110.0, 85.0],
        "tension_n": [15.0, 25.0, 15.0],
        "velocity_m_s": [-0.3, 0.6, 0.3],
    }
)


@pytest.fixture(scope="module")
def nothing():
    """A recording of the paper's law."""
    return simulate_recording(SMALL, seed=3)


@pytest.fixture(scope="module")
def empty(nothing):
    """Its diagnosis."""
    return explained(diagnose(nothing).summary)


@pytest.fixture(scope="module")
def named():
    """The diagnosis of a recording with viscous friction, and the slope it has."""
    recording = simulate_recording(SMALL, seed=1, effects={"viscous": 1.0})
    (truth,) = recording.metadata["simulation"]["truth"]["effects"]
    return diagnose(recording, target=ASKED), truth["parameters"]["slope"]


@pytest.mark.nightly
@pytest.mark.parametrize("level", ["trial", "assembly"])
def test_student_t_scatter_of_normal_trials_is_found_to_leave_no_gap(nothing, empty, level):
    summary = diagnose(nothing, Analysis(scatter=Scatter(**{level: "student-t"}))).summary
    assert summary.verdict == empty.verdict == "no-gap"
    assert summary.gap != empty.gap
    (line,) = summary.attention
    assert f"scatter.{level}" in line
    assert "on the motor board" in line
    assert empty.attention == ()


def test_a_cause_is_named_with_its_size(named):
    (cause,) = named[0].summary.causes
    assert named[0].summary.verdict == "named"
    assert cause.effect == "viscous"
    slope = cause.parameters["slope"]
    # Five standard deviations: a wrong unit or a lost factor is a hundred of them.
    assert abs(slope.mean - named[1]) < 5 * slope.sd
    assert cause.makes_a_gap
    # What an effect changes in many trials is no reason to leave one out.
    assert named[0].summary.stray_trials == ()


def test_the_law_is_drawn_together_with_what_acts(named):
    law = named[0].curves["law"].to_dataset()
    assert list(law["effect"]) == ["viscous"]
    assert (law["variant"] != "").mean() == pytest.approx(named[0].summary.inclusion[0].probability)
    # friction at rest, 15 N and 85°: a law that was fitted alone has 5 % too much
    for size, true in table1_coefficients().items():
        own = law.sel(pulley=size)
        at_rest = np.asarray(own["c1"] * 15 + own["c2"])
        expected = float(true.c1) * 15 + float(true.c2)
        assert abs(at_rest.mean() - expected) < 4 * at_rest.std()
        assert at_rest.std() < 0.01 * expected
    assert float(law["omega"].mean()) == pytest.approx(named[0].summary.scatter["omega"])


def test_friction_at_conditions_asked_for_is_that_of_the_truth(named):
    """Law and effect by hand; the law that was fitted alone misses by a part of the effect."""
    asked, viscous = named[0].summary.target, all_effects()["viscous"]
    (cause,) = named[0].summary.causes
    assert asked.stays_behind == {}
    assert [row.outside for row in asked.rows] == [(), (), ("n_pulleys",)]
    for row, (size, *condition, speed) in zip(asked.rows, ASKED.to_numpy(), strict=True):
        law, alone = table1_coefficients()[size], named[0].summary.law
        state = State.of(law, *condition, abs(speed), steady=True)
        added = float(viscous.laws[cause.law]({"slope": named[1]}, state))
        expected = float(coulomb_friction(law, *condition)) + added
        assert abs(row.friction.mean - expected) < 4 * row.friction.sd
        assert row.friction.sd < 0.02 * expected
        assert abs(row.gap_with_causes.mean) < 1e-3 * expected
        # Fitted alone, the law has what the effect does at the speeds that were recorded.
        own = Coefficients(*(alone[f"{name}[{size}]"].before.mean for name in law._fields))
        missed = row.friction.mean - float(coulomb_friction(own, *condition))
        assert row.gap_without_causes.mean == pytest.approx(missed, abs=1e-9)


@pytest.mark.parametrize(
    ("changed", "column", "expected"),
    [
        ({"tension_n": None}, "tension_n", "this column"),
        ({"pulley_size": "huge"}, "pulley_size", "large, medium, small"),
    ],
)
def test_conditions_that_no_law_is_for_are_refused(nothing, changed, column, expected):
    name, value = next(iter(changed.items()))
    asked = ASKED.drop(columns=name) if value is None else ASKED.assign(**changed)
    with pytest.raises(InputError) as raised:
        diagnose(nothing, target=asked)
    fault = raised.value.faults[0]
    assert (fault.column, expected in fault.expected) == (column, True)


def test_what_is_known_of_each_effect(named):
    summary = named[0].summary
    first, *rest = summary.inclusion
    assert first.effect == "viscous"
    assert first.probability > 0.99
    assert first.probability_above_practical > 0.99
    assert first.strength.q05 < summary.causes[0].strength < first.strength.q95
    assert all(entry.probability <= first.probability for entry in rest)


def test_where_it_lies(named):
    summary = named[0].summary
    axes = {axis.axis: axis for axis in summary.where}
    assert axes["velocity"].p_value < 0.01
    assert summary.where[0] == axes["velocity"]
    assert [axis.axis for axis in summary.where if axis.leads] == ["velocity"]
    share = axes["velocity"].share
    assert "It varies most with velocity." in summary.sentence
    # A drag that is the same at all tensions: speed alone explains most of it.
    assert axes["velocity"].alone.q05 > 0.75 > share.q95
    shares = [axis.share.mean for axis in summary.where if axis.share is not None]
    assert min(shares) >= 0
    assert sum(shares) + summary.unexplained.mean == pytest.approx(1.0, abs=1e-6)
    assert axes["setup"].share.q50 < 0.1
    # Viscous friction: less than the law's at the slowest, more at the fastest.
    shape = axes["velocity"].shape
    assert shape.high_n[0] < 0 < shape.low_n[-1]


def test_the_gap_shrinks_to_the_floor(named):
    """Before: what a straight recalibration leaves of a force of 10 % rms of friction."""
    gap = named[0].summary.gap
    assert 0.02 * gap.friction_rms < gap.systematic.q50 < 0.12 * gap.friction_rms
    assert gap.probability_above_practical > 0.95
    assert 0.9 < gap.shrink.q50 <= 1.0
    assert gap.trajectory.shrink.q50 > 0.6
    assert 0.01 < gap.floor.q50 / gap.friction_rms < 0.03


def test_held_out_data_are_predicted_better_with_the_cause(named):
    """Assemblies of both boards in twenty blocks, each held out once."""
    summary = named[0].summary
    density = summary.gap.held_out_log_density
    assert density.blocks == 20
    assert density.difference > 3 * density.error
    assert (summary.considered, summary.overruled_by) == ((), None)


def test_probabilities_add_up_and_effects_are_all_told(named):
    summary = named[0].summary
    assert sum(summary.probabilities.values()) == pytest.approx(1.0)
    for entry in summary.effects:
        assert (entry.log10_bayes_factor is None) == (entry.log10_bayes_factor_why is not None)


@pytest.mark.nightly  # another diagnosis
def test_same_recording_same_bytes(named, tmp_path):
    recording = simulate_recording(SMALL, seed=1, effects={"viscous": 1.0})
    again = diagnose(recording, target=ASKED)
    for name, diagnosis in (("first", named[0]), ("second", again)):
        diagnosis.write(tmp_path / name)
    for name in ("diagnosis.json", "diagnosis.nc"):
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "second" / name).read_bytes()


@pytest.mark.nightly
def test_no_effect_no_gap(empty):
    assert empty.verdict == "no-gap"
    assert empty.causes == empty.possible == ()
    assert empty.gap.shrink is None
    assert not empty.remainder.significant
    assert empty.gap.systematic.q95 < 0.02 * empty.gap.friction_rms


def has_no_bands_off_zero(summary):
    """Assert that bands hold zero; band and p-value are of the same residuals."""
    shapes = {axis.axis: axis.shape for axis in summary.where if axis.shape is not None}
    off = [
        name
        for name, shape in shapes.items()
        if any(low > 0 or high < 0 for low, high in zip(shape.low_n, shape.high_n, strict=True))
    ]
    assert off == []
    assert {"drive_end", "trial_in_setup", "setup"} <= set(shapes)


@pytest.mark.nightly  # one of accelerations alone has such bands too, in half of the time
def test_bands_of_an_empty_board_hold_zero(empty):
    has_no_bands_off_zero(empty)


@pytest.mark.nightly
def test_what_was_shipped_wrong_is_tuning_and_no_gap():
    """Every coefficient a fifth above Table I: recalibration takes it all."""
    laws = {
        size: Coefficients(*(1.2 * value for value in law))
        for size, law in table1_coefficients().items()
    }
    recording = simulate_recording(SMALL, seed=4, truth=Truth(coefficients=laws))
    summary = diagnose(recording).summary
    assert summary.verdict == "no-gap"
    # A fifth of friction is shipped wrong: 1 − 1/1.2 of what there is.
    assert summary.gap.as_shipped.q50 == pytest.approx(summary.gap.friction_rms / 6, rel=0.1)
    assert summary.gap.before.q50 < 0.2 * summary.gap.as_shipped.q50


@pytest.mark.nightly
def test_one_rig_and_one_angle_leave_their_effects_and_axes_out():
    design = Protocol({(5, 85.0): 1, (9, 85.0): 2, (15, 85.0): 2}, (6.0, 30.0), (), 2)
    recording = simulate_recording(design, seed=6, rigs=("gravity",))
    summary = diagnose(recording).summary
    why = {tested.effect: tested.log10_bayes_factor_why for tested in summary.effects}
    for name in ("torque-constant", "current-offset"):
        assert why[name].startswith("absent from these data")
    assert summary.rigs == ("gravity",)
    assert not summary.causes
    axes = {axis.axis: axis for axis in summary.where}
    assert axes["wrap_angle"].blind
    assert axes["wrap_angle"].share is None
    assert not axes["n_pulleys"].blind


@pytest.mark.nightly
def test_a_coefficient_can_be_held(nothing):
    """c3 held at Table I: its axis cannot be refitted, and is not."""
    summary = diagnose(nothing, fixed=["c3"]).summary
    assert summary.fixed == ("c3",)
    of_table = {f"c3[{size}]": float(law.c3) for size, law in table1_coefficients().items()}
    assert summary.fixed_at
    assert summary.fixed_at.items() <= of_table.items()
    assert summary.verdict == "no-gap"


@pytest.mark.parametrize("name", ["c4", "c1[huge]"])
def test_an_unknown_coefficient_is_refused(nothing, name):
    with pytest.raises(InputError, match="--fixed"):
        diagnose(nothing, fixed=[name])


@pytest.mark.nightly
def test_a_wider_prior_is_the_users(nothing, empty):
    """A width a hundred times as large costs an effect that is not there two decades."""
    rules = Analysis().diagnosis.model_copy(update={"widths": {"wear-drift": 100.0}})
    wide = diagnose(nothing, Analysis().model_copy(update={"diagnosis": rules})).summary

    def factor(summary):
        return next(o.log10_bayes_factor for o in summary.effects if o.effect == "wear-drift")

    assert factor(empty) - factor(wide) == pytest.approx(2.0, abs=0.3)


def test_one_acceleration_alone_tells_of_no_axis(small_recording):
    """It varies along none; what it leaves open is wide, and no cause is named."""
    recording = by_acceleration(small_recording)
    alone = with_trials(recording, recording.gravity.trials["trial"] == "g0007")
    summary = explained(diagnose(alone).summary)
    assert not summary.causes
    assert summary.verdict == "undecided"
    assert summary.where
    assert all(axis.blind and axis.p_value is None for axis in summary.where)
    assert summary.unexplained.q05 == summary.unexplained.mean == 1.0
    assert summary.all_unexplained_because == "no axis varied in these data"
    json.loads(summary.model_dump_json(), parse_constant=pytest.fail)


def test_accelerations_alone_of_one_assembly_are_diagnosed():
    """Without events a trial is one row; without a second assembly nothing is held out but it."""
    alone = Protocol({(9, 85.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
    recording = simulate_recording(alone, seed=3, rigs=("gravity",))
    trials, events = recording.gravity.trials.copy(), recording.gravity.events
    own = events[events["sensor"] == "drive"].groupby("trial")
    trials["acceleration_m_s2"] = [
        2
        * np.polyfit(
            of_trial["time_s"] - of_trial["time_s"].iloc[0], of_trial["displacement_m"], 2
        )[0]
        for _, of_trial in own
    ]
    trials["acceleration_sd_m_s2"] = 1e-3
    alone = replace(recording, gravity=Gravity(trials, events.iloc[:0]))
    summary = explained(diagnose(alone).summary)
    assert not summary.causes
    assert summary.gap.trajectory is None
    has_no_bands_off_zero(summary)


def test_accelerations_that_are_not_the_way_of_the_weights_enter_no_diagnosis():
    """Along no path is a force known: one such trial is left out, and none but such is refused."""
    alone = Protocol({(9, 85.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
    recording = simulate_recording(alone, seed=3, rigs=("gravity",))
    trials, none = recording.gravity.trials.copy(), recording.gravity.events.iloc[:0]
    trials["acceleration_m_s2"] = 0.3
    trials.loc[0, "acceleration_m_s2"] = 0.0
    data, _ = data_of(replace(recording, gravity=Gravity(trials, none)), "paper", None)
    assert len(data.rigs[0].table) == len(trials) - 1
    trials["acceleration_m_s2"] = -0.1
    with pytest.raises(InputError, match="whose acceleration is above 0"):
        data_of(replace(recording, gravity=Gravity(trials, none)), "paper", None)


@pytest.mark.nightly
def test_eight_empty_boards():
    """Bands that hold zero, no name, a floor that data held out agree with: as often as said."""
    panels, outside, agree = 0, 0, 0
    for seed in range(300, 308):
        summary = diagnose(simulate_recording(SMALL, seed=seed)).summary
        assert summary.verdict in ("no-gap", "undecided")
        assert summary.causes == ()
        shapes = [axis.shape for axis in summary.where if axis.shape is not None]
        panels += len(shapes)
        outside += sum(max(shape.low_n) > 0 or min(shape.high_n) < 0 for shape in shapes)
        agree += summary.gap.floor_agrees
    assert outside <= 0.05 * panels
    assert agree >= 7


@pytest.mark.nightly
def test_rough_wander_is_no_force_of_its_own(monkeypatch):
    """Friction wanders over 25 mm; ten cosines left 1 % of it to an unknown force."""
    rough = Nuisances(wander=0.02, wander_length_m=0.025)
    monkeypatch.setattr(reference, "draw_nuisances", lambda _: rough)
    made = reference.make(Withheld("none", (), "own"), 11)
    rules = Analysis().diagnosis.model_copy(update={"practical_share": 0.005})
    summary = diagnose(made.recording, Analysis(diagnosis=rules)).summary
    assert summary.verdict == "no-gap"
    assert summary.gap.systematic.q95 < 0.005 * summary.gap.friction_rms
