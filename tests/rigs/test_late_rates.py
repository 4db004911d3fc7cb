"""Rates by which a delay's and a lag's loss is told, against forces filtered in closed form."""

import numpy as np
import pytest
import scipy

from bayesfric.rigs.single_axis.answered import without_answers
from bayesfric.rigs.single_axis.even_log import even_grid, local_polynomial
from bayesfric.rigs.single_axis.force_rates import late_rates
from bayesfric.rigs.single_axis.readings import readings_of
from bayesfric.rigs.single_axis.weak_form import test_function as bump

INTERVAL = 1e-3


def swinging(hertz, behind_s=0.0, gain=1.0, seconds=4.0):
    time = INTERVAL * np.arange(round(seconds / INTERVAL))
    return time, gain * np.sin(2 * np.pi * hertz * time - 2 * np.pi * hertz * behind_s)


@pytest.mark.parametrize("hertz", [2.0, 12.0])
def test_a_lags_loss_is_exact_however_fast_the_command_changes(hertz):
    """At 12 Hz a lag of 15 ms is a turn of 1.1: up to its second order it is a fifth off."""
    lag_s, omega = 0.015, 2 * np.pi * hertz
    time, command = swinging(hertz)
    gain, behind = 1 / np.hypot(1, omega * lag_s), np.arctan(omega * lag_s) / omega
    acting = swinging(hertz, behind, gain)[1]
    log = even_grid(time, {"position": time, "force": command})
    test, centres = bump(20, INTERVAL), np.arange(1000, 3900, 7)  # long after the start
    curvature = test.over(command, test.curvature, centres)
    lagging = late_rates(log, test, centres, curvature, lag_s)[1]
    lost = test.over(command - acting, test.value, centres)
    np.testing.assert_allclose(lag_s * lagging, lost, atol=2e-3 * np.abs(lost).max())


def test_a_delays_loss_is_told_half_of_it_ago():
    time, command = swinging(2.0)
    log = even_grid(time, {"position": time, "force": command})
    test, centres = bump(20, INTERVAL), np.arange(1000, 3900, 7)
    delayed = late_rates(log, test, centres, np.zeros(centres.size), 0.008)[0]
    lost = test.over(command - swinging(2.0, 0.008)[1], test.value, centres)
    np.testing.assert_allclose(0.008 * delayed, lost, atol=1e-3 * np.abs(lost).max())


def test_what_is_commanded_beyond_a_limit_does_not_act_later():
    """A force of 4 N amplitude, clipped at 3 N, that acts 6 ms after it is logged."""
    time = INTERVAL * np.arange(8000)
    omega = 2 * np.pi * 0.7
    position = 0.1 * np.sin(omega * time)
    command = 4 * np.sin(2 * np.pi * 0.9 * time)
    log = even_grid(time, {"position": position, "force": command})
    rows = readings_of([log], [np.zeros(1, dtype=int)], 1e-6, limit=3.0)
    beyond = np.abs(rows.drive).min(axis=1) > 3.5  # long enough ago, too
    assert beyond.sum() > 20
    for rate in (rows.force_rate, rows.lagging_rate, rows.force_curvature):
        np.testing.assert_allclose(rate[beyond], 0.0, atol=1e-3)  # of 20 N/s
    within = np.abs(rows.drive).max(axis=1) < 2.5
    assert np.abs(rows.force_rate[within]).min() > 5


def test_what_a_loop_answers_to_motion_stays_in_the_force_that_tells_a_delay():
    """Without it a delay of 1 ms was told as none, and viscous friction as less to match."""
    time, place = swinging(1.1, gain=0.4)
    errors = 2e-5 * np.random.default_rng(5).uniform(-0.5, 0.5, time.size)
    stiff, damped = 60.0, 2.0

    def answer(read):
        return -stiff * read - damped * np.diff(read, prepend=read[0]) / INTERVAL

    force = answer(place + errors)
    log = even_grid(time, {"position": place + errors, "force": force})
    quiet = without_answers(log, 60, np.inf)
    inside = slice(200, -200)
    left = np.std((quiet.force - answer(place))[inside])
    assert left < 0.1 * np.std((force - answer(place))[inside])


@pytest.mark.parametrize("kept", [0.0, 0.64, 0.9])
def test_what_a_filtered_speed_answers_slowly_is_taken_away_too(kept):
    """Under a window's slope: the answers that stay longest have the most part there.

    The logged force has noise of its own, which no filter of the controller keeps.
    """
    rng = np.random.default_rng(3)
    time, place = swinging(0.5, seconds=8.0)
    errors = 1e-4 * rng.standard_normal(time.size)

    def answer(read):
        rate = np.diff(read, prepend=read[0]) / INTERVAL
        speed = scipy.signal.lfilter([1 - kept], [1.0, -kept], rate)
        return -4.0 * read - 0.6 * speed

    noise = 1e-3 * rng.standard_normal(time.size)
    force = answer(place + errors) + noise
    log = even_grid(time, {"position": place + errors, "force": force})
    half = 60
    kernel = bump(half // 2, INTERVAL).slope
    # Errors slower than two windows are motion to the polynomial through them.
    errors_told = errors - local_polynomial(errors, 2 * half, 4)
    wanted = np.convolve(force - answer(errors_told), kernel, "same")
    quiet = np.convolve(without_answers(log, half, np.inf).force, kernel, "same")
    logged = np.convolve(force, kernel, "same")
    inside = slice(300, -300)
    assert np.std((quiet - wanted)[inside]) < 0.05 * np.std((logged - wanted)[inside])
