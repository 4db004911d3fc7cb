"""The motor board in the linear model: one current a run, and the idle motor's."""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from bayesfric.analysis import Priors
from bayesfric.arrays import Array
from bayesfric.effects import State
from bayesfric.observation.coefficients import intercept_of, law_of_rows
from bayesfric.observation.linear import NoiseParameter, noise_parameter, rank
from bayesfric.observation.points import LinearReadings
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import BASELINES, FrictionLaw
from bayesfric.physics.motor import (
    load_current,
    nominal_tension,
    tension_feedback,
)
from bayesfric.recording.tables import Motor, RigConstants
from bayesfric.rigs.motor_board.likelihood import idle_basis, is_both_ways
from bayesfric.rigs.motor_board.places import run_condition
from bayesfric.rigs.pulley_radii import pulley_radii

SCATTER, ERROR = (1e-4, 1.0), (1e-5, 1.0)  # looked at


def motor_rows(
    motor: Motor,
    constants: RigConstants,
    laws: Mapping[str, Coefficients],
    baseline: FrictionLaw = BASELINES["paper"],
) -> LinearReadings:
    """Return the runs around a reference law, their readings in ampere.

    The torque constant is the specified one: that it may be another is an effect.

    Parameters
    ----------
    motor : Motor
        Runs and idle measurements.
    constants : RigConstants
        The board.
    laws : mapping of str to Coefficients
        Coefficients of each pulley size.
    baseline : FrictionLaw
        The law.
    """
    runs = motor.runs.rename(columns={"run": "trial"}).reset_index(drop=True)
    assert constants.motor_torque_constant_n_m_per_a and constants.capstan_radius_m
    torque, radius = constants.motor_torque_constant_n_m_per_a, constants.capstan_radius_m
    condition, sizes = run_condition(runs, constants), runs["pulley_size"]
    law = law_of_rows(laws, sizes)
    signed = baseline.motor(law, condition)
    speed = np.asarray(condition.velocity_m_s, dtype=np.float64)
    load = load_current(condition, signed, torque, radius)
    radii = pulley_radii(list(sizes.unique()), constants)
    per_newton = np.sign(speed) * radius / torque
    return LinearReadings(
        name="motor",
        table=runs,
        loads=("hanging_mass_kg",),
        state=State.of(
            law,
            np.asarray(condition.n_pulleys),
            np.asarray(condition.wrap_angle_deg),
            nominal_tension(condition, signed),
            np.abs(speed),
            load,
            radius_m=np.array([radii[size] for size in sizes]),
            order=rank(runs),
            gravity_m_s2=constants.gravity_m_s2,
            steady=True,
        ),
        friction_n=np.abs(signed),
        feedback=tension_feedback(law, condition),
        reading=runs["current_a"].to_numpy(dtype=np.float64) - load,
        per_newton=per_newton,
        errors=(np.ones(len(runs)), load),
        direct="current",
        intercept=per_newton * np.asarray(condition.n_pulleys) * intercept_of(law),
        **_idle(motor, speed),
    )


def _idle(motor: Motor, speed: Array) -> dict[str, Any]:
    """Return the fields of the idle motor's curve, at these speeds of runs [m/s]."""
    idle_speed = motor.idle["velocity_m_s"].to_numpy(dtype=np.float64)
    both_ways = is_both_ways(np.concatenate([speed, idle_speed]))
    idle = idle_basis(idle_speed, both_ways=both_ways)
    idle_current = motor.idle["current_a"].to_numpy(dtype=np.float64)
    fit = np.linalg.lstsq(idle, idle_current, rcond=None)[0]
    rough_a = max(float((idle_current - idle @ fit).std()), 1e-4)
    return {
        "noise": partial(_noise, rough_a),
        "curve": idle_basis(speed, both_ways=both_ways),
        "still_curve": idle,
        "still": idle_current,
        "curve_sd": lambda priors: (priors.idle_current_sd,) * idle.shape[1],
    }


def _noise(rough_a: float, priors: Priors) -> tuple[NoiseParameter, ...]:
    """Return the noise parameters; `rough_a` is the idle readings' own scatter [A]."""
    of_intercept = priors.omega_intercept_motor
    return (
        noise_parameter("tau_motor", priors.tau_motor, 0.012, SCATTER, 0.01, scatters=True),
        noise_parameter("omega_hung", priors.omega_motor, 0.006, SCATTER, 0.001, scatters=True),
        noise_parameter("omega_motor", priors.omega_motor, 0.012, SCATTER, 0.015, scatters=True),
        noise_parameter("omega_intercept_hung", of_intercept, 0.006, SCATTER, 0.001, scatters=True),
        noise_parameter(
            "omega_intercept_motor", of_intercept, 0.012, SCATTER, 0.015, scatters=True
        ),
        noise_parameter("sigma_current", priors.sigma_current, rough_a, ERROR, 0.002),
        noise_parameter("load_noise", priors.load_noise, 0.005, (1e-4, 0.5), 0.005),
    )
