"""Gain and phase of the open loop over frequency, as bands over the draws."""

import numpy as np

from bayesfric.arrays import Array, evenly
from bayesfric.margins.describing import natural_frequency
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.open_loop import OpenLoop
from bayesfric.schemas.margins import Bode

DRAWS = 100
LOWEST, HIGHEST = 0.05, 50.0
"""Over the natural frequency; no higher than half the sample rate, where L(jω) ends."""
DENSE, SHOWN_EVERY = 1501, 10
"""Frequencies at which phase is followed, and those of the figure."""
SHOWN_QUANTILES = (0.05, 0.5, 0.95)


def bode_bands(shaft: LoopAtShaft) -> tuple[Bode, ...]:
    """Return 5, 50 and 95 % of |L| and arg L over the draws, in each direction.

    Phase is followed from the lowest frequency on, where it lies between −315° and 45°.
    """
    rows = evenly(shaft.friction.size, DRAWS)
    own = float(np.median(natural_frequency(shaft)))
    top = min(HIGHEST * own, np.pi / float(np.median(shaft.sample_time)))
    omega = np.geomspace(LOWEST * own, top, DENSE)
    bands = []
    for direction in shaft.directions:
        response = OpenLoop(shaft, direction)(np.tile(omega, (rows.size, 1)), rows[:, None])
        phase = np.degrees(np.unwrap(np.angle(response), axis=1))
        phase -= 360.0 * (phase[:, :1] > 45.0)
        bands.append(
            Bode(
                direction=direction,
                frequency_hz=_short(omega / (2 * np.pi)),
                gain_db=_levels(20 * np.log10(np.abs(response))),
                phase_deg=_levels(phase),
            )
        )
    return tuple(bands)


def _levels(values: Array) -> tuple[tuple[float, ...], ...]:
    return tuple(_short(curve) for curve in np.quantile(values, SHOWN_QUANTILES, axis=0))


def _short(values: Array) -> tuple[float, ...]:
    return tuple(float(f"{value:.5g}") for value in values[::SHOWN_EVERY])
