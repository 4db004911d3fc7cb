"""Effects on simulated trials: forces along the way, and errors of a reading."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.boards.gravity import Condition, nominal_tension
from bayesfric.effects import Reading, State
from bayesfric.friction import Coefficients, coulomb_friction
from bayesfric.paper import table1
from bayesfric.recording.tables import Rig
from bayesfric.simulate.truth import AppliedEffect

__all__ = ["TrialForces", "place_in_order", "pulley_radii", "reading_errors"]

Array = NDArray[np.float64]
STEPS, FINE_STEPS = 900, 3600  # of Runge-Kutta; the second where a force goes round
TENSION_ITERATIONS = 5  # friction changes by a hundredth of what the tension does


def place_in_order(rows: int) -> Array:
    """Return the place of each row in the order of the recording, 0 to 1, shape (N,)."""
    return np.linspace(0, 1, rows) if rows > 1 else np.full(rows, 0.5)


def pulley_radii(sizes: "pd.Series[str]", rig: Rig) -> Array:
    """Return the pulley radius of each row, shape (N,) [m]."""
    known: Mapping[str, float] = {size: row.radius_m for size, row in table1().items()}
    stated = {size: pulley.radius_m for size, pulley in rig.pulleys.items() if pulley.radius_m}
    return np.array([stated.get(size) or known[size] for size in sizes])


class TrialForces:
    """Friction of the law and forces of effects on N trials that move.

    Parameters
    ----------
    law : Coefficients
        Of each trial, arrays of shape (N,).
    condition : Condition
        Likewise.
    factor : ndarray, shape (N,)
        1 + η + ε, what friction is multiplied by.
    radius_m, order : ndarray, shape (N,)
        Pulley radius [m] and place in the order of the recording.
    effects : sequence of AppliedEffect
        Those on friction or on the drive.
    weights : sequence of ndarray, shape (components, N)
        Of each effect's phases; empty of an effect without.
    """

    def __init__(
        self,
        law: Coefficients,
        condition: Condition,
        factor: Array,
        radius_m: Array,
        order: Array,
        effects: Sequence[AppliedEffect],
        weights: Sequence[Array],
    ) -> None:
        self._law, self._condition, self._factor = law, condition, factor
        self._radius, self._order = radius_m, order
        self._effects = list(zip(effects, weights, strict=True))

    @property
    def steps(self) -> int:
        """How finely the motion is to be followed."""
        return FINE_STEPS if any(len(weights) for _, weights in self._effects) else STEPS

    def acceleration(self, travel_m: Array, speed_m_s: Array) -> Array:
        """Return the acceleration of trials that move, shape (N,) [m/s²]."""
        condition, law = self._condition, self._law
        mass = condition.total_mass_kg
        friction, drag = np.zeros_like(speed_m_s), np.zeros_like(speed_m_s)
        for _ in range(TENSION_ITERATIONS):  # tension and inertia depend on what they change
            acceleration = (condition.drive_force_n - friction - drag) / mass
            state = State.of(
                law,
                condition.n_pulleys,
                condition.wrap_angle_deg,
                nominal_tension(condition, acceleration),
                speed_m_s,
                travel_m=travel_m,
                acceleration_m_s2=acceleration,
                radius_m=self._radius,
                order=self._order,
                gravity_m_s2=condition.gravity_m_s2,
            )
            friction = coulomb_friction(
                law, condition.n_pulleys, condition.wrap_angle_deg, state.tension_n
            )
            friction = friction + self._sum("friction", state)
            drag = self._sum("drive", state)
        return np.asarray((condition.drive_force_n - self._factor * friction - drag) / mass)

    def _sum(self, acts_on: str, state: State) -> Array:
        total = np.zeros_like(self._factor)
        for applied, weights in self._effects:
            if applied.effect.acts_on == acts_on:
                force = applied(state)
                total = total + ((weights * force).sum(axis=0) if len(weights) else force)
        return total


def reading_errors(
    effects: Sequence[AppliedEffect], weights: Sequence[Array], reading: Reading
) -> Array:
    """Return how far beyond its place each magnet passes [m].

    Parameters
    ----------
    effects : sequence of AppliedEffect
        Those on readings.
    weights : sequence of ndarray, shape (components, N, sensors)
        Of each effect's phases; empty of an effect without.
    reading : Reading
        Arrays of shape (N, sensors, events).
    """
    total = np.zeros(np.shape(reading.time_s))
    for applied, weight in zip(effects, weights, strict=True):
        beyond = applied(reading)
        total = total + ((weight[..., None] * beyond).sum(axis=0) if len(weight) else beyond)
    return total
