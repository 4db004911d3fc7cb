"""The length of play or of the wind-up of a load behind the drive, from a search over the rows.

A load that coasts through play, or oscillates on a spring, has another rhythm at each length, so
nothing can be interpolated between the lengths at quantiles of a prior. If the longest length fits
best, no length is reported: the explained force continues over the whole path, as that of a coarse
encoder in the loop does. A length that positions do not resolve is not reported either: the motion
of the load then consists of their errors, which are also in the force of the path.
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
from bayesfric.rigs.single_axis.rows import state_of

MOST = 40_000
"""Samples of the paths along which lengths are tried: lengths differ by a fifth, and more samples
only cost time."""


def with_lengths(
    readings: Readings, table: pd.DataFrame, measures: Measures, constants: RigConstants
) -> Measures:
    """Return measures with the strongest length of each way to hold a load, and its neighbours.

    Of a spring it is looked for at a middling damping, and then for the strongest of these.

    Parameters
    ----------
    readings : Readings
        Rows of all runs.
    table : DataFrame
        Trials.
    measures : Measures
        Of the recording, without lengths.
    constants : RigConstants
        The machine.
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
        takes, best = rows.strongest(effect, tried, measures)
        longest = best == tried[-1]
        if held == "spring":
            middling = np.array([measures.damping])
            own = rows.own_shares(effect, OWN, best * NEAR, middling)
            if own.takes > AXIS_RULES.own_length * takes:
                best, measures = own.length, replace(measures, mass_over_friction=own.heavy)
                longest = False
        if longest or best < AXIS_RULES.least_length * readings.position_sd:
            untold.add(held)
        lengths[held] = best * np.exp(SPREAD * SHAPE_NODES)
    measures = replace(measures, lengths=lengths, untold=frozenset(untold))
    spring = by_held["spring"]
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
    """Return rows along some of the paths, which have about :data:`MOST` samples in all."""
    motions, there = readings.load_motions.thinned(MOST)
    rows = np.flatnonzero(np.isin(readings.place, there))
    place = np.searchsorted(there, readings.place[rows])
    return replace(readings.at(rows), place=place, load_motions=motions)


class _OwnShares(NamedTuple):
    """A load on a spring, and what it takes off the squares."""

    takes: float
    heavy: float
    length: float
    damping: float


class _Rows(NamedTuple):
    """Rows without what the law and a line along the path explain of them.

    Parameters
    ----------
    readings, table, measures, constants
        As of :func:`with_lengths`.
    inside : ndarray of bool, shape (W,)
        Rows that tell it.
    basis : ndarray, shape (N, k)
        An orthonormal basis of the columns of the law, at these.
    left : ndarray, shape (N,)
        What they leave of the force.
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
        way, place = readings.way, readings.position @ readings.weights
        law = np.stack(
            [
                readings.acceleration,
                np.ones(readings.count),
                readings.speed @ readings.weights,
                readings.force_rate,
                *(way * (place / measures.stroke) ** power for power in range(2)),
                *readings.beside.T,
            ],
            axis=1,
        )[inside]
        basis = np.linalg.qr(law / np.maximum(np.abs(law).max(axis=0), 1e-300))[0]
        left = readings.force[inside] - basis @ (basis.T @ readings.force[inside])
        return cls(readings, table, measures, constants, inside, basis, left)

    def strongest(self, effect: Effect, lengths: Array, measures: Measures) -> tuple[float, float]:
        """Return what the best law of all lengths takes off the squares, and at which."""
        law = AxisLaw(self.measures.mass, self.measures.friction)
        nobody = np.zeros(len(self.table), dtype=np.bool_)
        state = state_of(self.readings, law, self.table, nobody, measures, self.constants)

        def takes(length: float) -> float:
            columns = [
                _column(effect, name, length, state, self.readings)[self.inside]
                for name in effect.laws
            ]
            return float(self.taken(np.stack(columns, axis=1), effect).max())

        return max((takes(float(length)), float(length)) for length in lengths)

    def taken(self, columns: Array, effect: Effect) -> Array:
        """Return what columns of amplitude 1 take off the squares, by the prior's width."""
        free = columns - self.basis @ (self.basis.T @ columns)
        noise = self.left @ self.left / self.left.size
        noise = noise / prior_moments(effect.amplitude.prior)[1] ** 2
        size = np.sum(free**2, axis=0) + noise
        return np.asarray(np.maximum(self.left @ free, 0.0) ** 2 / np.where(size > 0, size, np.inf))

    def own_shares(
        self, spring: Effect, shares: Array, lengths: Array, dampings: Array
    ) -> _OwnShares:
        """Return the best load on a spring whose mass and friction are not tied."""
        heavy, near, damped = (values.ravel() for values in np.meshgrid(shares, lengths, dampings))
        mass = self.measures.mass + self.readings.known_inertia
        friction = self.measures.friction
        moved = self.readings.load_motions.side_by_side(
            "spring", friction / mass, heavy, near / heavy, damped
        )
        late, lost = moved[:, self.readings.place[self.inside]]
        takes = self.taken(heavy * mass * late + friction * lost, spring)
        best = int(np.argmax(takes))
        return _OwnShares(*(float(values[best]) for values in (takes, heavy, near, damped)))


def _column(effect: Effect, law: str, length: float, state: State, readings: Readings) -> Array:
    """Return what a law of amplitude 1 adds to each row, (W,)."""
    assert effect.shape is not None
    values = {effect.amplitude.name: 1.0, effect.shape.name: length}
    inside = np.broadcast_to(effect.laws[law](values, state), readings.speed.shape)
    return np.asarray(inside @ readings.weights)
