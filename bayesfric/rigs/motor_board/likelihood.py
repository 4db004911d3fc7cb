"""Likelihood of the motor board: the density of all currents, of the runs and of the idle motor.

Given the parameters, the current of run j on assembly i is

    I = h(v)ᵀβ + (r / k_t) (m g + F (1 + η_i + ε_ij)) + noise.

The idle curve h(v)ᵀβ is common to all runs and to the measurements of the idle motor. β, η and ε
are Gaussian, and I is linear in them, so they are integrated out in closed form. The currents have
one joint normal density (:mod:`bayesfric.inference.grouped_normal`). The noise of a current grows
with the load: its variance is σ_I² + (λ · load current)². The load current is that of the law,
because the scatter of friction would change it by only 0.2 %. Speed is constant in a run, so an
effect on friction adds to F, and an effect on the motor's current adds to I. :mod:`.simulator`
simulates the same model.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.effects import State
from bayesfric.effects.terms import ActiveEffect, parameters_of, rough_values, total
from bayesfric.inference.priors import Parameter
from bayesfric.observation.coefficients import SizeIndex, coefficient_parameters
from bayesfric.observation.exact import ExactModel, Shown
from bayesfric.observation.scatter import ScatterLevels
from bayesfric.physics.laws import BASELINES, FrictionLaw
from bayesfric.physics.motor import load_current, nominal_tension, tension_feedback
from bayesfric.recording.tables import Motor, RigConstants
from bayesfric.rigs.motor_board.places import RunPlaces

TENSION_ITERATIONS = 2  # each reduces the error of the tension by a factor of about 20
SCATTER = ("tau_motor", "omega_motor", "omega_intercept_motor")
LEAST_CURRENT_A = 1e-5  # lower bound of the starting value of the noise


def is_both_ways(velocity_m_s: Array) -> bool:
    """Return whether the signed speeds have both signs."""
    return bool((velocity_m_s > 0).any() and (velocity_m_s < 0).any())


def idle_basis(velocity_m_s: Array, *, both_ways: bool) -> Array:
    """Return the columns of the idle curve.

    The idle current has the sign of the torque, so it is an odd function of the signed speed with a
    step at standstill: sign(v) [1, |v|, v²]. If the motor was run in both directions, with the
    cable or without, there is a further constant. It represents differences between the directions,
    such as a zero error of the sensor, or brushes that are off centre.

    Parameters
    ----------
    velocity_m_s : ndarray, shape (M,)
        Signed speed, never 0 [m/s].
    both_ways : bool
        Whether the motor was run in both directions.

    Returns
    -------
    ndarray, shape (M, 3) or (M, 4)
        Columns of level, slope, curvature and asymmetry; their coefficients are in A, A s/m,
        A s²/m² and A.
    """
    sign, speed = np.sign(velocity_m_s), np.abs(velocity_m_s)
    columns = [sign, sign * speed, sign * speed**2]
    if both_ways:
        columns.append(np.ones_like(speed))
    return np.stack(columns, axis=1)


class MotorModel(ExactModel):
    """Currents of the motor board; see :class:`bayesfric.observation.exact.ExactModel`.

    The scatter of runs and assemblies is normal; Student-t options of the analysis are not used.

    Parameters
    ----------
    motor : Motor
        Runs, and measurements of the idle motor.
    rig : RigConstants
        Constants of the board, such as torque constant and capstan radius.
    analysis : Analysis
        Priors, and whether each size has its own scatter.
    baseline : FrictionLaw
        The friction law.
    effects : sequence of ActiveEffect
        Effects that act in addition to the law. Those that :meth:`RunPlaces.supports` does not
        support are ignored.

    Attributes
    ----------
    condition : MotorCondition
        Condition of each run, arrays of shape (N,).
    trials : DataFrame
        The N runs in the order of all results; those of an assembly are adjacent. Their
        identifiers are in ``trial``.
    """

    def __init__(
        self,
        motor: Motor,
        rig: RigConstants,
        analysis: Analysis,
        baseline: FrictionLaw = BASELINES["paper"],
        effects: Sequence[ActiveEffect] = (),
    ) -> None:
        self._friction = baseline.motor
        assert rig.motor_torque_constant_n_m_per_a and rig.capstan_radius_m
        codes, _ = pd.factorize(motor.runs["setup"])
        order = codes.argsort(kind="stable")
        runs = motor.runs.iloc[order].reset_index(drop=True).rename(columns={"run": "trial"})
        self.trials = runs
        self._places = RunPlaces(runs, rig)
        self._effects = [
            effect for effect in effects if self._places.supports(effect.effect) is None
        ]
        self.condition = self._places.condition
        self._runs = len(runs)
        self._torque_constant = rig.motor_torque_constant_n_m_per_a
        self._radius = rig.capstan_radius_m
        self._size = SizeIndex.of(runs["pulley_size"])
        idle_speed = motor.idle["velocity_m_s"].to_numpy(dtype=np.float64)
        speed = np.concatenate([runs["velocity_m_s"].to_numpy(dtype=np.float64), idle_speed])
        self._current = np.concatenate(
            [runs["current_a"].to_numpy(), motor.idle["current_a"].to_numpy()], dtype=np.float64
        )
        priors = analysis.priors
        self._columns = idle_basis(speed, both_ways=is_both_ways(speed)) * priors.idle_current_sd
        # If the idle motor ran in one direction only, its curve is assumed to be odd.
        self._by_idle = idle_basis(speed, both_ways=is_both_ways(idle_speed))
        self.coefficients = coefficient_parameters(self._size.sizes, analysis, baseline.without)
        self.scatter = ScatterLevels(
            SCATTER,
            (priors.tau_motor, priors.omega_motor, priors.omega_intercept_motor),
            self._size,
            analysis.scatter.model_copy(update={"trial": "normal", "assembly": "normal"}),
        )
        self.further = (
            Parameter("torque_constant_factor", "1", priors.torque_constant_factor),
            Parameter("sigma_current", "A", priors.sigma_current, "noise"),
            Parameter("load_noise", "1", priors.load_noise, "noise", power=0.5),
            *(parameter for active in self._effects for parameter in parameters_of(active)),
        )

    def law(self, theta: Mapping[str, Array]) -> Array:
        """Return the signed friction of each run by the law and the effects, (W, N) [N].

        It is fc of the law, plus effects on friction, at the nominal tension of the run, with the
        sign of v.
        """
        return self._forces(theta)[0]

    def _forces(self, theta: Mapping[str, Array]) -> tuple[Array, Array]:
        """Return signed friction, and signed forces of effects on the drive, (W, N) [N]."""
        law = self._size.coefficients(theta)
        friction = np.asarray(self._friction(law, self.condition))
        drag = held = np.zeros_like(friction)
        if not self._on("friction") and not self._on("drive"):
            return friction, held
        feedback, sign = tension_feedback(law, self.condition), np.sign(self.condition.velocity_m_s)
        for _ in range(TENSION_ITERATIONS):  # effects change the tension, on which they depend
            state = self._places.state(law, friction + sign * feedback * (drag + held))
            drag = self._added("friction", theta, state)
            held = self._added("drive", theta, state)
        return np.asarray(friction + sign * (feedback * drag + (feedback - 1) * held)), sign * held

    def _on(self, kind: str) -> list[ActiveEffect]:
        return [effect for effect in self._effects if effect.effect.acts_on == kind]

    def _added(self, kind: str, theta: Mapping[str, Array], state: State) -> Array:
        """Return the sum of the effects of one kind, shape (W, N) [N] or [A]."""
        acting = self._on(kind)
        shape = np.broadcast_shapes(
            *(np.shape(part) for part in (state.tension_n, state.speed_m_s))
        )
        return np.broadcast_to(total(acting, theta, state) if acting else 0.0, shape)

    def observed(self, theta: Mapping[str, Array]) -> Array:
        """Return the signed friction from the measured currents, (W, N) [N].

        It is ``k_t (I − I_idle(v)) / r − m g``, with an idle curve fitted to the idle measurements
        alone. It depends only on one parameter, the torque constant.
        """
        beyond = self._beyond_idle()[: self._runs]
        pull = self._torque(theta) * beyond / self._radius
        return np.asarray(pull - self.condition.weight_n)

    def read(self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator) -> Array:
        """Draw signed measured friction, given its relative deviation from the law, (…, W, N) [N].

        Currents of each draw are converted to friction as in :meth:`observed`, with the median
        torque constant. The common error of the idle curve is left out.
        """
        friction, held = self._forces(theta)
        torque = self._torque(theta)
        scattered = friction * (1 + deviation) + held
        current = load_current(self.condition, scattered, torque, self._radius)
        expected = load_current(self.condition, friction + held, torque, self._radius)
        sd = np.hypot(theta["sigma_current"][:, None], theta["load_noise"][:, None] * expected)
        current += sd * rng.standard_normal(current.shape)
        reading = np.median(torque) / self._radius
        return np.asarray(reading * current - self.condition.weight_n)

    def start(self) -> dict[str, float]:
        """Return starting values by least squares."""
        residual = self._beyond_idle()[self._runs :]
        friction = self.observed({"torque_constant_factor": np.ones(1)})[0]
        start = self._size.rough_coefficients(
            self.condition.n_pulleys,
            self.condition.wrap_angle_deg,
            nominal_tension(self.condition, friction),
            np.sign(self.condition.velocity_m_s) * friction,
        )
        start["torque_constant_factor"] = 1.0
        start["sigma_current"] = max(float(residual.std()), LEAST_CURRENT_A)
        start["load_noise"] = 0.005
        return start | rough_values(self._effects)

    def _beyond_idle(self) -> Array:
        """Return currents minus the curve fitted to the idle measurements, shape (M,) [A]."""
        idle = slice(self._runs, None)
        curve = np.linalg.lstsq(self._by_idle[idle], self._current[idle], rcond=None)[0]
        return np.asarray(self._current - self._by_idle @ curve)

    def _torque(self, theta: Mapping[str, Array]) -> Array:
        """Return the torque constant k_t [N·m/A], shape (W, 1)."""
        return self._torque_constant * theta["torque_constant_factor"][:, None]

    def intercept(self, theta: Mapping[str, Array]) -> Array:
        """Return the part of friction that does not grow with tension, signed, (W, N) [N]."""
        signed = np.sign(self.condition.velocity_m_s) * np.asarray(self.condition.n_pulleys)
        return np.asarray(self._size.coefficients(theta).c2 * signed)

    def shown(self, theta: Mapping[str, Array]) -> Shown:
        """Return the currents of the runs as measures of friction, then those of the idle motor."""
        (friction, held), torque = self._forces(theta), self._torque(theta)
        load = load_current(self.condition, friction + held, torque, self._radius)
        law = self._size.coefficients(theta)
        state = self._places.state(law, friction + held, load)
        runs = slice(None, self._runs)
        residual = np.tile(self._current, (len(load), 1))
        residual[:, runs] -= load + self._added("current", theta, state)
        variance = np.repeat(theta["sigma_current"][:, None] ** 2, self._current.size, axis=1)
        variance[:, runs] += (theta["load_noise"][:, None] * load) ** 2
        return Shown(
            residual,
            variance,
            friction,
            curve=self._columns,
            # Friction increases the current of a motor that lifts, and decreases it in lowering.
            sign=np.sign(self.condition.velocity_m_s),
            per_newton=self._radius / torque,
            newtons=float(np.median(torque)) / self._radius,
        )
