"""The change of a rig's friction by an effect, relative to friction, as its strength."""

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
"""Function of an applied effect that returns its change relative to friction, shape (rows,
times). For an effect with components, these are stacked along an additional first axis."""


def law_column(law: Coefficients) -> Coefficients:
    """Return the coefficients of each row with shape (rows, 1), to broadcast over times."""
    return Coefficients(*(np.asarray(part)[:, None] for part in law))


def around_rows(table: pd.DataFrame, constants: RigConstants) -> dict[str, Any]:
    """Return fields of State that do not depend on the motion, shape (rows, 1) or (1, 1)."""
    around = surroundings(table, constants)
    return {name: np.reshape(value, (-1, 1)) for name, value in around.items()}


def at_times(change: Array, shape: tuple[int, int]) -> Array:
    """Return a change, broadcast to (rows, times) even if it does not depend on time."""
    return np.broadcast_to(change, (*np.shape(change)[:-2], *shape))
