"""Searches for the period, along the path, of a periodic force such as cogging."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.readings import Readings
from bayesfric.rigs.single_axis.rough import without_columns

LEAST, MOST = 2.0, 100.0  # range of the search [waves over the path]
BESIDE_JOINTS = 5.0
"""The least number of waves if other joints are logged without a model of their forces. A slower
variation may be a force of these joints, and motor poles and gear teeth have shorter periods."""
APART = 0.25  # step of the search [waves over the path]
PHASES = 6  # phases of a wave that count as different
SEARCHED = round(2 * (MOST - LEAST)) * PHASES
"""Number of waves that data can distinguish: their numbers over the path differ by a half."""
FINER = np.linspace(-1.0, 1.0, 21)  # steps of the finer search around the best wave [APART]


class Wave(NamedTuple):
    """A sine of the position.

    Parameters
    ----------
    period : float
        Period [m or rad].
    start : float
        Position near the middle of the path at which the sine rises through zero [m or rad].
    spread : float
        Relative error of the period, 0.25 over the number of waves along the path.
    """

    period: float
    start: float
    spread: float


def strongest_wave(readings: Readings, least: float = LEAST) -> Wave:
    """Return the wave that reduces the squared residuals of the law most.

    The law and a smooth function of position are fitted together with the wave by least squares.

    Parameters
    ----------
    readings : Readings
        Windows. The wave is averaged over each window with the weights of its force.
    least : float
        Least number of waves over the path.
    """
    low, span = float(readings.position.min()), float(np.ptp(readings.position)) or 1.0
    middle = low + 0.5 * span
    place = (readings.position - middle) / span
    powers = [readings.way * (place**power @ readings.weights) for power in range(4)]
    basis, residual = without_columns(
        np.column_stack([readings.law_columns, readings.force_rate, *powers, readings.beside]),
        readings.force,
    )

    def numbers(turned: NDArray[np.complex128]) -> tuple[float, Array]:
        """Return by how much a wave reduces the squares, and amplitudes of its cosine and sine.

        `turned` is exp(i angle) of the wave at places inside each window.
        """
        mean = turned @ readings.weights * readings.way
        pair = np.stack([mean.real, mean.imag])
        pair = pair.T - basis @ (basis.T @ pair.T)
        pair_numbers = np.linalg.lstsq(pair, residual, rcond=1e-6)[0]
        return float(residual @ pair @ pair_numbers), np.asarray(pair_numbers, dtype=np.float64)

    turn = 2j * np.pi * place
    tried = np.arange(least, MOST, APART)
    turned, further, taken = np.exp(least * turn), np.exp(APART * turn), []
    for _ in tried:  # a product is much faster than a cosine and a sine
        taken.append(numbers(turned)[0])
        turned *= further
    best = tried[np.argmax(taken)]
    tried = np.maximum(best + APART * FINER, least)
    best = float(tried[np.argmax([numbers(np.exp(waves * turn))[0] for waves in tried])])
    cosine, sine = numbers(np.exp(best * turn))[1]
    period = span / best
    start = middle - period * float(np.arctan2(cosine, sine)) / (2 * np.pi)
    return Wave(period, start, 0.25 / best)
