"""A wave of the force along the path, put into rows by hand, and a log that begins in motion."""

from dataclasses import replace

import numpy as np
import pytest
from rigs.driven_mass import Machine, simulate, write

import bayesfric as bf
from bayesfric.diagnosis.acting import lawbook
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.rigs import all_rigs
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.period import SEARCHED, strongest_wave
from bayesfric.rigs.single_axis.readings import readings_of

pytestmark = pytest.mark.usefixtures("lengths_not_searched")


@pytest.fixture(scope="module")
def trials(tmp_path_factory):
    made = Machine(control_hz=500.0, bandwidth_hz=5.0)
    tables = simulate(made, runs=2, seconds=2.0, seed=3)
    folder = write(tmp_path_factory.mktemp("wave") / "axis", made, *tables)
    return all_rigs()["single-axis"].trials(bf.read_recording(folder))


@pytest.mark.parametrize(("period", "start"), [(0.021, 0.004), (0.033, -0.011)])
def test_the_wave_that_was_put_in_is_found(trials, period, start):
    rows = trials.readings
    wave = np.sin(2 * np.pi * (rows.position - start) / period) @ rows.weights
    strongest = strongest_wave(replace(rows, force=rows.force + 0.3 * wave * rows.way))
    assert strongest.period == pytest.approx(period, rel=0.01)
    middle = 0.5 * (rows.position.min() + rows.position.max())
    turns = (strongest.start - middle) / strongest.period - (start - middle) / period
    assert abs(turns - round(turns)) < 0.05


def test_the_wave_that_was_looked_for_weighs_as_one_of_all(trials):
    effect = trials.suited(all_effects(None)["cogging"])
    (law,) = lawbook(candidates_of(effect))["cogging"]
    assert law.log_weight == pytest.approx(-np.log(SEARCHED))
    assert effect.shape.prior.median == trials.measures.wave.period


def log(position):
    time = np.arange(position.size) * 2e-3
    return EvenLog(time, position, np.ones(time.size), np.ones(time.size, dtype=bool), 2e-3, {})


def windows(position):
    return readings_of([log(position)], [np.zeros(1, dtype=np.intp)], 1e-6)


def test_what_was_before_a_log_that_begins_in_motion_is_left_out():
    """A sine of 0.5 Hz and 0.1 m from its middle: a fifth of the stroke is 0.04 m on, at 131 ms."""
    time = np.arange(4000) * 2e-3
    turning = windows(0.1 * np.sin(np.pi * time))
    begun = turning.time_s - turning.half_s
    assert begun.min() == pytest.approx(np.arcsin(0.4) / np.pi, abs=0.02)
    assert windows(0.1 * time[:2000]).time_s.min() < 0.1  # it never turns: there is nothing better
