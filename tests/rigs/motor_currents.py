"""Currents of a small motor board, and the one dense normal that they are."""

import numpy as np
import pandas as pd
from scipy import stats

from bayesfric.observation.exact import ExactLikelihood
from bayesfric.physics.motor import motor_friction
from bayesfric.recording.tables import Motor, RigConstants
from bayesfric.rigs.motor_board.likelihood import MotorModel
from bayesfric.rigs.motor_board.places import run_condition
from bayesfric.simulate import table1_coefficients

RIG = RigConstants(motor_torque_constant_n_m_per_a=0.0259, capstan_radius_m=0.0065)
VALUES = {
    **{
        f"{name}[{size}]": float(value)
        for size, law in table1_coefficients().items()
        for name, value in law._asdict().items()
    },
    "tau_motor": 0.02,
    "omega_motor": 0.05,
    "omega_intercept_motor": 0.08,
    "torque_constant_factor": 1.02,
    "sigma_current": 0.003,
    "load_noise": 0.004,
}
SCATTER = ("tau_motor", "omega_motor", "omega_intercept_motor")


def motor_likelihood(motor, *arguments, **options):
    return ExactLikelihood(MotorModel(motor, *arguments, **options))


def theta(**changes):
    return {name: np.array([value]) for name, value in (VALUES | changes).items()}


def board():
    """Seven runs on three assemblies, out of order and of both signs, and five idle points."""
    runs = pd.DataFrame(
        {
            "run": list("abcdefg"),
            "setup": ["x", "y", "x", "z", "y", "x", "z"],
            "pulley_size": "medium",
            "n_pulleys": [9, 5, 9, 15, 5, 9, 15],
            "wrap_angle_deg": [85.0, 50.0, 85.0, 85.0, 50.0, 85.0, 85.0],
            "hanging_mass_kg": [1.5, 1.5, 1.0, 1.5, 2.2, 3.0, 1.5],
            "velocity_m_s": [0.1, 0.5, -0.4, 1.2, 0.9, 0.7, -0.2],
            "current_a": [3.95, 3.86, 2.33, 4.10, 5.72, 7.9, 3.2],
        }
    )
    idle = pd.DataFrame(
        {
            "velocity_m_s": [0.1, 0.4, 0.8, 1.2, -0.5],
            "current_a": [0.055, 0.058, 0.064, 0.069, -0.060],
        }
    )
    return Motor(runs, idle)


def constant_friction(condition):
    """The part of friction that does not grow with tension, against the motion."""
    c2 = float(table1_coefficients()["medium"].c2)
    return np.sign(condition.velocity_m_s) * condition.n_pulleys * c2


def one_way(motor):
    """The same board with an idle motor that was only measured raising."""
    return Motor(motor.runs, motor.idle[motor.idle["velocity_m_s"] > 0].reset_index(drop=True))


def dense(motor, values, idle_sd=1.0):
    """Mean and covariance of all currents, runs in the order of the file, idle last."""
    condition = run_condition(motor.runs, RIG)
    friction = motor_friction(table1_coefficients()["medium"], condition)
    per_newton = 0.0065 / (0.0259 * values["torque_constant_factor"])
    load = per_newton * (condition.weight_n + friction)
    speed = np.concatenate([motor.runs["velocity_m_s"], motor.idle["velocity_m_s"]])
    sign = np.sign(speed)
    basis = np.column_stack([sign, sign * np.abs(speed), sign * speed**2])
    if (speed < 0).any() and (speed > 0).any():
        basis = np.column_stack([basis, np.ones_like(sign)])
    size, runs = speed.size, len(motor.runs)
    covariance = idle_sd**2 * basis @ basis.T + values["sigma_current"] ** 2 * np.eye(size)
    moved = np.zeros(size)
    moved[:runs] = per_newton * friction
    covariance[:runs, :runs] += np.diag((values["load_noise"] * load) ** 2)
    covariance += np.diag((values["tau_motor"] * moved) ** 2)
    setup = np.concatenate([motor.runs["setup"], ["idle"] * len(motor.idle)])
    same = setup[:, None] == setup
    covariance += values["omega_motor"] ** 2 * same * np.outer(moved, moved)
    moved[:runs] = per_newton * constant_friction(condition)
    covariance += values["omega_intercept_motor"] ** 2 * same * np.outer(moved, moved)
    mean = np.concatenate([load, np.zeros(size - runs)])
    current = np.concatenate([motor.runs["current_a"], motor.idle["current_a"]])
    return current, mean, covariance


def log_density(current, mean, covariance, rows):
    chosen = np.ix_(rows, rows)
    return stats.multivariate_normal(mean[rows], covariance[chosen]).logpdf(current[rows])
