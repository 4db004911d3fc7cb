"""Wear, run-in, warm-up: friction that changes from trial to trial."""

from collections.abc import Mapping

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, State

RUN_IN = 0.2  # of the recording, after which 1/e of the change is still to come


def _linear(p: Mapping[str, Array], state: State) -> Array:
    return np.asarray(p["change"] * state.friction_n * (np.asarray(state.order) - 0.5))


def _saturating(p: Mapping[str, Array], state: State) -> Array:
    whole = -np.expm1(-1 / RUN_IN)
    done = -np.expm1(-np.asarray(state.order) / RUN_IN) / whole
    mean = 1 / whole - RUN_IN
    return np.asarray(p["change"] * state.friction_n * (done - mean))


EFFECT = Effect(
    name="wear-drift",
    acts_on="friction",
    sentence="friction changes in the course of the recording",
    amplitude=EffectParameter(
        name="change",
        unit="1",
        meaning="change of friction from the first trial to the last, as a share of friction",
        prior=Normal(mean=0.0, sd=0.3),
        plausible=(-0.5, 0.5),
        reference="argued: new bearings and cables that run in may lose half of their friction, "
        "and worn ones gain as much",
    ),
    laws={"linear": _linear, "saturating": _saturating},
    edge={"order": 1.0},
)
