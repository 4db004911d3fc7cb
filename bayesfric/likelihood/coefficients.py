"""c1, c2, c3 of each pulley size as parameters, shared by the likelihoods of the rigs."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.analysis import Analysis
from bayesfric.friction import Coefficients
from bayesfric.priors import Parameter

__all__ = ["SizeIndex", "coefficient_parameters"]

Array = NDArray[np.float64]
UNITS = {"c1": "1", "c2": "N", "c3": "1/deg"}
PAPER_SIZES = ("small", "medium", "large")


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
            parameters.append(Parameter(f"{name}[{size}]", unit, prior))
    return tuple(parameters)
