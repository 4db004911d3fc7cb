"""Recordings that lack an axis, a sensor, a table or a column: a right answer for each.

Each is written, read and fitted. The truth is known: what the data inform lies within
four posterior standard deviations of it (six in 100,000 by chance), and so does the
law's friction at each condition that was measured, whatever cannot be told apart.
"""

import dataclasses
from functools import cache

import numpy as np
import pytest
from altered import by_acceleration, of_size, one_size, with_trials
from reasons import explained

import bayesfric as bf
from bayesfric.analysis import Analysis, Sampler
from bayesfric.errors import InputError
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import board_friction
from bayesfric.physics.motor import motor_friction
from bayesfric.recording import write_recording
from bayesfric.recording.tables import Gravity, Motor
from bayesfric.rigs.gravity_board.trial_motion import trial_condition
from bayesfric.rigs.motor_board.places import run_condition
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import simulate_recording, table1_coefficients

SHORT = Sampler(burn=10, steps=80, thin=2, extensions=0)
# A ridge needs a proposal that follows it, and that a first run to be fitted to.
RIDGE = Sampler(burn=100, steps=300, thin=3, extensions=8)
NORMAL_90 = 2 * 1.6449  # standard deviations between the 5 and 95 % quantiles


def simulated(cells, tensions=(6.0, 28.0), other_tensions=(6.0, 28.0)):
    return simulate_recording(
        Protocol(cells, tensions, other_tensions, 2), seed=2, rigs=("gravity",)
    )


def without_column(recording, name):
    gravity = recording.gravity
    trials = gravity.trials.drop(columns=name)
    return dataclasses.replace(recording, gravity=Gravity(trials, gravity.events), motor=None)


def one_sensor(recording):
    gravity = with_trials(recording, of_size(recording, "medium")).gravity
    load = gravity.events[gravity.events["sensor"] == "load"].reset_index(drop=True)
    return dataclasses.replace(recording, gravity=Gravity(gravity.trials, load), motor=None)


def one_trial(recording):
    return with_trials(recording, recording.gravity.trials["trial"] == "g0007")


def gravity(recording):
    return dataclasses.replace(recording, motor=None)


NOTHING = {"c1": False, "c2": False, "c3": False}
ALL = {"c1": True, "c2": True, "c3": True}
# Accelerations stand for events where a case is not about events: their fits are faster.
CASES = {
    "one size": (
        lambda r: by_acceleration(with_trials(r, of_size(r, "large"))),
        SHORT,
        ALL,
    ),
    "size of the user's own": (
        lambda r: by_acceleration(with_trials(r, of_size(r, "medium"), pulley_size="lab")),
        SHORT,
        ALL,
    ),
    "one angle": (
        lambda r: by_acceleration(simulated({(5, 85.0): 1, (9, 85.0): 2}, (6.0, 16.0, 28.0))),
        SHORT,
        {"c1": True, "c2": True, "c3": False},
    ),
    "one pulley": (
        lambda r: by_acceleration(simulated({(1, 85.0): 2, (1, 50.0): 1, (1, 135.0): 1})),
        SHORT,
        ALL,
    ),
    "one sensor": (one_sensor, SHORT, ALL),
    "no motor board": (gravity, SHORT, ALL),
    "no setup column": (lambda r: by_acceleration(without_column(r, "setup")), SHORT, ALL),
    "no order column": (lambda r: by_acceleration(without_column(r, "order")), SHORT, ALL),
    "one trial": (one_trial, RIDGE, NOTHING),
    "accelerations": (lambda r: by_acceleration(gravity(r)), SHORT, ALL),
    "accelerations without errors": (
        lambda r: by_acceleration(gravity(r), sd_stated=False),
        SHORT,
        ALL,
    ),
    "accelerations and events": (
        lambda r: by_acceleration(with_trials(r, of_size(r, "medium")), slice(None, None, 2)),
        SHORT,
        ALL,
    ),
    "motor board": (
        lambda r: dataclasses.replace(one_size(r, "medium"), gravity=None),
        SHORT,
        ALL,
    ),
    "one motor run": (
        lambda r: dataclasses.replace(
            r, gravity=None, motor=Motor(r.motor.runs.iloc[:1], r.motor.idle.iloc[:1])
        ),
        SHORT,
        NOTHING,
    ),
}
# A sampler on a ridge, and what differs from a neighbour by one column.
NIGHTLY = {
    *("one trial", "no motor board", "motor board", "one pulley", "no order column"),
    *("accelerations", "accelerations without errors", "accelerations and events"),
    "no setup column",
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
        friction = fitted.predictive[group].to_dataset()
        table = recording.gravity.trials if group == "trials" else recording.motor.runs
        table = table.set_index(key).loc[friction[key].to_numpy()].reset_index()
        laws = [true_laws()[size] for size in table["pulley_size"]]
        law = Coefficients(*(np.array(column) for column in zip(*laws, strict=True)))
        if group == "trials":
            truth = board_friction(law, trial_condition(table, recording.rig))
        else:
            truth = motor_friction(law, run_condition(table, recording.rig))
        low, middle, high = friction["law_n"].to_numpy().T
        assert (np.abs(middle - truth) < 4 * (high - low) / NORMAL_90).all()


@pytest.fixture(scope="module")
def fit_of(small_recording, tmp_path_factory):
    """Recording and fit of a case, once each."""

    @cache
    def fitted(name):
        make, sampler, _ = CASES[name]
        recording = read_back(make(small_recording), tmp_path_factory.mktemp("recording"))
        return recording, bf.fit(recording, Analysis(seed=5, sampler=sampler))

    return fitted


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.nightly] if n in NIGHTLY else []) for n in CASES],
)
def test_what_is_informed_is_right_and_the_rest_is_said_to_be_open(name, fit_of, tmp_path):
    _, sampler, informed = CASES[name]
    recording, fitted = fit_of(name)
    summary = explained(fitted.summary)
    assert summary.pulleys
    for size, coefficients in summary.pulleys.items():
        assert {c: entry.informed for c, entry in coefficients.items()} == informed, size
        for c, truth in true_laws()[size]._asdict().items():
            entry = coefficients[c]
            assert abs(entry.mean - truth) < 4 * entry.sd, (size, c)
            if c == "c3" and not informed[c]:
                # The prior's, a share of c1 whose square has this mean.
                c1 = coefficients["c1"]
                assert entry.sd == pytest.approx(0.005 * np.hypot(c1.mean, c1.sd), rel=0.15)
    check_friction(fitted, recording)
    if sampler is RIDGE:
        assert summary.converged
        prior_decides = any(
            line.startswith("These data hardly inform") for line in summary.attention
        )
        assert prior_decides is not all(informed.values())
    fitted.write(tmp_path / "out")
    assert (tmp_path / "out" / "fit.json").is_file()


@pytest.mark.nightly
def test_columns_that_are_left_out_say_what_is_lost(fit_of):
    """Without setups each (size, n, angle) is one assembly; the order is not used."""
    _, unordered = fit_of("no order column")
    _, whole = fit_of("accelerations")
    assert unordered.summary.pulleys == whole.summary.pulleys
    summary = fit_of("no setup column")[1].summary
    assert summary.data_quality.setups == 9
    assert summary.data_quality.replicated_cells == 0
    assert any("assembled twice" in line for line in summary.attention)


@pytest.mark.nightly
def test_one_tension_leaves_the_split_of_c1_and_c2_wide(tmp_path):
    """Friction at 16 N is known to a few per cent, its two parts are not."""
    recording = simulated({(5, 85.0): 1, (9, 85.0): 2, (9, 50.0): 1}, (16.0,), (16.0,))
    recording = with_trials(recording, of_size(recording, "medium"))
    recording = read_back(by_acceleration(recording), tmp_path)
    fitted = bf.fit(recording, Analysis(seed=5, sampler=RIDGE))
    check_friction(fitted, recording)
    posterior = fitted.draws["posterior"]
    law = true_laws()["medium"]
    c1, c2 = (posterior[c].sel(pulley="medium").to_numpy() for c in ("c1", "c2"))
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
