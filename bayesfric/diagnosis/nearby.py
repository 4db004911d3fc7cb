"""A model around a fitted law, and not so far from the last that nothing linear holds there.

Effects are shares of the law's friction. Where several together take the law's place, as a fall
and a rise with speed may on few speeds, the best law of what is linear has hardly any friction
left: around it shares mean nothing, and no scatter is small.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from bayesfric.diagnosis.forms import Form
from bayesfric.diagnosis.model import LinearModel
from bayesfric.effects.candidates import Candidate
from bayesfric.physics.friction import Coefficients

FARTHEST = 1.5  # times friction of the last law, or as small a part of it
STEPS = (1.0, 0.5, 0.25)  # shares of the way that are tried
ROUNDING = 1e-300


def around_nearby(
    model: LinearModel,
    laws: Mapping[str, Coefficients],
    candidates: Sequence[Candidate],
    *,
    scattering: Sequence[tuple[Candidate, float]],
    forms: Sequence[Form],
) -> LinearModel:
    """Return the model around other laws, or as far on the way to them as holds.

    Parameters
    ----------
    model : LinearModel
        Around the last laws.
    laws : mapping of str to Coefficients
        As they were fitted, by pulley size.
    candidates, scattering, forms
        As of :meth:`~bayesfric.diagnosis.model.LinearModel.around`.
    """
    for step in (*STEPS, 0.0):
        part = {size: _between(model.laws[size], law, step) for size, law in laws.items()}
        around = model.around(part, candidates, scattering=scattering, forms=forms)
        if step == 0.0 or _is_near(model, around):
            break
    return around


def _between(first: Coefficients, other: Coefficients, step: float) -> Coefficients:
    mixed = (1 - step) * np.array(first) + step * np.array(other)
    return Coefficients(*mixed.tolist())


def _is_near(model: LinearModel, around: LinearModel) -> bool:
    """Return whether friction of every trial is of one size in both."""
    for before, after in zip(model.rigs, around.rigs, strict=True):
        first, other = (np.maximum(rig.rows.friction_n, ROUNDING) for rig in (before, after))
        if np.abs(np.log(other / first)).max(initial=0.0) > np.log(FARTHEST):
            return False
    return True
