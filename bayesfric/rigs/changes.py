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
"""Function that returns the change of friction by an applied effect, relative to friction, shape
(rows, times). For an effect with components, its result has a further first axis for these."""


def law_column(law: Coefficients) -> Coefficients:
    """Return each row's law as columns, which broadcast over times."""
    return Coefficients(*(np.asarray(part)[:, None] for part in law))


def around_rows(table: pd.DataFrame, constants: RigConstants) -> dict[str, Any]:
    """Return the fields of State of each row as columns, which broadcast over times."""
    around = surroundings(table, constants)
    return {name: np.reshape(value, (-1, 1)) for name, value in around.items()}


def at_times(change: Array, shape: tuple[int, int]) -> Array:
    """Broadcast a change to all times."""
    return np.broadcast_to(change, (*np.shape(change)[:-2], *shape))
