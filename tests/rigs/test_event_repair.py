"""Faults put into simulated events are found and repaired; clean events are left alone."""

import numpy as np
import pandas as pd
import pytest

from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import board_friction
from bayesfric.rigs.gravity_board.event_repair import repair_events
from bayesfric.rigs.gravity_board.event_trains import SENSORS
from bayesfric.rigs.gravity_board.trial_motion import trial_condition
from bayesfric.simulate import Truth, simulate_recording

SPACING = 0.0098
KEYS = ["trial", "sensor"]
RADIUS_M = {"small": 0.0038, "medium": 0.00782, "large": 0.01145}


def simulated(seed, **truth):
    return simulate_recording("quick", seed=seed, truth=Truth(**truth), rigs=("gravity",)).gravity


def repair(events, trial_ids=None):
    trial_ids = pd.Series(events["trial"].unique()) if trial_ids is None else trial_ids
    return repair_events(events, trial_ids, spacing_m=SPACING)


def one_train(gravity, place=0, sensor="drive", events=None):
    """The events of one trial and sensor, as a table of its own."""
    rows = gravity.events.query("trial == @gravity.trials.trial[@place] and sensor == @sensor")
    return rows.iloc[:events].reset_index(drop=True)


def fifteen_trains(gravity):
    """The events of every twelfth trial, in one table: a repair has its price whatever it reads."""
    trains = [one_train(gravity, place) for place in range(0, 180, 12)]
    return pd.concat(trains).sort_values([*KEYS, "time_s"]).reset_index(drop=True)


def of_each(events, *which):
    """The labels of these events of each train."""
    return events.groupby(KEYS).nth(list(which)).index


def rows_of_each(events, **counts):
    """What the repair of each of the trains has to tell."""
    return [row(train, **counts) for _, train in events.groupby(KEYS)]


def counted(events):
    """What a recorder that counts would have written for these times."""
    events = events.sort_values([*KEYS, "time_s"]).reset_index(drop=True)
    return events.assign(displacement_m=events.groupby(KEYS).cumcount() * SPACING)


def missing(events, *which):
    """The true table without some events: a displacement skips, nothing is wrong."""
    return events.drop(index=list(which)).reset_index(drop=True)


def with_bounces(events, bounces):
    """Events with more of them, each so many seconds after the event that it repeats."""
    extra = events.loc[list(bounces)]
    extra = extra.assign(time_s=extra["time_s"] + list(bounces.values()))
    return pd.concat([events, extra])


def table(repaired):
    return repaired.repaired.to_dict("records")


def row(events, *, missed, doubled, removed, used=True):
    trial, sensor = events[KEYS].iloc[0]
    counts = {"missed": missed, "doubled": doubled, "removed": removed, "used": used}
    return {"trial": trial, "sensor": sensor} | counts


def same(events, expected):
    pd.testing.assert_frame_equal(events.reset_index(drop=True), expected, check_exact=True)


@pytest.mark.parametrize("sigma_x", [30e-6, 100e-6])
@pytest.mark.parametrize("seed", range(4))
def test_clean_events_are_left_alone(seed, sigma_x):
    gravity = simulated(seed, sigma_x=sigma_x)
    repaired = repair(gravity.events, gravity.trials["trial"])
    assert repaired.events is gravity.events
    assert table(repaired) == []


@pytest.mark.parametrize("sigma_x", [30e-6, 100e-6])
@pytest.mark.parametrize("event", [1, 2, 5, 30, -3, -2])
def test_a_missed_event_shifts_what_comes_after_it(event, sigma_x):
    events = fifteen_trains(simulated(3, sigma_x=sigma_x))
    truth = missing(events, *of_each(events, event))
    repaired = repair(counted(truth))
    same(repaired.events, truth)
    assert table(repaired) == rows_of_each(events, missed=1, doubled=0, removed=0)


@pytest.mark.parametrize("bounce", [0.2e-3, 2e-3])
@pytest.mark.parametrize("event", [0, 1, 2, 30, -2, -1])
def test_a_doubled_event_is_taken_out(event, bounce):
    events = fifteen_trains(simulated(4))
    repaired = repair(counted(with_bounces(events, dict.fromkeys(of_each(events, event), bounce))))
    same(repaired.events, events)
    assert table(repaired) == rows_of_each(events, missed=0, doubled=1, removed=1)


def test_the_earlier_of_two_edges_goes_where_it_is_off_the_motion():
    events = one_train(simulated(4))
    repaired = repair(counted(with_bounces(events, {20: -2e-3, 40: -2e-3})))
    same(repaired.events, events)
    assert table(repaired) == [row(events, missed=0, doubled=2, removed=2)]


@pytest.mark.parametrize("sigma_x", [30e-6, 100e-6])
def test_several_faults_in_one_train(sigma_x):
    events = fifteen_trains(simulated(5, sigma_x=sigma_x))
    truth = missing(events, *of_each(events, 2, 18, 19, 28, -2))
    bounces = {0: 0.5e-3, 8: 1e-3, 26: 2e-3, 30: 2e-3}  # of the rows that are left
    bounces = {row: bounce for at, bounce in bounces.items() for row in of_each(truth, at)}
    repaired = repair(counted(with_bounces(truth, bounces)))
    same(repaired.events, truth)
    assert table(repaired) == rows_of_each(events, missed=5, doubled=4, removed=4)


def test_a_fault_beside_another_trial_and_sensor_stays_there():
    gravity = simulated(6)
    trial = gravity.trials["trial"][7]
    gone = gravity.events.query("trial == @trial and sensor == 'load'").index[10]
    truth = gravity.events.drop(index=gone)
    recorded = truth.copy()
    later = (truth["trial"] == trial) & (truth["sensor"] == "load") & (truth.index > gone)
    recorded.loc[later, "displacement_m"] -= SPACING
    shuffled = recorded.sample(frac=1, random_state=1)
    repaired = repair(shuffled, gravity.trials["trial"])
    assert repaired.events.index.equals(shuffled.index)
    back = repaired.events.sort_index()
    assert np.abs(back["displacement_m"] - truth["displacement_m"]).max() < 1e-12
    pd.testing.assert_frame_equal(back[~later], truth[~later], check_exact=True)
    expected = {"missed": 1, "doubled": 0, "removed": 0, "used": True}
    assert table(repaired) == [{"trial": trial, "sensor": "load"} | expected]


def test_a_displacement_that_skips_a_spacing_is_right():
    events = one_train(simulated(7))
    truth = missing(events, 1, 20, 21, 50)
    repaired = repair(truth)
    assert repaired.events is truth
    assert table(repaired) == []


def test_a_stray_event_is_taken_out():
    events = one_train(simulated(8))
    halfway = (events["time_s"][31] - events["time_s"][30]) / 2
    repaired = repair(counted(with_bounces(events, {30: halfway})))
    same(repaired.events, events)
    assert table(repaired) == [row(events, missed=0, doubled=0, removed=1)]


def test_repairing_twice_is_repairing_once():
    gravity = simulated(9, sigma_x=100e-6)
    trials = gravity.trials["trial"].iloc[::4]
    rng = np.random.default_rng(0)
    events = gravity.events[gravity.events["trial"].isin(trials)]
    kept = events[rng.uniform(size=len(events)) > 0.05].reset_index(drop=True)
    bounces = rng.choice(len(kept), 125, replace=False)
    lengths = dict(zip(bounces.tolist(), rng.uniform(-2e-3, 2e-3, 125), strict=True))
    once = repair(counted(with_bounces(kept, lengths)), trials)
    assert len(once.repaired) > 75
    again = repair(once.events, trials)
    assert again.events is once.events
    assert table(again) == []


def test_half_the_events_at_random_are_beyond_repair():
    events = one_train(simulated(10))
    rng = np.random.default_rng(1)
    wild = events["time_s"].to_numpy().copy()
    half = rng.choice(wild.size, wild.size // 2, replace=False)
    wild[half] = rng.uniform(wild[0], wild[-1], half.size)
    repaired = repair(counted(events.assign(time_s=wild)))
    assert repaired.events.empty
    (only,) = table(repaired)
    assert only["removed"] == len(events)
    assert not only["used"]


def test_more_than_a_fifth_of_the_events_at_fault_are_beyond_repair():
    events = one_train(simulated(10), events=60)
    bounces = dict.fromkeys(range(6, 36, 3), 1e-3)  # ten of 70
    assert repair(counted(with_bounces(events, bounces))).repaired["used"].all()
    bounces = dict.fromkeys(range(6, 54, 3), 1e-3)  # sixteen of 76
    assert not repair(counted(with_bounces(events, bounces))).repaired["used"].any()


def test_fewer_than_five_left_are_beyond_repair():
    events = one_train(simulated(10), events=4)
    assert not repair(events).repaired["used"].any()
    events = one_train(simulated(10), place=1, events=5)
    assert repair(events).repaired.empty


def test_no_events_at_all():
    gravity = simulated(0)
    none = gravity.events.iloc[:0]
    assert repair(none, gravity.trials["trial"]).events is none


def board_with(extra_friction, seed, sigma_x):
    """The quick protocol with further friction, integrated by RK4; no law for it in closed form.

    `extra_friction` takes travel [m], speed [m/s], the law's friction and each pulley's
    radius [m].
    """
    recording = simulate_recording("quick", seed=seed, rigs=("gravity",))
    trials, dt = recording.gravity.trials, 1e-3
    rng = np.random.default_rng(seed)
    condition = trial_condition(trials, recording.rig)
    laws = [Truth().coefficients[size] for size in trials["pulley_size"]]
    law = board_friction(Coefficients(*map(np.array, zip(*laws, strict=True))), condition)
    radius = trials["pulley_size"].map(RADIUS_M).to_numpy()
    phase = rng.uniform(0, 2 * np.pi, radius.size)

    def slope(state):
        x, v = state
        friction = law + extra_friction(x, v, law, x / radius + phase)
        return np.stack([v, (condition.drive_force_n - friction) / condition.total_mass_kg])

    state = np.zeros((2, len(trials)))
    travel = [state[0]]
    while travel[-1].min() < 0.6:
        k1 = slope(state)
        k2 = slope(state + dt / 2 * k1)
        k3 = slope(state + dt / 2 * k2)
        state = state + dt / 6 * (k1 + 2 * k2 + 2 * k3 + slope(state + dt * k3))
        travel.append(state[0])
    travel = np.array(travel)
    tables = []
    for place, trial in enumerate(trials["trial"]):
        for sensor in SENSORS:
            magnet = np.arange(0.001 + rng.uniform(0, SPACING), 0.6, SPACING)
            passed = magnet + sigma_x * rng.standard_normal(magnet.size)
            time = np.interp(passed, travel[:, place], dt * np.arange(len(travel)))
            time += 20e-6 * rng.standard_normal(magnet.size)
            tables.append(pd.DataFrame({"trial": trial, "sensor": sensor, "time_s": time}))
    return counted(pd.concat(tables))


@pytest.mark.nightly
@pytest.mark.parametrize("sigma_x", [30e-6, 100e-6])
@pytest.mark.parametrize(
    "extra",
    [
        pytest.param(lambda x, v, law, angle: 0.1 * law * v / 1.2, id="viscous"),
        pytest.param(lambda x, v, law, angle: -law * np.exp(-x / 0.002), id="presliding"),
        pytest.param(lambda x, v, law, angle: 0.1 * law * np.sin(angle), id="runout"),
        pytest.param(lambda x, v, law, angle: 0.1 * law * np.exp(-((v / 0.1) ** 2)), id="stribeck"),
    ],
)
def test_friction_that_is_not_constant_is_no_fault(extra, sigma_x):
    events = board_with(extra, 1, sigma_x)
    repaired = repair(events)
    assert table(repaired) == []
    assert repaired.events is events
