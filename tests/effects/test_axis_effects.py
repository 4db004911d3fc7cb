"""What an axis' effects add, against numbers worked out by hand."""

import numpy as np
import pytest

from bayesfric.effects import PULLEYS, State, all_effects

EFFECTS = all_effects(None)
AT = State(
    n_pulleys=1.0,
    wrap_angle_deg=85.0,
    tension_n=15.0,
    speed_m_s=0.4,
    tension_friction_n=0.0,
    constant_friction_n=1.5,
    pulley_friction_n=1.5,
    travel_m=0.002,
    acceleration_m_s2=-3.0,
    position_m=0.2,
    direction=-1.0,
    drive_force_n=-4.0,
    mass_kg=2.0,
    force_rate_n_s=20.0,
    lagging_rate_n_s=16.0,
    force_curvature_n_s2=500.0,
    wave_from_m=0.03,
    tested=1.0,
    load=lambda held, heavy, length: (4.0, -0.2),
    carried_n=-5.0,
    held_n=-3.0,
)


@pytest.mark.parametrize(
    ("name", "law", "values", "expected"),
    [
        ("axis-bias", "constant", {"force": 0.3}, -0.3),
        ("direction-asymmetry", "relative", {"share": 0.2}, -0.3),
        ("payload", "carried", {"mass": 0.5}, -1.5),
        ("gravity-torque", "lever", {"torque": 2.0, "angle": 0.1}, -2.0 * np.sin(0.3)),
        ("spring", "linear", {"stiffness": 5.0, "rest": 0.05}, -0.75),
        # The gear drives what it carries along the way it runs; 2 N of that take inertia.
        ("load-asymmetry", "driving", {"share": 0.1}, 0.5),
        ("load-asymmetry", "driven-back", {"share": 0.1}, 0.0),
        ("load-asymmetry", "driving-what-is-held", {"share": 0.1}, 0.3),
        ("load-asymmetry", "driven-back-by-what-is-held", {"share": 0.1}, 0.0),
        # A quarter of a period beyond where it rises, against the way it runs.
        ("cogging", "wave", {"force": 0.5, "period": 0.04}, -0.5),
        ("delay", "late", {"time": 0.005}, 0.1),
        ("actuator-lag", "first-order", {"time": 0.005}, 0.08),
        # Half wound up: 1.5 N of 3 N are missing. The load lags by 1/1500 s² of 500 N/s², a mass
        # of 2 kg at 0.4 m/s is taken along over a third of 4 mm, and half of both counts.
        (
            "transmission-compliance",
            "half-mass",
            {"share": 0.5, "length": 0.004},
            0.5 * (0.5 * (0.32 * 1.5 / np.cosh(1.5) ** 2 / 0.004 - 2 / 3) - 1.5),
        ),
        ("transmission-compliance", "mass", {"share": 0.6, "length": 0.0003}, -0.6 * 0.1),
        ("transmission-compliance", "seen-at-load", {"share": 0.6, "length": 0.0045}, 0.225),
        # 4 N is commanded, 2.5 N is the limit: 1.5 N is lost, against the way it runs.
        ("torque-saturation", "beyond", {"share": 1.0, "limit": 2.5}, 1.5),
        ("torque-saturation", "beyond", {"share": 1.0, "limit": 4.5}, 0.0),
        ("backlash", "friction", {"share": 0.4, "gap": 0.02}, -0.6),
        ("backlash", "friction", {"share": 0.4, "gap": 0.0002}, 0.0),
        # The load gains 4 m/s² on the drive, and a fifth of its friction does not reach the drive.
        ("backlash", "mass", {"share": 0.5, "gap": 0.04}, 0.5 * (2 * 4 - 0.2 * 1.5)),
        ("backlash", "half-mass", {"share": 0.5, "gap": 0.04}, 0.5 * (4 - 0.2 * 1.5)),
        ("backlash", "mass-alone", {"share": 0.5, "gap": 0.04}, 0.5 * 2 * 4),
    ],
)
def test_it_is_the_force_against_the_motion(name, law, values, expected):
    assert EFFECTS[name].laws[law](values, AT) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(
    "name", [name for name, effect in EFFECTS.items() if effect.needs - PULLEYS]
)
def test_a_board_feels_nothing_of_it(name):
    """A board offers no direction, no drive force and no test runs: nothing acts there."""
    board = State(9.0, 85.0, 15.0, 0.4, 1.0, 0.5, 0.1, travel_m=0.3)
    for law in EFFECTS[name].laws.values():
        values = {parameter.name: 0.5 for parameter in EFFECTS[name].parameters}
        assert not np.any(law(values, board))
