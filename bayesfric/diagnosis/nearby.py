"""A model linearised around a fitted law, or around a law on the way to it.

Effects are relative to the friction of the law. Several effects together may replace the law, for
example a fall and a rise with speed that were measured at few speeds. The fitted law then has
hardly any friction, so that relative effects and scatter have no meaning.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from bayesfric.diagnosis.forms import Form
from bayesfric.diagnosis.model import LinearModel
from bayesfric.effects.candidates import Candidate
from bayesfric.physics.friction import Coefficients

FARTHEST = 1.5  # largest ratio of friction between the two laws, in either direction
STEPS = (1.0, 0.5, 0.25)  # fractions of the way that are tried
ROUNDING = 1e-300


def around_nearby(
    model: LinearModel,
    laws: Mapping[str, Coefficients],
    candidates: Sequence[Candidate],
    *,
    scattering: Sequence[tuple[Candidate, float]],
    forms: Sequence[Form],
) -> tuple[LinearModel, bool]:
    """Return the model around other laws or on the way to them, and whether that is the last step.

    It is the last step if the model is around the other laws, or cannot come closer.

    Parameters
    ----------
    model : LinearModel
        Model around the previous laws.
    laws : mapping of str to Coefficients
        The fitted laws, by pulley size.
    candidates, scattering, forms
        As for :meth:`~bayesfric.diagnosis.model.LinearModel.around`.
    """
    for step in (*STEPS, 0.0):
        part = {size: _between(model.laws[size], law, step) for size, law in laws.items()}
        around = model.around(part, candidates, scattering=scattering, forms=forms)
        if step == 0.0 or _is_near(model, around):
            break
    return around, step in (1.0, 0.0)


def _between(first: Coefficients, other: Coefficients, step: float) -> Coefficients:
    mixed = (1 - step) * np.array(first) + step * np.array(other)
    return Coefficients(*mixed.tolist())


def _is_near(model: LinearModel, around: LinearModel) -> bool:
    """Return whether the friction of every trial is similar in both models."""
    for before, after in zip(model.rigs, around.rigs, strict=True):
        first, other = (np.maximum(rig.rows.friction_n, ROUNDING) for rig in (before, after))
        if np.abs(np.log(other / first)).max(initial=0.0) > np.log(FARTHEST):
            return False
    return True
