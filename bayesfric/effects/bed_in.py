"""Bed-in: friction that settles over the first trials of each assembly."""

import numpy as np

from bayesfric.analysis import LogNormal, Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State


def _first(p: Parameters, state: State) -> Array:
    """Return the excess in an assembly's first trial; 0 in a steady state, where it is over."""
    return np.asarray(p["excess"] * state.friction_n * (not state.steady))


def _exponential(p: Parameters, state: State) -> Array:
    return np.asarray(_first(p, state) * np.exp(-np.asarray(state.trial_in_setup) / p["trials"]))


def _hyperbolic(p: Parameters, state: State) -> Array:
    """Return the remaining excess if its rate of decay is in proportion to its square."""
    return np.asarray(_first(p, state) / (1 + np.asarray(state.trial_in_setup) / p["trials"]))


EFFECT = Effect(
    name="bed-in",
    acts_on="friction",
    sentence="friction settles over the first trials of each assembly",
    amplitude=EffectParameter(
        name="excess",
        unit="1",
        meaning="excess of friction in the first trial of an assembly, as a share of friction",
        prior=Normal(mean=0.0, sd=0.15),
        plausible=(-0.3, 0.3),
        reference="argued: cable and grease settle within a few runs. An excess above a third of "
        "friction would be visible without analysis",
    ),
    shape=EffectParameter(
        name="trials",
        unit="1",
        meaning="trials after which 1/e (`exponential`) or half (`hyperbolic`) of the excess is "
        "left",
        prior=LogNormal(median=3.0, sd_log=0.7),
        plausible=(0.3, 20.0),
        reference="argued: a change that lasts longer than an assembly's trials is wear or warm-up",
        typical=3.0,
    ),
    laws={"exponential": _exponential, "hyperbolic": _hyperbolic},
    edge={"trial_in_setup": 0.0},
    needs=frozenset({"pulleys"}),
    axes=frozenset({"trial_in_setup"}),
)
