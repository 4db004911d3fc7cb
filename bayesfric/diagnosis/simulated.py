"""The entry of a user's simulator that replaces the law in a diagnosis."""

import numpy as np

from bayesfric.diagnosis.acting import At
from bayesfric.diagnosis.model import LinearModel
from bayesfric.inference.priors import describe
from bayesfric.rigs.data import Data
from bayesfric.rigs.own_law import OwnLaw
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import EffectNumber
from bayesfric.schemas.diagnosis import SimulatorUsed


def own_law_of(data: Data) -> OwnLaw | None:
    """Return the simulator that replaces the law; None if a law is examined."""
    return data.rigs[0].own_law


def simulator_used(own: OwnLaw | None, model: LinearModel, at: At) -> SimulatorUsed | None:
    """Return the entry of a simulator, with its parameters fitted under a hypothesis.

    Parameters
    ----------
    own : OwnLaw or None
        The simulator.
    model : LinearModel
        Model that is linear in the simulator's parameters.
    at : At
        The hypothesis at its mode.
    """
    if own is None:
        return None
    (size,) = model.layout.sizes
    numbers = {}
    for place, parameter in enumerate(own.parameters):
        scale = float(model.scales[place])
        mean = float(np.asarray(model.laws[size][place])) + scale * float(at.mean[place])
        sd = scale * float(np.sqrt(at.covariance[place, place]))
        numbers[parameter.name] = EffectNumber(
            **Interval.of_normal(mean, sd).model_dump(),
            unit=parameter.unit,
            prior=describe(parameter.prior),
            prior_density=parameter.prior,
        )
    return SimulatorUsed(name=own.law.name, calls=own.calls, parameters=numbers)
