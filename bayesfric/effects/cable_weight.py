"""Weight of the cable that passes from one side to the other."""

import numpy as np

from bayesfric.analysis import HalfNormal, Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State
from bayesfric.physics.gravity import TRAVEL_M

CABLE_M = 1.6  # length of the cable between the masses; all of it moves


def _passing(p: Parameters, state: State) -> Array:
    longer = 2 * np.asarray(state.travel_m) - p["middle"]  # drive side less load side
    weight = p["density"] * np.asarray(state.gravity_m_s2) * (not state.steady)
    return np.asarray(-weight * longer)


def _with_inertia(p: Parameters, state: State) -> Array:
    moved = p["density"] * CABLE_M * np.asarray(state.acceleration_m_s2) * (not state.steady)
    return np.asarray(_passing(p, state) + moved)


EFFECT = Effect(
    name="cable-weight",
    acts_on="drive",
    sentence="cable passes from the load side to the drive side, so the weight of the cable adds "
    "to the drive",
    amplitude=EffectParameter(
        name="density",
        unit="kg/m",
        meaning="mass of a metre of cable",
        prior=HalfNormal(scale=0.02),
        plausible=(0.0, 0.003),
        reference="argued: steel that fills 0.5 to 0.7 of a circle of 0.61 mm weighs 1.2 to "
        "1.6 g/m; a coated or doubled cable weighs twice that",
    ),
    shape=EffectParameter(
        name="middle",
        unit="m",
        meaning="how much longer the hanging cable is on the load side than on the drive side at "
        "the release",
        prior=Normal(mean=TRAVEL_M, sd=0.2),
        plausible=(0.0, 1.2),
        reference="argued: the masses change places in a trial of 0.6 m, and hang from cords "
        "of their own",
        typical=TRAVEL_M,
    ),
    laws={"passing": _passing, "with-inertia": _with_inertia},
    edge={"travel_m": TRAVEL_M, "n_pulleys": 5.0},
    along_path=True,
    needs=frozenset({"pulleys"}),
    axes=frozenset({"displacement"}),
)
