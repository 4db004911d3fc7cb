"""The motor board in the linear model: one current a run, and the idle motor's."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.effects import State
from bayesfric.effects.candidates import Candidate, unit_values
from bayesfric.inference.information import Information
from bayesfric.inference.smooths import Smooth
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG, Coefficients
from bayesfric.physics.motor import (
    load_current,
    motor_friction,
    nominal_tension,
    tension_feedback,
)
from bayesfric.recording.tables import Motor, RigConstants
from bayesfric.rigs.gravity_board.rows import rank
from bayesfric.rigs.layout import COEFFICIENTS, Layout
from bayesfric.rigs.motor_board.likelihood import idle_basis, run_condition
from bayesfric.rigs.windows import Windows

__all__ = ["MotorNoise", "MotorPart", "idle_columns"]

Array = NDArray[np.float64]
LOG_2PI = float(np.log(2 * np.pi))


class MotorNoise(NamedTuple):
    """What scatters on the motor board.

    Parameters
    ----------
    tau, omega : float
        Of friction, relative, a run and an assembly.
    sigma_a : float
        Noise of a current [A].
    load : float
        Noise of a current per load current.
    """

    tau: float
    omega: float
    sigma_a: float
    load: float


class MotorPart:
    """Currents of the motor board as information on the local numbers.

    The torque constant is the specified one: that it may be another is an effect.

    Parameters
    ----------
    motor : Motor
        Runs and idle measurements.
    rig : RigConstants
        The board.
    laws : mapping of str to Coefficients
        The reference law of each pulley size.
    radii : mapping of str to float
        Pulley radius of each size [m].
    layout : Layout
        Where numbers stand.
    smooths, candidates : sequence
        In the order of the layout.
    small : sequence of (Candidate, float)
        Small amounts of effects, with the standard deviation of their amplitudes.
    scales : ndarray, shape (q,)
        Prior standard deviation of each local number.
    friction_scale : mapping of str to float
        Unit of the smooth forces of each size [N].
    scattering : sequence of (Candidate, float)
        Effects whose force scatters with friction, with their amplitudes.

    Attributes
    ----------
    trials : DataFrame
        N runs; their id is ``trial``.
    friction_n : ndarray, shape (N,)
        By the reference law, against the motion.
    acceleration : ndarray, shape (N,)
        None.
    """

    def __init__(
        self,
        motor: Motor,
        rig: RigConstants,
        laws: Mapping[str, Coefficients],
        radii: Mapping[str, float],
        layout: Layout,
        smooths: Sequence[Smooth],
        candidates: Sequence[Candidate],
        small: Sequence[tuple[Candidate, float]],
        scales: Array,
        friction_scale: Mapping[str, float],
        *,
        scattering: Sequence[tuple[Candidate, float]] = (),
    ) -> None:
        runs = motor.runs.rename(columns={"run": "trial"}).reset_index(drop=True)
        self.trials, self._layout = runs, layout
        assert rig.motor_torque_constant_n_m_per_a and rig.capstan_radius_m
        constant, radius = rig.motor_torque_constant_n_m_per_a, rig.capstan_radius_m
        self._per_ampere = constant / radius
        self.condition = run_condition(runs, rig)
        sizes = runs["pulley_size"]
        self.size = np.array([layout.sizes.index(size) for size in sizes])
        law = Coefficients(*(np.array(c) for c in zip(*(laws[s] for s in sizes), strict=True)))
        signed = motor_friction(law, self.condition)
        self._sign = np.sign(np.asarray(self.condition.velocity_m_s))
        self.friction_n = np.abs(signed)
        self.acceleration = np.zeros(len(runs))
        self._feedback = tension_feedback(law, self.condition)
        self._load = load_current(self.condition, signed, constant, radius)
        codes, setups = pd.factorize(runs["setup"])
        self.setup, self.setups = codes, tuple(str(setup) for setup in setups)
        self._member = np.equal.outer(np.arange(len(setups)), codes).astype(np.float64)
        self._size_of_setup = self.size[[int(np.argmax(codes == j)) for j in range(len(setups))]]
        self.state = State.of(
            law,
            np.asarray(self.condition.n_pulleys),
            np.asarray(self.condition.wrap_angle_deg),
            nominal_tension(self.condition, signed),
            np.abs(self.condition.velocity_m_s),
            self._load,
            radius_m=np.array([radii[size] for size in sizes]),
            order=rank(runs),
            gravity_m_s2=rig.gravity_m_s2,
            steady=True,
        )
        speed = np.asarray(self.condition.velocity_m_s, dtype=np.float64)
        idle_speed = motor.idle["velocity_m_s"].to_numpy(dtype=np.float64)
        both_ways = _both_ways(motor)
        self._idle = idle_basis(idle_speed, both_ways=both_ways)
        self._idle_current = motor.idle["current_a"].to_numpy(dtype=np.float64)
        self._current = runs["current_a"].to_numpy(dtype=np.float64) - self._load
        force = np.array([friction_scale[size] for size in sizes])
        columns = np.zeros((len(runs), layout.local))
        columns[:, :COEFFICIENTS] = self._coefficients()
        place = COEFFICIENTS
        for smooth in smooths:
            if smooth.rig != "gravity":
                shapes = smooth.columns(self.covariates())
                unit = self.friction_n if smooth.relative else force
                columns[:, place : place + smooth.count] = self._amperes(unit * shapes).T
            place += smooth.count
        for index, candidate in enumerate(candidates):
            columns[:, layout.candidate(index)] = self._candidate(candidate)
        for index, (candidate, _) in enumerate(small):
            columns[:, layout.small_amount(index)] = self._candidate(candidate)
        if layout.idle:
            columns[:, -layout.idle :] = idle_basis(speed, both_ways=both_ways)
        self.columns = columns * scales
        # The current of a relative deviation of friction of 1 [A].
        self._scattered = np.asarray(self._sign * self.friction_n / self._per_ampere)
        for candidate, amplitude in scattering:
            self._scattered += amplitude * self._candidate(candidate)
        self._idle_columns = self._idle * scales[-layout.idle :]

    def covariates(self) -> dict[str, Array]:
        """Return where every run is, arrays of shape (N,)."""
        state = self.state
        return {
            "velocity": np.asarray(state.speed_m_s),
            "tension": np.asarray(state.tension_n),
            "n_pulleys": np.asarray(state.n_pulleys, dtype=np.float64),
            "wrap_angle": np.asarray(state.wrap_angle_deg, dtype=np.float64),
        }

    def relative_force(self, candidate: Candidate) -> Array:
        """Return what an effect of amplitude 1 adds to friction as a share of it, (N,)."""
        return np.asarray(self._per_ampere * self._candidate(candidate) / self.friction_n)

    def start(self) -> MotorNoise:
        """Return a rough estimate of what scatters."""
        fit = np.linalg.lstsq(self._idle, self._idle_current, rcond=None)[0]
        return MotorNoise(0.015, 0.015, float((self._idle_current - self._idle @ fit).std()), 0.005)

    def information(
        self,
        noise: MotorNoise,
        kept: NDArray[np.intp],
        used: NDArray[np.bool_] | None = None,
    ) -> Information:
        """Return what the currents say of the kept local numbers.

        Parameters
        ----------
        noise : MotorNoise
            Scatter and noise.
        kept : ndarray of int
            Local columns.
        used : ndarray of bool, shape (N,), or None
            Runs that enter; None is all. The idle motor always does.
        """
        runs = np.ones(len(self.setup), dtype=bool) if used is None else used
        moved = self._scattered[runs]
        variance = self.variance(noise)[runs] + (noise.tau * moved) ** 2
        columns, current = self.columns[np.ix_(runs, kept)], self._current[runs]
        weighted = columns / variance[:, None]
        group, groups = self.setup[runs], len(self.setups)
        summed = self._member[:, runs] @ (weighted * moved[:, None])
        stiffness = np.bincount(group, moved**2 / variance, groups)
        pulled = np.bincount(group, moved * current / variance, groups)
        share = noise.omega**2 / (1 + noise.omega**2 * stiffness)
        constant = -0.5 * (np.log(variance) + LOG_2PI + current**2 / variance).sum()
        constant += 0.5 * (share * pulled**2 - np.log1p(noise.omega**2 * stiffness)).sum()
        count = self._layout.total(kept)
        precision, slope = np.zeros((count, count)), np.zeros(count)
        for size in range(len(self._layout.sizes)):
            mine = self.size[runs] == size
            theirs = self._size_of_setup == size
            part = weighted[mine].T @ columns[mine]
            part -= (summed[theirs].T * share[theirs]) @ summed[theirs]
            place = self._layout.spread(kept, size)
            precision[np.ix_(place, place)] += part
            slope[place] += weighted[mine].T @ current[mine]
            slope[place] -= (share[theirs] * pulled[theirs]) @ summed[theirs]
        idle = self._layout.idle
        precision[-idle:, -idle:] += self._idle_columns.T @ self._idle_columns / noise.sigma_a**2
        slope[-idle:] += self._idle_columns.T @ self._idle_current / noise.sigma_a**2
        left = self._idle_current / noise.sigma_a
        constant += -0.5 * (LOG_2PI + 2 * np.log(noise.sigma_a) + left**2).sum()
        return Information(precision, slope, float(constant))

    def variance(self, noise: MotorNoise) -> Array:
        """Return the variance of each run's current without friction's scatter, (N,) [A²]."""
        return noise.sigma_a**2 + (noise.load * self._load) ** 2

    def windows(self, noise: MotorNoise) -> Windows:
        """Return one residual force a run; its columns hold the idle curve too."""
        newton = self._sign * self._per_ampere
        where = self.covariates()
        nowhere = np.full(len(self.trials), np.nan)
        return Windows(
            row=np.arange(len(self.trials)),
            residual_n=newton * self._current,
            columns=newton[:, None] * self.columns,
            covariance=tuple((newton**2 * self.variance(noise))[:, None, None]),
            covariates=where | {"displacement": nowhere, "order": np.asarray(self.state.order)},
        )

    def _amperes(self, force_n: Array) -> Array:
        """Return what a force against the motion adds to each current, (…, N) [A]."""
        return np.asarray(self._sign * self._feedback * force_n / self._per_ampere)

    def _coefficients(self) -> Array:
        n, tension = np.asarray(self.state.n_pulleys), np.asarray(self.state.tension_n)
        turn = np.asarray(self.state.wrap_angle_deg) - REFERENCE_WRAP_ANGLE_DEG
        return self._amperes(np.stack([n * tension, n + 0.0, n * tension * turn])).T

    def _candidate(self, candidate: Candidate) -> Array:
        effect = candidate.effect
        if effect.acts_on == "reading" or effect.components:
            return np.zeros(len(self.trials))
        values, small = unit_values(candidate)
        law = np.asarray(effect.laws[candidate.law](values, self.state)) / small
        law = np.broadcast_to(law, (len(self.trials),))
        return law if effect.acts_on == "current" else self._amperes(law)


def idle_columns(motor: Motor | None) -> int:
    """Return how many columns the curve of the idle motor has."""
    return 0 if motor is None else 4 if _both_ways(motor) else 3


def _both_ways(motor: Motor) -> bool:
    speed = motor.idle["velocity_m_s"]
    return bool((speed > 0).any() and (speed < 0).any())
