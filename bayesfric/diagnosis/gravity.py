"""Inertia of a joint whose gravity nobody knows: whether a motion tells the one from the other."""

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
    """Return by which factor gravity that nobody knows makes the error of the inertia larger.

    Over a short stroke, or in a motion of one frequency, the acceleration goes with the place,
    and so does the pull of gravity.

    Parameters
    ----------
    model : LinearModel
        In which the hypotheses were compared.
    turns : bool
        Whether the machine turns.

    Returns
    -------
    float or None
        None where the two are told apart, or where gravity is known or does not act.
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
    """Return how many times wider gravity that is left out makes the inertia of a joint.

    Parameters
    ----------
    factor : float or None
        Of :func:`gravity_hides_inertia`.
    named : collection of str
        The causes: with gravity among them the errors after have its part already, and the law
        alone is told to be biased.
    """
    return {} if factor is None or "gravity-torque" in named else {INERTIA: (factor, factor)}
