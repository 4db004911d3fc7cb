"""The cable of the gravity board as a spring: model (3) of the paper."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.arrays import Array

LINEAR_DENSITY_KG_M = 1.4e-3  # steel that fills 0.6 of a circle of 0.61 mm


class Cable(NamedTuple):
    """The cable as a spring and a damper; the defaults are assumptions.

    Parameters
    ----------
    axial_stiffness_n : array_like
        EA [N]; 0.61 mm 7×19 stainless steel has 14 to 16 kN.
    length_m : array_like
        Between the masses [m].
    damping_ratio : array_like
        Of the masses ringing against each other, over the critical [-].
    """

    axial_stiffness_n: ArrayLike = 15e3
    length_m: ArrayLike = 1.6
    damping_ratio: ArrayLike = 0.05

    @property
    def stiffness_n_m(self) -> Array:
        """The spring constant k = EA / L [N/m]."""
        stiffness = np.asarray(self.axial_stiffness_n, dtype=np.float64)
        return stiffness / np.asarray(self.length_m, dtype=np.float64)

    @property
    def wave_time_s(self) -> Array:
        """How long a stretch takes from one mass to the other, L / √(EA / μ) [s]."""
        stiffness = np.asarray(self.axial_stiffness_n, dtype=np.float64)
        return np.asarray(self.length_m, dtype=np.float64) / np.sqrt(
            stiffness / LINEAR_DENSITY_KG_M
        )
