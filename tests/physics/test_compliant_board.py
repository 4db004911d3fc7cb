"""Model (3): Runge-Kutta against DOP853, the closed form against both, and energy."""

from dataclasses import fields

import numpy as np
import pytest
from physics.compliant import CompliantMotion, compliant_motion, integrate
from scipy.integrate import simpson, solve_ivp

from bayesfric.analysis import Priors
from bayesfric.physics.cable import Cable
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import (
    Condition,
    board_friction,
    coulomb_acceleration,
    nominal_tension,
    trajectory,
)
from bayesfric.simulate import table1_coefficients

G = 9.80665
MEDIUM = table1_coefficients()["medium"]
BOARD = Condition(9, 85.0, 1.75, 1.41, G)  # 15.5 N, 0.8 m/s²
STALLS = Condition(19, 135.0, 2.0, 1.9, G)  # friction exceeds the drive
TIMES = np.linspace(0.0, 1.2, 121)
STATIC = float(compliant_motion(BOARD, 0.0).start_stretch_m)


def reference(motion, times):
    """Eq. (3) as printed, with m1 g in the first row, until the centre of mass stops."""
    m1, m2, g, fc, fv, k, b, v0, stretch = (float(getattr(motion, f.name)) for f in fields(motion))

    def right_hand_side(_t, y):
        x1, x2, v1, v2 = y
        pull = k * (stretch + x1 - x2) + b * (v1 - v2)
        drag = fc / 2 + fv / 4 * (v1 + v2)
        return v1, v2, (m1 * g - pull - drag) / m1, (-m2 * g + pull - drag) / m2

    def stopped(_t, y):
        return m1 * y[2] + m2 * y[3]

    stopped.terminal, stopped.direction = True, -1
    solution = solve_ivp(
        right_hand_side,
        (0.0, times[-1]),
        (0.0, 0.0, v0, v0),
        method="DOP853",
        events=stopped if fc >= (m1 - m2) * g else None,
        dense_output=True,
        rtol=1e-12,
        atol=1e-14,
    )
    return solution.sol(np.minimum(times, solution.t[-1])), solution.t[-1]


def friction(condition):
    return float(board_friction(MEDIUM, condition))


@pytest.mark.parametrize("viscous", [0.0, 0.4])
@pytest.mark.parametrize(
    ("condition", "speed", "stretch", "damping_ratio"),
    [
        (BOARD, 0.0, None, 0.05),
        (BOARD, 0.12, None, 0.0),
        (BOARD, 0.1, 1.3 * STATIC, 0.05),
        (BOARD, 0.1, 0.5 * STATIC, 1.0),
        (BOARD, 0.1, 1.3 * STATIC, 2.5),
        (STALLS, 0.3, None, 0.05),
        (STALLS, 0.3, 0.0, 0.05),
    ],
)
def test_runge_kutta_and_closed_form_follow_eq_3(condition, speed, stretch, damping_ratio, viscous):
    motion = compliant_motion(
        condition,
        friction(condition),
        Cable(damping_ratio=damping_ratio),
        viscous_n_s_m=viscous,
        start_speed_m_s=speed,
        start_stretch_m=stretch,
    )
    expected, _ = reference(motion, TIMES)
    got = integrate(motion, TIMES)
    assert np.abs(np.array(got[:2]) - expected[:2]).max() < 1e-8
    if viscous == 0.0:
        closed = motion.ends(TIMES)
        assert np.abs(np.array(closed[:2]) - expected[:2]).max() < 1e-9
        assert np.abs(np.array(closed) - np.array(got)).max() < 1e-6  # speeds too


@pytest.mark.parametrize("viscous", [0.0, 0.4])
@pytest.mark.parametrize("stretch", [None, 0.6 * STATIC])
def test_energy_balance_closes(viscous, stretch):
    motion = compliant_motion(
        BOARD, friction(BOARD), viscous_n_s_m=viscous, start_speed_m_s=0.1, start_stretch_m=stretch
    )
    times = np.linspace(0.0, 0.8, 4001)
    x1, x2, v1, v2 = integrate(motion, times)
    m1, m2, k = motion.mass_drive_kg, motion.mass_load_kg, motion.stiffness_n_m
    gravity = G * (m1 * x1[-1] - m2 * x2[-1])
    dry = 0.5 * motion.friction_n * (x1[-1] + x2[-1])
    wet = simpson(0.25 * viscous * (v1 + v2) ** 2, x=times)
    damped = simpson(motion.damping_n_s_m * (v1 - v2) ** 2, x=times)
    kinetic = 0.5 * (m1 * v1**2 + m2 * v2**2)
    elastic = 0.5 * k * (motion.start_stretch_m + x1 - x2) ** 2
    stored = kinetic[-1] - kinetic[0] + elastic[-1] - elastic[0]
    assert damped > 1e-8
    assert gravity - dry - wet - damped == pytest.approx(stored, abs=1e-9)


@pytest.mark.parametrize("viscous", [0.0, 0.4])
def test_a_stiff_cable_recovers_eqs_4_and_5(viscous):
    rigid = trajectory(MEDIUM, BOARD, start_speed_m_s=0.1)
    times = np.linspace(0.0, 0.3, 1501)
    gap = []
    for stiffer in (1.0, 100.0):
        motion = compliant_motion(
            BOARD,
            friction(BOARD),
            Cable(15e3 * stiffer),
            start_speed_m_s=0.1,
            viscous_n_s_m=viscous,
        )
        expected = motion.rigid.position(times)
        if viscous == 0.0:
            assert np.abs(expected - rigid.position(times)).max() < 1e-14
        ends = integrate(motion, times)
        gap.append(max(np.abs(x - expected).max() for x in ends[:2]))
    assert gap[0] > 1e-6
    assert gap[1] == pytest.approx(gap[0] / 100, rel=0.05)  # linear in 1/k


def test_the_cable_rings_around_the_nominal_tension():
    motion = compliant_motion(BOARD, friction(BOARD))
    tension = nominal_tension(BOARD, coulomb_acceleration(MEDIUM, BOARD))
    assert motion.stiffness_n_m * motion.moving_stretch_m == pytest.approx(tension, rel=1e-12)
    late = motion.ends(10.0)
    stretch = motion.start_stretch_m + late.drive_position_m - late.load_position_m
    assert stretch == pytest.approx(motion.moving_stretch_m, rel=1e-12)


def test_damping_ratio_is_the_logarithmic_decrement():
    zeta = 0.05
    motion = compliant_motion(BOARD, friction(BOARD), Cable(damping_ratio=zeta))
    rate = np.sqrt(motion.stiffness_n_m / motion.reduced_mass_kg * (1 - zeta**2))
    ends = motion.ends(2 * np.pi / rate * np.arange(4))  # a swing each
    away = (
        motion.start_stretch_m
        + ends.drive_position_m
        - ends.load_position_m
        - motion.moving_stretch_m
    )
    decrement = 2 * np.pi * zeta / np.sqrt(1 - zeta**2)
    assert np.log(away[:-1] / away[1:]) == pytest.approx(decrement, rel=1e-9)


def test_a_stalling_board_stops_with_its_centre_of_mass_and_stays():
    motion = compliant_motion(STALLS, friction(STALLS), start_speed_m_s=0.3)
    times = np.linspace(0.0, 3.0, 61)
    _, stop = reference(motion, times)
    assert float(motion.rigid.stop_time) == pytest.approx(stop, abs=1e-10)
    for ends in (integrate(motion, times), motion.ends(times)):
        after = times > stop
        assert np.ptp(np.array(ends)[:2, after], axis=1).max() == 0.0
        assert np.abs(np.array(ends)[2:, after]).max() == 0.0
    for end in ("drive", "load"):
        reach = getattr(motion.ends(times[-1]), f"{end}_position_m")
        assert motion.time_at(1.001 * reach, end) == np.inf
        assert motion.time_at(0.999 * reach, end) < stop


def test_at_rest_it_moves_only_when_the_drive_exceeds_friction():
    drive = float(BOARD.drive_force_n)
    for surplus, moves in ((0.0, False), (-1e-3, False), (1e-3, True)):
        motion = compliant_motion(BOARD, drive - surplus)
        ends = integrate(motion, [0.0, 1.0])
        assert all((float(x[-1]) > 0) is moves for x in ends[:2])
        assert np.array(motion.ends(1.0)[:2]) == pytest.approx(np.array(ends[:2])[:, -1], abs=1e-9)
    # The static stretch balances both masses when friction is all of the drive.
    held = compliant_motion(BOARD, drive)
    assert held.start_stretch_m == pytest.approx(held.moving_stretch_m, rel=1e-12)


def test_friction_that_matches_the_drive_holds_a_strained_cable_too():
    # Many masses, so that the sum of the forces on the two is not always rounded to zero.
    condition = BOARD._replace(mass_load_kg=np.linspace(1.2, 1.7, 200))
    strained = compliant_motion(condition, condition.drive_force_n, start_stretch_m=0.5 * STATIC)
    assert np.abs(integrate(strained, [0.0, 0.05])).max() == 0.0
    assert np.abs(strained.ends(0.05)).max() == 0.0


@pytest.mark.parametrize("stretch", [None, 0.8 * STATIC])
@pytest.mark.parametrize("end", ["drive", "load"])
def test_time_and_position_are_inverse(end, stretch):
    motion = compliant_motion(BOARD, friction(BOARD), start_speed_m_s=0.05, start_stretch_m=stretch)
    travel = np.linspace(0.003, 0.6, 60)
    back = getattr(motion.ends(motion.time_at(travel, end)), f"{end}_position_m")
    assert np.abs(back - travel).max() < 1e-13


def test_a_batch_is_its_trials_one_by_one():
    loads = np.array([1.41, 1.5, 1.72])
    stiffness = np.array([[15e3], [18e3]])
    condition = BOARD._replace(mass_load_kg=loads)
    batch = compliant_motion(
        condition, board_friction(MEDIUM, condition), Cable(stiffness), start_speed_m_s=0.2
    )
    together = integrate(batch, TIMES)
    assert together.drive_position_m.shape == (2, 3, TIMES.size)
    for place in np.ndindex(2, 3):
        trial = CompliantMotion(*(getattr(batch, f.name)[place] for f in fields(batch)))
        alone = trial.ends(TIMES)
        assert np.abs(together.load_position_m[place] - alone.load_position_m).max() < 1e-9


def test_what_cannot_be_solved_is_refused():
    with pytest.raises(ValueError, match="integrate"):
        compliant_motion(BOARD, 0.7, viscous_n_s_m=0.1).ends(0.5)
    for times in ([0.2, 0.1], [-0.1, 0.1], [[0.1]]):
        with pytest.raises(ValueError, match="ascending"):
            integrate(compliant_motion(BOARD, 0.7), times)


def test_the_default_cable_is_the_median_of_its_priors():
    priors, cable = Priors(), Cable()
    assert cable.axial_stiffness_n == priors.axial_stiffness_n.median
    assert cable.length_m == priors.cable_length_m.median
    assert cable.damping_ratio == priors.damping_ratio.median


def test_friction_may_be_constant_or_the_law():
    frictionless = compliant_motion(BOARD, board_friction(Coefficients(0.0, 0.0, 0.0), BOARD))
    expected = BOARD.drive_force_n / BOARD.total_mass_kg
    assert frictionless.rigid.acceleration == pytest.approx(float(expected), rel=1e-14)
