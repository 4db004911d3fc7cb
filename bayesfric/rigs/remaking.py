"""Draws of new trials and of replicated recordings from the posterior predictive."""

from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array
from bayesfric.inference.model import RigLikelihood


@dataclass(frozen=True)
class Remade:
    """Draws of measured friction, with noise.

    Parameters
    ----------
    apart : ndarray, shape (W, N)
        Friction of new trials, each on a new assembly of its own [N].
    together : ndarray, shape (W, N)
        Friction in replicates of the whole recording: trials of an assembly share a new one [N].
    """

    apart: Array
    together: Array


def remake(
    likelihood: RigLikelihood,
    named: dict[str, Array],
    deviation: Array,
    rng: np.random.Generator,
) -> Remade:
    """Draw new trials and replicated recordings.

    Parameters
    ----------
    likelihood : RigLikelihood
        Likelihood of the fit.
    named : dict of str to ndarray, shape (W,)
        Posterior draws of each parameter.
    deviation : ndarray, shape (W, N)
        Relative deviations of new trials, each on an assembly of its own.
    rng : Generator
        Source of randomness for noise and for the scatter of replicated recordings.
    """
    together = likelihood.draw_scatter(named, rng, together=True)
    return Remade(*likelihood.draw_observed(named, np.stack([deviation, together]), rng))
