"""Frequency responses of a few draws, for the figures."""

import numpy as np
from numpy.typing import NDArray

from bayesfric.arrays import evenly
from bayesfric.margins.describing import natural_frequency
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.open_loop import OpenLoop
from bayesfric.schemas.margins import NyquistFan

DRAWS = 12
POINTS = 100
DIGITS = 5
DENSE = 1500
LARGEST = 6.0  # of |L|, what a picture shows
SMALLEST = 0.03


def nyquist_fans(shaft: LoopAtShaft) -> tuple[NyquistFan, ...]:
    """Return L(jω) and what friction sees, of some draws, in each direction.

    The latter is motor speed per friction torque times √(kp J), a pure number: near ω_n it
    is 1/(2ζ).
    """
    rows = evenly(shaft.friction.size, DRAWS)
    scale = np.sqrt(shaft.kp * shaft.inertia)[rows, None]
    near = natural_frequency(shaft)[rows, None] * np.geomspace(0.1, 10.0, DENSE)[None, :]
    fans = []
    for direction in shaft.directions:
        loop = OpenLoop(shaft, direction)
        omega = np.sort(np.concatenate([loop.frequencies()[rows], near], axis=1), axis=1)
        response = loop(omega, rows[:, None])
        seen = loop.seen_by_friction(omega, rows[:, None]) * scale
        size = np.abs(response)
        shown = (size > SMALLEST) & (size < LARGEST)
        for what, values in (("loop", response), ("seen-by-friction", seen)):
            used = shown if what == "loop" else np.full(shown.shape, True)
            picked = [_thinned(curve[use]) for curve, use in zip(values, used, strict=True)]
            fans.append(
                NyquistFan(
                    what=what,
                    direction=direction,
                    real=tuple(tuple(_short(curve.real)) for curve in picked),
                    imag=tuple(tuple(_short(curve.imag)) for curve in picked),
                )
            )
    return tuple(fans)


def _thinned(curve: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Keep points that are evenly spaced along the curve."""
    if curve.size <= POINTS:
        return curve
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(curve)))])
    places = np.searchsorted(way, np.linspace(0, way[-1], POINTS))
    return np.asarray(curve[np.unique(np.minimum(places, curve.size - 1))])


def _short(values: NDArray[np.float64]) -> list[float]:
    return [float(f"{value:.{DIGITS}g}") for value in values]
