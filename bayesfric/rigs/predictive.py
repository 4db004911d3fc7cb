"""The parts of a fit from which a rig predicts its trials, and the load of a trial at rest."""

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
    """The parts of a fit from which a rig predicts its trials.

    Parameters
    ----------
    likelihood : RigLikelihood
        Likelihood of the rig.
    law : FrictionLaw
        The friction law of the fit.
    named : dict of str to ndarray, shape (W,)
        Posterior draws by parameter.
    factor : ndarray, shape (W, N)
        Ratio of friction to that of the law, for new trials on new assemblies.
    remade : Remade
        Replicates of trials, and of whole recordings.
    rng : Generator
        Source of randomness for further replicates of recordings.
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
    """The load of a trial at rest.

    Parameters
    ----------
    tension_n : ndarray, shape (C,)
        Tension of the cable at rest [N].
    drive_n : ndarray, shape (C,)
        Drive force, which friction at rest balances [N].
    """

    tension_n: Array
    drive_n: Array
