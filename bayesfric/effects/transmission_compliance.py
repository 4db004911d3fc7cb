"""A transmission that gives: friction winds it up, and part of the mass follows late.

After a reversal the load stands still, while the drive winds the transmission from the friction
on one side to that on the other. Over this travel, l = 2 C / s for a friction C and a stiffness s,
the force that is missing falls in proportion to the travel, from 2 C to nothing; then the load is
taken along.
"""

from collections.abc import Mapping
from functools import partial

import numpy as np

from bayesfric.analysis import HalfNormal, LogNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import (
    Effect,
    EffectParameter,
    State,
    followed,
    followed_by_own_shares,
)
from bayesfric.physics.loads import taken_along

SPREAD = 3.0  # a spring takes a load along over a third of the travel


def _late(heavy: float, length: Array, state: State) -> Array:
    """Return the load's mass over the stiffness, times the force's second derivative."""
    square = heavy * np.asarray(state.mass_kg) * length / (2 * state.friction_n)
    return np.asarray(square * np.asarray(state.force_curvature_n_s2))


def _wound_up(heavy: float, p: Mapping[str, Array], state: State) -> Array:
    """Return the force of a load with as large a share of the mass, times a number."""
    length = p["length"]
    _, caught = taken_along(state.travel_m, state.speed_m_s, length, SPREAD)
    left = np.maximum(1 - np.asarray(state.travel_m) / length, 0.0)
    taken = heavy * np.asarray(state.mass_kg) * caught - 2 * state.friction_n * left
    late = heavy * _late(heavy, length, state)
    return np.asarray(p["share"] * (np.abs(state.direction) * taken - late))


def _seen_at_load(p: Mapping[str, Array], state: State) -> Array:
    # What is wound up is not seen; the motor, half of the mass, is ahead of the position.
    return np.asarray(p["share"] * 0.5 * _late(0.5, p["length"], state))


EFFECT = Effect(
    name="transmission-compliance",
    acts_on="drive",
    sentence="the transmission gives, so that friction winds it up and part of the mass follows "
    "late",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="share of the friction that is behind the spring. By variant, the share of the "
        "mass behind it is half of this share, this share, or a share of its own",
        prior=HalfNormal(scale=0.5),
        plausible=(0.0, 1.0),
        reference="by definition: between nothing and all of it is behind the spring",
    ),
    shape=EffectParameter(
        name="length",
        unit="m",
        meaning="travel after a reversal over which friction winds up the transmission: twice "
        "the friction over the stiffness. If the mass has a share of its own, friction with that "
        "share is meant",
        prior=LogNormal(median=6e-4, sd_log=1.0),
        plausible=(1e-5, 0.02),
        reference="argued: harmonic drives, belts and long screws give a ten-thousandth to a "
        "hundredth of the travel under their friction",
        typical=0.004,
    ),
    laws={
        "half-mass": partial(_wound_up, 0.5),
        "mass": partial(_wound_up, 1.0),
        "seen-at-load": _seen_at_load,
        "rings-half-mass": followed("spring", "length", 0.5),
        "rings-mass": followed("spring", "length", 1.0),
        "rings-own-shares": followed_by_own_shares("spring", "length"),
        "rings-mass-alone": followed("spring", "length", np.inf),
    },
    along_path=True,
    needs=frozenset({"direction", "drive", "spring"}),
    axes=frozenset({"acceleration", "travel_since_reversal", "velocity"}),
)
