"""Integrates deviations that rows of a group, and of its assembly, share, in closed form."""

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
    """R deviations that the rows of a group share, integrated out.

    Row i changes by ``u_i`` (R,) times the deviations of its group, which are independent and
    normal. Sums are over the rows of a group, weighted by their precision.

    Parameters
    ----------
    columns : ndarray, shape (G, R, k)
        Sums of ``u_i x_iᵀ``, with the columns x of the numbers.
    response : ndarray, shape (G, R)
        Sums of ``u_i y_i``, with the response y.
    stiffness : ndarray, shape (G, R, R)
        Sums of ``u_i u_iᵀ``.
    taken : ndarray, shape (G, R, R)
        Posterior covariance of the deviations, given the numbers.
    pulled, log_determinant : float
        Decrease of the squared response, and increase of the log determinant of its covariance.
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
        """Integrate out deviations with standard deviations `sd`, (R,) or (G, R)."""
        taken, log_determinant = taken_up(stiffness, sd)
        pulled = float((response * (taken @ response[:, :, None])[:, :, 0]).sum())
        return cls(columns, response, stiffness, taken, pulled, float(log_determinant.sum()))

    @property
    def constant(self) -> float:
        """Increase of the log density."""
        return 0.5 * (self.pulled - self.log_determinant)

    def left(self, sums: Array) -> Array:
        """Return sums of groups, (G, R, …), minus the part that their deviations absorb."""
        rest = math.prod(sums.shape[2:])  # -1 would be ambiguous without groups
        lost = self.stiffness @ (self.taken @ sums.reshape(*sums.shape[:2], rest))
        return np.asarray(sums - lost.reshape(sums.shape))

    def taken_by(self, groups: Flags) -> tuple[Array, Array]:
        """Return what some groups' deviations subtract from precision, (k, k), and slope, (k,)."""
        columns = self.columns[groups]
        shares = self.taken[groups] @ columns
        flat = shares.reshape(-1, columns.shape[2])
        return (
            np.asarray(flat.T @ columns.reshape(flat.shape)),
            np.asarray(flat.T @ self.response[groups].ravel()),
        )


@dataclass(frozen=True)
class NestedDeviations:
    """Deviations of groups of rows, and of assemblies of groups, with the same effect on rows.

    Parameters
    ----------
    group, setup : SharedDeviation
        Deviations of the G groups, then those of the J assemblies after them.
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
        """Integrate out the deviations of groups, then those of assemblies.

        Parameters
        ----------
        moved : ndarray, shape (N, R)
            Change of a row by each deviation of 1.
        pulls, columns, response : ndarray, shape (N, R), (N, k) and (N,)
            `moved`, the columns of the numbers, and the observations, each multiplied by the
            precision of the rows' own errors.
        by_group, by_setup : sparse arrays, shape (G, N) and (J, G)
            Membership of rows in groups, and of groups in assemblies, from :func:`indicator`.
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
        """Return what some of them subtract from precision, (k, k), and slope, (k,)."""
        first, second = self.group.taken_by(groups), self.setup.taken_by(setups)
        return first[0] + second[0], first[1] + second[1]

    def of_groups(self) -> tuple[Array, Array, Array]:
        """Return sums over each group's rows, minus the part that all deviations absorb.

        Returns
        -------
        columns, response, own : ndarray, shape (G, R, k), (G, R) and (G, R)
            Input of :func:`second_moments`, for each deviation of a group.
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
        """Return the parts of a row that the deviations absorb, over its ``pulls``.

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
    """Return the posterior covariance and log determinant of integrated deviations.

    Parameters
    ----------
    gram : ndarray, shape (…, R, R)
        Products of the columns of R deviations, weighted by the precision of the rows.
    sd : array_like, shape (R,) or (…, R)
        Standard deviations of the deviations.
    sign : array_like, shape (R,), or float
        −1 for a deviation whose variance is subtracted, else 1.

    Returns
    -------
    taken : ndarray, shape (…, R, R)
        (D⁻¹ + G)⁻¹, their covariance given everything else.
    log_determinant : ndarray, shape (…)
        log |1 + D G|.
    """
    scale = np.asarray(sd, dtype=np.float64)
    whole = scale[..., :, None] * gram * scale[..., None, :]
    whole = whole + np.eye(gram.shape[-1]) * np.asarray(sign)
    inverse, log_determinant = inverted(whole)
    return scale[..., :, None] * inverse * scale[..., None, :], log_determinant


def squares_left(columns: Array, response: Array, mean: Array, covariance: Array) -> Array:
    """Return the posterior mean of squared residuals, (…), with uncertain numbers.

    Parameters
    ----------
    columns : ndarray, shape (…, k)
        Columns of k numbers.
    response : ndarray, shape (…)
        Observed responses.
    mean, covariance : ndarray, shape (k,) and (k, k)
        Posterior moments of the numbers.
    """
    flat = columns.reshape(-1, columns.shape[-1])
    spread = np.einsum("ij,ij->i", flat @ covariance, flat)
    square = (response.ravel() - flat @ mean) ** 2 + spread
    return np.asarray(square.reshape(response.shape))


def indicator(codes: Whole, count: int) -> csr_array:
    """Return the membership of N rows in `count` groups, (count, N)."""
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
