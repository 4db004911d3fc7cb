"""The motor board's closed form against iteration, and the paper's figures."""

import numpy as np
import pytest

from bayesfric.paper import paper
from bayesfric.physics.friction import Coefficients, coulomb_friction
from bayesfric.physics.motor import (
    MotorCondition,
    load_current,
    motor_friction,
    nominal_tension,
    recursive_motor_friction,
    tension_feedback,
)
from bayesfric.simulate import table1_coefficients

G = 9.80665


@pytest.mark.parametrize("velocity", [0.3, -0.3])
def test_friction_is_the_law_at_its_own_tension(velocity):
    law = Coefficients(0.0128, 0.0261, 2.79e-5)
    condition = MotorCondition(15, 135.0, 1.5, velocity, G)
    friction = 0.0
    for _ in range(200):  # F = sign(v) fc(m g + F / 2), by iteration
        tension = 1.5 * G + friction / 2
        friction = np.sign(velocity) * float(coulomb_friction(law, 15, 135.0, tension))
    computed = motor_friction(law, condition)
    assert float(computed) == pytest.approx(friction, rel=1e-12)
    assert float(nominal_tension(condition, computed)) == pytest.approx(tension, rel=1e-12)


@pytest.mark.parametrize("velocity", [0.3, -0.3])
def test_recursive_friction_by_a_loop_over_pulleys(velocity):
    law = Coefficients(0.0128, 0.0261, 2.79e-5)
    a = 0.0128 + 2.79e-5 * 50
    tension = 1.5 * G
    for _ in range(15):  # towards the motor: up when it pulls, down when the weight does
        tension = (tension + 0.0261) / (1 - a) if velocity > 0 else (1 - a) * tension - 0.0261
    computed = recursive_motor_friction(law, MotorCondition(15, 135.0, 1.5, velocity, G))
    assert float(computed) == pytest.approx(tension - 1.5 * G, rel=1e-12)


def test_the_papers_nominal_tensions_come_out():
    quoted = paper()["nominal_tension"]
    for size, law in table1_coefficients().items():
        condition = MotorCondition(
            quoted["n_pulleys"], quoted["wrap_angle_deg"], quoted["hanging_mass_kg"], 0.5, G
        )
        tension = float(nominal_tension(condition, motor_friction(law, condition)))
        assert abs(tension - quoted[f"{size}_n"]) < 0.15, (size, tension)


def test_an_error_of_the_torque_constant_is_magnified():
    """1 % of the torque constant is about 8, 22 and 35 % of friction at n = 9, 1.5 kg."""
    for size, share in (("small", 0.08), ("medium", 0.22), ("large", 0.35)):
        condition = MotorCondition(9, 85.0, 1.5, 0.5, G)
        friction = float(motor_friction(table1_coefficients()[size], condition))
        current = float(load_current(condition, friction, 0.0259, 0.0065))
        inferred = 1.01 * current * 0.0259 / 0.0065 - 1.5 * G
        assert inferred / friction - 1 == pytest.approx(share, rel=0.1)


@pytest.mark.parametrize("velocity", [0.3, -0.3])
def test_a_further_drag_is_fed_back_by_the_tension(velocity):
    """F = sign(v) n (k (m g + (F + D) / 2) + c2) + D, by differences in D."""
    law = Coefficients(0.0128, 0.0261, 2.79e-5)
    condition, sign = MotorCondition(15, 135.0, 1.5, velocity, G), np.sign(velocity)
    forces = []
    for drag in (0.0, 1.0):
        force = 0.0
        for _ in range(200):
            friction = float(coulomb_friction(law, 15, 135.0, 1.5 * G + force / 2))
            force = sign * friction + drag
        forces.append(force)
    feedback = float(tension_feedback(law, condition))
    assert feedback == pytest.approx(forces[1] - forces[0], rel=1e-10)
