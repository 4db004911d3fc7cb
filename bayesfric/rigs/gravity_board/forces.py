"""What pulls at trials of the gravity board: friction by law and steady effects, and drive."""

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

TENSION_ITERATIONS = 2  # each takes the error of an effect's tension down by some 100


class Forces(NamedTuple):
    """What pulls at N trials, arrays that broadcast to (W, N)."""

    friction: Array  # scatter multiplies it [N]
    drive: Array  # at standstill, scatter leaves it alone [N]
    mass: Array  # that is accelerated [kg]


class SteadyForces:
    """Forces that do not change along a trial.

    Parameters
    ----------
    baseline : FrictionLaw
        The friction law.
    condition : Condition
        Of the N trials.
    size : SizeIndex
        Their pulley sizes.
    effects : sequence of ActiveEffect
        On friction or drive.
    state : callable
        (law, acceleration) to where the trials are, arrays of shape (W, N).
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
        """Return the friction that scatters, and drive and mass as effects on them leave them.

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
        for _ in range(TENSION_ITERATIONS):  # the drag changes the tension on which it depends
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
