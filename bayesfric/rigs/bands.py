"""Quantiles over draws, in which predictions are stored."""

import numpy as np

from bayesfric.arrays import Array
from bayesfric.schemas.base import QUANTILES


def bands(values: Array) -> Array:
    """Return the :data:`QUANTILES` over the first axis (draws), along a new last axis."""
    return np.moveaxis(np.quantile(values, QUANTILES, axis=0), 0, -1)
