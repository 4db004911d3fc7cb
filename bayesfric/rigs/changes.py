"""The relative change of a rig's friction by an effect: the measure of its strength."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.physics.friction import Coefficients
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.acting import surroundings
from bayesfric.rigs.truth import AppliedEffect

Change = Callable[[AppliedEffect], Array]
"""An applied effect to its change relative to friction, shape (rows, times); of an effect
with components one after another on a first axis."""


def law_column(law: Coefficients) -> Coefficients:
    """Return the law of each row as columns, to broadcast over times."""
    return Coefficients(*(np.asarray(part)[:, None] for part in law))


def around_rows(table: pd.DataFrame, constants: RigConstants) -> dict[str, Any]:
    """Return what surrounds rows as columns, fields of State, to broadcast over times."""
    around = surroundings(table, constants)
    return {name: np.reshape(value, (-1, 1)) for name, value in around.items()}


def at_times(change: Array, shape: tuple[int, int]) -> Array:
    """Return a change at every time, also where it does not depend on time."""
    return np.broadcast_to(change, (*np.shape(change)[:-2], *shape))
