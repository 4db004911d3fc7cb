"""Likelihood of the motor board: all currents, of the runs and of the idle motor.

Given the parameters, run j on assembly i has the current

    I = h(v)ᵀβ + (r / k_t) (m g + F (1 + η_i + ε_ij)) + noise,

with the idle curve h(v)ᵀβ shared by every run and by the idle measurements. β, η
and ε are Gaussian and linear, so they are integrated out in closed form: the
currents are one normal (:mod:`bayesfric.inference.grouped_normal`). The noise of a
current grows with the load: its variance is σ_I² + (λ · load current)², the load
current being the law's; the scatter of friction would change it by 0.2 %. Speed is
constant in a run, so an effect on friction adds to F, and one on the motor's current to I.
The simulator that mirrors it is :mod:`bayesfric.simulate`.
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

TENSION_ITERATIONS = 2  # each takes the error of an effect's tension down by some 20
SCATTER = ("tau_motor", "omega_motor", "omega_intercept_motor")
LEAST_CURRENT_A = 1e-5  # of the noise, as a start, where the idle curve fits perfectly


def is_both_ways(velocity_m_s: Array) -> bool:
    """Return whether signed speeds go both ways."""
    return bool((velocity_m_s > 0).any() and (velocity_m_s < 0).any())


def idle_basis(velocity_m_s: Array, *, both_ways: bool) -> Array:
    """Return the columns of the idle curve.

    The idle current carries the sign of the torque, so it is an odd curve of the
    signed speed, with a step at standstill: sign(v) [1, |v|, v²]. What makes the two
    directions differ, a zero error of the sensor or brushes off centre, is one
    constant more, where the motor was run in both, with the cable or without.

    Parameters
    ----------
    velocity_m_s : ndarray, shape (M,)
        Signed speed, never 0 [m/s].
    both_ways : bool
        Whether the motor was run in both directions.

    Returns
    -------
    ndarray, shape (M, 3) or (M, 4)
        Level, slope, curvature and asymmetry; times A, A s/m, A s²/m² and A.
    """
    sign, speed = np.sign(velocity_m_s), np.abs(velocity_m_s)
    columns = [sign, sign * speed, sign * speed**2]
    if both_ways:
        columns.append(np.ones_like(speed))
    return np.stack(columns, axis=1)


class MotorModel(ExactModel):
    """Currents of the motor board; see :class:`bayesfric.observation.exact.ExactModel`.

    The scatter of a run is normal: the Student-t option of the analysis is for
    gravity-board trials.

    Parameters
    ----------
    motor : Motor
        Runs that enter and idle measurements.
    rig : RigConstants
        The board; torque constant and capstan radius.
    analysis : Analysis
        Priors, and whether each size has a scatter of its own.
    baseline : FrictionLaw
        The friction law.
    effects : sequence of ActiveEffect
        What acts beside the law; what :meth:`RunPlaces.supports` refuses is left out.

    Attributes
    ----------
    condition : MotorCondition
        Of each run, arrays of shape (N,).
    trials : DataFrame
        The N runs in the order of every result, those of an assembly adjacent;
        their id is ``trial``.
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
        # Of an idle motor that ran one way alone, the other is taken to be alike.
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

        fc of eq. (15) and of the effects at the nominal tension of the run, with the sign of v.
        """
        return self._forces(theta)[0]

    def _forces(self, theta: Mapping[str, Array]) -> tuple[Array, Array]:
        """Return the friction that scatters and what scatter leaves alone, signed, (W, N) [N]."""
        law = self._size.coefficients(theta)
        friction = np.asarray(self._friction(law, self.condition))
        drag = held = np.zeros_like(friction)
        if not self._on("friction") and not self._on("drive"):
            return friction, held
        feedback, sign = tension_feedback(law, self.condition), np.sign(self.condition.velocity_m_s)
        for _ in range(TENSION_ITERATIONS):  # the drag changes the tension on which it depends
            state = self._places.state(law, friction + sign * feedback * (drag + held))
            drag = self._added("friction", theta, state)
            held = self._added("drive", theta, state)
        return np.asarray(friction + sign * (feedback * drag + (feedback - 1) * held)), sign * held

    def _on(self, kind: str) -> list[ActiveEffect]:
        return [effect for effect in self._effects if effect.effect.acts_on == kind]

    def _added(self, kind: str, theta: Mapping[str, Array], state: State) -> Array:
        """Return what effects of one kind add, shape (W, N)."""
        acting = self._on(kind)
        shape = np.broadcast_shapes(
            *(np.shape(part) for part in (state.tension_n, state.speed_m_s))
        )
        return np.broadcast_to(total(acting, theta, state) if acting else 0.0, shape)

    def observed(self, theta: Mapping[str, Array]) -> Array:
        """Return the signed friction that the currents show, (W, N) [N].

        ``k_t (I − I_idle(v)) / r − m g`` with the idle curve of the idle measurements alone; of the
        parameters only the torque constant counts.
        """
        beyond = self._beyond_idle()[: self._runs]
        pull = self._torque(theta) * beyond / self._radius
        return np.asarray(pull - self.condition.weight_n)

    def read(self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator) -> Array:
        """Draw the signed friction that the currents would show, (…, W, N) [N].

        As :meth:`observed` reads it from the currents with the median torque constant, whatever
        that of the draw; the idle curve's error, which all runs share, is left out.
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
        """Return rough estimates by least squares, a place to climb from."""
        left = self._beyond_idle()[self._runs :]
        friction = self.observed({"torque_constant_factor": np.ones(1)})[0]
        start = self._size.rough_coefficients(
            self.condition.n_pulleys,
            self.condition.wrap_angle_deg,
            nominal_tension(self.condition, friction),
            np.sign(self.condition.velocity_m_s) * friction,
        )
        start["torque_constant_factor"] = 1.0
        start["sigma_current"] = max(float(left.std()), LEAST_CURRENT_A)
        start["load_noise"] = 0.005
        return start | rough_values(self._effects)

    def _beyond_idle(self) -> Array:
        """Return currents less the idle curve of the idle measurements, shape (M,)."""
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
        """Return the currents of runs and, after them, of the idle motor."""
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
            # Friction takes current from a motor that lifts, and gives it back as it lowers.
            sign=np.sign(self.condition.velocity_m_s),
            per_newton=self._radius / torque,
            newtons=float(np.median(torque)) / self._radius,
        )
