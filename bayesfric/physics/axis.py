"""A driven axis: mass, Coulomb friction and, on request, viscous friction.

With the drive force F, position q and friction against the motion,

    m q̈ = F − sign(q̇) (F_c + b |q̇|) − …

Where the axis turns, radians, N·m and kg·m² take the places of m, N and kg.
"""

from typing import NamedTuple

from numpy.typing import ArrayLike

from bayesfric.physics.friction import Coefficients

__all__ = ["AxisLaw"]


class AxisLaw(NamedTuple):
    """The law's numbers.

    Parameters
    ----------
    mass : array_like
        That moves [kg, or kg·m²].
    coulomb : array_like
        Friction whatever the speed [N, or N·m].
    viscous : array_like
        Friction per speed [N s/m, or N·m s/rad]; 0 where it is not asked for.
    """

    mass: ArrayLike
    coulomb: ArrayLike
    viscous: ArrayLike = 0.0

    @classmethod
    def of(cls, law: Coefficients) -> "AxisLaw":
        """Return the law whose numbers stand in the places of c1, c2 and c3."""
        return cls(*law)

    @property
    def in_places(self) -> Coefficients:
        """The numbers in the places of c1, c2 and c3, where a diagnosis keeps any law's."""
        return Coefficients(*self)
