"""Likelihood of the gravity board: event times given the friction law and effects.

The events of a trial are a quadratic form in its motion
(:mod:`bayesfric.rigs.gravity_board.measurements`): its acceleration, and what effects add to
its travel that change along it. All friction of a trial, effects on friction
included, is multiplied by 1 + s, s = η + ε. So the motion is linear in s, and a trial
is a normal density of s:

    w(s) = m0 − s m1,   log p(times | s) = log N(ŝ; s, 1/(m1ᵀ G m1)) + constant.

Without effects along the trial that is the density of its friction,
``f = (m1 + m2) (a_free − a)`` with Jacobian m1 + m2. How s scatters is
:mod:`bayesfric.inference.grouped_normal`'s. The simulator that mirrors all this is
:mod:`bayesfric.simulate`.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.analysis import Analysis
from bayesfric.effects import State
from bayesfric.effects.terms import (
    ActiveEffect,
    LinearTerm,
    linear_terms,
    parameters_of,
    rough_values,
    total,
)
from bayesfric.inference.grouped_normal import LOG_2PI, GroupedNormal, Groups
from bayesfric.inference.priors import Parameter
from bayesfric.inference.student import GroupedStudent
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import Condition, nominal_tension, tension_feedback
from bayesfric.physics.laws import BASELINES, Baseline
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.coefficients import SizeIndex, coefficient_parameters
from bayesfric.rigs.gravity_board.measurements import TrialMeasurements, pilot_accelerations
from bayesfric.rigs.gravity_board.paths import Paths, trial_paths

__all__ = ["GravityLikelihood", "trial_condition"]

Array = NDArray[np.float64]
START_SCATTER = 0.02  # of friction, a place to climb from
TENSION_ITERATIONS = 2  # each takes the error of an effect's tension down by some 100


def trial_condition(trials: pd.DataFrame, rig: RigConstants) -> Condition:
    """Return the condition of each trial, arrays of shape (N,)."""
    return Condition(
        trials["n_pulleys"].to_numpy(dtype=np.float64),
        trials["wrap_angle_deg"].to_numpy(dtype=np.float64),
        trials["mass_drive_kg"].to_numpy(dtype=np.float64),
        trials["mass_load_kg"].to_numpy(dtype=np.float64),
        rig.gravity_m_s2,
    )


class GravityLikelihood:
    """Event times of the gravity board, given coefficients, scatter and noise.

    Parameters
    ----------
    gravity : Gravity
        Trials that enter, those of a setup adjacent (see
        :func:`bayesfric.rigs.gravity_board.screening.screen_trials`).
    rig : RigConstants
        The board.
    analysis : Analysis
        Priors and the form of the scatter.
    baseline : Baseline
        The friction law.
    effects : sequence of ActiveEffect
        What acts beside the law; those that act on a motor current are left alone.

    Attributes
    ----------
    parameters : tuple of Parameter
        What the likelihood depends on.
    trials : DataFrame
        The N trials in the order of every result.
    setups : tuple of str
        The J assemblies in the order of every result.
    """

    def __init__(
        self,
        gravity: Gravity,
        rig: RigConstants,
        analysis: Analysis,
        baseline: Baseline = BASELINES["paper"],
        effects: Sequence[ActiveEffect] = (),
    ) -> None:
        self._friction = baseline.gravity
        here = [active for active in effects if active.effect.acts_on == "friction"]
        self._steady = [active for active in here if not active.effect.along_path]
        self.trials = gravity.trials
        self.condition = trial_condition(gravity.trials, rig)
        codes, setups = pd.factorize(gravity.trials["setup"])
        self.setups = tuple(str(setup) for setup in setups)
        self._groups = Groups(np.flatnonzero(np.diff(codes, prepend=-1)), codes.size)
        self._size = SizeIndex.of(gravity.trials["pulley_size"])
        self.sizes = self._size.sizes
        self._rough_acceleration = pilot_accelerations(gravity)
        self._rough = self._rough_coefficients()
        points = {name: np.array([value]) for name, value in self._rough.items()}
        self._rough_law = self._size.coefficients(points)
        self._moving: list[LinearTerm] = []
        paths = added = None
        if moving := [active for active in here if active.effect.along_path]:
            paths = trial_paths(gravity, rig)
            self._typical_speed = paths.speed_m_s.mean(axis=1)
            self._moving = linear_terms(moving, partial(self._slowing, paths), paths.seen)
            added = np.concatenate([term.responses for term in self._moving])
        self._measurements = TrialMeasurements(gravity, rig, analysis, paths, added)
        self._by_size = analysis.scatter.by_size
        priors = analysis.priors
        groups = [f"[{size}]" for size in self.sizes] if self._by_size else [""]
        self.parameters = (
            *coefficient_parameters(self.sizes, analysis),
            *(Parameter(f"tau{group}", "1", priors.tau, "scatter") for group in groups),
            *(Parameter(f"omega{group}", "1", priors.omega, "scatter") for group in groups),
            *self._measurements.parameters,
            *(parameter for active in here for parameter in parameters_of(active)),
        )
        scatter = analysis.scatter
        self._freedom = scatter.degrees_of_freedom if scatter.trial == "student-t" else None

    def law(self, theta: Mapping[str, Array]) -> Array:
        """Return the friction of each trial by the law and the steady effects [N].

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.

        Returns
        -------
        ndarray, shape (W, N)
            fc of eq. (15) at the nominal tension of the moving board, and what effects
            add that do not change along a trial.
        """
        law = self._size.coefficients(theta)
        friction = self._friction(law, self.condition)
        if not self._steady:
            return friction
        feedback = tension_feedback(law, self.condition)
        drag = np.zeros_like(friction)
        for _ in range(TENSION_ITERATIONS):  # the drag changes the tension on which it depends
            acceleration = (
                self.condition.drive_force_n - friction - feedback * drag
            ) / self.condition.total_mass_kg
            tension = nominal_tension(self.condition, acceleration)
            state = State.of(
                law, self.condition.n_pulleys, self.condition.wrap_angle_deg, tension, 0.0
            )
            drag = total(self._steady, theta, state)
        return friction + feedback * drag

    def observed(self, theta: Mapping[str, Array]) -> tuple[Array, Array, Array]:
        """Return what was measured of each trial's friction, where none changes along it.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name; only the noise counts.

        Returns
        -------
        friction, variance, log_constant : ndarray, shape (W, N)
            Friction [N], its error variance [N²], and the log density of the
            raw data less that of the friction.
        """
        acceleration = self._measurements.at(theta).acceleration()
        mass = self.condition.total_mass_kg
        return (
            self.condition.drive_force_n - mass * acceleration.mean,
            mass**2 * acceleration.variance,
            acceleration.log_constant + np.log(mass),
        )

    def log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return the log density of all the data, shape (W,)."""
        return np.asarray(self.setup_log_likelihood(theta).sum(axis=-1))

    def setup_log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return the log density of each assembly's data, shape (W, J)."""
        scattered, constant = self._scattered(theta)
        return scattered.group_log_density() + self._groups.total(constant)

    def trial_log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return each trial's log density given the rest of its assembly, shape (W, N)."""
        scattered, constant = self._scattered(theta)
        return scattered.single_log_density() + constant

    def trial_cdf(self, theta: Mapping[str, Array]) -> Array:
        """Return the probability of less friction of each trial given the rest, shape (W, N)."""
        return self._scattered(theta)[0].single_cdf()

    def draw_trial_cdf(self, theta: Mapping[str, Array], rng: np.random.Generator) -> Array:
        """Return :meth:`trial_cdf` of recordings made again with these parameters.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        rng : Generator
            Source of randomness.

        Returns
        -------
        ndarray, shape (W, N)
            A recording made again a row, with new scatter on new assemblies.
        """
        _, variance, law, _ = self._frictions(theta)
        deviation = self.draw_scatter(theta, rng, together=True)
        again = law * (1 + deviation) + np.sqrt(variance) * rng.standard_normal(law.shape)
        return self._around(theta, again, variance, law).single_cdf()

    def _scattered(
        self, theta: Mapping[str, Array]
    ) -> tuple[GroupedNormal | GroupedStudent, Array]:
        """Return the density of the frictions, and each trial's rest of the log density, (W, N)."""
        observed, variance, law, constant = self._frictions(theta)
        return self._around(theta, observed, variance, law), constant

    def _around(
        self, theta: Mapping[str, Array], observed: Array, variance: Array, law: Array
    ) -> GroupedNormal | GroupedStudent:
        """Return the density of frictions, all of shape (W, N), that scatter around the law."""
        tau, omega = self._scatter(theta)
        own = (law * tau) ** 2 + variance
        residual, moved = observed - law, (law * omega)[None]
        if self._freedom is None:
            return GroupedNormal(self._groups, residual, own, moved)
        return GroupedStudent(self._groups, residual, own, moved, self._freedom)

    def _frictions(self, theta: Mapping[str, Array]) -> tuple[Array, Array, Array, Array]:
        """Return friction observed, its variance, the law's, and the rest of the log density.

        All of shape (W, N). With effects along the trial, "observed" is the law's friction
        times 1 + ŝ: the density of the trial is one of its scatter, in newtons.
        """
        if not self._moving:
            friction, variance, constant = self.observed(theta)
            return friction, variance, self.law(theta), constant
        law = self.law(theta)
        form = self._measurements.at(theta)
        mass = self.condition.total_mass_kg
        along = np.concatenate([self._amplitudes(term, theta) for term in self._moving])
        # With A the amplitudes, m0 = (r, A) and m1 = (f, −A).
        mixed, squared, sloped = form.along(along)
        resting = (self.condition.drive_force_n - law) / mass - form.origin  # r
        slowed = law / mass  # f
        curved, slope = form.curvature[0], form.slope[0]
        precision = slowed**2 * curved - 2 * slowed * mixed + squared
        across = resting * slowed * curved + (slowed - resting) * mixed - squared
        scatter = (across - slope * slowed + sloped) / precision
        square = resting**2 * curved + 2 * resting * mixed + squared
        square = square - 2 * (slope * resting + sloped)
        constant = form.log_constant - 0.5 * (square - scatter**2 * precision)
        constant = constant + 0.5 * (LOG_2PI - np.log(precision)) + np.log(np.abs(law))
        return law * (1 + scatter), law**2 / precision, law, constant

    def _amplitudes(self, term: LinearTerm, theta: Mapping[str, Array]) -> Array:
        """Return the numbers of an effect's responses, shape (K, W, N).

        Responses are tabulated at rough coefficients: the ratio of the effect's force
        to that at the rough ones makes good for it, and the tension feeds back.
        """
        law, (n, wrap) = self._size.coefficients(theta), self.condition[:2]
        tension = nominal_tension(self.condition, self._rough_acceleration)
        values = term.active.values(theta) | {term.active.effect.amplitude.name: np.float64(1.0)}
        force = term.active.effect.laws[term.active.law]
        now = force(values, State.of(law, n, wrap, tension, self._typical_speed))
        then = force(values, State.of(self._rough_law, n, wrap, tension, self._typical_speed))
        ratio = np.divide(now, then, out=np.ones_like(now), where=then != 0)
        scale = ratio * tension_feedback(law, self.condition)
        return term.amplitudes(theta)[:, :, None] * scale

    def _slowing(self, paths: Paths, active: ActiveEffect, values: Mapping[str, Any]) -> Array:
        """Return the acceleration that an effect adds along the paths, shape (N, P) [m/s²]."""
        each = [np.reshape(np.asarray(part, dtype=np.float64), (-1, 1)) for part in self.condition]
        column = Condition(*each)
        law = Coefficients(*(np.transpose(part) for part in self._rough_law))
        tension = nominal_tension(column, paths.acceleration_m_s2)
        state = State.of(law, column.n_pulleys, column.wrap_angle_deg, tension, paths.speed_m_s)
        return -active.effect.laws[active.law](values, state) / column.total_mass_kg

    def draw_scatter(
        self, theta: Mapping[str, Array], rng: np.random.Generator, *, together: bool = False
    ) -> Array:
        """Draw η + ε of a new trial on a new assembly.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        rng : Generator
            Source of randomness.
        together : bool
            Whether trials of one assembly are on one new assembly too, as when the whole
            recording is made again; else each is on one of its own.

        Returns
        -------
        ndarray, shape (W, N)
            Relative deviation of friction from the law.
        """
        tau, omega = self._scatter(theta)
        shape = (len(tau), len(self.trials))
        if self._freedom is None:
            trial = rng.standard_normal(shape)
        else:
            trial = rng.standard_t(self._freedom, shape)
        if not together:
            return omega * rng.standard_normal(shape) + tau * trial
        assembly = rng.standard_normal((len(tau), len(self.setups)))
        return omega * assembly[:, self._groups.of_each] + tau * trial

    def draw_observed(
        self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator
    ) -> Array:
        """Draw what would be measured of friction that deviates so from the law.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        deviation : ndarray, shape (W, N)
            As :meth:`draw_scatter` draws it.
        rng : Generator
            Source of randomness.

        Returns
        -------
        ndarray, shape (W, N)
            Friction [N] with the error of the events.
        """
        sd = np.sqrt(self.observed(theta)[1])
        return self.law(theta) * (1 + deviation) + sd * rng.standard_normal(deviation.shape)

    def start(self) -> dict[str, float]:
        """Return rough estimates by least squares, a place to climb from."""
        scatter = {
            parameter.name: START_SCATTER
            for parameter in self.parameters
            if parameter.name.startswith(("tau", "omega"))
        }
        moving = [term.active for term in self._moving]
        effects = rough_values([*self._steady, *moving])
        return self._measurements.start() | scatter | effects | self._rough

    def _rough_coefficients(self) -> dict[str, float]:
        condition, acceleration = self.condition, self._rough_acceleration
        friction = condition.drive_force_n - condition.total_mass_kg * acceleration
        tension = nominal_tension(condition, acceleration)
        return self._size.rough_coefficients(
            condition.n_pulleys, condition.wrap_angle_deg, tension, friction
        )

    def _scatter(self, theta: Mapping[str, Array]) -> tuple[Array, Array]:
        if self._by_size:
            return self._size.spread(theta, "tau"), self._size.spread(theta, "omega")
        return theta["tau"][:, None], theta["omega"][:, None]
