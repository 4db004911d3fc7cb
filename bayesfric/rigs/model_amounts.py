"""Errors of the link parameters of a machine's model, estimated from one or more joints."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from bayesfric.arrays import Array
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import ModelError

SIGNIFICANT_SD = 3.3  # posterior sd: an error beyond this many is significant
NEGLIGIBLE_SHARE = 0.1  # share of the prior sd: smaller errors are never significant
LEAST_REDUCTION = 0.5  # of its prior variance, which data must remove for a number to be listed


@dataclass(frozen=True)
class ModelAmounts:
    """A normal density of C coefficients ("amounts") of model errors, with a prior N(0, 1) each.

    Parameters
    ----------
    mean : ndarray, shape (C,)
        Mean of the amounts.
    precision : ndarray, shape (C, C)
        Inverse covariance of the amounts.
    root : ndarray, shape (P, C)
        Change of each number of the model by an amount of 1, in the unit of the number.
    numbers : ndarray, shape (P,)
        Present values of the model's numbers.
    names : tuple of (str, str, str)
        Link, name and unit of each number.
    """

    mean: Array
    precision: Array
    root: Array
    numbers: Array
    names: tuple[tuple[str, str, str], ...]

    @classmethod
    def after_data(
        cls, mean: Array, covariance: Array, shares: Array, like: "ModelAmounts"
    ) -> "ModelAmounts":
        """Return the amounts, given the posterior of K directions; other directions keep the prior.

        Parameters
        ----------
        mean, covariance : ndarray, shape (K,) and (K, K)
            Posterior of the amounts along the directions.
        shares : ndarray, shape (K, C)
            Orthonormal directions.
        like : ModelAmounts
            The prior.
        """
        inverse = np.linalg.inv(covariance)
        precision = like.precision + shares.T @ (inverse - np.eye(len(mean))) @ shares
        centre = np.linalg.solve(precision, shares.T @ (inverse @ mean))
        return replace(like, mean=np.asarray(centre, dtype=np.float64), precision=precision)

    def combined_with(self, other: "ModelAmounts") -> "ModelAmounts":
        """Return the amounts given the independent data of two joints."""
        precision = self.precision + other.precision - np.eye(self.mean.size)
        weighted = self.precision @ self.mean + other.precision @ other.mean
        mean = np.asarray(np.linalg.solve(precision, weighted), dtype=np.float64)
        return replace(self, mean=mean, precision=precision)


def model_errors(by_joint: Sequence[ModelAmounts]) -> tuple[ModelError, ...]:
    """Return errors of a model's numbers that the data inform, the most significant first.

    Parameters
    ----------
    by_joint : sequence of ModelAmounts
        Amounts from the data of each joint, for the same model; empty without a model.
    """
    if not by_joint:
        return ()
    amounts = reduce(ModelAmounts.combined_with, by_joint)
    mean = amounts.root @ amounts.mean
    sd = np.sqrt(np.einsum("pc,pc->p", amounts.root, _covariance_with_numbers(amounts)))
    before = np.sqrt(np.sum(amounts.root**2, axis=1))
    listed = np.flatnonzero((before > 0) & (sd**2 < (1 - LEAST_REDUCTION) * before**2))
    ordered = sorted(listed, key=lambda place: -abs(mean[place]) / sd[place])
    errors = []
    for place in ordered:
        link, number, unit = amounts.names[place]
        centre, spread = float(mean[place]), float(sd[place])
        off = (
            abs(centre) > SIGNIFICANT_SD * spread and abs(centre) > NEGLIGIBLE_SHARE * before[place]
        )
        errors.append(
            ModelError(
                link=link,
                number=number,
                unit=unit,
                in_your_model=float(amounts.numbers[place]),
                error=Interval.of_normal(centre, spread),
                believed_sd=float(before[place]),
                significant=bool(off),
            )
        )
    return tuple(errors)


def _covariance_with_numbers(amounts: ModelAmounts) -> Array:
    """Return the covariance of each number with the amounts, (P, C)."""
    return np.asarray(np.linalg.solve(amounts.precision, amounts.root.T).T)
