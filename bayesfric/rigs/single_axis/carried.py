"""The load of an axis' gear, estimated from motion and position instead of the drive force.

The drive force of a window contains its own friction and error. As a regressor it would explain the
window by itself, as a limit of the drive would (:mod:`.limit`). So the load is fitted to all
windows: a mass times the acceleration, and a force that is a smooth function of position. The known
force of a model of the machine belongs to the load too, and so do forces of other joints, whose
amounts the same windows determine roughly.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd
import scipy

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.beside import rough_shares
from bayesfric.rigs.single_axis.readings import Readings
from bayesfric.rigs.single_axis.rough import POWERS, least_squares, places_of, pull_basis
from bayesfric.rigs.single_axis.weak_form import node_weights

ROUNDS = 3  # fits, each with friction by the load of the previous fit
PRECISE = 1e-8  # relative singular value that counts as 0
BINS = 12  # sections of the path in which both directions of motion are counted


class Pull(NamedTuple):
    """One load: its inertia, and its force as a function of position.

    Parameters
    ----------
    mass : float
        The mass that moves [kg, or kg·m²].
    pull : ndarray, shape (m,)
        Coefficients of the functions of :func:`.rough.pull_basis` [N or N·m].
    middle, half : float
        Middle and half range of the positions, by which they are standardised [m or rad].
    """

    mass: float
    pull: Array
    middle: float
    half: float

    def at(self, position: Array) -> Array:
        """Return the force at some positions, shape (N,) [N or N·m]."""
        return np.asarray(pull_basis(position, self.middle, self.half) @ self.pull)


@dataclass(frozen=True)
class Carried:
    """The loads of a recording's gear.

    Parameters
    ----------
    columns : tuple of str
        Columns of the table of runs that determine the load of a run.
    loads : mapping of tuple to Pull
        The loads, by the values of these columns.
    others : ndarray, shape (K,)
        Rough amounts of the forces beside the law.
    """

    columns: tuple[str, ...]
    loads: Mapping[tuple[float, ...], Pull]
    others: Array

    def at(self, readings: Readings, table: pd.DataFrame) -> tuple[Array, Array]:
        """Return the static and the inertial part of the load at places inside each window.

        Parameters
        ----------
        readings : Readings
            W windows.
        table : DataFrame
            The table of their trials.

        Returns
        -------
        held, moved : ndarray, shape (W, P)
            Positive along the position [N or N·m].
        """
        beside = readings.way * (readings.beside @ self.others)
        held, moved = readings.known_held + beside[:, None], readings.known_moved.copy()
        keys, accelerations = _keys(table, self.columns), _accelerations(readings)
        for key, load in self.loads.items():
            mine = np.array([other == key for other in keys], dtype=np.bool_)[readings.trial]
            at = readings.position[mine]
            held[mine] += load.at(at.ravel()).reshape(at.shape)
            moved[mine] += load.mass * accelerations[mine]
        return held, moved


def carried_by(
    readings: Readings, inside: Flags, table: pd.DataFrame, columns: Sequence[str]
) -> Carried:
    """Return the loads of the gear, each fitted to its own windows.

    Parameters
    ----------
    readings : Readings
        W windows.
    inside : ndarray of bool, shape (W,)
        Windows that are fitted.
    table : DataFrame
        The table of their trials.
    columns : sequence of str
        Columns of the runs with which the load may differ. If any load has few windows, all runs
        are assumed to have the same load.
    """
    keys = _keys(table, columns)
    rows_of = {
        key: np.flatnonzero(inside & np.array([other == key for other in keys])[readings.trial])
        for key in dict.fromkeys(keys)
    }
    if min(rows.size for rows in rows_of.values()) < AXIS_RULES.rows_a_load_number * (POWERS + 3):
        columns, rows_of = (), {(): np.flatnonzero(inside)}
    places = readings.mean_position
    pull = pull_basis(places, *places_of(places)) * readings.way[:, None]
    law = np.column_stack([readings.law_columns, pull])
    rubbing = np.zeros((readings.count, 0))
    for _ in range(ROUNDS):
        others = rough_shares(np.hstack([law, rubbing]), readings.beside, readings.force, inside)
        loads = {key: _fitted(readings, places, rows, others) for key, rows in rows_of.items()}
        carried_force = Carried(tuple(columns), loads, others)
        if not others.size:
            break
        carried = np.add(*carried_force.at(readings, table)) @ readings.weights
        rubbing = np.abs(carried)[:, None]  # without friction by the load, `others` are biased
    return carried_force


def _accelerations(readings: Readings) -> Array:
    """Return accelerations along the position at places inside each window, (W, P).

    Within a window, acceleration changes linearly, with the slope between neighbouring windows. A
    force that depends on its magnitude is therefore smooth where the window's mean passes zero.
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
    """Return the key of each trial's load: the values of some columns."""
    return [tuple(map(float, row)) for row in table[list(columns)].to_numpy(dtype=np.float64)]


def _fitted(readings: Readings, places: Array, rows: Whole, others: Array) -> Pull:
    """Return the load that some windows determine, beyond known forces and those of others."""
    middle, half = places_of(places[rows])
    way, beside = readings.way[rows], readings.beside[rows] @ others
    force = readings.force[rows] - beside
    model_force = (
        way * ((readings.known_held + readings.known_moved) @ readings.weights)[rows] + beside
    )
    law = readings.law_columns[rows]
    pull = pull_basis(places[rows], middle, half) * way[:, None]
    count = pull.shape[1]
    if (way > 0).all() or (way < 0).all():
        pull[:, 0] = 0.0  # a constant force cannot be separated from Coulomb friction then
    coefficients, squares = least_squares(law, force, rcond=PRECISE)
    with_pull, squares_with_pull = least_squares(np.column_stack([law, pull]), force, rcond=PRECISE)
    if squares - squares_with_pull >= AXIS_RULES.pulled * float(force @ force):
        coefficients = with_pull
    elif model_force.any():
        pull = pull[:, :0]
    else:
        return Pull(max(float(coefficients[0]), 0.0), np.zeros(count), middle, half)
    for _ in range(ROUNDS):  # without friction by the load, the force of the position is biased
        carried = (
            model_force + coefficients[0] * law[:, 0] + pull @ coefficients[3 : 3 + pull.shape[1]]
        )
        columns = np.column_stack([law, pull, np.abs(carried)])
        coefficients, _ = least_squares(columns, force, rcond=PRECISE)
    amounts = np.zeros(count)
    amounts[: pull.shape[1]] = coefficients[3 : 3 + pull.shape[1]]
    return Pull(max(float(coefficients[0]), 0.0), amounts, middle, half)


def shows_both_ways(readings: Readings, loads: int) -> bool:
    """Return whether windows lift and lower at the same poses, or move several loads.

    Parameters
    ----------
    readings : Readings
        W windows.
    loads : int
        Number of different loads.
    """
    places = readings.mean_position
    span = float(np.ptp(places)) or 1.0
    cell = np.minimum((BINS * (places - places.min()) / span).astype(np.intp), BINS - 1)
    counts = np.stack([np.bincount(cell[readings.way == way], minlength=BINS) for way in (-1, 1)])
    both = (counts > 0).all(axis=0)
    return loads > 1 or bool(counts[:, both].sum() > AXIS_RULES.both_ways * readings.count)


def warmth_of(readings: Readings, order: Array) -> Array | None:
    """Return the relative warmth of the axis in each window, (W,); None if it is unknown.

    Warmth is the logged temperature. If no temperature varies, it is the sum of the windows' speeds
    so far, a measure of the work against friction. If this sum correlates with the order of the
    runs, warmth is unknown. It has a mean of 0 and a range of 1.

    Parameters
    ----------
    readings : Readings
        W windows.
    order : ndarray, shape (W,)
        Rank of each window's trial in the order of the recording, 0 to 1.
    """
    warm = readings.temperature
    if not np.isfinite(warm).all() or np.ptp(warm) == 0:
        sequence = np.lexsort((readings.time_s, order))
        step = readings.mean_speed[sequence]
        warm = np.empty(readings.count)
        warm[sequence] = np.cumsum(step)
        if np.ptp(order) == 0 or np.ptp(warm) == 0:
            return None
        if abs(float(scipy.stats.spearmanr(warm, order)[0])) > AXIS_RULES.order_alike:
            return None
    spread = float(np.ptp(warm))
    return np.asarray((warm - warm.mean()) / spread) if spread > 0 else None
