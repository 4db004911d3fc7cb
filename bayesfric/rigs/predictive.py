"""Inputs of predictions of a rig's trials, and conditions at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from bayesfric.arrays import Array
    from bayesfric.inference.model import RigLikelihood
    from bayesfric.physics.laws import FrictionLaw
    from bayesfric.rigs.remaking import Remade


@dataclass(frozen=True)
class Predictive:
    """A fit with replicated trials, from which predictions are made.

    Parameters
    ----------
    likelihood : RigLikelihood
        Likelihood of the rig.
    law : FrictionLaw
        Friction law of the fit.
    named : dict of str to ndarray, shape (W,)
        Posterior draws of each parameter.
    factor : ndarray, shape (W, N)
        Friction of new trials on new assemblies, relative to that of the law.
    remade : Remade
        Measured friction of new trials and of replicates of the whole recording.
    rng : Generator
        Source of randomness for further replicates.
    """

    likelihood: RigLikelihood
    law: FrictionLaw
    named: dict[str, Array]
    factor: Array
    remade: Remade
    rng: np.random.Generator

    @property
    def medians(self) -> dict[str, Array]:
        """Posterior median of each parameter, shape (1,)."""
        return {name: np.median(draws, keepdims=True) for name, draws in self.named.items()}


@dataclass(frozen=True)
class Resting:
    """Tension and driving force at rest in C conditions.

    Parameters
    ----------
    tension_n : ndarray, shape (C,)
        Tension of the cable at rest [N].
    drive_n : ndarray, shape (C,)
        Driving force, which friction at rest must balance [N].
    """

    tension_n: Array
    drive_n: Array
