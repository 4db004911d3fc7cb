"""Wear, run-in, warm-up: friction that changes from trial to trial.

The change decays exponentially if surfaces settle, and grows exponentially if wear feeds on itself.
Between the two it is linear in the order of trials.
"""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State

STRAIGHT = 1e-4  # a rate below this gives a straight line, to a relative error of 1e-5


def _exponential(p: Parameters, state: State) -> Array:
    """Return the change so far, less its mean over the recording."""
    order, rate = np.asarray(state.order), np.asarray(p["rate"], dtype=np.float64)
    straight = np.abs(rate) < STRAIGHT
    rate = np.where(straight, 1.0, rate)
    done = np.where(straight, order, np.expm1(rate * order) / np.expm1(rate))
    mean = np.where(straight, 0.5, 1 / rate - 1 / np.expm1(rate))
    return np.asarray(p["change"] * state.friction_n * (done - mean))


EFFECT = Effect(
    name="wear-drift",
    acts_on="friction",
    sentence="friction changes over the course of the recording",
    amplitude=EffectParameter(
        name="change",
        unit="1",
        meaning="change of friction from the first trial to the last, as a share of friction",
        prior=Normal(mean=0.0, sd=0.3),
        plausible=(-0.5, 0.5),
        reference="argued: new bearings and cables that run in may lose half of their friction, "
        "and worn ones gain as much",
    ),
    shape=EffectParameter(
        name="rate",
        unit="1",
        meaning="rate of an exponential change, in e-folds over the recording; positive if the "
        "change accelerates, negative if it decays, 0 if it is linear in the order of trials",
        prior=Normal(mean=0.0, sd=5.0),
        plausible=(-15.0, 15.0),
        reference="argued: surfaces run in over a fifteenth of the recording or more, wear "
        "steadily, or wear ever faster because wear debris is abrasive",
        typical=0.0,
    ),
    laws={"exponential": _exponential},
    edge={"order": 1.0},
    axes=frozenset({"order"}),
)
