"""c1, c2, c3 of each pulley size as parameters, shared by the likelihoods of the rigs."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from bayesfric.analysis import Analysis
from bayesfric.inference.priors import Parameter
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG, Coefficients

__all__ = ["SizeIndex", "coefficient_parameters"]

Array = NDArray[np.float64]
UNITS = {"c1": "1", "c2": "N", "c3": "1/deg"}
PAPER_SIZES = ("small", "medium", "large")
LEAST_C1 = 1e-4  # a start above zero, where least squares does not give one
LEAST_C2_N = 1e-3


@dataclass(frozen=True)
class SizeIndex:
    """Which pulley size each of N trials has.

    Parameters
    ----------
    sizes : tuple of str
        The paper's from small to large, then a user's own by name.
    of_trial : ndarray of int, shape (N,)
        Place in `sizes`.
    """

    sizes: tuple[str, ...]
    of_trial: NDArray[np.intp]

    @classmethod
    def of(cls, pulley_size: "pd.Series[str]") -> "SizeIndex":
        """Index a column of sizes."""
        known = {size: place for place, size in enumerate(PAPER_SIZES)}
        sizes = sorted(set(pulley_size), key=lambda size: (known.get(size, len(known)), size))
        return cls(tuple(sizes), pd.Index(sizes).get_indexer(pd.Index(pulley_size)))

    def spread(self, theta: Mapping[str, Array], name: str) -> Array:
        """Return ``name[size]`` for the size of each trial, shape (W, N)."""
        by_size = np.stack([theta[f"{name}[{size}]"] for size in self.sizes], axis=-1)
        return by_size[:, self.of_trial]

    def coefficients(self, theta: Mapping[str, Array]) -> Coefficients:
        """Return the law of each trial, arrays of shape (W, N)."""
        return Coefficients(*(self.spread(theta, name) for name in Coefficients._fields))

    def rough_coefficients(
        self,
        n_pulleys: ArrayLike,
        wrap_angle_deg: ArrayLike,
        tension_n: ArrayLike,
        friction_n: ArrayLike,
    ) -> dict[str, float]:
        """Return c1, c2, c3 of each size by least squares, a place to climb from.

        Parameters
        ----------
        n_pulleys, wrap_angle_deg, tension_n, friction_n : array_like, shape (N,)
            Number of pulleys, wrap angle [deg], nominal tension [N] and observed
            size of friction [N] of each trial.

        Returns
        -------
        dict of str to float
            Least-norm where the trials leave a coefficient open; c1 and c2 above 0.
        """
        n, tension = np.asarray(n_pulleys), np.asarray(tension_n)
        wrap = np.asarray(wrap_angle_deg) - REFERENCE_WRAP_ANGLE_DEG
        columns = np.stack([n * tension, n, n * tension * wrap], axis=1)
        rough = {}
        for place, size in enumerate(self.sizes):
            rows = self.of_trial == place
            width = np.abs(columns[rows]).max(axis=0)
            width[width == 0] = 1.0
            friction = np.asarray(friction_n)[rows]
            scaled = np.linalg.lstsq(columns[rows] / width, friction, rcond=1e-3)[0]
            c1, c2, c3 = (float(value) for value in scaled / width)
            rough[f"c1[{size}]"] = max(c1, LEAST_C1)
            rough[f"c2[{size}]"] = max(c2, LEAST_C2_N)
            rough[f"c3[{size}]"] = c3
        return rough


def coefficient_parameters(sizes: tuple[str, ...], analysis: Analysis) -> tuple[Parameter, ...]:
    """Return c1, c2, c3 of each size, with the priors of the analysis.

    Parameters
    ----------
    sizes : tuple of str
        Pulley sizes.
    analysis : Analysis
        Its priors, and those of single sizes.
    """
    priors = analysis.priors
    parameters = []
    for name, unit in UNITS.items():
        for size in sizes:
            override = getattr(priors.pulleys.get(size), name, None)
            prior = override or getattr(priors, name)
            parameters.append(Parameter(f"{name}[{size}]", unit, prior, "coefficient", linear=True))
    return tuple(parameters)
