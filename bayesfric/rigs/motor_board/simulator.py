"""Simulation of the motor board: runs in random order, and the idle motor.

The friction of a run scatters with its assembly and by itself. Effects on the drive do not scatter.
The current is the sum of that of the idle motor, that of the load, effects on the current, and
noise that grows with the load.
"""

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.effects import State
from bayesfric.physics.friction import Coefficients, coulomb_friction
from bayesfric.physics.motor import MotorCondition, load_current, motor_friction, nominal_tension
from bayesfric.recording.tables import Motor, RigConstants
from bayesfric.rigs.acting import PhasedEffect, draw_phases, of_kind, surroundings, total
from bayesfric.rigs.motor_board.places import run_condition
from bayesfric.rigs.protocols import (
    IDLE_REPEATS,
    IDLE_SPEEDS_M_S,
    MOTOR_ASSEMBLIES,
    MOTOR_SPEEDS_M_S,
)
from bayesfric.rigs.truth import Truth, laws_of

CURRENT_DECIMALS = 6  # recorded decimals of a current in ampere
TENSION_ITERATIONS = 12  # each reduces the error of the tension by a factor of about 10


def runs_in_random_order(rng: np.random.Generator) -> pd.DataFrame:
    """Return a table of runs, with assemblies, and the runs of each, in random order."""
    rows: list[dict[str, Any]] = []
    for place, chosen in enumerate(rng.permutation(len(MOTOR_ASSEMBLIES)), start=1):
        assembly = MOTOR_ASSEMBLIES[chosen]
        settings = list(product(assembly.masses_kg, MOTOR_SPEEDS_M_S))
        for index in rng.permutation(len(settings)):
            mass, speed = settings[index]
            order = len(rows) + 1
            rows.append(
                {
                    "run": f"m{order:04d}",
                    "order": order,
                    "setup": f"m{place:03d}",
                    "pulley_size": assembly.pulley_size,
                    "n_pulleys": assembly.n_pulleys,
                    "wrap_angle_deg": assembly.wrap_angle_deg,
                    "hanging_mass_kg": mass,
                    "velocity_m_s": speed,
                }
            )
    return pd.DataFrame(rows)


def simulate_motor(
    rig: RigConstants, truth: Truth, rng: np.random.Generator, effects_rng: np.random.Generator
) -> Motor:
    """Return simulated runs with every assembly, weight and speed, and the idle motor."""
    runs = runs_in_random_order(rng)
    assert rig.motor_torque_constant_n_m_per_a and rig.capstan_radius_m
    condition = run_condition(runs, rig)
    setup_index = pd.factorize(runs["setup"])[0]
    eta = truth.omega_motor * rng.standard_normal(setup_index.max() + 1)
    factor = 1 + eta[setup_index] + truth.tau_motor * rng.standard_normal(len(runs))
    law = laws_of(truth, runs["pulley_size"])
    if truth.omega_intercept_motor:
        kappa = truth.omega_intercept_motor * rng.standard_normal(setup_index.max() + 1)
        intercept = np.asarray(condition.n_pulleys) * np.asarray(law.c2)
        factor += kappa[setup_index] * intercept / np.abs(motor_friction(law, condition))
    acting = draw_phases(truth, len(runs), 1, effects_rng)
    around = {**surroundings(runs, rig), "steady": True}
    unscattered, drag = _forces(law, condition, acting, around)
    friction = factor * unscattered + drag
    constant = rig.motor_torque_constant_n_m_per_a * truth.torque_constant_factor
    load = load_current(condition, friction, constant, rig.capstan_radius_m)
    noise = np.hypot(truth.sigma_current, truth.load_noise * load)
    current = _idle(truth, runs["velocity_m_s"].to_numpy()) + load
    state = State.of(
        law,
        condition.n_pulleys,
        condition.wrap_angle_deg,
        nominal_tension(condition, friction),
        np.abs(condition.velocity_m_s),
        load,
        **around,
    )
    current = current + total(of_kind(acting, "current"), state)
    current += noise * rng.standard_normal(len(runs))
    speed = np.repeat(IDLE_SPEEDS_M_S, IDLE_REPEATS)
    idle = _idle(truth, speed) + truth.sigma_current * rng.standard_normal(speed.size)
    return Motor(
        runs=runs.assign(current_a=current.round(CURRENT_DECIMALS)),
        idle=pd.DataFrame({"velocity_m_s": speed, "current_a": idle.round(CURRENT_DECIMALS)}),
    )


def _idle(truth: Truth, velocity_m_s: Array) -> Array:
    level, slope, curvature = truth.idle_current
    speed = np.abs(velocity_m_s)
    return np.asarray(np.sign(velocity_m_s) * (level + slope * speed + curvature * speed**2))


def _forces(
    law: Coefficients,
    condition: MotorCondition,
    acting: Sequence[PhasedEffect],
    around: Mapping[str, Any],
) -> tuple[Array, Array | float]:
    """Return friction without scatter, and forces of effects on the drive, both signed [N]."""
    on_friction, on_drive = of_kind(acting, "friction"), of_kind(acting, "drive")
    if not on_friction and not on_drive:
        return motor_friction(law, condition), 0.0
    n, wrap = condition.n_pulleys, condition.wrap_angle_deg
    sign, speed = np.sign(condition.velocity_m_s), np.abs(condition.velocity_m_s)
    friction = drag = np.zeros_like(speed)
    for _ in range(TENSION_ITERATIONS):
        tension = nominal_tension(condition, friction + drag)
        state = State.of(law, n, wrap, tension, speed, **around)
        size = coulomb_friction(law, n, wrap, state.tension_n)
        friction = np.asarray(sign * (size + total(on_friction, state)))
        drag = np.asarray(sign * total(on_drive, state))
    return friction, drag
