"""What a fit is asked of a rig's trials, and what holds them at rest."""

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
    """A fit, from which predictions are made.

    Parameters
    ----------
    likelihood : RigLikelihood
        Of the rig.
    law : FrictionLaw
        The friction law of the fit.
    named : dict of str to ndarray, shape (W,)
        Posterior draws by parameter.
    factor : ndarray, shape (W, N)
        Friction over that of the law, for new trials on new assemblies.
    remade : Remade
        New trials, and whole recordings made again.
    rng : Generator
        For further recordings made again.
    """

    likelihood: RigLikelihood
    law: FrictionLaw
    named: dict[str, Array]
    factor: Array
    remade: Remade
    rng: np.random.Generator

    @property
    def medians(self) -> dict[str, Array]:
        """Of each parameter, of shape (1,)."""
        return {name: np.median(draws, keepdims=True) for name, draws in self.named.items()}


@dataclass(frozen=True)
class Resting:
    """What friction has to hold at rest.

    Parameters
    ----------
    tension_n : ndarray, shape (C,)
        Tension of the cable at rest [N].
    drive_n : ndarray, shape (C,)
        Force that would move it [N].
    """

    tension_n: Array
    drive_n: Array
