"""Frequency responses of the open loop, for the figures: bands over the draws, and some draws."""

import numpy as np

from bayesfric.arrays import Array, Complex, evenly
from bayesfric.margins.describing import natural_frequency
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.open_loop import OpenLoop
from bayesfric.schemas.base import QUANTILES
from bayesfric.schemas.margins import Bode, NyquistFan

BODE_DRAWS = 100
LOWEST, HIGHEST = 0.05, 50.0
"""Frequency range over the natural frequency; at most half the sample rate."""
BODE_POINTS, SHOWN_EVERY = 1501, 10
"""Number of frequencies for unwrapping the phase, and step to those of the figure."""
FAN_DRAWS = 12
FAN_POINTS = 100
DIGITS = 5
DENSE = 1500
LARGEST = 6.0  # largest |L| in a figure
SMALLEST = 0.03


def bode_bands(shaft: LoopAtShaft) -> tuple[Bode, ...]:
    """Return 5, 50 and 95 % of |L| and arg L over the draws, in each direction.

    The phase is unwrapped from the lowest frequency, where it lies between −315° and 45°.
    """
    rows = evenly(shaft.friction.size, BODE_DRAWS)
    own = float(np.median(natural_frequency(shaft)))
    top = min(HIGHEST * own, np.pi / float(np.median(shaft.sample_time)))
    omega = np.geomspace(LOWEST * own, top, BODE_POINTS)
    bands = []
    for direction in shaft.directions:
        response = OpenLoop(shaft, direction)(np.tile(omega, (rows.size, 1)), rows[:, None])
        phase = np.degrees(np.unwrap(np.angle(response), axis=1))
        phase -= 360.0 * (phase[:, :1] > 45.0)
        bands.append(
            Bode(
                direction=direction,
                frequency_hz=_short(omega[::SHOWN_EVERY] / (2 * np.pi)),
                gain_db=_levels(20 * np.log10(np.abs(response))),
                phase_deg=_levels(phase),
            )
        )
    return tuple(bands)


def _levels(values: Array) -> tuple[tuple[float, ...], ...]:
    return tuple(_short(curve[::SHOWN_EVERY]) for curve in np.quantile(values, QUANTILES, axis=0))


def _short(values: Array) -> tuple[float, ...]:
    return tuple(float(f"{value:.{DIGITS}g}") for value in values)


def nyquist_fans(shaft: LoopAtShaft) -> tuple[NyquistFan, ...]:
    """Return L(jω), and motor speed per friction torque, of some draws, in each direction.

    The latter is multiplied by √(kp J), which makes it dimensionless: near ω_n it is 1/(2ζ).
    """
    rows = evenly(shaft.friction.size, FAN_DRAWS)
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
                    real=tuple(_short(curve.real) for curve in picked),
                    imag=tuple(_short(curve.imag) for curve in picked),
                )
            )
    return tuple(fans)


def _thinned(curve: Complex) -> Complex:
    """Keep points that are evenly spaced along the curve."""
    if curve.size <= FAN_POINTS:
        return curve
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(curve)))])
    places = np.searchsorted(way, np.linspace(0, way[-1], FAN_POINTS))
    return np.asarray(curve[np.unique(np.minimum(places, curve.size - 1))])
