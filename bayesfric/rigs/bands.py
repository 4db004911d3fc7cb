"""Quantiles over draws, in which predictions are stored."""

import numpy as np

from bayesfric.arrays import Array

QUANTILES = (0.05, 0.5, 0.95)


def bands(values: Array) -> Array:
    """Return the :data:`QUANTILES` over the first axis (draws), along a new last axis."""
    return np.moveaxis(np.quantile(values, QUANTILES, axis=0), 0, -1)
