"""A drive that gives less than the command beyond a limit."""

import numpy as np

from bayesfric.analysis import HalfNormal, LogNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _beyond(p: Parameters, state: State) -> Array:
    drive = np.asarray(state.drive_force_n)
    lost = np.sign(drive) * np.maximum(np.abs(drive) - p["limit"], 0.0)
    return np.asarray(p["share"] * lost * np.asarray(state.direction))


EFFECT = Effect(
    name="torque-saturation",
    acts_on="drive",
    sentence="beyond a limit the drive gives less than what is commanded",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="share of the command beyond the limit that is lost; 1 if the drive clips",
        prior=HalfNormal(scale=1.0),
        plausible=(0.0, 1.2),
        reference="by definition: none or all of it is lost",
    ),
    shape=EffectParameter(
        name="limit",
        unit="N",
        meaning="force above which the drive loses a part of the command",
        prior=LogNormal(median=2.5, sd_log=0.6),
        plausible=(1.0, 40.0),
        reference="argued: a drive is chosen for several times the friction. Where commands are "
        "logged, the limit is where acceleration no longer grows with the command",
        typical=2.5,
    ),
    laws={"beyond": _beyond},
    along_path=True,
    needs=frozenset({"drive", "direction", "limit"}),
    axes=frozenset({"acceleration", "load"}),
)
