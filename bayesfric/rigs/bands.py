"""Bands: the quantiles over draws that every prediction is stored as."""

import numpy as np

from bayesfric.arrays import Array

QUANTILES = (0.05, 0.5, 0.95)


def bands(values: Array) -> Array:
    """Return quantiles over the first axis (draws), quantile last."""
    return np.moveaxis(np.quantile(values, QUANTILES, axis=0), 0, -1)
