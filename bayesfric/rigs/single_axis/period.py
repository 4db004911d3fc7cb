"""The period, along the path, of a force that comes back: looked for among all waves."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.readings import Readings

LEAST, MOST = 2.0, 100.0  # waves over the path that are looked for
BESIDE_JOINTS = 5.0
"""The least where other joints are logged and no model says how they pull: what varies as slowly
over the stroke is theirs as well as the drive's, and poles and teeth come closer."""
APART = 0.25  # waves over the path, between two that are tried
PHASES = 6  # that tell a wave from its neighbours
SEARCHED = round(2 * (MOST - LEAST)) * PHASES
"""Waves that data can tell apart: half a wave more over the path is another."""
FINER = np.linspace(-1.0, 1.0, 21)


class Wave(NamedTuple):
    """A sine of the position.

    Parameters
    ----------
    period : float
        [m or rad].
    start : float
        Where it rises through zero, near the middle of the path [m or rad].
    spread : float
        Relative error of the period, by half a wave over the whole path.
    """

    period: float
    start: float
    spread: float


def strongest_wave(readings: Readings, least: float = LEAST) -> Wave:
    """Return the wave that takes most of the force which the law leaves.

    The law, and what is smooth in the position, is fitted along with it by least squares.

    Parameters
    ----------
    readings : Readings
        Rows; positions inside a window are averaged as the force is.
    least : float
        Waves over the path, from which on it is looked.
    """
    low, span = float(readings.position.min()), float(np.ptp(readings.position)) or 1.0
    middle = low + 0.5 * span
    place = (readings.position - middle) / span
    ones = np.ones(readings.count)
    fixed_waves = np.stack(
        [readings.acceleration, ones, readings.speed @ readings.weights, readings.force_rate]
        + [readings.way * (place**power @ readings.weights) for power in range(4)]
        + [*readings.beside.T],
        axis=1,
    )
    basis = np.linalg.qr(fixed_waves / np.maximum(np.abs(fixed_waves).max(axis=0), 1e-300))[0]
    left = readings.force - basis @ (basis.T @ readings.force)

    def numbers(turned: NDArray[np.complex128]) -> tuple[float, Array]:
        """Return what a wave takes off the squares, and its cosine's and sine's amplitudes.

        The wave is given as exp(i angle) inside each window.
        """
        mean = turned @ readings.weights * readings.way
        pair = np.stack([mean.real, mean.imag])
        pair = pair.T - basis @ (basis.T @ pair.T)
        pair_numbers = np.linalg.lstsq(pair, left, rcond=1e-6)[0]
        return float(left @ pair @ pair_numbers), np.asarray(pair_numbers, dtype=np.float64)

    turn = 2j * np.pi * place
    tried = np.arange(least, MOST, APART)
    turned, further, taken = np.exp(least * turn), np.exp(APART * turn), []
    for _ in tried:  # a product is much quicker than a cosine and a sine
        taken.append(numbers(turned)[0])
        turned *= further
    best = tried[np.argmax(taken)]
    tried = np.maximum(best + APART * FINER, least)
    best = float(tried[np.argmax([numbers(np.exp(waves * turn))[0] for waves in tried])])
    cosine, sine = numbers(np.exp(best * turn))[1]
    period = span / best
    start = middle - period * float(np.arctan2(cosine, sine)) / (2 * np.pi)
    return Wave(period, start, 0.25 / best)
