"""Friction pulley by pulley against the recursion itself, and how far it is from eq. (15)."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.optimize import brentq

from bayesfric.physics.friction import (
    Coefficients,
    coulomb_friction,
    equal_pulleys,
    in_a_row,
    recursive_friction,
    tension_slope,
)
from bayesfric.physics.gravity import Condition, board_friction, recursive_board_friction
from bayesfric.rigs.protocols import PROTOCOLS
from bayesfric.simulate import table1_coefficients

TABLE_1 = table1_coefficients()
SMALL = TABLE_1["small"]
G = 9.80665
# Every (size, n, θ) of both protocols.
CELLS = sorted(
    {
        (a.pulley_size, a.n_pulleys, a.wrap_angle_deg)
        for design in PROTOCOLS.values()
        for a in design.assemblies()
    }
)


def pulley_by_pulley(law, wraps):
    """The loss over pulleys that each have a wrap angle of their own, from drive to load."""
    columns = Coefficients(*(np.asarray(value)[..., None] for value in law))
    return in_a_row(tension_slope(columns, 1.0, wraps), law.c2)


def tension_after(law, wraps, tension):
    """Walk from the drive to the load, a pulley at a time."""
    for wrap in wraps:
        tension = (1 - (law.c1 + law.c3 * (wrap - 85))) * tension - law.c2
    return tension


@pytest.mark.parametrize("wraps", [[85.0], [50.0] * 7, [15.0, 180.0, 90.0, 60.0, 150.0]])
def test_the_loss_is_that_of_the_walk(wraps):
    drive = 21.0
    load = tension_after(SMALL, wraps, drive)
    losses = [pulley_by_pulley(SMALL, wraps)]
    if len(set(wraps)) == 1:
        losses.append(equal_pulleys(SMALL, len(wraps), wraps[0]))
    for loss in losses:
        for known_at, tension in (("drive", drive), ("load", load), ("mean", (drive + load) / 2)):
            friction = recursive_friction(loss, tension, known_at)
            assert friction == pytest.approx(drive - load, rel=1e-12)


def test_the_order_of_the_pulleys_matters_to_the_constant_part_only():
    # c2 lost early is pulled through what follows: the steep pulley after it or before it.
    wide_first, other = (pulley_by_pulley(SMALL, wraps) for wraps in ([180.0, 15.0], [15.0, 180.0]))
    assert wide_first.share == pytest.approx(other.share, rel=1e-14)
    first = 1 - (SMALL.c1 + SMALL.c3 * (15 - 85))
    assert wide_first.constant_n == pytest.approx(SMALL.c2 * (1 + first), rel=1e-14)
    assert wide_first.constant_n - other.constant_n > 1e-5


@pytest.mark.parametrize("a", [0.0, 1e-300, 1e-17, 1e-9, 1e-4, 0.3, -0.02])
def test_no_digit_is_lost_at_small_friction(a):
    law, n = Coefficients(a, 0.02, 0.0), 19
    kept = 1 - Fraction(a)
    share = 1 - kept**n
    passes = sum(kept**i for i in range(n))
    for loss in (equal_pulleys(law, n, 85.0), pulley_by_pulley(law, [85.0] * n)):
        assert loss.share == pytest.approx(float(share), rel=1e-14, abs=0)
        assert loss.constant_n == pytest.approx(0.02 * float(passes), rel=1e-14)


def test_draws_and_pulleys_broadcast():
    draws = Coefficients(np.array([0.01, 0.02]), np.array([0.02, 0.03]), np.zeros(2))
    losses = pulley_by_pulley(draws, [60.0, 85.0, 120.0])
    assert losses.share.shape == (2,)
    assert losses.share[1] == pytest.approx(1 - 0.98**3, rel=1e-12)
    table = equal_pulleys(
        Coefficients(*(value[:, None] for value in draws)), np.array([5, 9, 15, 19]), 85.0
    )
    assert table.constant_n.shape == (2, 4)


@pytest.mark.parametrize(("size", "n", "wrap"), CELLS)
def test_board_friction_balances_the_tensions_of_both_ends(size, n, wrap):
    law, m1, m2 = TABLE_1[size], 1.9, 1.3

    def mismatch(acceleration):
        return tension_after(law, [wrap] * n, m1 * (G - acceleration)) - m2 * (G + acceleration)

    acceleration = brentq(mismatch, -20, 20, xtol=1e-15, rtol=1e-15)
    friction = recursive_board_friction(law, Condition(n, wrap, m1, m2, G))
    assert friction == pytest.approx((m1 - m2) * G - (m1 + m2) * acceleration, rel=1e-12)


def test_without_friction_there_is_none():
    condition = Condition(np.array([1, 19]), 85.0, 2.0, 1.8, G)
    assert (recursive_board_friction(Coefficients(0.0, 0.0, 0.0), condition) == 0.0).all()


@pytest.mark.parametrize(("size", "n", "wrap"), CELLS)
def test_at_the_mean_tension_it_exceeds_eq_15_by_a_few_tenths_of_a_per_cent(size, n, wrap):
    law = TABLE_1[size]
    loss, a = equal_pulleys(law, n, wrap), float(tension_slope(law, 1, wrap))
    for tension in (3.0, 15.0, 33.0):
        ratio = recursive_friction(loss, tension, "mean") / coulomb_friction(law, n, wrap, tension)
        assert 0.0009 < ratio - 1 < 0.0070
        # a/2 + a²/3 − (n a)²/12 to third order
        assert ratio - 1 == pytest.approx(
            a / 2 + a**2 / 3 - (n * a) ** 2 / 12, abs=(n * a) ** 3 / 8
        )


@pytest.mark.parametrize(("size", "n", "wrap"), CELLS)
def test_at_one_end_it_differs_from_eq_15_by_half_an_a_for_each_pulley(size, n, wrap):
    law = TABLE_1[size]
    loss, a = equal_pulleys(law, n, wrap), float(tension_slope(law, 1, wrap))
    nominal = coulomb_friction(law, n, wrap, 15.0)
    drive = recursive_friction(loss, 15.0, "drive") / nominal - 1
    load = recursive_friction(loss, 15.0, "load") / nominal - 1
    assert drive == pytest.approx(-(n - 1) * a / 2, abs=(n * a) ** 2 / 6)
    assert load == pytest.approx((n + 1) * a / 2, abs=(n * a) ** 2 / 2)


def test_on_the_board_it_exceeds_eq_15_by_a_tenth_to_seven_tenths_of_a_per_cent():
    excess = []
    for design in PROTOCOLS.values():
        for assembly in design.assemblies():
            drive, load = (np.array(masses) for masses in zip(*assembly.trials, strict=True))
            condition = Condition(assembly.n_pulleys, assembly.wrap_angle_deg, drive, load, G)
            law = TABLE_1[assembly.pulley_size]
            ratio = recursive_board_friction(law, condition) / board_friction(law, condition)
            excess.extend(ratio - 1)
    assert min(excess) == pytest.approx(0.00098, abs=1e-5)
    assert max(excess) == pytest.approx(0.00678, abs=1e-5)


def test_a_tension_known_nowhere_is_refused():
    with pytest.raises(ValueError, match="'motor'"):
        recursive_friction(equal_pulleys(SMALL, 3, 85.0), 10.0, "motor")
