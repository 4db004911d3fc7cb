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

import numpy as np
import pandas as pd

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.effects.terms import ActiveEffect, parameters_of, rough_values
from bayesfric.errors import Fault, InputError
from bayesfric.inference.grouped_normal import LOG_2PI
from bayesfric.observation.coefficients import coefficient_parameters
from bayesfric.observation.exact import ExactModel, Shown
from bayesfric.observation.scatter import ScatterLevels
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
from bayesfric.rigs.gravity_board.places import TrialPlaces
from bayesfric.rigs.gravity_board.wander import Wander

SCATTER = ("tau", "omega", "omega_intercept")
WALKERS_AT_ONCE = 50
START_WANDER = 0.02  # of friction, a place to climb from
ONLY_NORMAL = "normal, since for Student-t scatter trials that did not move have no likelihood"


class GravityModel(ExactModel):
    """Event times of the gravity board; see :class:`bayesfric.observation.exact.ExactModel`.

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
    condition : Condition
        Of each trial, arrays of shape (N,).
    trials : DataFrame
        The N trials in the order of every result, all of which moved.

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
        supported = [effect for effect in effects if self._places.supports(effect.effect) is None]
        self._effects = supported
        along = [
            effect for effect in supported if effect.effect.along_path or effect.effect.components
        ]
        steady = [effect for effect in supported if effect not in along]
        self.trials, self.condition = gravity.trials, self._places.condition
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
        self.coefficients = coefficient_parameters(self.sizes, analysis, baseline.without)
        priors = tuple(getattr(analysis.priors, name) for name in SCATTER)
        self.scatter = ScatterLevels(SCATTER, priors, self._size, analysis.scatter)
        self.further = (
            *self._wander.parameters,
            *noise,
            *(parameter for active in supported for parameter in parameters_of(active)),
        )
        self.at_rest: TrialsAtRest | None = None
        if at_rest is not None and len(at_rest):
            for level in ("trial", "assembly"):
                if getattr(analysis.scatter, level) == "student-t":
                    column = f"scatter.{level}"
                    fault = Fault("analysis.toml", ONLY_NORMAL, column=column, value="student-t")
                    raise InputError([fault])
            self.at_rest = TrialsAtRest(
                at_rest,
                gravity.trials,
                rig,
                self.sizes,
                baseline,
                supported,
                self._wander,
                self.scatter,
            )

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
        parts = [self._steady(some, self._forces.at(some)) for some in _blocks(theta)]
        friction, variance, log_constant = zip(*parts, strict=True)
        return np.concatenate(friction), np.concatenate(variance), np.concatenate(log_constant)

    def _steady(self, theta: Mapping[str, Array], forces: Forces) -> tuple[Array, Array, Array]:
        acceleration = self._form(theta, forces.friction).acceleration()
        return (
            forces.drive - forces.mass * acceleration.mean,
            forces.mass**2 * acceleration.variance,
            acceleration.log_constant + np.log(forces.mass),
        )

    def shown(self, theta: Mapping[str, Array]) -> Shown:
        """Return the friction that the events of each trial show."""
        friction, variance, law, constant = self._frictions(theta)
        return Shown(friction - law, variance, law, constant)

    def _frictions(self, theta: Mapping[str, Array]) -> tuple[Array, Array, Array, Array]:
        """Return friction observed, its variance, the law's, and the rest of the log density.

        All of shape (W, N). With effects along the trial, "observed" is the law's friction
        times 1 + ŝ: the density of the trial is one of its scatter, in newtons.
        """
        law, drive, mass = forces = self._forces.at(theta)
        if self._along.columns is None:
            friction, variance, constant = self._steady(theta, forces)
            return friction, variance, law, constant
        added, scattered = self._along.amplitudes(theta, self._size.coefficients(theta))
        # Around the pilot, with A the amplitudes: m1 = (f, −A), of A only what scatters with
        # friction, and m0 = (r, A). The last entry is the residual's.
        slowed: list[Array | float] = [law / mass, *(-column for column in scattered), 0.0]
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

    def intercept(self, theta: Mapping[str, Array]) -> Array:
        """Return the part of friction that does not grow with tension, (W, N) [N]."""
        pulleys = np.asarray(self.condition.n_pulleys, dtype=np.float64)
        return np.asarray(self._size.coefficients(theta).c2) * pulleys

    def read(self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator) -> Array:
        """Draw the friction that the events would show, with their error, (…, W, N) [N].

        `deviation` is how far friction is from the law, relative to it.
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
        effects = rough_values(self._effects)
        wander = dict.fromkeys(
            (parameter.name for parameter in self._wander.parameters), START_WANDER
        )
        return self._rough_noise | wander | self._wander.start() | effects | self._places.rough


def _blocks(theta: Mapping[str, Array]) -> Iterator[dict[str, Array]]:
    """Return some walkers at a time: the forms of many trials would not fit a cache."""
    whole = dict(zip(theta, np.broadcast_arrays(*theta.values()), strict=True))
    walkers = len(next(iter(whole.values())))
    for start in range(0, walkers, WALKERS_AT_ONCE):
        stop = start + WALKERS_AT_ONCE
        yield {name: values[start:stop] for name, values in whole.items()}
