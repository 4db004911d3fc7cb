"""A torque constant of the motor board's motor that is not the specified one."""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.arrays import Array
from bayesfric.effects.base import Effect, EffectParameter, Parameters, State

TYPICAL_CURRENT_A = 4.0  # load current


def _scaled(p: Parameters, state: State) -> Array:
    return np.asarray(state.load_current_a) * (1 / (1 + p["error"]) - 1)


def _saturating(p: Parameters, state: State) -> Array:
    # Iron saturates as the current grows, so the error grows with the current.
    current = np.asarray(state.load_current_a)
    error = p["error"] * np.abs(current) / TYPICAL_CURRENT_A
    return np.asarray(current * (1 / (1 + error) - 1))


EFFECT = Effect(
    name="torque-constant",
    acts_on="current",
    sentence="the motor's torque constant differs from the specified one",
    amplitude=EffectParameter(
        name="error",
        unit="1",
        meaning="relative error of the torque constant; in `saturating`, which grows with the "
        "current, the error at a load of 4 A",
        prior=Normal(mean=0.0, sd=0.1),
        plausible=(-0.1, 0.1),
        reference="data sheets of small motors give torque constants with tolerances of 5 to 10 %",
    ),
    laws={"scaled": _scaled, "saturating": _saturating},
    needs=frozenset({"pulleys"}),
    axes=frozenset({"rig", "tension"}),
)
