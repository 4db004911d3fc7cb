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

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import TypeAlias

import numpy as np
import pandas as pd

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.effects.terms import ActiveEffect, parameters_of, rough_values
from bayesfric.errors import Fault, InputError
from bayesfric.inference.grouped_normal import LOG_2PI, GroupedNormal, Groups
from bayesfric.inference.heavy_groups import HeavyGroups
from bayesfric.inference.model import GivenRest
from bayesfric.inference.student import GroupedStudent
from bayesfric.observation.coefficients import coefficient_parameters
from bayesfric.physics.laws import BASELINES, FrictionLaw
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.along import EffectsAlong
from bayesfric.rigs.gravity_board.at_rest import TrialsAtRest
from bayesfric.rigs.gravity_board.forces import Forces, SteadyForces
from bayesfric.rigs.gravity_board.hall_events import Motions, TrialForm
from bayesfric.rigs.gravity_board.measurements import (
    TrialMeasurements,
    event_table,
    joined,
    noise_parameters,
    rough_noise,
)
from bayesfric.rigs.gravity_board.places import TrialPlaces, trial_condition
from bayesfric.rigs.gravity_board.scatter import scatter_parameters, scatter_values
from bayesfric.rigs.gravity_board.wander import Wander

__all__ = ["GravityLikelihood", "trial_condition"]

Scattered: TypeAlias = GroupedNormal | GroupedStudent | HeavyGroups
WALKERS_AT_ONCE = 50
START_SCATTER = 0.02  # of friction, a place to climb from
ONLY_NORMAL = "normal, since for Student-t scatter trials that did not move have no likelihood"


class GravityLikelihood:
    """Event times of the gravity board, given coefficients, scatter and noise.

    Methods are those of :class:`bayesfric.inference.model.RigLikelihood`: of W sets of
    parameters by name, and, where they draw, of a generator.

    Parameters
    ----------
    gravity : Gravity
        Trials that enter, those of a setup adjacent (see
        :func:`bayesfric.rigs.gravity_board.screening.screen_trials`).
    rig : RigConstants
        The board.
    analysis : Analysis
        Priors and the form of the scatter.
    baseline : FrictionLaw
        The friction law.
    effects : sequence of ActiveEffect
        What acts beside the law; what :meth:`TrialPlaces.supports` refuses is left out.
    at_rest : DataFrame or None
        Trials that did not move, see :mod:`bayesfric.rigs.gravity_board.at_rest`; None
        without any.
    places : TrialPlaces or None
        Of these trials, where other likelihoods of them share it; None is found anew.

    Attributes
    ----------
    parameters : tuple of Parameter
        What the likelihood depends on.
    trials : DataFrame
        The N trials in the order of every result, all of which moved.
    setups : tuple of str
        The J assemblies in the order of every result, those on which no trial moved last.

    Raises
    ------
    InputError
        Trials did not move, and scatter is Student-t.
    """

    def __init__(
        self,
        gravity: Gravity,
        rig: RigConstants,
        analysis: Analysis,
        baseline: FrictionLaw = BASELINES["paper"],
        effects: Sequence[ActiveEffect] = (),
        at_rest: pd.DataFrame | None = None,
        places: TrialPlaces | None = None,
    ) -> None:
        self._places = places or TrialPlaces(gravity, rig)
        here = [one for one in effects if self._places.supports(one.effect) is None]
        self._effects = here
        along = [one for one in here if one.effect.along_path or one.effect.components]
        steady = [one for one in here if one not in along]
        self.trials, self.condition = gravity.trials, self._places.condition
        codes, setups = pd.factorize(gravity.trials["setup"])
        self._groups = Groups(np.flatnonzero(np.diff(codes, prepend=-1)), codes.size)
        self._size = self._places.size
        self.sizes = self._size.sizes
        self._forces = SteadyForces(
            baseline, self.condition, self._size, steady, self._places.state
        )
        self._along = EffectsAlong(self._places, along)
        self._wander = Wander(self._places, analysis)
        noise = noise_parameters(gravity, analysis)
        self._rough_noise = rough_noise(noise, self._places.residual_m)
        self._gravity, self._rig, self._analysis = gravity, rig, analysis
        self.parameters = (
            *coefficient_parameters(self.sizes, analysis, baseline.without),
            *scatter_parameters(self.sizes, analysis),
            *self._wander.parameters,
            *noise,
            *(parameter for active in here for parameter in parameters_of(active)),
        )
        scatter = analysis.scatter
        freedom = scatter.degrees_of_freedom
        self._freedom = freedom if scatter.trial == "student-t" else None
        self._assembly_freedom = freedom if scatter.assembly == "student-t" else None
        self._at_rest: TrialsAtRest | None = None
        self.setups = tuple(str(setup) for setup in setups)
        if at_rest is not None and len(at_rest):
            for level in ("trial", "assembly"):
                if getattr(scatter, level) == "student-t":
                    column = f"scatter.{level}"
                    fault = Fault("analysis.toml", ONLY_NORMAL, column=column, value="student-t")
                    raise InputError([fault])
            self._at_rest = TrialsAtRest(
                at_rest, gravity.trials, rig, self.sizes, baseline, here, self._wander
            )
            self.setups += self._at_rest.setups

    def law(self, theta: Mapping[str, Array]) -> Array:
        """Return the friction of each trial by the law and the steady effects, (W, N) [N].

        fc of eq. (15) at the nominal tension of the moving board, and what effects add that do
        not change along a trial.
        """
        return self._forces.at(theta).friction

    def observed(self, theta: Mapping[str, Array]) -> tuple[Array, Array, Array]:
        """Return what was measured of each trial's friction, where none changes along it.

        That is friction [N], its error variance [N²], and the log density of the raw data less that
        of the friction, each of shape (W, N).
        """
        parts = [self._shown(some, self._forces.at(some)) for some in _blocks(theta)]
        friction, variance, log_constant = zip(*parts, strict=True)
        return np.concatenate(friction), np.concatenate(variance), np.concatenate(log_constant)

    def _shown(self, theta: Mapping[str, Array], forces: Forces) -> tuple[Array, Array, Array]:
        acceleration = self._form(theta, forces.friction).acceleration()
        return (
            forces.drive - forces.mass * acceleration.mean,
            forces.mass**2 * acceleration.variance,
            acceleration.log_constant + np.log(forces.mass),
        )

    def log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return the log density of all the data, shape (W,)."""
        return np.asarray(self.setup_log_likelihood(theta).sum(axis=-1))

    def setup_log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return the log density of each assembly's data, shape (W, J)."""
        return self._of_setups(theta, *self._scattered(theta))

    def given_rest(
        self, theta: Mapping[str, Array], rng: np.random.Generator | None = None
    ) -> GivenRest:
        """Return densities and probabilities of each trial and assembly given the rest.

        An assembly on which no trial moved has no probability of less friction, nor has any
        where scatter is Student-t. A trial is made again given those of its assembly that
        moved; what trials at rest add to that is left out.
        """
        scattered, constant = self._scattered(theta)
        setup_cdf = np.full((len(scattered.residual), len(self.setups)), np.nan)
        if isinstance(scattered, GroupedNormal):
            moved = scattered.group_cdf()
            setup_cdf[:, : moved.shape[1]] = moved
        density, cdf = scattered.single_log_density() + constant, scattered.single_cdf()
        if self._at_rest is not None:
            normal = _normal(scattered)
            density = density + self._at_rest.trial_log_density(theta, normal)
            cdf = self._at_rest.trial_cdf(theta, normal, cdf)
        setup = self._of_setups(theta, scattered, constant)
        more = setup[:, :0] if rng is None else scattered.draw_again(rng)
        return GivenRest(density, setup, cdf, setup_cdf, more)

    def _of_setups(
        self, theta: Mapping[str, Array], scattered: Scattered, constant: Array
    ) -> Array:
        moved = scattered.group_log_density() + self._groups.total(constant)
        if self._at_rest is None:
            return moved
        found = self._at_rest.setup_log_probability(theta, _normal(scattered))
        found[:, : moved.shape[1]] += moved
        return found

    def draw_trial_cdf(self, theta: Mapping[str, Array], rng: np.random.Generator) -> Array:
        """Return the probability of less friction than each trial's, of recordings made again.

        A recording a row, with new scatter on new assemblies.
        """
        _, variance, law, _ = self._frictions(theta)
        deviation = self.draw_scatter(theta, rng, together=True)
        again = law * (1 + deviation) + np.sqrt(variance) * rng.standard_normal(law.shape)
        return self._around(theta, again, variance, law).single_cdf()

    def _scattered(self, theta: Mapping[str, Array]) -> tuple[Scattered, Array]:
        """Return the density of the frictions, and each trial's rest of the log density, (W, N)."""
        observed, variance, law, constant = self._frictions(theta)
        return self._around(theta, observed, variance, law), constant

    def _around(
        self, theta: Mapping[str, Array], observed: Array, variance: Array, law: Array
    ) -> Scattered:
        """Return the density of frictions, all of shape (W, N), that scatter around the law."""
        tau, omega, of_intercept = scatter_values(theta, self._size)
        own = (law * tau) ** 2 + variance
        residual = observed - law
        moved = np.stack([law * omega, self._intercept(theta) * of_intercept])
        if self._freedom is not None:
            return GroupedStudent(self._groups, residual, own, moved, self._freedom)
        if self._assembly_freedom is not None:
            return HeavyGroups(self._groups, residual, own, moved, self._assembly_freedom)
        return GroupedNormal(self._groups, residual, own, moved)

    def _frictions(self, theta: Mapping[str, Array]) -> tuple[Array, Array, Array, Array]:
        """Return friction observed, its variance, the law's, and the rest of the log density.

        All of shape (W, N). With effects along the trial, "observed" is the law's friction
        times 1 + ŝ: the density of the trial is one of its scatter, in newtons.
        """
        law, drive, mass = forces = self._forces.at(theta)
        if self._along.columns is None:
            friction, variance, constant = self._shown(theta, forces)
            return friction, variance, law, constant
        added, scattered = self._along.amplitudes(theta, self._size.coefficients(theta))
        # Around the pilot, with A the amplitudes: m1 = (f, −A), of A only what scatters with
        # friction, and m0 = (r, A). The last entry is the residual's.
        slowed: list[Array | float] = [law / mass, *(-one for one in scattered), 0.0]
        around = (drive - law) / mass - self._measurements.origin
        form = self._form(theta, law, (slowed, [around, *added, -1.0]))
        precision, across, square = form.triangle
        constant = form.log_constant - 0.5 * (square - across**2 / precision)
        constant = constant + 0.5 * (LOG_2PI - np.log(precision)) + np.log(np.abs(law))
        return law * (1 + across / precision), law**2 / precision, law, constant

    def _form(
        self, theta: Mapping[str, Array], friction_n: Array, motions: Motions | None = None
    ) -> TrialForm:
        """Return what was measured, the wander along the trials integrated out."""
        variances = self._wander.variances(theta, friction_n)
        variances += self._along.variances(theta, self._size.coefficients(theta))
        return self._measurements.at(theta, variances, motions)

    def _intercept(self, theta: Mapping[str, Array]) -> Array:
        """Return the part of each trial's friction that does not grow with tension, (W, N) [N]."""
        pulleys = np.asarray(self.condition.n_pulleys, dtype=np.float64)
        return np.asarray(self._size.coefficients(theta).c2) * pulleys

    def draw_scatter(
        self, theta: Mapping[str, Array], rng: np.random.Generator, *, together: bool = False
    ) -> Array:
        """Draw η + κ n c2 / fc + ε of a new trial on a new assembly, (W, N).

        `together` puts trials of one assembly on one new assembly too, as when the whole recording
        is made again; else each is on one of its own.
        """
        tau, omega, of_intercept = scatter_values(theta, self._size)
        of_intercept = of_intercept * self._intercept(theta) / self.law(theta)
        shape = (len(tau), len(self.trials))
        if self._freedom is None:
            trial = rng.standard_normal(shape)
        else:
            trial = rng.standard_t(self._freedom, shape)
        assemblies = (len(tau), len(self.setups)) if together else shape
        drawn = rng.standard_normal((2, *assemblies))
        if self._assembly_freedom is not None:  # both numbers of an assembly are far out together
            freedom = self._assembly_freedom
            drawn = drawn * np.sqrt(freedom / rng.chisquare(freedom, assemblies))
        slope, intercept = drawn[..., self._groups.of_each] if together else drawn
        return np.asarray(omega * slope + of_intercept * intercept + tau * trial)

    def draw_observed(
        self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator
    ) -> Array:
        """Draw the friction that the events would show, with their error, (…, W, N) [N].

        `deviation` is how far friction is from the law, as :meth:`draw_scatter` draws it.
        """
        sd = np.sqrt(self.observed(theta)[1])
        return self.law(theta) * (1 + deviation) + sd * rng.standard_normal(deviation.shape)

    @cached_property
    def _measurements(self) -> TrialMeasurements:
        """Made when a density is first asked for: a start needs none."""
        columns, scattered = self._along.columns, self._along.scattered
        drawn_anew = joined(self._wander.columns, scattered)
        if columns is None and scattered is None:
            table = self._places.table
        else:
            table = event_table(self._gravity, self._rig, columns, drawn_anew)
        return TrialMeasurements(self._gravity, table, self._analysis, columns, drawn_anew)

    def start(self) -> dict[str, float]:
        """Return rough estimates by least squares, a place to climb from."""
        scatter = {
            parameter.name: START_SCATTER
            for parameter in self.parameters
            if parameter.name.startswith(("tau", "omega", "wander"))
        }
        scatter |= self._wander.start()
        effects = rough_values(self._effects)
        return self._rough_noise | scatter | effects | self._places.rough


def _blocks(theta: Mapping[str, Array]) -> Iterator[dict[str, Array]]:
    """Return some walkers at a time: the forms of many trials would not fit a cache."""
    whole = dict(zip(theta, np.broadcast_arrays(*theta.values()), strict=True))
    walkers = len(next(iter(whole.values())))
    for start in range(0, walkers, WALKERS_AT_ONCE):
        stop = start + WALKERS_AT_ONCE
        yield {name: values[start:stop] for name, values in whole.items()}


def _normal(scattered: Scattered) -> GroupedNormal:
    assert isinstance(scattered, GroupedNormal)  # else trials at rest are refused
    return scattered
