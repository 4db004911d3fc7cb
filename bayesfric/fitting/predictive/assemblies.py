"""Leave-one-assembly-out checks: the deviation of each assembly from its prediction.

Given the parameters, assemblies are independent. If the model is right, their leave-one-out
probabilities are therefore nearly independent and uniform: they depend on each other only through
the parameters, which all assemblies inform.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
import scipy
import xarray as xr
from scipy.special import ndtr, ndtri

from bayesfric.arrays import Array
from bayesfric.fitting.predictive.left_out import FromUniform, LeftOut, scores, uniformity
from bayesfric.schemas.base import QUANTILES

FAR_SD = 3.0  # standard deviations; assemblies farther away are named
FEWEST = 5  # least number of assemblies for a check of their distribution
SETS_AGAIN = 2000  # simulated sets of independent uniform probabilities


@dataclass(frozen=True)
class Assemblies:
    """Leave-one-out results of a rig's assemblies.

    Parameters
    ----------
    names : tuple of str
        Names of J assemblies.
    pit : ndarray, shape (J,)
        Leave-one-out CDF value of each assembly's friction.
    uniformity : FromUniform
        Deviation of these from a uniform distribution.
    without : mapping of str to ndarray, shape (J,)
        Posterior mean of each coefficient without the assembly.
    """

    names: tuple[str, ...]
    pit: Array
    uniformity: FromUniform
    without: Mapping[str, Array] = field(default_factory=dict)

    @property
    def z(self) -> Array:
        """Normal scores, shape (J,); positive for more friction than predicted."""
        return scores(self.pit)

    def chance(self, z: float) -> float:
        """Return the probability of an assembly as far out in a recording from the model."""
        return float(-np.expm1(self.pit.size * np.log1p(-2 * ndtr(-abs(z)))))

    def table(self, trials: pd.DataFrame) -> xr.Dataset:
        """Return the data of the figure, in the order of the scores.

        Parameters
        ----------
        trials : DataFrame
            Trials of the rig, with ``setup``.

        Returns
        -------
        Dataset
            By ``assembly``: ``z``, ``pit``, ``trials``, its condition, and ``expected``,
            quantiles of the score of the same rank among independent normal scores. By
            ``probability``: ``pit_difference`` and ``pit_band``.
        """
        order = np.argsort(self.z)
        rank = np.arange(1, order.size + 1)
        expected = scipy.stats.beta.ppf(
            np.array(QUANTILES), rank[:, None], order.size + 1 - rank[:, None]
        )
        own = trials.groupby("setup", sort=False)
        names = [self.names[place] for place in order]
        condition = [c for c in ("pulley_size", "n_pulleys", "wrap_angle_deg") if c in trials]
        return xr.Dataset(
            {
                "z": ("assembly", self.z[order]),
                "pit": ("assembly", self.pit[order]),
                "trials": ("assembly", own.size().loc[names].to_numpy()),
                "expected": (("assembly", "quantile"), ndtri(expected)),
                "far": FAR_SD,
                "pit_difference": ("probability", self.uniformity.difference),
                "pit_band": (
                    ("end", "probability"),
                    np.stack([self.uniformity.low, self.uniformity.high]),
                ),
            }
            | {name: ("assembly", own[name].first().loc[names].to_numpy()) for name in condition},
            coords={
                "assembly": names,
                "quantile": list(QUANTILES),
                "probability": self.uniformity.grid,
            },
        )


def assemblies_of(left: LeftOut, setups: tuple[str, ...], seed: int) -> Assemblies | None:
    """Return the leave-one-out results of assemblies; None for fewer than five.

    Parameters
    ----------
    left : LeftOut
        Leave-one-out predictions of the rig.
    setups : tuple of str
        Names of the assemblies.
    seed : int
        Seed of the simulated sets for the band.
    """
    there = np.isfinite(left.setup_pit)
    if left.setup_pit.size == 0 or there.sum() < FEWEST:
        return None
    pit = left.setup_pit[there]
    rng = np.random.default_rng(np.random.SeedSequence([seed, 5]))
    names = tuple(name for name, present in zip(setups, there, strict=True) if present)
    uniform = uniformity(pit, rng.uniform(size=(SETS_AGAIN, pit.size)))
    without = {name: means[there] for name, means in left.without.items()}
    return Assemblies(names, pit, uniform, without)
