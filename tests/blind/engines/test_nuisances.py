"""The nuisances of the blind engine are as large as it says."""

from dataclasses import replace

import numpy as np
import pytest
from blind.engines.boards import nature

from bayesfric.blind.engines.boards import SPACING_M, board_of
from bayesfric.blind.engines.design import trials_of
from bayesfric.blind.engines.motion import move
from bayesfric.blind.engines.nuisances import (
    Nuisances,
    disturbed,
    disturbed_trains,
    draw_nuisances,
)
from bayesfric.blind.engines.recorder import Train

TRIALS = trials_of(np.random.default_rng(1))


def disturbed_by(**sizes):
    board = board_of(nature(), TRIALS)
    return disturbed(board, TRIALS, Nuisances(**sizes), np.random.default_rng(2))


def test_without_any_the_board_is_what_it_was():
    board, same = board_of(nature(), TRIALS), disturbed_by()
    place = np.full((len(TRIALS), 1), 0.3)
    assert same.factor_at(place) == pytest.approx(board.factor)
    assert same.state.constant_n == pytest.approx(board.state.constant_n)
    assert not np.any(same.push_m_s)


def test_friction_wanders_with_its_rms_and_its_length():
    """Of a squared exponential kernel, exp(-1/2) of the variance one length on."""
    board = disturbed_by(wander=0.02, wander_length_m=0.05)
    travel = np.tile(np.linspace(0, 0.6, 61), (len(TRIALS), 1))
    off = board.factor_at(travel) - 1
    assert off.std() == pytest.approx(0.02, rel=0.06)
    ahead = (off[:, 5:] * off[:, :-5]).mean() / (off**2).mean()
    assert ahead == pytest.approx(np.exp(-0.5), abs=0.06)
    assert abs(np.corrcoef(off[0], off[1])[0, 1]) < 0.7  # drawn anew in each trial


def test_a_push_is_the_speed_at_the_release():
    board = disturbed_by(push_m_s=0.05)
    motion = move(replace(board, wander=None), ())
    assert motion.speed_m_s[:, :1] == pytest.approx(np.asarray(board.push_m_s), abs=1e-12)
    assert 0.02 < np.mean(board.push_m_s) < 0.03  # uniform up to 0.05


def test_ends_differ_and_intercepts_scatter_by_assembly():
    board = disturbed_by(ends=0.01)
    left, right = board.factor[TRIALS.drive_left], board.factor[~TRIALS.drive_left]
    assert left.mean() / right.mean() - 1 == pytest.approx(0.01, rel=0.01)
    plain, scattered = board_of(nature(), TRIALS), disturbed_by(omega_intercept=0.05)
    ratio = (scattered.state.constant_n / plain.state.constant_n)[:, 0]
    by_setup = [ratio[TRIALS.setup == setup] for setup in range(TRIALS.setup.max() + 1)]
    assert max(np.ptp(ratios) for ratios in by_setup) < 1e-12
    assert np.std([ratios[0] for ratios in by_setup]) == pytest.approx(0.05, rel=0.4)


def test_a_late_sensor_is_late_and_lost_events_are_lost():
    time = np.sqrt(2 * SPACING_M * np.arange(1, 61) / 1.0)
    trains = [Train(0, "drive", time), Train(0, "load", time)]
    board, start = board_of(nature(), TRIALS), np.zeros((len(TRIALS), 1))
    rng = np.random.default_rng(3)
    drive, load = disturbed_trains(trains, board, start, Nuisances(late_s=2e-4), rng)
    assert drive.time_s == pytest.approx(time, abs=1e-15)
    assert load.time_s - time == pytest.approx(2e-4, abs=1e-12)
    fewer = disturbed_trains(trains, board, start, Nuisances(lost=3), rng)
    assert sum(train.time_s.size for train in fewer) == 2 * 60 - 3


def test_the_masses_ring_against_each_other():
    """Times move by the ringing over the speed; the centre of mass does not ring."""
    time = np.sqrt(2 * SPACING_M * np.arange(1, 61) / 1.0)
    trains = [Train(0, sensor, time) for sensor in ("drive", "load")]
    board, start = board_of(nature(), TRIALS), np.zeros((len(TRIALS), 1))
    rng = np.random.default_rng(3)
    drive, load = disturbed_trains(trains, board, start, Nuisances(ring_m=5e-5), rng)
    moved = [sensor.time_s - time for sensor in (drive, load)]
    speed = np.gradient(np.arange(60), time) * SPACING_M
    assert np.abs(moved[0] * speed).max() < 5e-5
    weighed = TRIALS.drive_kg[0] * moved[0] + TRIALS.load_kg[0] * moved[1]
    assert np.abs(weighed).max() < 1e-12
    assert np.abs(moved[0]).max() > 1e-6


def test_sizes_are_drawn_anew_for_each_case():
    drawn = [draw_nuisances(np.random.default_rng(seed)) for seed in range(400)]
    wander = np.array([nuisances.wander for nuisances in drawn])
    # Half-normal of scale 1 %.
    assert wander.mean() == pytest.approx(0.01 * np.sqrt(2 / np.pi), rel=0.12)
    assert np.mean([nuisances.stray != 0 for nuisances in drawn]) == pytest.approx(0.3, abs=0.07)
