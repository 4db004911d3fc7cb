"""A grid over the probable values of a shape, refined until it resolves them."""

from collections.abc import Callable

import numpy as np

from bayesfric.arrays import Array
from bayesfric.diagnosis.shapes import WIDEST

REFINEMENTS = 4  # of a grid of shapes


def refined_grid(log_evidences: Callable[[Array], Array], best: float) -> tuple[Array, Array]:
    """Return a grid over the probable values of a shape, and their probabilities.

    Parameters
    ----------
    log_evidences : callable
        Shapes as normal quantiles, (G,), to log evidences of one or of several cases, (G, S).
    best : float
        Centre of the first grid.

    Returns
    -------
    grid : ndarray, shape (G,)
        Normal quantiles.
    weights : ndarray, shape (G, S)
        Probabilities in each case, with a standard normal prior.
    """
    centre, width = best, 2.0
    for _ in range(REFINEMENTS):
        grid = np.clip(centre + width * np.linspace(-1, 1, 41), -WIDEST, WIDEST)
        logs = log_evidences(grid) - 0.5 * grid[:, None] ** 2
        weights = np.exp(logs - logs.max(axis=0))
        weights /= weights.sum(axis=0)
        of_all = weights.mean(axis=1)
        mean = float(of_all @ grid)
        sd = float(np.sqrt(of_all @ (grid - mean) ** 2))
        if sd > width / 12:
            break
        centre, width = float(grid[np.argmax(of_all)]), max(6 * sd, width / 15)
    return grid, weights
