"""A transmission that gives: part of the mass follows the drive late."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bayesfric.analysis import Normal
from bayesfric.effects.base import Effect, EffectParameter, State

Array = NDArray[np.float64]


def _two_masses(p: Mapping[str, Array], state: State) -> Array:
    # With the load's mass M behind a stiffness K it is M/K of the second derivative.
    return np.asarray(-p["square"] * np.asarray(state.force_curvature_n_s2))


EFFECT = Effect(
    name="transmission-compliance",
    acts_on="drive",
    sentence="the transmission gives, so that part of the mass follows late",
    amplitude=EffectParameter(
        name="square",
        unit="s²",
        meaning="load's mass over the stiffness of the transmission: one over the square of the "
        "angular frequency at which it rings against a held drive; negative where the position "
        "is the load's",
        prior=Normal(mean=0.0, sd=1e-4),
        plausible=(-1e-3, 1e-3),
        reference="argued: arms ring at 5 to 50 Hz against a held drive: 1e-3 to 1e-5 s²",
    ),
    laws={"two-masses": _two_masses},
    along_path=True,
    needs=frozenset({"drive"}),
)
