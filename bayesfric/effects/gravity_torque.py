"""A weight on a lever: a torque that varies with the sine of the angle.

Over a small stroke about the hanging position it is the same as a spring. Few joints have a spring,
and most have a weight.
"""

import numpy as np

from bayesfric.analysis import Normal, Uniform
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _lever(p: Parameters, state: State) -> Array:
    pull = np.sin(np.asarray(state.position_m) + p["angle"])
    return np.asarray(p["torque"] * pull * np.asarray(state.direction))


EFFECT = Effect(
    name="gravity-torque",
    acts_on="drive",
    sentence="the weight of an eccentric mass gives a torque that varies with the sine of the "
    "angle",
    amplitude=EffectParameter(
        name="torque",
        unit="N",
        meaning="largest torque of the weight",
        prior=Normal(mean=0.0, sd=1.0),
        plausible=(-10.0, 10.0),
        reference="argued: joints are balanced, or their drives are chosen, so that the weight "
        "takes no more than several times the friction",
    ),
    shape=EffectParameter(
        name="angle",
        unit="1",
        meaning="angle to add to the position so that the weight hangs down at zero [rad]",
        prior=Uniform(low=-1.7, high=1.7),  # includes a quarter turn: zero where the lever is level
        plausible=(-1.5708, 1.5708),
        reference="the zero of an encoder is arbitrary. Half a turn more only changes the sign of "
        "the torque",
        typical=0.3,
    ),
    laws={"lever": _lever},
    along_path=True,
    needs=frozenset({"acting-gravity", "angle", "position"}),
    axes=frozenset({"direction", "displacement", "rotation_angle"}),
    is_exact=True,
    odds=10.0,  # argued: for each joint with a spring, ten have a weight
)
