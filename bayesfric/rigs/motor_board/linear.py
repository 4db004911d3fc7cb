"""The motor board in the linear model: one current for each run, and those of the idle motor."""

from collections.abc import Mapping
from functools import partial

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

SCATTER = (1e-4, 1.0)  # range of the search for relative scatter
ERROR = (1e-5, 1.0)  # range of the search for the noise of a current [A]


def motor_rows(
    motor: Motor,
    constants: RigConstants,
    laws: Mapping[str, Coefficients],
    baseline: FrictionLaw = BASELINES["paper"],
) -> LinearReadings:
    """Return the runs, linearised around a reference law, with readings in ampere.

    The torque constant is the specified one. A deviation of it is an effect.

    Parameters
    ----------
    motor, constants : Motor, RigConstants
        Runs and measurements of the idle motor, and constants of the board.
    laws : mapping of str to Coefficients
        Coefficients of each pulley size.
    baseline : FrictionLaw
        The friction law.
    """
    runs = motor.runs.rename(columns={"run": "trial"}).reset_index(drop=True)
    assert constants.motor_torque_constant_n_m_per_a and constants.capstan_radius_m
    torque, radius = constants.motor_torque_constant_n_m_per_a, constants.capstan_radius_m
    condition, sizes = run_condition(runs, constants), runs["pulley_size"]
    law = law_of_rows(laws, sizes)
    signed = baseline.motor(law, condition)
    speed = np.asarray(condition.velocity_m_s, dtype=np.float64)
    load = load_current(condition, signed, torque, radius)
    idle_speed, idle_current = motor.idle[["velocity_m_s", "current_a"]].to_numpy(np.float64).T
    both_ways = is_both_ways(np.concatenate([speed, idle_speed]))
    idle = idle_basis(idle_speed, both_ways=both_ways)
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
            radius_m=sizes.map(pulley_radii(list(sizes.unique()), constants)).to_numpy(np.float64),
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
        noise=partial(_noise, _scatter_of(idle, idle_current)),
        curve=idle_basis(speed, both_ways=both_ways),
        still_curve=idle,
        still=idle_current,
        curve_sd=lambda priors: (priors.idle_current_sd,) * idle.shape[1],
    )


def _scatter_of(columns: Array, current_a: Array) -> float:
    """Return the scatter of idle currents around their least-squares curve, at least 1e-4 A [A]."""
    curve = np.linalg.lstsq(columns, current_a, rcond=None)[0]
    return max(float((current_a - columns @ curve).std()), 1e-4)


def _noise(rough_a: float, priors: Priors) -> tuple[NoiseParameter, ...]:
    """Return the noise parameters; `rough_a` is the scatter of the idle currents [A]."""
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
