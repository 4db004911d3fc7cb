"""Friction and drive of the gravity board's trials, with effects.

Effects that change along a trial are fixed responses with an amplitude for each walker.
The responses are computed once, at rough friction coefficients. For each walker they are multiplied
by two factors. The first is the ratio of the effect's force to its force at the rough coefficients.
The second is the feedback of tension: a force along the path changes tension, and so friction.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from bayesfric.arrays import Array
from bayesfric.effects import State
from bayesfric.effects.terms import ActiveEffect, LinearTerm, linear_terms, total
from bayesfric.observation.coefficients import SizeIndex
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import Condition, tension_feedback
from bayesfric.physics.laws import FrictionLaw
from bayesfric.rigs.gravity_board.measurements import Columns, joined
from bayesfric.rigs.gravity_board.places import TrialPlaces

TENSION_ITERATIONS = 2  # each reduces the error of the tension by a factor of about 100


class Forces(NamedTuple):
    """Forces on N trials and their mass, arrays that broadcast to (W, N)."""

    friction: Array  # multiplied by scatter [N]
    drive: Array  # at zero acceleration, without scatter [N]
    mass: Array  # accelerated mass, including the drive's change with acceleration [kg]


class SteadyForces:
    """Forces that do not change along a trial.

    Parameters
    ----------
    baseline : FrictionLaw
        The friction law.
    condition : Condition
        Condition of each of N trials.
    size : SizeIndex
        Pulley size of each trial.
    effects : sequence of ActiveEffect
        Effects on friction or drive.
    state : callable
        Function of (law, acceleration) that returns the state of each trial, arrays of shape
        (W, N).
    """

    def __init__(
        self,
        baseline: FrictionLaw,
        condition: Condition,
        size: SizeIndex,
        effects: Sequence[ActiveEffect],
        state: Callable[[Coefficients, Array], State],
    ) -> None:
        self._friction = baseline.gravity
        self._condition, self._size = condition, size
        self._effects, self._state = tuple(effects), state

    def at(self, theta: Mapping[str, Array]) -> Forces:
        """Return friction, drive and mass, including the effects.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        """
        law, condition = self._size.coefficients(theta), self._condition
        friction = self._friction(law, condition)
        drive, mass = condition.drive_force_n, condition.total_mass_kg
        if not self._effects:
            return Forces(friction, drive, mass)
        feedback = tension_feedback(law, condition)
        drag = held = slope = np.zeros_like(friction)
        for _ in range(TENSION_ITERATIONS):  # effects change the tension, on which they depend
            acceleration = (drive - friction - feedback * (drag + held)) / mass
            drag = self._force("friction", theta, law, acceleration)
            held = self._force("drive", theta, law, acceleration)
            slope = self._force("drive", theta, law, acceleration + 1) - held
        return Forces(
            friction + feedback * drag + (feedback - 1) * held,
            drive - held + slope * acceleration,
            mass + slope,
        )

    def _force(
        self, kind: str, theta: Mapping[str, Array], law: Coefficients, acceleration: Array
    ) -> Array:
        """Return the force of effects of one kind, shape (W, N) [N]."""
        of_kind = [effect for effect in self._effects if effect.effect.acts_on == kind]
        if not of_kind:
            return np.zeros_like(acceleration)
        return np.broadcast_to(
            total(of_kind, theta, self._state(law, acceleration)), acceleration.shape
        )


class EffectsAlong:
    """Responses of N trials to effects that change along them.

    Parameters
    ----------
    places : TrialPlaces
        The trials and their measured motion.
    active : sequence of ActiveEffect
        Effects along the path, effects on readings, and effects with phases.

    Attributes
    ----------
    active : tuple of ActiveEffect
        These effects.
    columns : Columns or None
        K responses of effects without phases; None if there are none.
    scattered : Columns or None
        Response to each component of effects with phases, which are independent in each trial;
        None if there are none.
    """

    def __init__(self, places: TrialPlaces, active: Sequence[ActiveEffect]) -> None:
        self._places, self.active = places, tuple(active)
        without_phase = [effect for effect in active if not effect.effect.components]
        readings = [effect for effect in without_phase if effect.effect.acts_on == "reading"]
        forces = [effect for effect in without_phase if effect.effect.acts_on != "reading"]
        by_force, by_reading = [], []
        if forces:
            by_force = linear_terms(forces, places.added_acceleration, places.paths.seen)
        if readings:
            by_reading = linear_terms(readings, places.reading_response, np.asarray)
        self._terms: list[LinearTerm] = [*by_force, *by_reading]
        self.columns = joined(
            *(places.columns(list(term.responses)) for term in by_force),
            *(places.read_columns(term.responses) for term in by_reading),
        )
        self._phased = [effect for effect in active if effect.effect.components]
        components = [self._components(effect) for effect in self._phased]
        self._counts = [len(columns.acceleration) for columns in components]
        self.scattered = joined(*components)

    def variances(self, theta: Mapping[str, Array], law: Coefficients) -> list[Array]:
        """Return the variance of the coefficient of each of :attr:`scattered`, shape (W, N).

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        law : Coefficients
            Coefficients for each walker and trial, arrays of shape (W, N).
        """
        variances = []
        for active, count in zip(self._phased, self._counts, strict=True):
            amplitude = active.values(theta)[active.effect.amplitude.name]
            variances += [(amplitude * self._scale(active, theta, law)) ** 2] * count
        return variances

    def _components(self, active: ActiveEffect) -> Columns:
        """Return responses to an effect's components; for readings, separately for each sensor."""
        places, unit = self._places, {active.effect.amplitude.name: np.float64(1.0)}
        if active.effect.acts_on != "reading":
            return places.columns(list(places.added_acceleration(active, unit)))
        assert places.events is not None
        sensors = places.events.of_sensors
        both = places.reading_response(active, unit)
        return places.read_columns(
            np.concatenate([both * sensor for sensor in sensors if sensor.any()])
        )

    def amplitudes(
        self, theta: Mapping[str, Array], law: Coefficients
    ) -> tuple[list[Array], list[Array | float]]:
        """Return the coefficient of each response, and its part that scatters with friction.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        law : Coefficients
            Coefficients for each walker and trial, arrays of shape (W, N).

        Returns
        -------
        added : list of K ndarrays, shape (W, N)
            Coefficients of the responses.
        scattered : list of K ndarrays, shape (W, N), or 0
            The same coefficients for effects on friction; 0 for other effects.
        """
        added: list[Array] = []
        scattered: list[Array | float] = []
        for term in self._terms:
            numbers = list(
                term.amplitudes(theta)[:, :, None] * self._scale(term.active, theta, law)
            )
            added += numbers
            on_friction = term.active.effect.acts_on == "friction"
            scattered += numbers if on_friction else [0.0] * len(numbers)
        return added, scattered

    def _scale(self, active: ActiveEffect, theta: Mapping[str, Array], law: Coefficients) -> Array:
        """Return the factor of a response in addition to its amplitude, shape (W, N)."""
        places, effect = self._places, active.effect
        if effect.acts_on == "reading":
            return np.ones((1, places.acceleration.size))
        values = active.values(theta) | {effect.amplitude.name: np.float64(1.0)}
        force = effect.laws[active.law]
        at_walker = np.asarray(force(values, places.typical_state(law)))
        at_rough = np.asarray(force(values, places.typical_state(places.law)))
        if effect.components:  # the first is a cosine, which is largest at travel 0, used here
            at_walker, at_rough = at_walker[0], at_rough[0]
        ratio = np.divide(at_walker, at_rough, out=np.ones_like(at_walker), where=at_rough != 0)
        return np.asarray(ratio * tension_feedback(law, places.condition))
