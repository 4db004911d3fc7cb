"""A response that decays geometrically, without the import of scipy.signal.

That import takes as long as a tenth of a joint's diagnosis.
"""

import numpy as np
import scipy

from bayesfric.arrays import Array


def decaying(driven: Array, kept: float, before: float = 0.0) -> Array:
    """Return y with y_k = driven_k + kept y_(k−1), shape (N,).

    Parameters
    ----------
    driven : ndarray, shape (N,)
        What is added at each sample.
    kept : float
        Factor of the decay per sample, at least 0 and less than 1.
    before : float
        y before the first sample.
    """
    right = driven.astype(np.float64)
    right[:1] += kept * before
    bands = np.stack([np.ones(right.size), np.full(right.size, -kept)])
    return np.asarray(scipy.linalg.solve_banded((1, 0), bands, right, check_finite=False))
