"""Friction that differs between the two physical ends: guides, bearings or a plate out of line."""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _relative(p: Parameters, state: State) -> Array:
    return np.asarray(p["difference"] * state.friction_n * np.asarray(state.drive_end))


def _constant_part(p: Parameters, state: State) -> Array:
    """Return the difference if its cause is seals or grease, independent of tension."""
    ends = np.asarray(state.drive_end) * np.ones_like(state.tension_n)
    return np.asarray(p["difference"] * np.asarray(state.constant_friction_n) * ends)


EFFECT = Effect(
    name="end-asymmetry",
    acts_on="friction",
    sentence="friction differs with the end that carries the drive mass",
    amplitude=EffectParameter(
        name="difference",
        unit="1",
        meaning="friction, or its constant part, with the drive mass on the right less that on "
        "the left, as a share",
        prior=Normal(mean=0.0, sd=0.1),
        plausible=(-0.2, 0.2),
        reference="argued: two ends of one board are built alike; a guide that rubs at one of "
        "them may cost a tenth",
    ),
    laws={"relative": _relative, "constant-part": _constant_part},
    edge={"drive_end": 0.5},
    needs=frozenset({"pulleys"}),
    two_ends="drive_end",
    axes=frozenset({"drive_end"}),
)
