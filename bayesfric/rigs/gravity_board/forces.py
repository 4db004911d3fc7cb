"""Friction and drive of the gravity board's trials, with effects that are constant in a trial."""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from bayesfric.arrays import Array
from bayesfric.effects import State
from bayesfric.effects.terms import ActiveEffect, total
from bayesfric.observation.coefficients import SizeIndex
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import Condition, tension_feedback
from bayesfric.physics.laws import FrictionLaw

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
