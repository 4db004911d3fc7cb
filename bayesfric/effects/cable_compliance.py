"""A cable that stretches: the masses ring on it after the release, eq. (3)."""

import numpy as np

from bayesfric.analysis import LogNormal, Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, Reading

DAMPING_RATIO = 0.05


def _ringing(p: Parameters, reading: Reading) -> Array:
    drive, load = np.asarray(reading.mass_drive_kg), np.asarray(reading.mass_load_kg)
    rate = np.sqrt(p["stiffness"] * (1 / drive + 1 / load))
    phase = rate * np.asarray(reading.time_s)
    stretch = p["stretch"] * np.cos(phase) * np.exp(-DAMPING_RATIO * phase)
    at_load = np.asarray(reading.is_load)
    moved = np.where(at_load, -drive, load) / (drive + load) * stretch
    return np.asarray(-moved)  # an end that is ahead reaches its magnet earlier


EFFECT = Effect(
    name="cable-compliance",
    acts_on="reading",
    sentence="the cable stretches, and the two masses ring on it after the release",
    amplitude=EffectParameter(
        name="stretch",
        unit="m",
        meaning="stretch at the release beyond that of the moving board; negative if the "
        "drive side was held",
        prior=Normal(mean=0.0, sd=3e-4),
        plausible=(-5e-4, 5e-4),
        reference="argued: tensions change by some 5 N at the release, over 9.4 kN/m",
    ),
    shape=EffectParameter(
        name="stiffness",
        unit="N/m",
        meaning="stiffness of the cable between the masses",
        prior=LogNormal(median=9400.0, sd_log=0.3),
        plausible=(5000.0, 16000.0),
        reference="argued: EA of 12 to 16 kN, 0.61 mm steel cable 7×19, over 1 to 2.4 m",
        typical=9400.0,
    ),
    laws={"ringing": _ringing},
    along_path=True,
    needs=frozenset({"pulleys"}),
    axes=frozenset({"displacement"}),
)
