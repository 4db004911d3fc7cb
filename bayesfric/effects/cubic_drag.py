"""Drag that grows with the cube of speed: the next odd power after viscous friction.

Churned oil and eddy currents make viscous friction nonlinear. Over a small range of speeds this
effect is confounded with ``air-drag``, and with ``viscous`` if the law has no viscous friction.
"""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _cubic(p: Parameters, state: State) -> Array:
    moving = np.abs(np.asarray(state.direction))
    return np.asarray(p["coefficient"] * np.asarray(state.speed_m_s) ** 3 * moving)


EFFECT = Effect(
    name="cubic-drag",
    acts_on="drive",
    sentence="a drag changes in proportion to the cube of speed",
    amplitude=EffectParameter(
        name="coefficient",
        unit="N s³/m³",
        meaning="force against the motion at 1 m/s; negative if friction grows less than in "
        "proportion to speed",
        prior=Normal(mean=0.0, sd=0.15),
        plausible=(-0.5, 0.5),
        reference="argued: at the top speed it changes friction by no more than friction itself; "
        "polynomial laws of joints are in Simoni et al., Modelling the temperature in "
        "joint friction of industrial manipulators, Robotica (2017)",
        joint_prior=Normal(mean=0.0, sd=0.45),  # as large as `air-drag` at the top speed
    ),
    laws={"cubic": _cubic},
    along_path=True,
    needs=frozenset({"direction"}),
    axes=frozenset({"velocity"}),
)
