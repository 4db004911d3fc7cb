"""Magnets of the sensor pulley that are displaced.

The pattern repeats each revolution, and the recording does not say which magnet came first. So the
pattern is a sum of waves with one and two periods a revolution, with free phases. For five magnets
these are all patterns except a constant; for more magnets they are the smooth patterns.
"""

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, Reading

WAVES = (1, 2)  # periods a revolution


def _waves(p: Parameters, reading: Reading) -> Array:
    turn = 2 * np.pi * np.asarray(reading.event) / reading.magnets_per_revolution
    amplitude = p["error"] / np.sqrt(len(WAVES))
    return np.stack([amplitude * wave(k * turn) for k in WAVES for wave in (np.cos, np.sin)])


EFFECT = Effect(
    name="magnet-spacing",
    acts_on="reading",
    sentence="the magnets of the sensor pulleys are displaced",
    amplitude=EffectParameter(
        name="error",
        unit="m",
        meaning="rms error of a magnet's place",
        prior=HalfNormal(scale=1e-4),
        plausible=(0.0, 2e-4),
        reference="argued: magnets glued into holes sit to a tenth or two of a millimetre",
    ),
    laws={"waves": _waves},
    along_path=True,
    components=2 * len(WAVES),
    needs=frozenset({"pulleys"}),
    axes=frozenset({"rotation_angle", "sensor"}),
)
