"""Trials and recordings made again, as the fit expects them."""

from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array
from bayesfric.inference.model import RigLikelihood


@dataclass(frozen=True)
class Remade:
    """Friction as it would be measured, noise included.

    Parameters
    ----------
    apart : ndarray, shape (W, N)
        Of new trials, each on a new assembly of its own [N].
    together : ndarray, shape (W, N)
        Of the whole recording: trials of one assembly are on one new assembly [N].
    """

    apart: Array
    together: Array


def remake(
    likelihood: RigLikelihood,
    named: dict[str, Array],
    deviation: Array,
    rng: np.random.Generator,
) -> Remade:
    """Draw trials and recordings anew.

    Parameters
    ----------
    likelihood : RigLikelihood
        Of the fit.
    named : dict of str to ndarray, shape (W,)
        Posterior draws by parameter.
    deviation : ndarray, shape (W, N)
        Relative scatter of new trials, each on an assembly of its own.
    rng : Generator
        For the noise, and for the scatter of whole recordings.
    """
    together = likelihood.draw_scatter(named, rng, together=True)
    return Remade(*likelihood.draw_observed(named, np.stack([deviation, together]), rng))
