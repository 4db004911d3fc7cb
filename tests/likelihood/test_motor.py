"""The likelihood of motor currents against one dense normal distribution."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from bayesfric.analysis import Analysis
from bayesfric.boards.motor import motor_friction
from bayesfric.likelihood.model import Model
from bayesfric.likelihood.motor import MotorLikelihood, run_condition
from bayesfric.recording.tables import Motor, Rig
from bayesfric.simulate import table1_coefficients

RIG = Rig(motor_torque_constant_n_m_per_a=0.0259, capstan_radius_m=0.0065)
VALUES = {
    **{
        f"{name}[{size}]": float(value)
        for size, law in table1_coefficients().items()
        for name, value in law._asdict().items()
    },
    "tau_motor": 0.02,
    "omega_motor": 0.05,
    "torque_constant_factor": 1.02,
    "sigma_current": 0.003,
    "load_noise": 0.004,
}


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


def dense(motor, values):
    """Mean and covariance of all currents, runs in the order of the file, idle last."""
    condition = run_condition(motor.runs, RIG)
    friction = motor_friction(table1_coefficients()["medium"], condition)
    per_newton = 0.0065 / (0.0259 * values["torque_constant_factor"])
    load = per_newton * (condition.weight_n + friction)
    speed = np.concatenate([motor.runs["velocity_m_s"], motor.idle["velocity_m_s"]])
    sign = np.sign(speed)
    basis = np.column_stack([sign, sign * np.abs(speed), sign * speed**2])
    size, runs = speed.size, len(motor.runs)
    covariance = basis @ basis.T + values["sigma_current"] ** 2 * np.eye(size)
    moved = np.zeros(size)
    moved[:runs] = per_newton * friction
    covariance[:runs, :runs] += np.diag((values["load_noise"] * load) ** 2)
    covariance += np.diag((values["tau_motor"] * moved) ** 2)
    setup = np.concatenate([motor.runs["setup"], ["idle"] * len(motor.idle)])
    same = setup[:, None] == setup
    covariance += values["omega_motor"] ** 2 * same * np.outer(moved, moved)
    mean = np.concatenate([load, np.zeros(size - runs)])
    current = np.concatenate([motor.runs["current_a"], motor.idle["current_a"]])
    return current, mean, covariance


def log_density(current, mean, covariance, rows):
    chosen = np.ix_(rows, rows)
    return stats.multivariate_normal(mean[rows], covariance[chosen]).logpdf(current[rows])


def test_all_currents_are_one_normal():
    motor = board()
    expected = log_density(*dense(motor, VALUES), np.arange(12))
    likelihood = MotorLikelihood(motor, RIG, Analysis())
    assert likelihood.log_likelihood(theta())[0] == pytest.approx(expected, abs=1e-7)


def test_leaving_out_runs_and_assemblies_is_a_ratio_of_densities():
    """The idle curve is shared, so what is left out hangs together with all the rest."""
    motor = board()
    likelihood = MotorLikelihood(motor, RIG, Analysis())
    pieces = dense(motor, VALUES)
    whole = log_density(*pieces, np.arange(12))
    by_run = dict(
        zip(likelihood.trials["trial"], likelihood.trial_log_likelihood(theta())[0], strict=True)
    )
    for place, run in enumerate(motor.runs["run"]):
        rest = np.delete(np.arange(12), place)
        assert by_run[run] == pytest.approx(whole - log_density(*pieces, rest), abs=1e-6)
    by_setup = dict(
        zip(likelihood.setups, likelihood.setup_log_likelihood(theta())[0], strict=True)
    )
    for setup in "xyz":
        left_out = np.flatnonzero(motor.runs["setup"] == setup)
        rest = np.delete(np.arange(12), left_out)
        assert by_setup[setup] == pytest.approx(whole - log_density(*pieces, rest), abs=1e-6)


def test_walkers_are_independent_rows():
    likelihood = MotorLikelihood(board(), RIG, Analysis())
    other = {"torque_constant_factor": 0.97, "omega_motor": 0.01, "c1[medium]": 0.005}
    both = {
        name: np.concatenate([one, two])
        for (name, one), two in zip(theta().items(), theta(**other).values(), strict=True)
    }
    for density in ("log_likelihood", "setup_log_likelihood", "trial_log_likelihood"):
        together = getattr(likelihood, density)(both)
        alone = getattr(likelihood, density)(theta(**other))
        assert together[1] == pytest.approx(alone[0], abs=1e-9)


def test_observed_friction_is_datas_formula():
    """F = k_t (I − I_idle) / r − m g, with an idle curve that the points lie on."""
    motor = board()
    speed = motor.idle["velocity_m_s"]
    motor.idle["current_a"] = np.sign(speed) * (0.05 + 0.01 * np.abs(speed))
    found = MotorLikelihood(motor, RIG, Analysis())
    by_run = dict(zip(found.trials["trial"], found.observed(theta())[0], strict=True))
    expected = 1.02 * 0.0259 * (2.33 + 0.05 + 0.004) / 0.0065 - 1.0 * 9.80665
    assert by_run["c"] == pytest.approx(expected, rel=1e-9)


def test_start_has_a_finite_density():
    model = Model([MotorLikelihood(board(), RIG, Analysis())])
    assert np.isfinite(model.log_posterior(model.start()[None]))[0]
