"""Statistics of events that are tabulated over the noise ratio."""

import numpy as np
import pytest
from rigs.hall import SPACING, TICK, design, few_trials

from bayesfric.rigs.gravity_board.hall_events import reduce_events


def events_table(recording):
    gravity = recording.gravity
    ids = gravity.trials["trial"]
    reduced = reduce_events(gravity.events, ids, spacing_m=SPACING, tick_s=TICK)
    return reduced.with_first_speed(1.0)


@pytest.mark.parametrize("ratio", [1e-4, 1e-2, 0.3, 0.67, 5.0, 300.0])
def test_table_agrees_with_a_direct_solution(ratio):
    """â and its variance by weighted least squares on one trial, without the table."""
    recording = few_trials(1, 60)
    sigma_x = 30e-6
    sigma_t = ratio * sigma_x
    events = recording.gravity.events
    tau, columns = design(events)
    columns = np.column_stack([columns, tau**2 / 2])
    travel = events["displacement_m"].to_numpy()
    pilot = np.linalg.lstsq(columns, travel, rcond=None)[0]
    speed = pilot[2] + pilot[3] * tau
    variance = sigma_x**2 + (sigma_t**2 + TICK**2 / 12) * speed**2
    information = columns.T @ (columns / variance[:, None])
    fit = np.linalg.solve(information, columns.T @ (travel / variance))
    acceleration = (
        events_table(recording).at(np.array([sigma_x]), np.array([sigma_t])).acceleration()
    )
    assert acceleration.mean[0, 0] == pytest.approx(fit[3], rel=1e-9)
    assert acceleration.variance[0, 0] == pytest.approx(np.linalg.inv(information)[3, 3], rel=1e-6)


def test_statistics_between_the_nodes_are_those_of_the_events():
    """Over all ratios, whichever interval they are in, of walkers in any order."""
    recording = few_trials(3, 40)
    table = events_table(recording)
    rng = np.random.default_rng(0)
    log_ratio = rng.permutation(np.concatenate([np.linspace(-9.2, 9.2, 41), [-2.0, 0.0, 3.0]]))
    # Of a scale of 1 m, beside which the clock's tick is nothing.
    sigma_x = 1 / np.sqrt(1 + np.exp(2 * log_ratio))
    sigma_t = np.exp(log_ratio) * sigma_x / table.typical_speed
    statistics = table.at(sigma_x, sigma_t)
    exact = table.statistics(log_ratio)
    size = np.abs(exact).max(axis=0)
    form = np.moveaxis(statistics.triangle, 0, 1)
    assert (np.abs(form - exact[:, :-1]) / size[:-1]).max() < 1e-8
    at_scale = table.constant - 0.5 * table.degrees_of_freedom * np.log(2 * np.pi)
    expected = at_scale - 0.5 * exact[:, -1]
    assert np.abs(statistics.log_constant - expected).max() < 1e-5
