"""The closed forms of the gravity board against numerical integration of its forces."""

import numpy as np
import pytest
from physics.damped import damped_trajectory
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from bayesfric.physics.friction import Coefficients, coulomb_friction
from bayesfric.physics.gravity import (
    Condition,
    board_friction,
    coulomb_acceleration,
    nominal_tension,
    tension_feedback,
    trajectory,
)

SMALL = Coefficients(0.0128, 0.0261, 2.79e-5)
G = 9.80665


def integrate(law, condition, viscous, factor, v0, times):
    """Newton's law with the tension found anew at each step, until the cable stops."""
    n, wrap, m1, m2, g = condition

    def force_balance(a, v, scale):
        tension = 0.5 * ((m1 + m2) * g - (m1 - m2) * a)
        friction = n * ((law.c1 + law.c3 * (wrap - 85)) * tension + law.c2) + viscous * v
        return (m1 + m2) * a - (m1 - m2) * g + scale * friction

    def acceleration(v):
        # The scatter multiplies the friction of the unscattered motion.
        nominal = brentq(force_balance, -50, 50, args=(v, 1.0), xtol=1e-15, rtol=1e-15)
        friction = (m1 - m2) * g - (m1 + m2) * nominal
        return ((m1 - m2) * g - factor * friction) / (m1 + m2)

    def stopped(_t, y):
        return y[1]

    stopped.terminal, stopped.direction = True, -1
    solution = solve_ivp(
        lambda _t, y: (y[1], acceleration(y[1])),
        (0, times[-1]),
        (0.0, v0),
        method="DOP853",
        events=stopped,
        dense_output=True,
        rtol=1e-13,
        atol=1e-14,
    )
    return solution.sol(np.minimum(times, solution.t[-1]))[0], solution.t_events[0]


@pytest.mark.parametrize("factor", [1.0, 1.04])
def test_moving_trial_follows_newtons_law(factor):
    condition = Condition(9, 50.0, 2.0, 1.6, G)
    times = np.linspace(0, 1.2, 25)
    expected, _ = integrate(SMALL, condition, 0.0, factor, 0.07, times)
    motion = trajectory(SMALL, condition, start_speed_m_s=0.07, friction_factor=factor)
    assert np.abs(motion.position(times) - expected).max() < 1e-9


@pytest.mark.parametrize("viscous", [0.0, 0.3, 1e-9, 40.0])
@pytest.mark.parametrize("factor", [1.0, 1.04])
def test_the_reference_with_viscous_friction_follows_newtons_law(viscous, factor):
    condition = Condition(9, 50.0, 2.0, 1.6, G)
    times = np.linspace(0, 1.2, 25)
    expected, _ = integrate(SMALL, condition, viscous, factor, 0.07, times)
    motion = damped_trajectory(
        SMALL, condition, start_speed_m_s=0.07, viscous_n_s_m=viscous, friction_factor=factor
    )
    assert np.abs(motion.position(times) - expected).max() < 1e-9


def test_stalling_trial_stops_and_stays():
    condition = Condition(19, 135.0, 2.0, 1.8, G)  # friction exceeds the drive
    times = np.linspace(0, 3.0, 31)
    expected, stops = integrate(SMALL, condition, 0.0, 1.0, 0.6, times)
    motion = trajectory(SMALL, condition, start_speed_m_s=0.6)
    assert stops.size == 1
    assert abs(float(motion.stop_time) - stops[0]) < 1e-9
    assert np.abs(motion.position(times) - expected).max() < 1e-9
    assert motion.speed(times[-1]) == 0.0
    reach = float(motion.position(np.inf))
    assert motion.time_at(reach * 1.001) == np.inf
    assert motion.time_at(reach * 0.999) < motion.stop_time


def test_cable_at_rest_moves_only_when_the_drive_exceeds_friction():
    at_rest = nominal_tension(Condition(9, 85.0, 1.0, 0.9, G), 0.0)
    friction = float(coulomb_friction(SMALL, 9, 85.0, at_rest))
    balance = friction / G  # mass difference that friction just holds
    for surplus, moves in ((-1e-6, False), (1e-6, True)):
        half = 0.5 * (balance + surplus)
        motion = trajectory(SMALL, Condition(9, 85.0, 0.95 + half, 0.95 - half, G))
        assert (float(motion.position(1.0)) > 0) is moves


@pytest.mark.parametrize("v0", [0.0, 0.3])
def test_time_and_position_are_inverse(v0):
    motion = trajectory(SMALL, Condition(9, 85.0, 2.0, 1.6, G), start_speed_m_s=v0)
    travel = np.linspace(0.001, 0.6, 50)
    assert np.abs(motion.position(motion.time_at(travel)) - travel).max() < 1e-12


def test_speed_is_the_derivative_of_position():
    motion = trajectory(SMALL, Condition(9, 85.0, 2.0, 1.6, G), start_speed_m_s=0.1)
    t, h = np.linspace(0.1, 1.0, 10), 1e-5
    slope = (motion.position(t + h) - motion.position(t - h)) / (2 * h)
    assert np.abs(slope - motion.speed(t)).max() < 1e-9


def test_board_friction_is_the_law_at_its_own_tension():
    condition = Condition(np.array([5, 19]), np.array([50.0, 135.0]), 3.2, 2.4, G)
    friction = board_friction(SMALL, condition)
    tension = nominal_tension(condition, coulomb_acceleration(SMALL, condition))
    expected = coulomb_friction(SMALL, condition.n_pulleys, condition.wrap_angle_deg, tension)
    assert friction == pytest.approx(expected, rel=1e-13)


def test_law_by_hand():
    # n ((c1 + c3 (θ − 85)) T + c2) = 9 ((0.0128 + 2.79e-5 · 50) · 15 + 0.0261)
    assert float(coulomb_friction(SMALL, 9, 135.0, 15.0)) == pytest.approx(2.151225, rel=1e-12)


def test_a_further_drag_is_fed_back_by_the_tension():
    """A drag taken from the driving force changes friction by so much of itself, less one."""
    condition = Condition(15, 50.0, 2.0, 1.6, G)
    slope = 15 * (0.0128 - 35 * 2.79e-5)
    expected = 3.6 / (3.6 - slope * 0.2)
    assert float(tension_feedback(SMALL, condition)) == pytest.approx(expected, rel=1e-12)
