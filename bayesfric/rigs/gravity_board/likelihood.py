"""Likelihood of the gravity board: event times given the friction law and effects.

The log density of a trial's events is a quadratic form in its motion w
(:mod:`bayesfric.rigs.gravity_board.measurements`). The motion consists of the acceleration and of
the amplitudes of effects that change along the trial. All friction of a trial, including effects on
friction, is multiplied by 1 + s with s = η + ε. The motion is therefore linear in s, and the
density of the events is a normal density of s:

    w(s) = m0 − s m1,   log p(times | s) = log N(ŝ; s, 1/(m1ᵀ G m1)) + constant.

Without effects along the trial, this is equivalent to a density of its friction,
``f = (m1 + m2) (a_free − a)``, with the Jacobian m1 + m2. The density of s for all trials is in
:mod:`bayesfric.inference.grouped_normal`. :mod:`.simulator` simulates the same model.
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
START_WANDER = 0.02  # starting value of the rms, relative to friction
ONLY_NORMAL = "normal: with Student-t scatter, trials that did not move cannot be used"


class GravityModel(ExactModel):
    """Event times of the gravity board; see :class:`bayesfric.observation.exact.ExactModel`.

    Parameters
    ----------
    gravity : Gravity
        Trials that are used; those of an assembly are adjacent (see
        :func:`bayesfric.rigs.gravity_board.screening.screen_trials`).
    rig : RigConstants
        Constants of the board.
    analysis : Analysis
        Priors and the form of the scatter.
    baseline : FrictionLaw
        The friction law.
    effects : sequence of ActiveEffect
        Effects that act in addition to the law. Those that :meth:`TrialPlaces.supports` does not
        support are ignored.
    at_rest : DataFrame or None
        Trials that did not move, see :mod:`bayesfric.rigs.gravity_board.at_rest`; None
        without any.
    places : TrialPlaces or None
        States of these trials, if they are shared with other likelihoods; None computes them.

    Attributes
    ----------
    condition : Condition
        Condition of each trial, arrays of shape (N,).
    trials : DataFrame
        The N trials, all of which moved, in the order of all results.

    Raises
    ------
    InputError
        There are trials that did not move, and scatter is Student-t.
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

        It is the law at the nominal tension of the moving board, plus effects that do not change
        along a trial.
        """
        return self._forces.at(theta).friction

    def observed(self, theta: Mapping[str, Array]) -> tuple[Array, Array, Array]:
        """Return the measured friction of each trial, assuming that it is constant along the trial.

        The results are the friction [N], its error variance [N²], and the log density of the raw
        data minus that of the friction, each of shape (W, N).
        """
        parts = [self._steady(block, self._forces.at(block)) for block in _blocks(theta)]
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
        """Return the measure of each trial's friction from its events."""
        friction, variance, law, constant = self._frictions(theta)
        return Shown(friction - law, variance, law, constant)

    def _frictions(self, theta: Mapping[str, Array]) -> tuple[Array, Array, Array, Array]:
        """Return observed friction, its variance, the law's, and the rest of the log density.

        All have shape (W, N). With effects along the trial, the observed friction is the law's
        friction times 1 + ŝ, so that the density of ŝ becomes a density in newtons.
        """
        law, drive, mass = forces = self._forces.at(theta)
        if self._along.columns is None:
            friction, variance, constant = self._steady(theta, forces)
            return friction, variance, law, constant
        added, scattered = self._along.amplitudes(theta, self._size.coefficients(theta))
        # With amplitudes A: m1 = (f / mass, −A of effects on friction, 0) and
        # m0 = (acceleration minus that of the pilot fit, A, −1). The last entry is the residual's.
        m1: list[Array | float] = [law / mass, *(-amplitude for amplitude in scattered), 0.0]
        acceleration = (drive - law) / mass - self._measurements.origin
        form = self._form(theta, law, (m1, [acceleration, *added, -1.0]))
        precision, across, square = form.triangle
        constant = form.log_constant - 0.5 * (square - across**2 / precision)
        constant = constant + 0.5 * (LOG_2PI - np.log(precision)) + np.log(np.abs(law))
        return law * (1 + across / precision), law**2 / precision, law, constant

    def _form(
        self, theta: Mapping[str, Array], friction_n: Array, motions: Motions | None = None
    ) -> TrialForm:
        """Return the quadratic forms with wander and phases integrated out."""
        variances = self._wander.variances(theta, friction_n)
        variances += self._along.variances(theta, self._size.coefficients(theta))
        return self._measurements.at(theta, variances, motions)

    def intercept(self, theta: Mapping[str, Array]) -> Array:
        """Return the part of friction that does not grow with tension, (W, N) [N]."""
        pulleys = np.asarray(self.condition.n_pulleys, dtype=np.float64)
        return np.asarray(self._size.coefficients(theta).c2) * pulleys

    def read(self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator) -> Array:
        """Draw measured friction, given its relative deviation from the law, (…, W, N) [N]."""
        sd = np.sqrt(self.observed(theta)[1])
        return self.law(theta) * (1 + deviation) + sd * rng.standard_normal(deviation.shape)

    @cached_property
    def _measurements(self) -> TrialMeasurements:
        """Tabulated events, computed for the first density; starting values do not need them."""
        columns, scattered = self._along.columns, self._along.scattered
        drawn_anew = joined(self._wander.columns, scattered)
        if columns is None and scattered is None:
            table = self._places.table
        else:
            table = event_table(self._gravity, self._rig, columns, drawn_anew)
        return TrialMeasurements(self._gravity, table, self._analysis, columns, drawn_anew)

    def start(self) -> dict[str, float]:
        """Return starting values by least squares."""
        effects = rough_values(self._effects)
        wander = dict.fromkeys(
            (parameter.name for parameter in self._wander.parameters), START_WANDER
        )
        return self._rough_noise | wander | self._wander.start() | effects | self._places.rough


def _blocks(theta: Mapping[str, Array]) -> Iterator[dict[str, Array]]:
    """Yield blocks of walkers whose forms fit into the cache of a processor."""
    whole = dict(zip(theta, np.broadcast_arrays(*theta.values()), strict=True))
    walkers = len(next(iter(whole.values())))
    for start in range(0, walkers, WALKERS_AT_ONCE):
        stop = start + WALKERS_AT_ONCE
        yield {name: values[start:stop] for name, values in whole.items()}
