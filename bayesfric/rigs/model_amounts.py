"""How wrong a machine's model is: amounts of its links' errors, by one joint or by several."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from bayesfric.arrays import Array
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import ModelError

OFF_FROM_SD = 3.3  # standard deviations, from which on a number is off
FELT = 0.1  # of a number's prior error, below which a change is not listed
LEAST_SHARE_TAKEN = (
    0.5  # of the variance that was believed, that data take at least of a number that is listed
)


@dataclass(frozen=True)
class ModelAmounts:
    """A normal density of C amounts that were N(0, 1) before the data.

    Parameters
    ----------
    mean : ndarray, shape (C,)
        Of the amounts.
    precision : ndarray, shape (C, C)
        Inverse covariance.
    root : ndarray, shape (P, C)
        By how much an amount of 1 moves each number of the model, in its unit.
    numbers : ndarray, shape (P,)
        Of the model as it stands.
    names : tuple of (str, str, str)
        Link, number and unit of each.
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
        """Return the amounts where K directions of them are known, and the rest is as before.

        Parameters
        ----------
        mean, covariance : ndarray, shape (K,) and (K, K)
            Of the directions.
        shares : ndarray, shape (K, C)
            Orthonormal directions.
        like : ModelAmounts
            Before the data.
        """
        inverse = np.linalg.inv(covariance)
        precision = like.precision + shares.T @ (inverse - np.eye(len(mean))) @ shares
        centre = np.linalg.solve(precision, shares.T @ (inverse @ mean))
        return replace(like, mean=np.asarray(centre, dtype=np.float64), precision=precision)

    def and_of(self, other: "ModelAmounts") -> "ModelAmounts":
        """Return the amounts given the independent data of two joints together."""
        precision = self.precision + other.precision - np.eye(self.mean.size)
        pulled = self.precision @ self.mean + other.precision @ other.mean
        mean = np.asarray(np.linalg.solve(precision, pulled), dtype=np.float64)
        return replace(self, mean=mean, precision=precision)


def model_errors(by_joint: Sequence[ModelAmounts]) -> tuple[ModelError, ...]:
    """Return the errors of those of a model's numbers that the data inform, the surest first.

    Parameters
    ----------
    by_joint : sequence of ModelAmounts
        Of the same model, a joint each; empty without one.
    """
    if not by_joint:
        return ()
    amounts = reduce(ModelAmounts.and_of, by_joint)
    mean = amounts.root @ amounts.mean
    sd = np.sqrt(np.einsum("pc,pc->p", amounts.root, _solved(amounts)))
    before = np.sqrt(np.sum(amounts.root**2, axis=1))
    listed = np.flatnonzero((before > 0) & (sd**2 < (1 - LEAST_SHARE_TAKEN) * before**2))
    ordered = sorted(listed, key=lambda place: -abs(mean[place]) / sd[place])
    errors = []
    for place in ordered:
        link, number, unit = amounts.names[place]
        centre, spread = float(mean[place]), float(sd[place])
        off = abs(centre) > OFF_FROM_SD * spread and abs(centre) > FELT * before[place]
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
    """Return the covariance of the amounts times each number's root, (P, C)."""
    return np.asarray(np.linalg.solve(amounts.precision, amounts.root.T).T)
