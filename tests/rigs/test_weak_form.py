"""Windows of force and momentum against closed forms."""

import numpy as np
import pytest
from rigs.driven_mass import Machine, simulate, write
from scipy.signal import savgol_filter

from bayesfric.recording import read_recording
from bayesfric.rigs import all_rigs
from bayesfric.rigs.single_axis.even_log import (
    even_grid,
    local_polynomial,
    position_noise,
    smooth_motion,
)
from bayesfric.rigs.single_axis.force_rates import _beside
from bayesfric.rigs.single_axis.readings import PIECE, readings_of
from bayesfric.rigs.single_axis.rough import rough_law
from bayesfric.rigs.single_axis.run_rows import _relative_variance, passes_of
from bayesfric.rigs.single_axis.weak_form import node_weights
from bayesfric.rigs.single_axis.weak_form import test_function as bump

pytestmark = pytest.mark.usefixtures("lengths_not_searched")
INTERVAL = 1e-3


@pytest.mark.parametrize("half", [4, 19, 60])
def test_a_parabola_has_its_acceleration_and_no_more(half):
    test = bump(half, INTERVAL)
    time = INTERVAL * np.arange(-half, half + 1)
    assert test.value @ np.ones_like(time) == pytest.approx(1, abs=1e-12)
    assert test.curvature @ (3 + 2 * time + 0.5 * 7 * time**2) == pytest.approx(7, rel=1e-9)
    assert -test.slope @ (3 + 2 * time) == pytest.approx(2, rel=1e-9)


def test_integration_by_parts_is_the_mean_of_the_derivative():
    """Of a sine, ∫ φ'' q dt is −ω² ∫ φ q dt, and −∫ φ' F dt is ∫ φ F' dt."""
    half, omega = 40, 2 * np.pi * 3.0
    test, time = bump(half, INTERVAL), INTERVAL * np.arange(-half, half + 1)
    wave = np.sin(omega * time + 0.3)
    assert test.curvature @ wave == pytest.approx(-(omega**2) * (test.value @ wave), rel=1e-4)
    slope = omega * np.cos(omega * time + 0.3)
    assert -test.slope @ wave == pytest.approx(test.value @ slope, rel=1e-4)


@pytest.mark.parametrize(("half", "degree"), [(1, 2), (3, 2), (20, 4)])
@pytest.mark.parametrize("slope", [False, True])
def test_a_local_polynomial_is_that_of_savitzky_and_golay_up_to_the_ends(half, degree, slope):
    values = np.random.default_rng(4).standard_normal(120).cumsum()
    expected = savgol_filter(values, 2 * half + 1, degree, deriv=int(slope))
    np.testing.assert_allclose(
        local_polynomial(values, half, degree, slope=slope), expected, rtol=0, atol=1e-11
    )


def test_a_few_places_have_the_mean_of_all():
    places, weights = node_weights()
    u = np.linspace(-1, 1, 20001)
    shape = (1 - u**2) ** 3
    for function in (np.exp, np.cos, lambda x: x**4):
        whole = np.trapezoid(shape * function(u), u) / np.trapezoid(shape, u)
        assert weights @ function(places) == pytest.approx(whole, rel=1e-6)


def test_the_noise_of_positions_is_found():
    rng = np.random.default_rng(1)
    time = INTERVAL * np.arange(4000)
    columns = {"position": np.sin(3 * time) + 4e-6 * rng.standard_normal(4000), "force": time}
    assert position_noise(even_grid(time, columns), 1e-9) == pytest.approx(4e-6, rel=0.05)
    assert position_noise(even_grid(time, columns), 1e-4) == pytest.approx(1e-4 / 12**0.5)


def moving(seconds=4.0, interval=INTERVAL, mass=2.0, coulomb=1.5):
    time = np.arange(0, seconds, interval)
    omega = 2 * np.pi * 0.7
    position, velocity = 0.1 * np.sin(omega * time), 0.1 * omega * np.cos(omega * time)
    force = mass * -(omega**2) * position + coulomb * np.sign(velocity)
    return time, position, force


def test_mass_and_friction_come_out_of_an_exact_log():
    time, position, force = moving()
    log = even_grid(time, {"position": position, "force": force})
    rows = readings_of([log], [np.zeros(1, dtype=int)], 1e-9)
    mass, coulomb, viscous, _ = rough_law(rows.force, rows.acceleration, rows.speed.mean(axis=1))
    assert (mass, coulomb) == pytest.approx((2.0, 1.5), rel=1e-4)
    assert viscous == pytest.approx(0.0, abs=1e-3)


def test_no_window_holds_a_reversal():
    """At each turning of the sine the friction jumps; every row has one sign of it."""
    time, position, force = moving(mass=0.0)
    log = even_grid(time, {"position": position, "force": force})
    rows = readings_of([log], [np.zeros(1, dtype=int)], 1e-5)
    np.testing.assert_allclose(rows.force, 1.5, rtol=1e-12)
    turns = (np.arange(6) + 0.5) / 1.4
    assert np.abs(rows.time_s[:, None] - turns).min() > rows.half_s


def test_uneven_samples_are_put_on_a_grid_and_a_gap_is_left_out():
    rng = np.random.default_rng(2)
    time, position, force = moving(interval=5e-4)
    kept = np.sort(rng.choice(time.size, time.size // 2, replace=False))
    kept = kept[(time[kept] < 1.0) | (time[kept] > 1.2)]
    log = even_grid(time[kept], {"position": position[kept], "force": force[kept]})
    rows = readings_of([log], [np.zeros(1, dtype=int)], 1e-6)
    mass, coulomb, _, _ = rough_law(rows.force, rows.acceleration, rows.speed.mean(axis=1))
    assert (mass, coulomb) == pytest.approx((2.0, 1.5), rel=0.01)
    assert not ((rows.time_s > 1.0) & (rows.time_s < 1.2)).any()


def test_travel_is_counted_from_the_last_reversal():
    time, position, force = moving()
    log = even_grid(time, {"position": position, "force": force})
    rows = readings_of([log], [np.zeros(1, dtype=int)], 1e-7)
    later = rows.time_s > 0.6
    np.testing.assert_allclose(
        rows.travel[later], 0.1 + rows.way[later, None] * rows.position[later], atol=2e-4
    )


def test_an_axis_that_rests_has_no_way():
    columns = {"position": np.full(200, 0.3), "force": np.zeros(200)}
    log = even_grid(INTERVAL * np.arange(200), columns)
    assert not smooth_motion(log, 8, 1e-6)[2].any()
    assert readings_of([log], [np.zeros(1, dtype=int)], 1e-6) is None


@pytest.mark.parametrize(("resolution", "reach"), [(1e-6, 2), (1e-3, 8)])
def test_a_stop_is_not_run_over(resolution, reach):
    """An axis at 0.2 m/s stands still from one sample to the next, as friction may have it.

    A parabola through eight samples on either side still moves for eight samples more.
    """
    step, stop = 5e-3, 300
    position = 0.2 * step * np.minimum(np.arange(600.0), stop)
    position = resolution * np.round(position / resolution)
    log = even_grid(step * np.arange(600), {"position": position, "force": np.ones(600)})
    _, velocity, way = smooth_motion(log, 8, resolution / 12**0.5)
    assert not way[stop + 1 :].any()
    assert (way[20 : stop - reach] == 1).all()
    np.testing.assert_allclose(velocity[20 : stop - reach], 0.2, rtol=max(40 * resolution, 1e-2))


@pytest.mark.parametrize(("back", "lasts"), [(0.0, 3), (-0.1, 2)])
def test_a_short_stop_and_a_turn_back_are_not_run_over(back, lasts):
    """What disturbs a joint holds it for some samples, or turns it back; then it goes on.

    A parabola through eight samples on either side moves on all the while, and three samples
    about the stop cannot tell.
    """
    step, stop = 5e-3, 300
    speed = np.full(600, 0.2)
    speed[stop : stop + lasts] = back
    position = step * np.concatenate([[0.0], np.cumsum(speed)[:-1]])
    position += 1e-5 * np.random.default_rng(1).standard_normal(600)
    log = even_grid(step * np.arange(600), {"position": position, "force": np.ones(600)})
    way = smooth_motion(log, 8, 1e-5)[2]
    assert not way[stop : stop + lasts + 1].any()
    assert (way[20 : stop - 2] == 1).all()
    assert (way[stop + lasts + 3 : 580] == 1).all()


def test_pieces_are_neighbours_of_one_pass():
    time, position, force = moving()
    log = even_grid(time, {"position": position, "force": force})
    rows = readings_of([log], [np.array([0, time.size // 2])], 1e-5)
    for piece in range(rows.piece.max() + 1):
        mine = rows.piece == piece
        assert mine.sum() <= PIECE
        assert len(set(rows.way[mine])) == len(set(rows.trial[mine])) == 1
        assert np.ptp(np.diff(rows.time_s[mine])) < 1e-9 if mine.sum() > 2 else True


def test_a_force_that_jumps_between_samples_is_trusted_less_there():
    force = np.sin(2 * np.pi * np.arange(400) / 100)
    # A smooth course hides nothing: its sine squared is twice its median at the most.
    assert _relative_variance(force).max() == pytest.approx(3, rel=0.02)
    force[200:] += 1.0
    loud = _relative_variance(force)
    assert loud[199] > 100 * np.median(loud)
    assert loud[:150].max() == pytest.approx(3, rel=0.06)  # six loud samples move the median


def test_a_later_rate_is_not_told_by_the_errors_of_the_force_itself():
    """What it has beside the earlier one would explain a row by its own error otherwise."""
    rng = np.random.default_rng(4)
    time, position, force = moving(seconds=16.0)
    late = np.interp(time + 0.006, time, force)  # logged 6 ms before it acts
    error = 0.3 * rng.standard_normal(time.size)

    def read(logged):
        log = even_grid(time, {"position": position, "force": logged})
        return readings_of([log], [np.zeros(1, dtype=int)], 1e-5)

    quiet, loud = read(late), read(late + error)
    own = loud.force - quiet.force
    beyond = (loud.lagging_rate - loud.force_rate) - (quiet.lagging_rate - quiet.force_rate)
    assert abs(np.corrcoef(own, beyond)[0, 1]) < 5 / np.sqrt(own.size)


def test_a_curvature_is_told_by_what_lies_beside_a_window():
    kernel, place = _beside(8, 24, 0.002), 0.002 * np.arange(-24, 25)
    assert not kernel[16:33].any()
    moments = [kernel @ values for values in (np.ones(49), place, place**2)]
    assert moments == pytest.approx([0.0, 0.0, 2.0], abs=1e-6)


def test_travel_counts_from_rest():
    position = np.concatenate(
        [np.zeros(20), 0.01 * np.arange(1, 31), 0.3 - 0.01 * np.arange(1, 31)]
    )
    way = np.concatenate([np.zeros(20), np.ones(30), -np.ones(30)])
    travel, before = passes_of(position, way, 9.0)
    assert travel[49] == pytest.approx(0.3)
    assert travel[79] == pytest.approx(0.3, abs=0.011)
    assert (before == 9.0).all()  # nobody saw where it came from
    begun, _ = passes_of(position[20:], way[20:], 9.0)
    assert begun[:20] == pytest.approx(9.0)


def test_nobody_saw_by_which_way_it_came_to_where_a_log_begins():
    """From rest it goes up, and comes back or does not: its first fifth counts in the latter."""
    time = INTERVAL * np.arange(4000)
    angle = np.pi * np.clip(time - 0.2, 0.0, 2.0)
    path, force = 0.5 * (1 - np.cos(angle)), np.cos(angle) + np.sign(np.sin(angle))

    def first(count):
        log = even_grid(time[:count], {"position": path[:count], "force": force[:count]})
        rows = readings_of([log], [np.zeros(1, dtype=np.intp)], 1e-7)
        return rows.position[rows.time_s < 0.8].min()

    assert first(1150) < 0.1
    assert first(4000) > 0.19


@pytest.mark.nightly
def test_a_coarse_encoder_leaves_the_mass_alone(tmp_path):
    """Steps of a two-hundredth of the path: over nine samples the axis seems to stand still."""
    machine = Machine(resolution=1e-3, top_speed=0.3)
    table, samples = simulate(machine, runs=3, seconds=6.0, seed=5)
    recording = read_recording(write(tmp_path / "axis", machine, table, samples))
    law = all_rigs()["single-axis"].trials(recording)._rough
    assert law.mass == pytest.approx(machine.mass, rel=0.03)
    assert law.coulomb == pytest.approx(machine.coulomb, rel=0.03)
