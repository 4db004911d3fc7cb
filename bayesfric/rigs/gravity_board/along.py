"""Effects that change along a trial, as fixed responses times numbers.

Responses are tabulated at rough coefficients. For those of the walker the ratio of the
effect's force to that at the rough ones makes good, and the tension, which a force along
the path changes too, feeds back.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bayesfric.effects.terms import ActiveEffect, LinearTerm, linear_terms
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import tension_feedback
from bayesfric.rigs.gravity_board.measurements import Columns
from bayesfric.rigs.gravity_board.places import TrialPlaces

__all__ = ["EffectsAlong"]

Array = NDArray[np.float64]


class EffectsAlong:
    """What effects add along N trials.

    Parameters
    ----------
    places : TrialPlaces
        Where the trials are.
    active : sequence of ActiveEffect
        Effects along the path, and on readings.

    Attributes
    ----------
    active : tuple of ActiveEffect
        Forces first.
    columns : Columns or None
        Of K responses; None without effects.
    """

    def __init__(self, places: TrialPlaces, active: Sequence[ActiveEffect]) -> None:
        self._places = places
        forces = [one for one in active if one.effect.acts_on != "reading"]
        readings = [one for one in active if one.effect.acts_on == "reading"]
        self.active = (*forces, *readings)
        self.columns: Columns | None = None
        self._terms: list[LinearTerm] = []
        if not active:
            return
        paths, seen = places.paths, places.with_events
        travel, acceleration = [], []
        for term in linear_terms(forces, places.slowing, paths.seen):
            self._terms.append(term)
            for response in term.responses:
                acceleration.append(response.mean(axis=-1))
                if places.events is not None:
                    there = paths.of(np.flatnonzero(seen))
                    travel.append(there.response(places.events, response[seen]))
        for term in linear_terms(readings, places.misread, np.asarray):
            self._terms.append(term)
            travel += list(term.responses)
            acceleration += [np.zeros(seen.size)] * len(term.responses)
        self.columns = Columns(np.array(travel), np.stack(acceleration))

    def amplitudes(
        self, theta: Mapping[str, Array], law: Coefficients
    ) -> tuple[list[Array], list[Array | float]]:
        """Return the number of each response, and what of it scatters with friction.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        law : Coefficients
            Of each walker and trial, arrays of shape (W, N).

        Returns
        -------
        added : list of K ndarrays, shape (W, N)
            Numbers.
        scattered : list of K ndarrays, shape (W, N), or 0
            The same of effects on friction; 0 of what scatter leaves alone.
        """
        added: list[Array] = []
        scattered: list[Array | float] = []
        for term in self._terms:
            numbers = list(term.amplitudes(theta)[:, :, None] * self._scale(term, theta, law))
            added += numbers
            here = term.active.effect.acts_on == "friction"
            scattered += numbers if here else [0.0] * len(numbers)
        return added, scattered

    def _scale(self, term: LinearTerm, theta: Mapping[str, Array], law: Coefficients) -> Array:
        """Return by what a response is to be multiplied beside its amplitude, shape (W, N)."""
        places, effect = self._places, term.active.effect
        if effect.acts_on == "reading":
            return np.ones((1, places.acceleration.size))
        values = term.active.values(theta) | {effect.amplitude.name: np.float64(1.0)}
        force = effect.laws[term.active.law]
        now = np.asarray(force(values, places.typical_state(law)))
        then = np.asarray(force(values, places.typical_state(places.law)))
        ratio = np.divide(now, then, out=np.ones_like(now), where=then != 0)
        return np.asarray(ratio * tension_feedback(law, places.condition))
