"""An elastic transmission: friction winds it up, and part of the mass follows with a delay.

After a reversal the load stands still, while the drive winds the transmission up from the load's
friction in one direction to that in the other. This takes a travel of l = 2 C / s, for a friction C
behind a stiffness s. Over this travel the missing force falls linearly from 2 C to 0. Then the load
moves.
"""

from functools import partial

import numpy as np

from bayesfric.analysis import HalfNormal, LogNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import (
    Effect,
    EffectParameter,
    Parameters,
    State,
    load_law,
    sprung_by_own_shares,
)
from bayesfric.physics.loads import taken_along

SPREAD = 3.0  # the load is accelerated over a third of the length


def _late(heavy: float, length: Array, state: State) -> Array:
    """Return (load's mass / stiffness) × second derivative of the force."""
    square = heavy * np.asarray(state.mass_kg) * length / (2 * state.friction_n)
    return np.asarray(square * np.asarray(state.force_curvature_n_s2))


def _wound_up(heavy: float, p: Parameters, state: State) -> Array:
    """Return the force of a load whose share of the mass is `heavy` times its friction share."""
    length = p["length"]
    _, caught = taken_along(state.travel_m, state.speed_m_s, length, SPREAD)
    left = np.maximum(1 - np.asarray(state.travel_m) / length, 0.0)
    taken = heavy * np.asarray(state.mass_kg) * caught - 2 * state.friction_n * left
    late = heavy * _late(heavy, length, state)
    return np.asarray(p["share"] * (np.abs(state.direction) * taken - late))


def _seen_at_load(p: Parameters, state: State) -> Array:
    # A sensor at the load does not see the wind-up. The motor, half of the mass, is ahead of it.
    return np.asarray(p["share"] * 0.5 * _late(0.5, p["length"], state))


EFFECT = Effect(
    name="transmission-compliance",
    acts_on="drive",
    sentence="the transmission is elastic: friction winds it up, and part of the mass follows with "
    "a delay",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="share of the friction that is behind the spring. By variant, the share of the "
        "mass behind it is half of this share, this share, or a share of its own. In "
        "`rings-mass-alone` only mass is behind it",
        prior=HalfNormal(scale=0.5),
        plausible=(0.0, 1.0),
        reference="by definition: the share behind the spring is between 0 and 1",
    ),
    shape=EffectParameter(
        name="length",
        unit="m",
        meaning="travel after a reversal over which friction winds up the transmission: twice "
        "the friction behind the spring over the stiffness. In `rings-own-shares` and "
        "`rings-mass-alone` that friction is all friction times the share of the mass behind it",
        prior=LogNormal(median=6e-4, sd_log=1.0),
        plausible=(1e-5, 0.02),
        reference="argued: friction winds up harmonic drives, belts and long screws by a "
        "ten-thousandth to a hundredth of the travel",
        typical=0.004,
    ),
    laws={
        "half-mass": partial(_wound_up, 0.5),
        "mass": partial(_wound_up, 1.0),
        "seen-at-load": _seen_at_load,
        "rings-half-mass": load_law("spring", "length", 0.5),
        "rings-mass": load_law("spring", "length", 1.0),
        "rings-own-shares": sprung_by_own_shares,
        "rings-mass-alone": load_law("spring", "length", np.inf),
    },
    along_path=True,
    needs=frozenset({"direction", "drive", "spring"}),
    axes=frozenset({"acceleration", "travel_since_reversal", "velocity"}),
)
