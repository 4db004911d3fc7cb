"""Deviations that rows share, integrated out in closed form: of a group, and of its assembly."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.inference.symmetric import inverted


@dataclass(frozen=True)
class SharedDeviation:
    """R deviations that rows of a group share, integrated out.

    A row i moves by ``u_i`` (R,) times the deviations of its group, which are independent and
    normal. Sums are over the rows of a group, weighted by their precision.

    Parameters
    ----------
    columns : ndarray, shape (G, R, k)
        Of ``u_i x_iᵀ``, with the columns x of the numbers.
    response : ndarray, shape (G, R)
        Of ``u_i y_i``, with the response y.
    stiffness : ndarray, shape (G, R, R)
        Of ``u_i u_iᵀ``.
    taken : ndarray, shape (G, R, R)
        Posterior covariance of the deviations, the numbers known.
    pulled, log_determinant : float
        By what the square of the responses is less, and the log determinant of their covariance
        more.
    """

    columns: Array
    response: Array
    stiffness: Array
    taken: Array
    pulled: float
    log_determinant: float

    @classmethod
    def of(
        cls, columns: Array, response: Array, stiffness: Array, sd: ArrayLike
    ) -> "SharedDeviation":
        """Integrate deviations of these standard deviations, (R,) or (G, R), out."""
        taken, log_determinant = taken_up(stiffness, sd)
        pulled = float((response * (taken @ response[:, :, None])[:, :, 0]).sum())
        return cls(columns, response, stiffness, taken, pulled, float(log_determinant.sum()))

    @property
    def constant(self) -> float:
        """What the log density is more."""
        return 0.5 * (self.pulled - self.log_determinant)

    def left(self, sums: Array) -> Array:
        """Return sums of groups, (G, R, …), without what their deviations take up."""
        rest = math.prod(sums.shape[2:])  # -1 would be any number where no group is left
        lost = self.stiffness @ (self.taken @ sums.reshape(*sums.shape[:2], rest))
        return np.asarray(sums - lost.reshape(sums.shape))

    def taken_by(self, groups: Flags) -> tuple[Array, Array]:
        """Return what some groups' deviations take from precision, (k, k), and slope, (k,)."""
        columns = self.columns[groups]
        shares = self.taken[groups] @ columns
        flat = shares.reshape(-1, columns.shape[2])
        return (
            np.asarray(flat.T @ columns.reshape(flat.shape)),
            np.asarray(flat.T @ self.response[groups].ravel()),
        )


@dataclass(frozen=True)
class NestedDeviations:
    """Deviations of groups of rows, and of assemblies of groups, that move rows alike.

    Parameters
    ----------
    group, setup : SharedDeviation
        Of the G groups, then of the J assemblies, what the groups' take up taken off.
    setup_of : ndarray of int, shape (G,)
        Assembly of each group.
    """

    group: SharedDeviation
    setup: SharedDeviation
    setup_of: Whole

    @classmethod
    def of(
        cls,
        moved: Array,
        pulls: Array,
        columns: Array,
        response: Array,
        by_group: csr_array,
        by_setup: csr_array,
        sd: tuple[Sequence[float], Sequence[float]],
    ) -> "NestedDeviations":
        """Integrate the deviations of groups out, then those of assemblies.

        Parameters
        ----------
        moved : ndarray, shape (N, R)
            By what each deviation of 1 moves a row.
        pulls, columns, response : ndarray, shape (N, R), (N, k) and (N,)
            The same, the columns of the numbers and what was observed, each multiplied by
            the precision of the rows' own errors.
        by_group, by_setup : sparse arrays, shape (G, N) and (J, G)
            Which rows are a group's, and which groups an assembly's, as of :func:`indicator`.
        sd : pair of sequences of float, (R,) each
            Standard deviations of a group's and of an assembly's deviations.
        """
        group = SharedDeviation.of(
            _summed(by_group, moved[:, :, None] * columns[:, None, :]),
            _summed(by_group, moved * response[:, None]),
            _summed(by_group, moved[:, :, None] * pulls[:, None, :]),
            sd[0],
        )
        setup = SharedDeviation.of(
            _summed(by_setup, group.left(group.columns)),
            _summed(by_setup, group.left(group.response)),
            _summed(by_setup, group.left(group.stiffness)),
            sd[1],
        )
        setup_of = np.asarray(by_setup.tocsc().indices, dtype=np.intp)
        return cls(group, setup, setup_of)

    @property
    def constant(self) -> float:
        """The constant that the deviations add to the log density."""
        return self.group.constant + self.setup.constant

    def taken_by(self, groups: Flags, setups: Flags) -> tuple[Array, Array]:
        """Return what is taken from precision, (k, k), and slope, (k,), by some of them."""
        first, second = self.group.taken_by(groups), self.setup.taken_by(setups)
        return first[0] + second[0], first[1] + second[1]

    def of_groups(self) -> tuple[Array, Array, Array]:
        """Return sums over each group's rows that all deviations are taken off.

        Returns
        -------
        columns, response, own : ndarray, shape (G, R, k), (G, R) and (G, R)
            As :func:`second_moments` takes them, of each of a group's deviations.
        """
        group, setup = self.group, self.setup
        along = group.left(group.stiffness)
        above = along @ setup.taken[self.setup_of]
        columns = group.left(group.columns) - above @ setup.columns[self.setup_of]
        response = group.left(group.response)
        response = response - np.einsum("grs,gs->gr", above, setup.response[self.setup_of])
        own = along - above @ along.swapaxes(1, 2)
        return columns, response, np.einsum("grr->gr", own)

    def of_setups(self) -> tuple[Array, Array, Array]:
        """Return the same over each assembly's rows, (J, R, k), (J, R) and (J, R)."""
        setup = self.setup
        own = np.einsum("grr->gr", setup.left(setup.stiffness))
        return setup.left(setup.columns), setup.left(setup.response), own

    def of_rows(self) -> tuple[Array, Array, Array]:
        """Return the parts of a row that the deviations take up, over its ``pulls``.

        Returns
        -------
        columns, response, variance : ndarray, shape (G, R, k), (G, R) and (G, R, R)
            By group.
        """
        group, setup, at = self.group, self.setup, self.setup_of
        free = np.eye(group.taken.shape[1]) - group.taken @ group.stiffness
        above = free @ setup.taken[at]
        return (
            group.taken @ group.columns + above @ setup.columns[at],
            np.einsum("grs,gs->gr", group.taken, group.response)
            + np.einsum("grs,gs->gr", above, setup.response[at]),
            group.taken + above @ free.swapaxes(1, 2),
        )


def taken_up(gram: Array, sd: ArrayLike, sign: ArrayLike = 1.0) -> tuple[Array, Array]:
    """Return what deviations that are integrated out take up of their sums.

    Parameters
    ----------
    gram : ndarray, shape (…, R, R)
        Products of the columns of R deviations, weighted by the precision of the rows.
    sd : array_like, shape (R,) or (…, R)
        Their standard deviations.
    sign : array_like, shape (R,), or float
        −1 of one that takes its variance away from what others have more.

    Returns
    -------
    taken : ndarray, shape (…, R, R)
        (D⁻¹ + G)⁻¹, their covariance with all else known.
    log_determinant : ndarray, shape (…)
        log |1 + D G|.
    """
    scale = np.asarray(sd, dtype=np.float64)
    whole = scale[..., :, None] * gram * scale[..., None, :]
    whole = whole + np.eye(gram.shape[-1]) * np.asarray(sign)
    inverse, log_determinant = inverted(whole)
    return scale[..., :, None] * inverse * scale[..., None, :], log_determinant


def squares_left(columns: Array, response: Array, mean: Array, covariance: Array) -> Array:
    """Return the mean squares of responses less columns, (…), of numbers that are uncertain.

    Parameters
    ----------
    columns : ndarray, shape (…, k)
        Of k numbers.
    response : ndarray, shape (…)
        From which they are taken.
    mean, covariance : ndarray, shape (k,) and (k, k)
        Of the numbers.
    """
    flat = columns.reshape(-1, columns.shape[-1])
    spread = np.einsum("ij,ij->i", flat @ covariance, flat)
    square = (response.ravel() - flat @ mean) ** 2 + spread
    return np.asarray(square.reshape(response.shape))


def indicator(codes: Whole, count: int) -> csr_array:
    """Return which of N rows belongs to which of `count` groups, (count, N)."""
    ones = np.ones(codes.size)
    return csr_array((ones, (codes, np.arange(codes.size))), shape=(count, codes.size))


def _summed(groups: csr_array, values: Array) -> Array:
    """Return sums over the rows of each group, (G, …), of values (N, …)."""
    flat = groups @ values.reshape(len(values), int(np.prod(values.shape[1:])))
    return np.asarray(flat.reshape(groups.shape[0], *values.shape[1:]))


def second_moments(
    columns: Array,
    response: Array,
    own: Array,
    size: Whole,
    mean: Sequence[Array],
    covariance: Sequence[Array],
) -> Array:
    """Return twice the derivative of the log evidence by a variance added to each row or group."""
    moments = np.empty(own.size)
    for which, (m, v) in enumerate(zip(mean, covariance, strict=True)):
        mine = size == which
        moments[mine] = squares_left(columns[mine], response[mine], m, v)
    return moments - own
