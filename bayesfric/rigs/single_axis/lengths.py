"""Searches for the length of play, or of the wind-up of a spring, of a load behind the drive.

A load that coasts through play, or oscillates on a spring, moves with another period at each
length. Its motion can therefore not be interpolated between a few quantiles of a prior, and the
length is found by a search over a fine grid.

No length is reported in two cases. If the longest length fits best, the explained force continues
over the whole path, as the force of a coarse encoder in the loop does. If the length is below the
resolution of the positions, the simulated motion of the load consists of their errors, which are
also in the force.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags
from bayesfric.effects import Effect, State, all_effects
from bayesfric.effects.candidates import SHAPE_NODES, prior_moments
from bayesfric.physics.axis import AxisLaw
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.following import DAMPINGS, LENGTHS, NEAR, OWN, REFINED
from bayesfric.rigs.single_axis.measures import SPREAD, Measures
from bayesfric.rigs.single_axis.readings import Readings
from bayesfric.rigs.single_axis.rough import without_columns
from bayesfric.rigs.single_axis.rows import state_of

MOST = 40_000
"""Samples of the paths along which lengths are tried. Lengths differ by a fifth, so more samples
would not change the best one."""


def with_lengths(
    readings: Readings, table: pd.DataFrame, measures: Measures, constants: RigConstants
) -> Measures:
    """Return measures with the best-fitting length of play and of wind-up, and lengths around it.

    The length of a spring's wind-up is searched at a middle damping ratio. Then the damping ratio
    that fits best is chosen.

    Parameters
    ----------
    readings : Readings
        Windows of all runs.
    table : DataFrame
        Table of trials.
    measures : Measures
        Scales of the recording, without lengths.
    constants : RigConstants
        The constants of the machine.
    """
    rows = _Rows.of(_thinned(readings), table, measures, constants)
    by_held = {
        held: effect
        for effect in all_effects(None).values()
        for held in effect.needs & LENGTHS.keys()
    }
    lengths, untold = {}, set()
    for held, effect in by_held.items():
        tried = measures.stroke * LENGTHS[held]
        reduction, best = rows.strongest(effect, tried, measures)
        longest = best == tried[-1]
        if held == "spring":
            middling = np.array([measures.damping])
            own = rows.own_shares(effect, OWN, best * NEAR, middling)
            if own.reduction > AXIS_RULES.own_length * reduction:
                best, measures = own.length, replace(measures, mass_over_friction=own.heavy)
                longest = False
        if longest or best < AXIS_RULES.least_length * readings.position_sd:
            untold.add(held)
        lengths[held] = best * np.exp(SPREAD * SHAPE_NODES)
    measures = replace(measures, lengths=lengths, untold=frozenset(untold))
    spring = by_held["spring"]
    rows.readings.load_motions.simulate(
        measures.slows(rows.readings), lengths["spring"], measures.mass_over_friction, DAMPINGS
    )
    damped = max(
        (replace(measures, damping=damping) for damping in DAMPINGS),
        key=lambda tried: rows.strongest(spring, lengths["spring"], tried)[0],
    )
    if damped.mass_over_friction == Measures.mass_over_friction:
        return damped
    middle = float(lengths["spring"][len(SHAPE_NODES) // 2])
    finer = rows.own_shares(
        spring,
        damped.mass_over_friction * REFINED["shares"],
        middle * REFINED["length"],
        damped.damping * REFINED["damping"],
    )
    lengths["spring"] = lengths["spring"] * finer.length / middle
    return replace(damped, lengths=lengths, mass_over_friction=finer.heavy, damping=finer.damping)


def _thinned(readings: Readings) -> Readings:
    """Return windows along some of the paths, which have about :data:`MOST` samples in total."""
    motions, there = readings.load_motions.thinned(MOST)
    rows = np.flatnonzero(np.isin(readings.place, there))
    place = np.searchsorted(there, readings.place[rows])
    return replace(readings.at(rows), place=place, load_motions=motions)


class _OwnShares(NamedTuple):
    """The best-fitting load on a spring.

    Parameters
    ----------
    reduction : float
        Reduction of the residual sum of squares.
    heavy : float
        Ratio of its share of the mass to its share of the friction.
    length : float
        Wind-up [m or rad].
    damping : float
        Damping ratio.
    """

    reduction: float
    heavy: float
    length: float
    damping: float


class _Rows(NamedTuple):
    """Residuals of the windows' forces after the law and a force that is linear in position.

    Parameters
    ----------
    readings, table, measures, constants
        As of :func:`with_lengths`.
    inside : ndarray of bool, shape (W,)
        The N windows that are used: those within the limit of the drive.
    basis : ndarray, shape (N, k)
        Orthonormal basis of the fitted columns.
    left : ndarray, shape (N,)
        Residual force.
    """

    readings: Readings
    table: pd.DataFrame
    measures: Measures
    constants: RigConstants
    inside: Flags
    basis: Array
    left: Array

    @classmethod
    def of(
        cls,
        readings: Readings,
        table: pd.DataFrame,
        measures: Measures,
        constants: RigConstants,
    ) -> "_Rows":
        """Fit the law by least squares."""
        inside = measures.limit.within(readings)
        spring = readings.way * readings.mean_position / measures.stroke
        law = np.column_stack(
            [readings.law_columns, readings.force_rate, readings.way, spring, readings.beside]
        )
        left = without_columns(law[inside], readings.force[inside])
        return cls(readings, table, measures, constants, inside, *left)

    def strongest(self, effect: Effect, lengths: Array, measures: Measures) -> tuple[float, float]:
        """Return the largest reduction of the residual sum of squares, and its length.

        The maximum is over all laws of an effect and over all lengths.
        """
        law = AxisLaw(self.measures.mass, self.measures.friction)
        no_trial = np.zeros(len(self.table), dtype=np.bool_)
        state = state_of(self.readings, law, self.table, no_trial, measures, self.constants)

        def reduction(length: float) -> float:
            columns = [
                _column(effect, name, length, state, self.readings)[self.inside]
                for name in effect.laws
            ]
            return float(self.reductions(np.stack(columns, axis=1), effect).max())

        return max((reduction(float(length)), float(length)) for length in lengths)

    def reductions(self, columns: Array, effect: Effect) -> Array:
        """Return by how much each of K columns reduces the residual sum of squares, (K,).

        Amplitudes are not negative, and are regularised by the width of the effect's prior.

        Parameters
        ----------
        columns : ndarray, shape (N, K)
            The force of an amplitude of 1 in each window.
        """
        free = columns - self.basis @ (self.basis.T @ columns)
        noise = self.left @ self.left / self.left.size
        noise = noise / prior_moments(effect.amplitude.prior)[1] ** 2
        size = np.sum(free**2, axis=0) + noise
        return np.asarray(np.maximum(self.left @ free, 0.0) ** 2 / np.where(size > 0, size, np.inf))

    def own_shares(
        self, spring: Effect, shares: Array, lengths: Array, dampings: Array
    ) -> _OwnShares:
        """Return the best load on a spring among all combinations of ratio, length and damping."""
        heavy, near, damped = (values.ravel() for values in np.meshgrid(shares, lengths, dampings))
        mass = self.measures.mass + self.readings.known_inertia
        friction, slows = self.measures.friction, self.measures.slows(self.readings)
        moved = self.readings.load_motions.side_by_side(
            "spring", slows, heavy, near / heavy, damped
        )
        late, lost = moved[:, self.readings.place[self.inside]]
        reduction = self.reductions(heavy * mass * late + friction * lost, spring)
        best = int(np.argmax(reduction))
        return _OwnShares(*(float(values[best]) for values in (reduction, heavy, near, damped)))


def _column(effect: Effect, law: str, length: float, state: State, readings: Readings) -> Array:
    """Return the force of a law with amplitude 1 in each window, (W,)."""
    assert effect.shape is not None
    values = {effect.amplitude.name: 1.0, effect.shape.name: length}
    inside = np.broadcast_to(effect.laws[law](values, state), readings.speed.shape)
    return np.asarray(inside @ readings.weights)
