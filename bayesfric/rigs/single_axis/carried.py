"""What the gear of an axis carries: told by the motion and the place, never by the force itself.

The drive force of a row has that row's own friction and error in it. As a regressor it would
explain all of the row by itself, as a limit of the drive would (:mod:`.limit`). So the load is what
a fit of all rows says: mass times acceleration, and a pull that is a smooth function of the place.
What is known of the force by a model of the machine is carried too, and so is what other joints
pull with, in amounts that the same rows tell roughly.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import pandas as pd
import scipy

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.beside import rough_shares
from bayesfric.rigs.single_axis.readings import Readings
from bayesfric.rigs.single_axis.rough import POWERS, places_of, pull_basis
from bayesfric.rigs.single_axis.weak_form import node_weights

ROUNDS = 3  # of taking off what friction by the load may be
BINS = 12  # of the path, in which it is looked whether the axis runs both ways


class Pull(NamedTuple):
    """What one load is.

    Parameters
    ----------
    mass : float
        That moves [kg, or kg·m²].
    pull : ndarray, shape (m,)
        Of the functions of :func:`.rough.pull_basis`.
    middle, half : float
        Of the positions, which make a place of one.
    """

    mass: float
    pull: Array
    middle: float
    half: float


@dataclass(frozen=True)
class Carried:
    """What the gear carries, of each load that was told apart.

    Parameters
    ----------
    columns : tuple of str
        Of the table of runs, that say which load a run moves.
    loads : mapping of tuple to Pull
        By the values of these columns.
    others : ndarray, shape (K,)
        Rough amounts of the forces beside the law.
    """

    columns: tuple[str, ...]
    loads: Mapping[tuple[float, ...], Pull]
    others: Array

    def beside_more(self, names: Sequence[str]) -> "Carried":
        """Return the same where more stands beside the rows that the loads' pulls hold already."""
        return replace(self, others=np.append(self.others, np.zeros(len(names))))

    def at(self, readings: Readings, table: pd.DataFrame) -> tuple[Array, Array]:
        """Return what is held, and what the mass takes, positive along the position, (W, P) twice.

        Parameters
        ----------
        readings : Readings
            W rows.
        table : DataFrame
            Their trials.
        """
        beside = readings.way * (readings.beside @ self.others)
        held, moved = readings.known_held + beside[:, None], readings.known_moved.copy()
        keys, accelerations = _keys(table, self.columns), _accelerations(readings)
        for key, load in self.loads.items():
            mine = np.array([other == key for other in keys], dtype=np.bool_)[readings.trial]
            at = readings.position[mine]
            pull = pull_basis(at.ravel(), load.middle, load.half) @ load.pull
            held[mine] += pull.reshape(at.shape)
            moved[mine] += load.mass * accelerations[mine]
        return held, moved


def carried_by(
    readings: Readings, inside: Flags, table: pd.DataFrame, columns: Sequence[str]
) -> Carried:
    """Return what the gear carries, by a fit of the rows of each load.

    Parameters
    ----------
    readings : Readings
        W rows.
    inside : ndarray of bool, shape (W,)
        Rows that are fitted.
    table : DataFrame
        Their trials.
    columns : sequence of str
        By which runs may move other loads; where one has few rows, all are taken to be the same.
    """
    keys = _keys(table, columns)
    rows_of = {
        key: np.flatnonzero(inside & np.array([other == key for other in keys])[readings.trial])
        for key in dict.fromkeys(keys)
    }
    if min(rows.size for rows in rows_of.values()) < AXIS_RULES.rows_a_load_number * (POWERS + 3):
        columns, rows_of = (), {(): np.flatnonzero(inside)}
    places = readings.position @ readings.weights
    law = _law(readings, places)
    rubbing = np.zeros((readings.count, 0))
    for _ in range(ROUNDS):
        others = rough_shares(np.hstack([law, rubbing]), readings.beside, readings.force, inside)
        loads = {key: _fitted(readings, places, rows, others) for key, rows in rows_of.items()}
        carried_force = Carried(tuple(columns), loads, others)
        if not others.size:
            break
        carried = np.add(*carried_force.at(readings, table)) @ readings.weights
        rubbing = np.abs(carried)[:, None]  # friction by the load bends what others seem to pull
    return carried_force


def _law(readings: Readings, places: Array) -> Array:
    """Return columns of the law, and of what pulls by place, in the sense of the motion, (W, n)."""
    pull = pull_basis(places, *places_of(places)) * readings.way[:, None]
    speed = readings.speed @ readings.weights
    return np.column_stack([readings.acceleration, np.ones(readings.count), speed, pull])


def _accelerations(readings: Readings) -> Array:
    """Return accelerations along the position at places inside every row, (W, P).

    Where a row's mean passes through zero those at its places do so one after another: what goes
    with their size has no corner. Their slope is that between neighbouring rows.
    """
    own = readings.acceleration * readings.way
    near = (np.diff(readings.piece) == 0) & (np.diff(readings.time_s) > 0)
    step = np.where(near, np.diff(readings.time_s), 1.0)
    slope = np.where(near, np.diff(own) / step, 0.0)
    total = np.concatenate([slope, [0.0]]) + np.concatenate([[0.0], slope])
    count = np.concatenate([near, [False]]).astype(float) + np.concatenate([[False], near])
    offset = node_weights()[0] * readings.half_s
    return np.asarray(own[:, None] + (total / np.maximum(count, 1.0))[:, None] * offset)


def _keys(table: pd.DataFrame, columns: Sequence[str]) -> list[tuple[float, ...]]:
    """Return what load each trial moves."""
    return [tuple(map(float, row)) for row in table[list(columns)].to_numpy(dtype=np.float64)]


def _fitted(readings: Readings, places: Array, rows: Whole, others: Array) -> Pull:
    """Return the load that some rows move, beyond what is known and what others pull with."""
    middle, half = places_of(places[rows])
    way, beside = readings.way[rows], readings.beside[rows] @ others
    force = readings.force[rows] - beside
    model_force = (
        way * ((readings.known_held + readings.known_moved) @ readings.weights)[rows] + beside
    )
    speed = (readings.speed @ readings.weights)[rows]
    law = np.stack([readings.acceleration[rows], np.ones(rows.size), speed], axis=1)
    pull = pull_basis(places[rows], middle, half) * way[:, None]
    count = pull.shape[1]
    if (way > 0).all() or (way < 0).all():
        pull[:, 0] = 0.0  # what is constant then is Coulomb friction
    both, left = _squares(law, force)
    pulled, less = _squares(np.column_stack([law, pull]), force)
    if left - less >= AXIS_RULES.pulled * float(force @ force):
        both = pulled
    elif model_force.any():
        pull = pull[:, :0]
    else:
        return Pull(max(float(both[0]), 0.0), np.zeros(count), middle, half)
    for _ in range(ROUNDS):  # friction by the load bends what the place seems to pull
        carried = model_force + both[0] * law[:, 0] + pull @ both[3 : 3 + pull.shape[1]]
        both, _ = _squares(np.column_stack([law, pull, np.abs(carried)]), force)
    own = np.zeros(count)
    own[: pull.shape[1]] = both[3 : 3 + pull.shape[1]]
    return Pull(max(float(both[0]), 0.0), own, middle, half)


def _squares(columns: Array, force: Array) -> tuple[Array, float]:
    width = np.abs(columns).max(axis=0, initial=0.0)
    width[width == 0] = 1.0
    coefficients = np.linalg.lstsq(columns / width, force, rcond=1e-8)[0] / width
    return coefficients, float(np.sum((force - columns @ coefficients) ** 2))


def shows_both_ways(readings: Readings, loads: int) -> bool:
    """Return whether rows lift and lower at one pose, or move several loads.

    Parameters
    ----------
    readings : Readings
        W rows.
    loads : int
        How many there are.
    """
    places = readings.position @ readings.weights
    span = float(np.ptp(places)) or 1.0
    cell = np.minimum((BINS * (places - places.min()) / span).astype(np.intp), BINS - 1)
    counts = np.stack([np.bincount(cell[readings.way == way], minlength=BINS) for way in (-1, 1)])
    both = (counts > 0).all(axis=0)
    return loads > 1 or bool(counts[:, both].sum() > AXIS_RULES.both_ways * readings.count)


def warmth_of(readings: Readings, order: Array) -> Array | None:
    """Return how warm the axis is at each row, −0.5 to 0.5 in all; None where nobody can say.

    It is the temperature that was logged. Without one it is the work that was done against
    friction up to then, where that does not go with the order of the runs.

    Parameters
    ----------
    readings : Readings
        W rows.
    order : ndarray, shape (W,)
        Place of each row's trial in the order of the recording, 0 to 1.
    """
    warm = readings.temperature
    if not np.isfinite(warm).all() or np.ptp(warm) == 0:
        sequence = np.lexsort((readings.time_s, order))
        step = (readings.speed @ readings.weights)[sequence]
        warm = np.empty(readings.count)
        warm[sequence] = np.cumsum(step)
        if np.ptp(order) == 0 or np.ptp(warm) == 0:
            return None
        if abs(float(scipy.stats.spearmanr(warm, order)[0])) > AXIS_RULES.order_alike:
            return None
    spread = float(np.ptp(warm))
    return np.asarray((warm - warm.mean()) / spread) if spread > 0 else None
