"""Which trials enter, by which rule, and how well two sensors agree."""

import dataclasses

import numpy as np
import pandas as pd
import pytest
from benchmark.kernels import timed
from scipy import stats

from bayesfric.recording.tables import Gravity
from bayesfric.rigs.gravity_board.screening import RULES, SELECTS_ON, screen_trials
from bayesfric.rigs.gravity_board.sensor_agreement import sensor_agreement
from bayesfric.simulate import Truth, simulate_recording

SPACING = 0.0098


@pytest.fixture(scope="module")
def recording():
    return simulate_recording("quick", seed=1, rigs=("gravity",))


def screened(recording, events=None, trials=None, **options):
    gravity = recording.gravity
    trials = gravity.trials if trials is None else trials
    events = gravity.events if events is None else events
    return screen_trials(Gravity(trials, events), recording.rig, **options)


def rows_of(events, trial, sensor):
    return ((events["trial"] == trial) & (events["sensor"] == sensor)).to_numpy()


def garbled(events, trial, sensor):
    """Events of one train at random times, recorded as if they were in order."""
    events = events.copy()
    rows = rows_of(events, trial, sensor)
    times = np.random.default_rng(2).uniform(0.5, 2.0, np.count_nonzero(rows))
    events.loc[rows, "time_s"] = np.sort(times)
    return events


def stretched(events, trials, sensor, factor):
    """A sensor whose pulley is too large by a factor: fewer spacings in the same travel."""
    events = events.copy()
    for trial in trials:
        rows = rows_of(events, trial, sensor)
        moment = events.loc[rows, "time_s"].to_numpy()
        origin = moment[0]
        place = np.arange(moment.size)
        pace = np.polynomial.Polynomial.fit(moment - origin, place, 2)
        noise = place - pace(moment - origin)
        # Where the true motion has done `factor` spacings for each that is counted.
        wanted = factor * place + noise + pace(0)
        fine = np.linspace(0, 1.1 * (moment[-1] - origin), 100_000)
        events.loc[rows, "time_s"] = origin + np.interp(wanted, pace(fine), fine)
    return events


def accelerations(events, trials, sensor):
    """Second derivatives by one sensor, one polynomial a trial [m/s²]."""
    values = []
    for trial in trials:
        own = events[rows_of(events, trial, sensor)]
        fit = np.polynomial.Polynomial.fit(own["time_s"], own["displacement_m"], 2)
        values.append(fit.deriv(2)(0.0))
    return np.array(values)


def test_clean_recording_enters_whole_and_unchanged(recording):
    gravity = recording.gravity
    screening = screened(recording)
    assert screening.excluded == {}
    assert screening.stalled == ()
    assert screening.repaired.empty
    pd.testing.assert_frame_equal(screening.gravity.events, gravity.events, check_exact=True)
    assert sorted(screening.gravity.trials["trial"]) == sorted(gravity.trials["trial"])
    assert (
        screening.gravity.trials["setup"].ne(screening.gravity.trials["setup"].shift()).sum() == 30
    )


def test_screening_twice_is_screening_once(recording):
    first, second = recording.gravity.trials["trial"][:2]
    events = garbled(recording.gravity.events, first, "load")
    events = events.drop(index=np.flatnonzero(rows_of(events, second, "drive"))[10])
    once = screened(recording, events)
    again = screen_trials(once.gravity, recording.rig)
    pd.testing.assert_frame_equal(again.gravity.events, once.gravity.events, check_exact=True)
    pd.testing.assert_frame_equal(again.gravity.trials, once.gravity.trials, check_exact=True)


def test_a_sensor_beyond_repair_leaves_and_the_other_stays(recording):
    trial = recording.gravity.trials["trial"][5]
    screening = screened(recording, garbled(recording.gravity.events, trial, "load"))
    assert screening.excluded == {}
    left = screening.gravity.events.query("trial == @trial")
    assert set(left["sensor"]) == {"drive"}
    assert screening.repaired["used"].tolist() == [False]
    assert trial not in set(screening.agreement.trials["trial"])


@pytest.mark.parametrize("exclude", [True, False])
def test_a_trial_without_a_sensor_left_leaves_in_any_case(recording, exclude):
    trial = recording.gravity.trials["trial"][5]
    events = garbled(recording.gravity.events, trial, "load")
    events = garbled(events, trial, "drive")
    screening = screened(recording, events, exclude=exclude)
    assert screening.excluded == {trial: "unrepairable-events"}
    assert trial not in set(screening.gravity.trials["trial"])
    assert trial not in set(screening.gravity.events["trial"])


def test_stalling_is_judged_after_repair_and_excludes_nothing(recording):
    trial = recording.gravity.trials["trial"][3]
    events = recording.gravity.events
    events = events[~rows_of(events, trial, "load")].copy()
    rows = np.flatnonzero(rows_of(events, trial, "drive"))[:30]
    others = events[events["trial"] != trial]

    def slowing(first_speed):  # at −0.2 m/s², from a first event at 1 s
        own = events.iloc[rows].copy()
        travel = np.arange(30) * SPACING
        own["time_s"] = 1.0 + (first_speed - np.sqrt(first_speed**2 - 0.4 * travel)) / 0.2
        return own

    assert screened(recording, pd.concat([others, slowing(0.35)])).stalled == ()
    stalling = slowing(0.339)  # stops after 0.2873 m; the 31st event is at 0.294 m
    screening = screened(recording, pd.concat([others, stalling]))
    assert screening.excluded == {}
    assert screening.stalled == (trial,)
    # With an event missed on the way the counted motion would go on to the next.
    recounted = stalling.drop(index=stalling.index[10])
    recounted["displacement_m"] = np.arange(29) * SPACING
    screening = screened(recording, pd.concat([others, recounted]))
    assert screening.stalled == (trial,)
    assert screening.repaired["missed"].tolist() == [1]


def test_what_cannot_be_computed_leaves_in_any_case(recording):
    """A pilot speed below zero at the first event has no logarithm."""
    trial = recording.gravity.trials["trial"][3]
    events = recording.gravity.events
    others = events[events["trial"] != trial]
    own = events[rows_of(events, trial, "drive")].iloc[:6].copy()
    # Least at 0.25 s, by a motion of six events that is a quadratic to the clock's tick.
    place = np.array([0, 6, 10, 15, 21, 28])
    own["displacement_m"] = place * SPACING
    own["time_s"] = 0.25 + np.sqrt(place / 12 + 0.25**2)
    own.loc[own.index[0], "time_s"] = 0.0
    screening = screened(recording, pd.concat([others, own]), exclude=False)
    assert screening.excluded == {trial: "stalled"}


@pytest.mark.parametrize("sigma_x", [30e-6, 100e-6])
def test_z_of_clean_trials_is_standard_normal(sigma_x):
    tables = []
    for seed in range(6):
        clean = simulate_recording(
            "quick", seed=50 + seed, truth=Truth(sigma_x=sigma_x), rigs=("gravity",)
        )
        agreement = sensor_agreement(clean.gravity.events, clean.gravity.trials, clean.rig)
        tables.append(agreement.trials)
        assert agreement.limit == pytest.approx(stats.norm.isf(0.5e-4), abs=1e-3)
    table = pd.concat(tables)
    assert len(table) == 6 * 180
    assert stats.kstest(table["z"], "norm").pvalue > 1e-3
    assert table["z"].std() == pytest.approx(1, abs=4 / np.sqrt(2 * len(table)))
    assert not table["disagrees"].any()


def test_few_events_widen_the_limit(recording):
    trials = recording.gravity.trials.iloc[:1]
    events = recording.gravity.events.query("trial == @trials.trial[0]")
    events = events.groupby("sensor").head(6)
    agreement = sensor_agreement(events, trials, recording.rig)
    span = events.groupby("sensor")["time_s"].agg(["min", "max"])
    shared = events["time_s"].between(span["min"].max(), span["max"].min()).sum()
    assert 10 <= shared < 12
    assert agreement.limit == pytest.approx(stats.t.isf(0.5e-4, shared - 6))


def test_a_sensor_one_percent_off_disagrees(recording):
    trials = recording.gravity.trials
    some = trials["trial"][::3].tolist()
    events = stretched(recording.gravity.events, some, "load", 1.01)
    screening = screened(recording, events)
    assert screening.repaired.empty
    table = screening.agreement.trials.set_index("trial")
    assert (table.loc[some, "z"] > screening.agreement.limit).all()
    assert (table.drop(index=some)["z"].abs() < screening.agreement.limit).all()
    material = table.index[table["disagrees"]].tolist()
    assert set(screening.excluded) == set(material)
    assert set(screening.excluded.values()) == {"sensors-disagree"}
    by_trial = trials.set_index("trial").loc[some]
    mass = by_trial["mass_drive_kg"] + by_trial["mass_load_kg"]
    drive = (by_trial["mass_drive_kg"] - by_trial["mass_load_kg"]) * 9.80665
    by_drive = accelerations(recording.gravity.events, some, "drive")
    by_load = by_drive / 1.01
    expected = mass * (by_drive - by_load) / (drive - mass * (by_drive + by_load) / 2)
    assert table.loc[some, "friction_share"].to_numpy() == pytest.approx(expected, rel=0.1)
    assert 0 < len(material) < len(some)
    assert screened(recording, events, exclude=False).excluded == {}


def test_a_sharp_difference_that_does_not_matter_excludes_nothing(recording):
    """A twentieth of a percent, at a noise of 1 µm: beyond noise, far below scatter."""
    quiet = simulate_recording(
        "quick", seed=1, truth=Truth(sigma_x=1e-6, sigma_t=1e-6), rigs=("gravity",)
    )
    some = quiet.gravity.trials["trial"][::5].tolist()
    screening = screened(quiet, stretched(quiet.gravity.events, some, "drive", 1.0005))
    table = screening.agreement.trials.set_index("trial")
    assert (table.loc[some, "z"] < -screening.agreement.limit).all()
    assert screening.excluded == {}


def test_sensors_are_compared_over_the_time_that_both_cover(recording):
    """Friction that grows on the way shows in a sensor that saw all of it, and is no fault."""
    trial = recording.gravity.trials["trial"][0]
    trials = recording.gravity.trials.iloc[:1]
    events = recording.gravity.events.query("trial == @trial").copy()
    moment = events["time_s"] - events["time_s"].min()
    events["time_s"] += 0.02 * moment**3  # the same slowing down for both
    rows = np.flatnonzero(rows_of(events, trial, "load"))[15:]
    short = events.drop(index=events.index[rows])
    (row,) = sensor_agreement(short, trials, recording.rig).trials.itertuples()
    assert row.friction_share < 0.01
    few = np.flatnonzero(rows_of(events, trial, "load"))[4:]
    assert (
        sensor_agreement(events.drop(index=events.index[few]), trials, recording.rig).limit is None
    )


def test_one_sensor_has_no_agreement(recording):
    events = recording.gravity.events.query("sensor == 'drive'")
    screening = screened(recording, events)
    assert screening.agreement.trials.empty
    assert screening.agreement.limit is None
    assert screening.excluded == {}


def test_trials_by_acceleration_alone_pass(recording):
    trials = recording.gravity.trials.assign(acceleration_m_s2=0.5)
    events = recording.gravity.events
    alone = trials["trial"][::2]
    screening = screened(recording, events[~events["trial"].isin(alone)], trials)
    assert screening.excluded == {}
    assert len(screening.gravity.trials) == len(trials)
    assert len(screening.agreement.trials) == len(trials) - len(alone)


def test_no_events_in_the_whole_recording(recording):
    trials = recording.gravity.trials.assign(acceleration_m_s2=0.5)
    none = recording.gravity.events.iloc[:0]
    rig = dataclasses.replace(recording.rig, hall_spacing_m=None, timer_resolution_s=None)
    screening = screen_trials(Gravity(trials, none), rig)
    assert screening.excluded == {}
    assert len(screening.gravity.trials) == len(trials)
    assert screening.gravity.events.empty
    assert screening.agreement.trials.empty


def test_each_rule_has_a_sentence():
    assert set(RULES) == set(SELECTS_ON)
    assert set(RULES) == {"unrepairable-events", "stalled", "size-at-rest", "sensors-disagree"}
    assert all(sentence[0].islower() and sentence[-1] != "." for sentence in RULES.values())


@pytest.mark.bench
def test_screening_the_paper_protocol_takes_half_a_second(benchmark):
    recording = simulate_recording("paper", seed=2, rigs=("gravity",))
    name = "screening of 600 trials"
    screening = timed(benchmark, name, screened, recording, within_s=0.5)
    assert len(screening.gravity.trials) == pytest.approx(600, rel=0.05)
