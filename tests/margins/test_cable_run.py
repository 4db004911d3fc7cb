"""Friction, efficiency and lost motion of runs of pulleys, against recursions by hand."""

import numpy as np
import pytest
from margins.loops import SMALL, loop, write_draws

from bayesfric.margins.assembly import draw_assembly
from bayesfric.margins.cable_run import run_friction
from bayesfric.margins.posterior import RigDiscrepancy, read_posterior
from bayesfric.margins.reflecting import at_shaft
from bayesfric.physics.friction import Coefficients

C1, C2, C3 = SMALL
LENGTH = 2.0


def friction(factor=1.0, **changes):
    run = loop({f"runs.0.{key}": value for key, value in changes.items()}).runs[0]
    ones = np.ones(1)
    return run_friction(
        run, Coefficients(C1 * ones, C2 * ones, C3 * ones), factor * ones, run.tension_n * ones,
        LENGTH * ones, factor * ones,
    )  # fmt: skip


def passed(tension, angles, factor=1.0):
    """Tension after some pulleys, the cable moving away from the known end."""
    for angle in angles:
        tension = (1 - factor * (C1 + C3 * (angle - 85))) * tension - factor * C2
    return tension


def before(tension, angles):
    for angle in reversed(angles):
        tension = (tension + C2) / (1 - (C1 + C3 * (angle - 85)))
    return tension


def test_thirteen_small_pulleys_at_70_degrees_pass_85_per_cent():
    computed = friction(count=13, wrap_angle_deg=70, topology="open")
    assert computed.efficiency == pytest.approx(0.8505, abs=5e-4)


def test_nominal_friction_is_eq_15_on_both_sides():
    pair = friction(wrap_angle_deg=105, topology="antagonist-pair")
    assert pair.nominal == pytest.approx(2 * 5 * ((C1 + 20 * C3) * 10 + C2), rel=1e-12)
    alone = friction(wrap_angle_deg=105, topology="open")
    assert pair.nominal == pytest.approx(2 * alone.nominal, rel=1e-12)


ANGLES = [30.0, 85.0, 150.0, 60.0, 120.0]


@pytest.mark.parametrize("fixed_at", ["motor", "load"])
def test_pulley_by_pulley_is_the_recursion(fixed_at):
    computed = friction(topology="open", model="recursive", tension_known_at=fixed_at,
                     wrap_angle_deg=ANGLES)  # fmt: skip
    if fixed_at == "load":  # driving: the motor pulls through all pulleys to 10 N at the load
        driving, overhauling = before(10, ANGLES) - 10, 10 - passed(10, ANGLES[::-1])
    else:
        driving, overhauling = 10 - passed(10, ANGLES), before(10, ANGLES[::-1]) - 10
    assert computed.loop == pytest.approx((driving + overhauling) / 2, rel=1e-12)


def test_with_the_mean_tension_known_it_is_nearly_eq_15():
    # 0.1 to 0.6 % apart, pulley by pulley above
    for count in (1, 5, 13):
        nominal = friction(topology="open", count=count).nominal
        mean = friction(topology="open", count=count, model="recursive").loop
        assert 0 < mean / nominal - 1 < 0.008


def test_an_equal_pair_does_not_care_about_the_load_to_first_order():
    # one side tighter by 1 N, the other slacker: their friction changes cancel
    tight = friction(topology="open", tension_n=11.0).nominal
    slack = friction(topology="open", tension_n=9.0).nominal
    assert tight + slack == pytest.approx(friction().nominal, rel=1e-12)


def test_the_assembly_factor_multiplies_friction():
    assert friction(1.1).nominal == pytest.approx(1.1 * friction().nominal, rel=1e-12)
    stiff = friction(2.0, topology="open", count=1)
    assert stiff.efficiency == pytest.approx(1 - 2 * C1, rel=1e-12)


@pytest.mark.parametrize("topology", ["open", "antagonist-pair"])
def test_lost_motion_is_half_of_f_over_k_spread_and_all_at_the_far_end(topology):
    # F over K: of a pair both friction and stiffness count twice
    sides = 2 if topology == "antagonist-pair" else 1
    spread = friction(topology=topology)
    assert spread.lost_length == pytest.approx(spread.loop / sides * LENGTH / 2, rel=1e-12)
    far = friction(topology=topology, distance_m=[LENGTH] * 5)
    assert far.lost_length == pytest.approx(far.loop / sides * LENGTH, rel=1e-12)
    uneven = friction(topology=topology, distance_m=[0.0, 0.0, 0.0, 0.0, LENGTH])
    assert uneven.lost_length == pytest.approx(far.lost_length / 5, rel=1e-12)


def test_where_c2_scatters_alone_friction_scatters_by_its_share(tmp_path):
    # 2 × 5 pulleys, c1 and c3 make 1.28 N of friction and c2 0.261 N; a tenth of c2 is 0.0261 N
    path = write_draws(tmp_path / "draws.nc", n=4000, sd=0.0, omega=0.0, omega_intercept=0.1)
    drawn = read_posterior(path)
    assert drawn.omega_intercept["small"] == pytest.approx(0.1)
    bench = loop()
    given = draw_assembly(bench, drawn, RigDiscrepancy(0.0, ""), seed=1)
    force = at_shaft(bench, given).stages[0].runs[0].nominal
    assert force.mean() == pytest.approx(1.541, rel=2e-3)
    assert force.std() == pytest.approx(0.0261, rel=0.05)
    # beside it the scatter of all three, independent of it
    both = write_draws(tmp_path / "draws.nc", n=4000, sd=0.0, omega=0.02, omega_intercept=0.1)
    given = draw_assembly(bench, read_posterior(both), RigDiscrepancy(0.0, ""), seed=1)
    force = at_shaft(bench, given).stages[0].runs[0].nominal
    assert force.std() == pytest.approx(np.hypot(0.0261, 0.02 * 1.541), rel=0.05)
    # and a fit without it has none
    alone = write_draws(tmp_path / "draws.nc", n=40, sd=0.0, omega=0.0)
    given = draw_assembly(bench, read_posterior(alone), RigDiscrepancy(0.0, ""), seed=1)
    assert np.ptp(at_shaft(bench, given).stages[0].runs[0].nominal) == 0.0
