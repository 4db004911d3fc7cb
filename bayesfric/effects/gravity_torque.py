"""A weight on a lever: torque that goes with sine and cosine of the angle.

On a small stroke about where it hangs it is a spring; few joints have one, and most have a weight.
"""

from collections.abc import Mapping

import numpy as np

from bayesfric.analysis import Normal, Uniform
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, State


def _lever(p: Mapping[str, Array], state: State) -> Array:
    pull = np.sin(np.asarray(state.position_m) + p["angle"])
    return np.asarray(p["torque"] * pull * np.asarray(state.direction))


EFFECT = Effect(
    name="gravity-torque",
    acts_on="drive",
    sentence="a weight off the axis pulls with the sine of the angle",
    amplitude=EffectParameter(
        name="torque",
        unit="N",
        meaning="largest torque of the weight",
        prior=Normal(mean=0.0, sd=1.0),
        plausible=(-10.0, 10.0),
        reference="argued: joints are balanced, or their drives are chosen, so that weight takes "
        "no more than some times friction",
    ),
    shape=EffectParameter(
        name="angle",
        unit="1",
        meaning="angle to add to the position so that the weight hangs at zero [rad]",
        prior=Uniform(low=-1.7, high=1.7),  # a quarter turn, as where 0 is level, lies inside
        plausible=(-1.5708, 1.5708),
        reference="nobody knows where an encoder's zero is; half a turn more changes the sign",
        typical=0.3,
    ),
    laws={"lever": _lever},
    along_path=True,
    needs=frozenset({"acting-gravity", "angle", "position"}),
    axes=frozenset({"direction", "displacement", "rotation_angle"}),
    is_exact=True,
    odds=10.0,  # argued: of joints pulled to a place ten have a weight where one has a spring
)
