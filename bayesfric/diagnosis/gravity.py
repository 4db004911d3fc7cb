"""Whether a motion separates a joint's inertia from unknown gravity."""

from collections.abc import Collection
from typing import Any

import numpy as np

from bayesfric.arrays import Array
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.widening import INERTIA, Factors
from bayesfric.diagnosis_rules import RULES

NOT_APART = (
    "These data do not separate inertia from gravity: the acceleration depends on the position, as "
    "the pull of gravity does, and unknown gravity makes the error of the inertia "
    "{factor:.2g} times larger. Move over a longer stroke and at several speeds, or give the "
    "machine's model or the known force"
)


def gravity_hides_inertia(model: LinearModel, turns: bool) -> float | None:
    """Return the factor by which unknown gravity increases the error of the inertia.

    Over a short stroke, or in a motion of one frequency, the acceleration is proportional to
    the position, and so is the torque of gravity.

    Parameters
    ----------
    model : LinearModel
        The model in which the hypotheses were compared.
    turns : bool
        Whether the machine turns.

    Returns
    -------
    float or None
        None if the motion separates the two, or if gravity is known or does not act.
    """
    rows: Any = model.rigs[0].rows
    if not turns or not model.data.rigs[0].along_path:
        return None
    if not rows.state.gravity_m_s2:
        return None
    readings = rows.readings
    knows = readings.known_held.any() or readings.known_moved.any() or readings.beside.shape[1]
    if knows or readings.simulated.shape[1] or not model.free[0, 0]:
        return None
    place = np.asarray(readings.position @ readings.weights)
    columns = np.asarray(rows.coefficient_columns())
    pull = [readings.way * np.sin(place), readings.way * np.cos(place)]
    alone = np.column_stack([columns[:, 1:], readings.way])
    left, beside = (
        _beyond(columns[:, 0], others) for others in (alone, np.column_stack([alone, *pull]))
    )
    factor = left / max(beside, 1e-12 * left) if left > 0 else 1.0
    return factor if factor > RULES.inertia_apart else None


def _beyond(column: Array, others: Array) -> float:
    size = np.linalg.norm(others, axis=0)
    scaled = others / np.where(size > 0, size, 1.0)
    return float(np.linalg.norm(column - scaled @ np.linalg.lstsq(scaled, column, rcond=None)[0]))


def by_gravity(factor: float | None, named: Collection[str]) -> Factors:
    """Return the factor by which neglected gravity widens the interval of a joint's inertia.

    Parameters
    ----------
    factor : float or None
        From :func:`gravity_hides_inertia`.
    named : collection of str
        The causes. If gravity is one of them, the errors with the causes include it already, and
        the law without the causes is reported as biased.
    """
    return {} if factor is None or "gravity-torque" in named else {INERTIA: (factor, factor)}
