"""The reference engine's motion, against closed forms and the balance of energy."""

import numpy as np
import pytest
from blind.engines.boards import G, acting, board
from scipy.integrate import quad

from bayesfric.blind.engines.law import TABLE_I
from bayesfric.blind.engines.motion import move, times_at

ONE_PULLEY = (1, 1, 85.0, 1.6, 1.5)
MANY = (0, 15, 50.0, 3.4665, 2.6515)


def test_one_pulley_is_an_atwood_machine():
    c1, c2, _ = TABLE_I[1]
    by_hand = ((1.6 - (1 + c1) * 1.5) * G - c2) / (1.6 + (1 + c1) * 1.5)
    motion = move(board(ONE_PULLEY), ())
    places = np.array([[0.0031, 0.0098, 0.3, 0.5999]])
    time, speed = times_at(motion, places)
    assert time == pytest.approx(np.sqrt(2 * places / by_hand), rel=1e-9)
    assert speed == pytest.approx(np.sqrt(2 * places * by_hand), rel=1e-8)


def test_many_pulleys_come_near_to_the_mean_of_both_tensions():
    c1, c2, c3 = TABLE_I[0]
    slope = 15 * (c1 + c3 * (50.0 - 85.0))
    # m1 (g − a) − m2 (g + a) = slope T + 15 c2, T the mean of the two, solved for a.
    drive, load = MANY[3:]
    pull, both = (drive - load) * G, drive + load
    tension, change = both * G / 2, (drive - load) / 2
    by_hand = (pull - slope * tension - 15 * c2) / (both - slope * change)
    (acceleration,) = move(board(MANY), ()).acceleration_m_s2[:, 0]
    friction = (slope * tension + 15 * c2) / both
    # The cable enters each pulley half a drop below its mean: (slope + 15 c2/T)/30. Tensions
    # rise as powers, whose mean lies below that of the ends: by slope × friction/12 T.
    share = slope + 15 * c2 / tension
    below = slope / share * (share / 30 + slope * share / 12)
    assert (acceleration - by_hand) / friction == pytest.approx(below, rel=0.03)


def test_drag_in_proportion_to_speed_has_its_exponential():
    c1, c2, _ = TABLE_I[1]
    both, drag = 1.6 + (1 + c1) * 1.5, 0.8
    pull = (1.6 - (1 + c1) * 1.5) * G - c2
    motion = move(
        board(ONE_PULLEY), [acting(lambda p, s, t: p["amplitude"] * s.speed_m_s, "drive", drag)]
    )
    t = motion.time_s[0]
    by_hand = pull / drag * (t - both / drag * -np.expm1(-drag * t / both))
    inside = motion.travel_m[0] < 0.6
    assert motion.travel_m[0][inside] == pytest.approx(by_hand[inside], rel=1e-7, abs=1e-10)


def test_a_spring_stops_the_cable_and_it_stays():
    c1, c2, _ = TABLE_I[1]
    both = 1.6 + (1 + c1) * 1.5
    pull = (1.6 - (1 + c1) * 1.5) * G - c2
    spring = 2 * pull / 0.4  # turns after 0.4 m
    effect = acting(lambda p, s, t: p["amplitude"] * s.travel_m, "drive", spring)
    motion = move(board(ONE_PULLEY), [effect])
    places = np.array([[0.1, 0.2, 0.39, 0.41]])
    time, _ = times_at(motion, places)
    rate = np.sqrt(spring / both)
    assert time[0, :3] == pytest.approx(np.arccos(1 - places[0, :3] / 0.2) / rate, rel=1e-7)
    assert np.isnan(time[0, 3])
    assert motion.stall_m[0] == pytest.approx(0.4, abs=1e-3)
    assert np.all(np.diff(motion.travel_m[0]) >= 0)


def test_a_board_that_does_not_start_stands():
    motion = move(board((0, 19, 85.0, 1.50, 1.49), ONE_PULLEY), ())
    assert motion.stall_m.tolist() == [0.0, np.inf]
    assert np.isnan(times_at(motion, np.array([[0.01], [0.01]]))[0][0, 0])


def test_weights_work_is_kinetic_energy_and_friction_work():
    c1, c2, c3 = TABLE_I[0]
    slope, n, drive, load = c1 + c3 * (50.0 - 85.0), 15, *MANY[3:]

    def per_pulley(x, v, tension):
        low_speed = 0.1 * (slope * tension + c2) * np.exp(-v / 0.15)
        return 0.03 * v + low_speed - 0.3 * c2 * np.exp(-x / 0.02) + 1e-4 * tension**2

    effects = [
        acting(lambda p, s, t: per_pulley(s.travel_m, s.speed_m_s, t), affine=False),
        acting(lambda p, s, t: 0.05 * s.speed_m_s**2, "drive"),
    ]
    motion = move(board(MANY), effects)
    x, v, a = motion.travel_m[0], motion.speed_m_s[0], motion.acceleration_m_s2[0]
    keep = np.concatenate([[True], np.diff(x) > 0])
    x, v, a = x[keep], v[keep], a[keep]

    # In time, where all is smooth: power of friction = tension drop × speed.
    t = motion.time_s[0][keep]

    def power(at):
        (where,) = np.interp([at], t, np.arange(t.size))
        i = min(int(where), t.size - 2)
        h, u = t[i + 1] - t[i], (at - t[i]) / (t[i + 1] - t[i])
        speed = _hermite(u, v[i], v[i + 1], h * a[i], h * a[i + 1])
        travel = _quintic(u, h, x[i : i + 2], v[i : i + 2], a[i : i + 2])
        tension = low = load * (G + _slope(u, v[i], v[i + 1], h * a[i], h * a[i + 1]) / h)
        for _ in range(n):
            tension += slope * tension + c2 + per_pulley(travel, speed, tension)
        return (tension - low + 0.05 * speed**2) * speed

    end = 200
    work = sum(quad(power, t[i], t[i + 1], epsabs=1e-13)[0] for i in range(end))
    kinetic = (drive + load) * v[end] ** 2 / 2
    assert kinetic + work == pytest.approx((drive - load) * G * x[end], rel=1e-8)
    assert work > 0.1 * kinetic


def _hermite(u, left, right, left_rate, right_rate):
    up = 3 * u**2 - 2 * u**3
    return (
        left * (1 - up)
        + right * up
        + left_rate * (u - 2 * u**2 + u**3)
        + right_rate * (u**3 - u**2)
    )


def _slope(u, left, right, left_rate, right_rate):
    up = 6 * u - 6 * u**2
    return (
        (right - left) * up + left_rate * (1 - 4 * u + 3 * u**2) + right_rate * (3 * u**2 - 2 * u)
    )


def _quintic(u, h, x, v, a):
    rows = [[1, 1, 1], [3, 4, 5], [6, 12, 20]]
    remainders = [
        x[1] - x[0] - h * v[0] - h**2 * a[0] / 2,
        h * (v[1] - v[0]) - h**2 * a[0],
        h**2 * (a[1] - a[0]),
    ]
    high = np.linalg.solve(rows, remainders)
    return x[0] + h * v[0] * u + h**2 * a[0] / 2 * u**2 + high @ [u**3, u**4, u**5]


def test_mass_that_pulleys_move_along_adds_to_the_inertia():
    effect = acting(lambda p, s, t: p["amplitude"] + 0 * s.radius_m, "inertia", 0.2)
    (with_mass,) = move(board(ONE_PULLEY), [effect]).acceleration_m_s2[:, 0]
    c1, c2, _ = TABLE_I[1]
    by_hand = ((1.6 - (1 + c1) * 1.5) * G - c2) / (1.6 + (1 + c1) * 1.5 + 0.2)
    assert with_mass == pytest.approx(by_hand, rel=1e-10)
