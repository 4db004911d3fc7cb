"""Recordings that lack an axis, a sensor, a table or a column: a right answer for each.

Each is written, read and fitted. The truth is known: what the data inform lies within
four posterior standard deviations of it (six in 100,000 by chance), and so does the
law's friction at each condition that was measured, whatever cannot be told apart.
"""

import dataclasses
from functools import cache

import numpy as np
import pytest

import bayesfric as bf
from bayesfric.analysis import Analysis, Sampler
from bayesfric.errors import InputError
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import board_friction
from bayesfric.physics.motor import motor_friction
from bayesfric.recording import write_recording
from bayesfric.recording.tables import Gravity, Motor
from bayesfric.rigs.gravity_board.likelihood import trial_condition
from bayesfric.rigs.gravity_board.trial_motion import pilot_fits
from bayesfric.rigs.motor_board.likelihood import run_condition
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import simulate_recording, table1_coefficients

SHORT = Sampler(burn=60, steps=80, thin=2, extensions=0)
# A ridge needs a proposal that follows it, and that a first run to be fitted to.
RIDGE = Sampler(burn=100, steps=300, thin=3, extensions=8)
NORMAL_90 = 2 * 1.6449  # standard deviations between the 5 and 95 % quantiles
ACCELERATION_SD = 0.002  # m/s²


def simulated(cells, tensions=(6.0, 28.0), other_tensions=(6.0, 28.0)):
    return simulate_recording(
        Protocol(cells, tensions, other_tensions, 2), seed=2, rigs=("gravity",)
    )


def with_trials(recording, chosen, **columns):
    """The chosen trials alone, of the gravity board."""
    gravity = recording.gravity
    trials = gravity.trials[chosen].assign(**columns).reset_index(drop=True)
    events = gravity.events[gravity.events["trial"].isin(trials["trial"])]
    return dataclasses.replace(
        recording, gravity=Gravity(trials, events.reset_index(drop=True)), motor=None
    )


def without_column(recording, name):
    gravity = recording.gravity
    trials = gravity.trials.drop(columns=name)
    return dataclasses.replace(recording, gravity=Gravity(trials, gravity.events), motor=None)


def by_acceleration(recording, chosen, *, sd_stated=True):
    """Chosen trials by an acceleration with an error, instead of their events."""
    trials, events = recording.gravity.trials, recording.gravity.events
    error = ACCELERATION_SD * np.random.default_rng(3).standard_normal(len(trials))
    measured = pilot_fits(events, trials["trial"]).acceleration + error
    trials = trials.assign(acceleration_m_s2=np.where(chosen, measured, np.nan))
    if sd_stated:
        trials["acceleration_sd_m_s2"] = np.where(chosen, ACCELERATION_SD, np.nan)
    events = events[~events["trial"].isin(trials["trial"][chosen])].reset_index(drop=True)
    rig = recording.rig
    if events.empty:
        rig = dataclasses.replace(
            rig, hall_spacing_m=None, magnets_per_revolution=None, timer_resolution_s=None
        )
    return dataclasses.replace(recording, rig=rig, gravity=Gravity(trials, events), motor=None)


def one_sensor(recording):
    gravity = recording.gravity
    load = gravity.events[gravity.events["sensor"] == "load"].reset_index(drop=True)
    return dataclasses.replace(recording, gravity=Gravity(gravity.trials, load), motor=None)


def of_size(recording, size):
    return recording.gravity.trials["pulley_size"] == size


def every(recording, step):
    return np.arange(len(recording.gravity.trials)) % step == 0


NOTHING = {"c1": False, "c2": False, "c3": False}
ALL = {"c1": True, "c2": True, "c3": True}
CASES = {
    "one size": (lambda r: with_trials(r, of_size(r, "large")), SHORT, ALL),
    "size of the user's own": (
        lambda r: with_trials(r, of_size(r, "medium"), pulley_size="lab"),
        SHORT,
        ALL,
    ),
    "one angle": (
        lambda r: simulated({(5, 85.0): 1, (9, 85.0): 2}, (6.0, 16.0, 28.0)),
        SHORT,
        {"c1": True, "c2": True, "c3": False},
    ),
    "one pulley": (lambda r: simulated({(1, 85.0): 2, (1, 50.0): 1, (1, 135.0): 1}), SHORT, ALL),
    "one sensor": (one_sensor, SHORT, ALL),
    "no motor board": (lambda r: dataclasses.replace(r, motor=None), SHORT, ALL),
    "no setup column": (lambda r: without_column(r, "setup"), SHORT, ALL),
    "no order column": (lambda r: without_column(r, "order"), SHORT, ALL),
    "one trial": (lambda r: with_trials(r, r.gravity.trials["trial"] == "g0007"), RIDGE, NOTHING),
    "accelerations": (lambda r: by_acceleration(r, every(r, 1)), SHORT, ALL),
    "accelerations without errors": (
        lambda r: by_acceleration(r, every(r, 1), sd_stated=False),
        SHORT,
        ALL,
    ),
    "accelerations and events": (lambda r: by_acceleration(r, every(r, 2)), SHORT, ALL),
    "motor board": (lambda r: dataclasses.replace(r, gravity=None), SHORT, ALL),
    "one motor run": (
        lambda r: dataclasses.replace(
            r, gravity=None, motor=Motor(r.motor.runs.iloc[:1], r.motor.idle.iloc[:1])
        ),
        SHORT,
        NOTHING,
    ),
}


def true_laws():
    laws = table1_coefficients()
    return laws | {"lab": laws["medium"]}


def read_back(recording, folder):
    write_recording(recording, folder / "board")
    return bf.read_recording(folder / "board")


def check_friction(fitted, recording):
    """The law's friction at the measured conditions, whatever its coefficients are."""
    for group, key in (("trials", "trial"), ("runs", "run")):
        if group not in fitted.predictive:
            continue
        found = fitted.predictive[group].to_dataset()
        table = recording.gravity.trials if group == "trials" else recording.motor.runs
        table = table.set_index(key).loc[found[key].to_numpy()].reset_index()
        laws = [true_laws()[size] for size in table["pulley_size"]]
        law = Coefficients(*(np.array(column) for column in zip(*laws, strict=True)))
        if group == "trials":
            truth = board_friction(law, trial_condition(table, recording.rig))
        else:
            truth = motor_friction(law, run_condition(table, recording.rig))
        low, middle, high = found["law_n"].to_numpy().T
        assert (np.abs(middle - truth) < 4 * (high - low) / NORMAL_90).all()


@pytest.fixture(scope="module")
def fit_of(small_recording, tmp_path_factory):
    """Recording and fit of a case, once each."""

    @cache
    def found(name):
        make, sampler, _ = CASES[name]
        recording = read_back(make(small_recording), tmp_path_factory.mktemp("recording"))
        return recording, bf.fit(recording, Analysis(seed=5, sampler=sampler))

    return found


@pytest.mark.parametrize("name", CASES)
def test_what_is_informed_is_right_and_the_rest_is_said_to_be_open(name, fit_of, tmp_path):
    _, sampler, informed = CASES[name]
    recording, fitted = fit_of(name)
    summary = fitted.summary
    assert summary.pulleys
    for size, coefficients in summary.pulleys.items():
        assert {c: entry.informed for c, entry in coefficients.items()} == informed, size
        for c, truth in true_laws()[size]._asdict().items():
            entry = coefficients[c]
            assert abs(entry.mean - truth) < 4 * entry.sd, (size, c)
            if c == "c3" and not informed[c]:
                assert entry.sd == pytest.approx(1e-3, rel=0.15)  # the prior's
    check_friction(fitted, recording)
    if sampler is RIDGE:
        assert summary.converged
        told = any("Driven by the prior" in line for line in summary.attention)
        assert told is not all(informed.values())
    fitted.write(tmp_path / "out")
    assert (tmp_path / "out" / "fit.json").is_file()


def test_columns_that_are_left_out_say_what_is_lost(fit_of):
    """Without setups each (size, n, angle) is one assembly; the order is not used."""
    _, unordered = fit_of("no order column")
    _, whole = fit_of("no motor board")
    assert unordered.summary.pulleys == whole.summary.pulleys
    summary = fit_of("no setup column")[1].summary
    assert summary.data_quality.setups == 9
    assert summary.data_quality.replicated_cells == 0
    assert any("no replicates" in line for line in summary.attention)


def test_one_tension_leaves_the_split_of_c1_and_c2_wide(tmp_path):
    """Friction at 16 N is known to a few per cent, its two parts are not."""
    recording = simulated({(5, 85.0): 1, (9, 85.0): 2, (9, 50.0): 1}, (16.0,), (16.0,))
    recording = read_back(recording, tmp_path)
    fitted = bf.fit(recording, Analysis(seed=5, sampler=RIDGE))
    check_friction(fitted, recording)
    posterior = fitted.draws["posterior"]
    for size, law in true_laws().items():
        if size == "lab":
            continue
        c1, c2 = (posterior[c].sel(pulley=size).to_numpy() for c in ("c1", "c2"))
        both = 16.0 * c1 + c2
        assert both.std() < 0.03 * both.mean()
        assert np.corrcoef(c1.ravel(), c2.ravel())[0, 1] < -0.95
        assert c2.std() > 0.15 * both.mean()
        assert c2.min() < 0.1 * both.mean()
        assert abs(both.mean() - (16.0 * law.c1 + law.c2)) < 4 * both.std()


def test_rig_that_is_not_there_is_refused(small_recording, tmp_path):
    recording = read_back(dataclasses.replace(small_recording, motor=None), tmp_path)
    with pytest.raises(InputError, match="data of the rig 'motor'"):
        bf.fit(recording, rigs=("gravity", "motor"))
