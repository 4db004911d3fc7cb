"""Drag of the air: grows with the square of speed, whatever the number of pulleys."""

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _quadratic(p: Parameters, state: State) -> Array:
    return np.asarray(p["coefficient"] * np.asarray(state.speed_m_s) ** 2)


EFFECT = Effect(
    name="air-drag",
    acts_on="drive",
    sentence="the air resists in proportion to the square of speed",
    amplitude=EffectParameter(
        name="coefficient",
        unit="N s²/m²",
        meaning="force against the motion at 1 m/s",
        prior=HalfNormal(scale=0.2),
        plausible=(0.0, 0.05),
        reference="argued: ρ c A / 2 of two weights with plates of 0.03 m² each, with a drag "
        "coefficient c of 1.2 and air of 1.2 kg/m³, is 0.04 N s²/m²",
        on_joints=(
            0.0,
            1.2,
            "argued: fans, stirred oil and long links take up to twice the friction of a joint "
            "at its top speed",
        ),
        joint_prior=HalfNormal(scale=0.6),  # as large as the friction of a joint at its top speed
    ),
    laws={"quadratic": _quadratic},
    edge={"speed_m_s": 1.3, "n_pulleys": 5.0},
    along_path=True,
    axes=frozenset({"velocity"}),
)
