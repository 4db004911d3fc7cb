"""How much play, or how long a wind-up, a load behind the drive may have: looked for in the rows.

A load that coasts through play, or rings on a spring, does so in another rhythm at each length:
between two lengths that a prior's quantiles would try nothing can be interpolated.
"""

from dataclasses import replace

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.effects import Effect, State, all_effects
from bayesfric.effects.candidates import SHAPE_NODES, prior_moments
from bayesfric.physics.axis import AxisLaw
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.single_axis.following import DAMPINGS, LENGTHS, NEAR, OWN, REFINED
from bayesfric.rigs.single_axis.measures import SPREAD, Measures
from bayesfric.rigs.single_axis.readings import Readings
from bayesfric.rigs.single_axis.rows import state_of

__all__ = ["with_lengths"]


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
    law = AxisLaw(measures.mass, measures.friction)
    nobody = np.zeros(len(table), dtype=np.bool_)
    inside = measures.limit.within(readings)
    way, place = readings.way, readings.position @ readings.weights
    speed = readings.speed @ readings.weights
    known = np.stack(
        [
            readings.acceleration,
            np.ones(readings.count),
            speed,
            readings.force_rate,
            *(way * (place / measures.stroke) ** power for power in range(2)),
            *readings.beside.T,
        ],
        axis=1,
    )[inside]
    basis = np.linalg.qr(known / np.maximum(np.abs(known).max(axis=0), 1e-300))[0]
    left = readings.force[inside] - basis @ (basis.T @ readings.force[inside])

    def strongest(effect: Effect, lengths: Array, measures: Measures) -> tuple[float, float]:
        """Return what the best law of all lengths takes off the squares, and at which."""
        state = state_of(readings, law, table, nobody, measures, constants)
        return max((told(effect, float(one), state), float(one)) for one in lengths)

    def told(effect: Effect, length: float, state: State) -> float:
        """Return what the best law of a length takes off the squares, by the prior's width."""
        columns = [_column(effect, law, length, state, readings)[inside] for law in effect.laws]
        return float(gain(np.stack(columns, axis=1), effect).max())

    def gain(columns: Array, effect: Effect) -> Array:
        """Return what columns of amplitude 1 take off the squares, by the prior's width."""
        free = columns - basis @ (basis.T @ columns)
        noise = left @ left / left.size / prior_moments(effect.amplitude.prior)[1] ** 2
        size = np.sum(free**2, axis=0) + noise
        return np.asarray(np.maximum(left @ free, 0.0) ** 2 / np.where(size > 0, size, np.inf))

    def own_shares(
        spring: Effect, shares: Array, lengths: Array, dampings: Array
    ) -> tuple[float, float, float, float]:
        """Return what the best load of own shares takes off the squares, and that load."""
        grid = np.meshgrid(shares, lengths, dampings)
        heavy, near, damped = (one.ravel() for one in grid)
        slows = measures.friction / measures.mass
        moved = readings.followed.side_by_side("spring", slows, heavy, near / heavy, damped)
        late, lost = moved[:, readings.place[inside]]
        columns = heavy * measures.mass * late + measures.friction * lost
        told_by = gain(columns, spring)
        best = int(np.argmax(told_by))
        return float(told_by[best]), float(heavy[best]), float(near[best]), float(damped[best])

    known_to = [one for one in all_effects(None).values() if one.needs & LENGTHS.keys()]
    found = {}
    for effect in known_to:
        (held,) = effect.needs & LENGTHS.keys()
        takes, best = strongest(effect, measures.stroke * LENGTHS[held], measures)
        if held == "spring":
            middling = np.array([measures.damping])
            more, heavy, length, _ = own_shares(effect, OWN, best * NEAR, middling)
            if more > takes:
                best, measures = length, replace(measures, mass_over_friction=heavy)
        found[held] = best * np.exp(SPREAD * SHAPE_NODES)
    measures = replace(measures, lengths=found)
    (spring,) = (one for one in known_to if "spring" in one.needs)
    each = [replace(measures, damping=one) for one in DAMPINGS]
    damped = max(each, key=lambda one: strongest(spring, found["spring"], one)[0])
    if damped.mass_over_friction == Measures.mass_over_friction:
        return damped
    middle = float(found["spring"][len(SHAPE_NODES) // 2])
    shares = damped.mass_over_friction * REFINED["shares"]
    dampings = damped.damping * REFINED["damping"]
    finer = own_shares(spring, shares, middle * REFINED["length"], dampings)
    _, heavy, length, damping = finer
    found["spring"] = found["spring"] * length / middle
    return replace(damped, mass_over_friction=heavy, lengths=found, damping=damping)


def _column(effect: Effect, law: str, length: float, state: State, readings: Readings) -> Array:
    """Return what a law of amplitude 1 adds to each row, (W,)."""
    assert effect.shape is not None
    values = {effect.amplitude.name: 1.0, effect.shape.name: length}
    found = np.broadcast_to(effect.laws[law](values, state), readings.speed.shape)
    return np.asarray(found @ readings.weights)
