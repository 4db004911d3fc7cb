"""Likelihood of the motor board: all currents, of the runs and of the idle motor.

Given the parameters, a run's current is

    I = h(v)ᵀβ + (r / k_t)(m g + F (1 + η_i + ε_ij)) + noise,

with the idle curve h(v)ᵀβ shared by every run and by the idle measurements. β, η
and ε are Gaussian and linear, so they are marginalised in closed form: the currents
are one normal whose covariance is diagonal, plus a rank-one block an assembly, plus
the idle curve's few columns (Woodbury's identity). The noise of a current grows with
the load: variance σ_I² + (λ · load current)².
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.analysis import Analysis
from bayesfric.boards.motor import MotorCondition, load_current, motor_friction
from bayesfric.friction import REFERENCE_WRAP_ANGLE_DEG
from bayesfric.likelihood.coefficients import SizeIndex, coefficient_parameters
from bayesfric.likelihood.scatter import LOG_2PI, SetupIndex
from bayesfric.priors import Parameter
from bayesfric.recording.tables import Motor, Rig

__all__ = ["MotorLikelihood", "idle_basis", "run_condition"]

Array = NDArray[np.float64]
LEAST_C1 = 1e-4  # a start above zero, where least squares does not give one
LEAST_C2_N = 1e-3
START = {
    "torque_constant_factor": 1.0,
    "load_noise": 0.005,
    "tau_motor": 0.01,
    "omega_motor": 0.02,
}


def run_condition(runs: pd.DataFrame, rig: Rig) -> MotorCondition:
    """Return the condition of each run, arrays of shape (N,)."""
    return MotorCondition(
        runs["n_pulleys"].to_numpy(dtype=np.float64),
        runs["wrap_angle_deg"].to_numpy(dtype=np.float64),
        runs["hanging_mass_kg"].to_numpy(dtype=np.float64),
        runs["velocity_m_s"].to_numpy(dtype=np.float64),
        rig.gravity_m_s2,
    )


def idle_basis(velocity_m_s: Array) -> Array:
    """Return the idle curve's columns sign(v) [1, |v|, v²], v in m/s; shape (N, 3).

    The idle current carries the sign of the torque that raises, as the motor's own
    friction does: an odd curve, level plus slope plus curvature.
    """
    speed = np.abs(velocity_m_s)
    columns = np.stack([np.ones_like(speed), speed, speed**2], axis=1)
    return np.asarray(np.sign(velocity_m_s)[:, None] * columns)


@dataclass(frozen=True)
class _Pieces:
    """The normal distribution of all currents, taken apart; shapes (W, …)."""

    r: Array  # (W, M) residuals of β = 0
    d: Array  # (W, M) diagonal
    load: Array  # (W, M) u: what an assembly's η moves
    gain: Array  # (W, G) 1 + Σ u²/d of a group
    solved: Array  # (W, M) A⁻¹ r, with A the diagonal plus the blocks u uᵀ
    basis: Array  # (W, 3, M) A⁻¹ B, with B the idle curve's columns


class MotorLikelihood:
    """Currents of the motor board, given coefficients, torque constant and noise.

    Parameters
    ----------
    motor : Motor
        Runs and idle measurements.
    rig : Rig
        The board; torque constant and capstan radius.
    analysis : Analysis
        Priors.

    Attributes
    ----------
    parameters : tuple of Parameter
        What the likelihood depends on.
    trials : DataFrame
        The N runs in the order of every result, their id as ``trial``.
    setups : tuple of str
        The J assemblies in the order of every result.
    sizes : tuple of str
        Pulley sizes.
    """

    def __init__(self, motor: Motor, rig: Rig, analysis: Analysis) -> None:
        assert rig.motor_torque_constant_n_m_per_a and rig.capstan_radius_m
        codes, setups = pd.factorize(motor.runs["setup"])
        order = codes.argsort(kind="stable")
        runs = motor.runs.iloc[order].reset_index(drop=True).rename(columns={"run": "trial"})
        self.trials = runs
        self.setups = tuple(str(setup) for setup in setups)
        self.condition = run_condition(runs, rig)
        self._torque_constant = rig.motor_torque_constant_n_m_per_a
        self._radius = rig.capstan_radius_m
        self._size = SizeIndex.of(runs["pulley_size"])
        self.sizes = self._size.sizes
        idle_speed = motor.idle["velocity_m_s"].to_numpy(dtype=np.float64)
        speed = np.concatenate([runs["velocity_m_s"].to_numpy(dtype=np.float64), idle_speed])
        self._current = np.concatenate(
            [runs["current_a"].to_numpy(), motor.idle["current_a"].to_numpy()]
        )
        # The idle measurements are a last group of their own, which no η moves.
        starts = np.flatnonzero(np.diff(codes[order], prepend=-1))
        self._runs = len(runs)
        self._index = SetupIndex(np.append(starts, len(runs)), speed.size)
        priors = analysis.priors
        self._columns = idle_basis(speed) * priors.idle_current_sd
        self.parameters = (
            *coefficient_parameters(self.sizes, analysis),
            Parameter("tau_motor", "1", priors.tau_motor),
            Parameter("omega_motor", "1", priors.omega_motor),
            Parameter("torque_constant_factor", "1", priors.torque_constant_factor),
            Parameter("sigma_current", "A", priors.sigma_current),
            Parameter("load_noise", "1", priors.load_noise),
        )

    def law(self, theta: Mapping[str, Array]) -> Array:
        """Return the law's signed friction of each run [N], shape (W, N)."""
        return motor_friction(self._size.coefficients(theta), self.condition)

    def observed(self, theta: Mapping[str, Array]) -> Array:
        """Return the signed friction that the currents show [N], shape (W, N).

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.

        Returns
        -------
        ndarray, shape (W, N)
            ``k_t (I − I_idle(v)) / r − m g`` with the idle curve of the idle
            measurements alone.
        """
        idle = slice(self._runs, None)
        curve = np.linalg.lstsq(self._columns[idle], self._current[idle], rcond=None)[0]
        beyond = (self._current - self._columns @ curve)[: self._runs]
        return np.asarray(self._per_ampere(theta) * beyond - self.condition.weight_n)

    def draw_scatter(self, theta: Mapping[str, Array], rng: np.random.Generator) -> Array:
        """Draw the relative deviation from the law of a new run on a new assembly.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        rng : Generator
            Source of randomness.

        Returns
        -------
        ndarray, shape (W, N)
            Of friction alone, without the noise of the current.
        """
        spread = np.hypot(theta["tau_motor"], theta["omega_motor"])
        return np.asarray(spread[:, None] * rng.standard_normal((len(spread), self._runs)))

    def start(self) -> dict[str, float]:
        """Return rough estimates by least squares, a place to climb from."""
        idle = slice(self._runs, None)
        curve = np.linalg.lstsq(self._columns[idle], self._current[idle], rcond=None)[0]
        left = self._current[idle] - self._columns[idle] @ curve
        start = START | {"sigma_current": max(float(left.std()), 1e-5)}
        friction = self.observed({"torque_constant_factor": np.ones(1)})[0]
        sign = np.sign(np.asarray(self.condition.velocity_m_s))
        tension = self.condition.weight_n + 0.5 * friction
        n = np.asarray(self.condition.n_pulleys)
        wrap = np.asarray(self.condition.wrap_angle_deg) - REFERENCE_WRAP_ANGLE_DEG
        columns = np.stack([n * tension, n, n * tension * wrap], axis=1)
        for place, size in enumerate(self.sizes):
            rows = self._size.of_trial == place
            width = np.abs(columns[rows]).max(axis=0)
            width[width == 0] = 1.0
            scaled = np.linalg.lstsq(columns[rows] / width, (sign * friction)[rows], rcond=1e-3)[0]
            c1, c2, c3 = scaled / width
            start[f"c1[{size}]"] = max(float(c1), LEAST_C1)
            start[f"c2[{size}]"] = max(float(c2), LEAST_C2_N)
            start[f"c3[{size}]"] = float(c3)
        return start

    def log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return the log density of all currents, shape (W,)."""
        pieces = self._pieces(theta)
        inner, right = self._inner(pieces)
        log_determinant = (
            np.log(pieces.d).sum(-1) + np.log(pieces.gain).sum(-1) + np.linalg.slogdet(inner)[1]
        )
        square = (pieces.r * pieces.solved).sum(-1) - _quadratic(inner, right)
        return np.asarray(-0.5 * (pieces.r.shape[-1] * LOG_2PI + log_determinant + square))

    def setup_log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return each assembly's log density given all other currents, shape (W, J)."""
        pieces = self._pieces(theta)
        inner, right = self._inner(pieces)
        # The same information with one assembly left out, an assembly at a time.
        own = np.stack(
            [
                [self._index.total(pieces.basis[:, i] * self._columns.T[j]) for j in range(3)]
                for i in range(3)
            ]
        )
        own = np.moveaxis(own, (0, 1), (-2, -1))[:, :-1]  # (W, J, 3, 3)
        own_right = np.moveaxis(self._index.total(pieces.basis * pieces.r[:, None]), 1, -1)[:, :-1]
        rest = inner[:, None] - own
        guess = np.linalg.solve(rest, (right[:, None] - own_right)[..., None])[..., 0]
        of_trial = self._index.of_trial[: self._runs]
        shift = (guess[:, of_trial] * self._columns[: self._runs]).sum(-1)
        error = np.concatenate(
            [pieces.r[:, : self._runs] - shift, np.zeros_like(pieces.r[:, self._runs :])], axis=1
        )
        solved = self._solve(error, pieces.d, pieces.load, pieces.gain)
        right_error = np.moveaxis(self._index.total(pieces.basis * error[:, None]), 1, -1)[:, :-1]
        whole = np.broadcast_to(inner[:, None], rest.shape)
        square = self._index.total(error * solved)[:, :-1] - _quadratic(whole, right_error)
        log_determinant = (
            self._index.total(np.log(pieces.d))[:, :-1]
            + np.log(pieces.gain[:, :-1])
            + np.linalg.slogdet(inner)[1][:, None]
            - np.linalg.slogdet(rest)[1]
        )
        counts = self._index.total(np.ones(self._index.trials))[:-1]
        return np.asarray(-0.5 * (counts * LOG_2PI + log_determinant + square))

    def trial_log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return each run's log density given all other currents, shape (W, N)."""
        pieces = self._pieces(theta)
        inner, right = self._inner(pieces)
        of_trial = self._index.of_trial
        block = 1 / pieces.d - (pieces.load / pieces.d) ** 2 / pieces.gain[:, of_trial]
        white = np.linalg.solve(inner, pieces.basis)
        precision = block - (pieces.basis * white).sum(axis=1)
        score = pieces.solved - np.einsum("wkm,wk->wm", white, right)
        density = 0.5 * (np.log(precision) - LOG_2PI - score**2 / precision)
        return np.asarray(density[:, : self._runs])

    def _per_ampere(self, theta: Mapping[str, Array]) -> Array:
        """Return the cable's pull per ampere, k_t / r [N/A], shape (W, 1)."""
        return self._torque_constant * theta["torque_constant_factor"][:, None] / self._radius

    def _pieces(self, theta: Mapping[str, Array]) -> _Pieces:
        per_ampere = self._per_ampere(theta)
        friction = self.law(theta)
        constant = self._torque_constant * theta["torque_constant_factor"][:, None]
        load = load_current(self.condition, friction, constant, self._radius)
        noise = theta["sigma_current"][:, None] ** 2
        scatter = (theta["tau_motor"][:, None] * friction / per_ampere) ** 2
        variance = noise + (theta["load_noise"][:, None] * load) ** 2 + scatter
        walkers, idle = len(load), self._index.trials - self._runs
        d = np.concatenate([variance, np.broadcast_to(noise, (walkers, idle))], axis=1)
        moved = theta["omega_motor"][:, None] * friction / per_ampere
        moved = np.concatenate([moved, np.zeros((walkers, idle))], axis=1)
        r = self._current - np.concatenate([load, np.zeros((walkers, idle))], axis=1)
        gain = 1 + self._index.total(moved**2 / d)
        basis = [self._solve(column, d, moved, gain) for column in self._columns.T]
        solved = self._solve(r, d, moved, gain)
        return _Pieces(r, d, moved, gain, solved, np.stack(basis, axis=1))

    def _solve(self, values: Array, d: Array, load: Array, gain: Array) -> Array:
        """Apply the inverse of diagonal plus rank-one blocks (Sherman–Morrison)."""
        along = load / d
        amount = self._index.total(along * values) / gain
        return np.asarray(values / d - along * amount[:, self._index.of_trial])

    def _inner(self, pieces: _Pieces) -> tuple[Array, Array]:
        """Return I + BᵀA⁻¹B, shape (W, 3, 3), and BᵀA⁻¹r, shape (W, 3)."""
        inner = np.eye(3) + np.einsum("wim,mj->wij", pieces.basis, self._columns)
        return inner, np.einsum("wim,wm->wi", pieces.basis, pieces.r)


def _quadratic(matrix: Array, vector: Array) -> Array:
    """Return vᵀ M⁻¹ v over the last axes."""
    solved = np.linalg.solve(matrix, vector[..., None])[..., 0]
    return np.asarray((vector * solved).sum(axis=-1))
