"""Errors of a machine model's link parameters, estimated from the data of one or more joints."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from bayesfric.arrays import Array
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import ModelError

OFF_FROM_SD = 3.3  # least significant error of a parameter [posterior sd]
LEAST_CHANGE = 0.1  # least significant error of a parameter [prior sd]
LEAST_VARIANCE_REDUCTION = 0.5  # least relative reduction of the prior variance, to be listed


@dataclass(frozen=True)
class ModelAmounts:
    """A normal density of C amounts, whose priors are N(0, 1).

    Errors of the model's P parameters are linear combinations of these amounts.

    Parameters
    ----------
    mean : ndarray, shape (C,)
        Mean of the amounts.
    precision : ndarray, shape (C, C)
        Inverse covariance of the amounts.
    root : ndarray, shape (P, C)
        Change of each parameter by an amount of 1, in the parameter's unit.
    numbers : ndarray, shape (P,)
        Present values of the parameters in the model.
    names : tuple of (str, str, str)
        Link, name and unit of each parameter.
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
        """Return the amounts after data that inform K directions of them.

        Parameters
        ----------
        mean, covariance : ndarray, shape (K,) and (K, K)
            Posterior mean and covariance of the amounts of the directions.
        shares : ndarray, shape (K, C)
            Orthonormal directions.
        like : ModelAmounts
            The amounts before the data.
        """
        inverse = np.linalg.inv(covariance)
        precision = like.precision + shares.T @ (inverse - np.eye(len(mean))) @ shares
        centre = np.linalg.solve(precision, shares.T @ (inverse @ mean))
        return replace(like, mean=np.asarray(centre, dtype=np.float64), precision=precision)

    def and_of(self, other: "ModelAmounts") -> "ModelAmounts":
        """Return the amounts given the independent data of both joints."""
        precision = self.precision + other.precision - np.eye(self.mean.size)
        pulled = self.precision @ self.mean + other.precision @ other.mean
        mean = np.asarray(np.linalg.solve(precision, pulled), dtype=np.float64)
        return replace(self, mean=mean, precision=precision)


def model_errors(by_joint: Sequence[ModelAmounts]) -> tuple[ModelError, ...]:
    """Return the errors of the model's parameters that the data inform, the most certain first.

    Parameters
    ----------
    by_joint : sequence of ModelAmounts
        Amounts of the same model by the data of each joint; empty without a model.
    """
    if not by_joint:
        return ()
    amounts = reduce(ModelAmounts.and_of, by_joint)
    mean = amounts.root @ amounts.mean
    sd = np.sqrt(np.einsum("pc,pc->p", amounts.root, _solved(amounts)))
    before = np.sqrt(np.sum(amounts.root**2, axis=1))
    listed = np.flatnonzero((before > 0) & (sd**2 < (1 - LEAST_VARIANCE_REDUCTION) * before**2))
    ordered = sorted(listed, key=lambda place: -abs(mean[place]) / sd[place])
    errors = []
    for place in ordered:
        link, number, unit = amounts.names[place]
        centre, spread = float(mean[place]), float(sd[place])
        off = abs(centre) > OFF_FROM_SD * spread and abs(centre) > LEAST_CHANGE * before[place]
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


def _solved(amounts: ModelAmounts) -> Array:
    """Return each parameter's row of `root` times the covariance of the amounts, (P, C)."""
    return np.asarray(np.linalg.solve(amounts.precision, amounts.root.T).T)
