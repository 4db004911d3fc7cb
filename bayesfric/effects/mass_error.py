"""A mass on one side that differs from the recorded one."""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _drive_side(p: Parameters, state: State) -> Array:
    pull = np.asarray(state.gravity_m_s2) - np.asarray(state.acceleration_m_s2)
    return np.asarray(-p["excess"] * pull * (1 - _felt(state)) * (not state.steady))


def _load_side(p: Parameters, state: State) -> Array:
    pull = np.asarray(state.gravity_m_s2) + np.asarray(state.acceleration_m_s2)
    return np.asarray(p["excess"] * pull * (1 + _felt(state)) * (not state.steady))


def _felt(state: State) -> Array:
    """Return the friction that the excess adds by its tension, as a share of its weight.

    Half of the weight enters the nominal tension, which is the mean of both sides.
    """
    return np.asarray(0.5 * np.asarray(state.tension_friction_n) / np.asarray(state.tension_n))


EFFECT = Effect(
    name="mass-error",
    acts_on="drive",
    sentence="the mass on one side is off by a constant",
    amplitude=EffectParameter(
        name="excess",
        unit="kg",
        meaning="mass on that side beyond the recorded one",
        prior=Normal(mean=0.0, sd=0.01),
        plausible=(-0.005, 0.005),
        reference="argued: a hook or a clamp that was not weighed is a few grams, and kitchen "
        "scales are no better",
    ),
    laws={"drive-side": _drive_side, "load-side": _load_side},
    edge={"n_pulleys": 5.0},
    needs=frozenset({"pulleys"}),
    axes=frozenset({"n_pulleys", "rig"}),
)
