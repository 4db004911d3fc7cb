"""The size of a rival's effect, relative to friction of the recorded machine."""

from collections.abc import Mapping

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.effects import Effect, State
from bayesfric.fitting.hypothesis import LawWithEffects
from bayesfric.observation.coefficients import law_of
from bayesfric.rigs.data import Data

MIDDLE = {"n_pulleys": 9.0, "wrap_angle_deg": 85.0, "tension_n": 15.0, "speed_m_s": 0.65}


def suited_effects(data: Data, effects: Mapping[str, Effect]) -> dict[str, Effect]:
    """Return effects with the rig's units and priors, by name; unchanged for two rigs."""
    if len(data.rigs) > 1:
        return dict(effects)
    return {name: data.rigs[0].suited(effect) for name, effect in effects.items()}


def size_at_edge(
    data: Data,
    theta: Mapping[str, Array],
    hypothesis: LawWithEffects,
    effects: Mapping[str, Effect],
) -> Array:
    """Return the effect relative to friction at the conditions where it is largest, (S,)."""
    if not hypothesis.effects:
        return np.empty(0)
    (name, law), effect = hypothesis.effects[0], effects[hypothesis.effects[0][0]]
    values = {p.name: theta[f"{name}.{p.name}"] for p in effect.parameters}
    place = MIDDLE | dict(effect.edge)
    place["speed_m_s"] = max(place["speed_m_s"], slowest_speed(data))
    shares, trials = [], data.rigs[0]
    for size in data.sizes:
        coefficients = law_of(theta, size)
        state = State.of(coefficients, **place)
        condition = place | {"pulley_size": size, "velocity_m_s": place["speed_m_s"]}
        if set(trials.asked) <= set(condition):  # a machine has a middle tension of its own
            own = trials.at(pd.DataFrame([condition]), coefficients)
            if isinstance(own, State):
                state = state._replace(pulley_friction_n=own.pulley_friction_n)
        shares.append(np.abs(effect.laws[law](values, state) / state.friction_n))
    return np.asarray(np.max(shares, axis=0))


def slowest_speed(data: Data) -> float:
    """Return the lowest measured speed [m/s]."""
    speeds = [trials.slowest_speed_m_s for trials in data.rigs]
    return min((speed for speed in speeds if np.isfinite(speed)), default=0.0)
