"""Cogging: a drive force that is periodic along the path.

Period and phase are not known beforehand. The response cannot be interpolated between two periods
whose waves drift apart by half a turn over the path. So the rig searches the data for period and
phase, and the evidence is divided by the number of distinguishable forms that were searched.
"""

import numpy as np

from bayesfric.analysis import HalfNormal, LogNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _wave(p: Parameters, state: State) -> Array:
    turns = (np.asarray(state.position_m) - state.wave_from_m) / p["period"]
    return np.asarray(p["force"] * np.sin(2 * np.pi * turns) * np.asarray(state.direction))


EFFECT = Effect(
    name="cogging",
    acts_on="drive",
    sentence="the drive force varies periodically along the path",
    amplitude=EffectParameter(
        name="force",
        unit="N",
        meaning="amplitude of the periodic force",
        prior=HalfNormal(scale=0.3),
        plausible=(0.0, 2.0),
        reference="argued: cogging is a few per cent to a fifth of the rated force, and the rated "
        "force is several times the friction",
    ),
    shape=EffectParameter(
        name="period",
        unit="m",
        meaning="wavelength of the periodic force",
        prior=LogNormal(median=0.05, sd_log=0.8),
        plausible=(0.002, 0.3),
        reference="argued: a pole pair or a tooth spans at least a hundredth of the travel. A "
        "wavelength above half of the travel is no period",
        typical=0.05,
    ),
    laws={"wave": _wave},
    along_path=True,
    needs=frozenset({"direction", "period"}),
    axes=frozenset({"direction", "displacement"}),
)
