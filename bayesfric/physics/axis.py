"""A driven axis: mass, Coulomb friction and, on request, viscous friction.

With the drive force F, position q and friction against the motion,

    m q̈ = F − sign(q̇) (F_c + b |q̇|) − …

Where the axis turns, radians, N·m and kg·m² take the places of m, N and kg.
"""

from typing import NamedTuple

import numpy as np

from bayesfric.physics.friction import Coefficients


class AxisLaw(NamedTuple):
    """The law's numbers.

    Parameters
    ----------
    mass : float
        That moves [kg, or kg·m²].
    coulomb : float
        Friction whatever the speed [N, or N·m].
    viscous : float
        Friction per speed [N s/m, or N·m s/rad]; 0 where it is not asked for.
    """

    mass: float
    coulomb: float
    viscous: float = 0.0

    @classmethod
    def of(cls, law: Coefficients) -> "AxisLaw":
        """Return the law whose numbers stand where a diagnosis has c1, c2 and c3."""
        return cls(*(float(np.asarray(coefficient)) for coefficient in law))
