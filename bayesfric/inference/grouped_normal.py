"""The joint normal density of measurements in groups, computed group by group.

The M measurements have the covariance

    Σ = diag(d) + Σ_k u_k u_kᵀ within each group + B Bᵀ,

where d are the variances of independent errors. Each group has its own deviations, such as that of
the friction of an assembly; u_k is the shift of the measurements by one standard deviation of the
k-th. B are the columns of a curve that all measurements share, whose coefficients have priors
N(0, 1). The deviations are integrated out group by group, and the coefficients of the curve last.
Until then all terms are sums over groups, so a group is left out by subtracting its terms.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from bayesfric.arrays import Array
from bayesfric.inference.priors import LOG_2PI as LOG_2PI
from bayesfric.inference.quadratic import eliminate, gram, matrices

LARGEST_CONDITION = 1e12  # condition number of a precision from which rounding errors matter


@dataclass(frozen=True)
class Groups:
    """Which measurements belong to which group; those of one group are adjacent.

    Parameters
    ----------
    starts : ndarray of int, shape (G,)
        Index of the first measurement of each group, ascending, the first being 0.
    count : int
        Number of measurements M.
    """

    starts: NDArray[np.intp]
    count: int

    @property
    def of_each(self) -> NDArray[np.intp]:
        """The group of each measurement, shape (M,)."""
        marks = np.zeros(self.count, dtype=np.intp)
        marks[self.starts[1:]] = 1
        return np.cumsum(marks)

    def total(self, values: Array) -> Array:
        """Sum the last axis (M) over each group (G)."""
        return np.add.reduceat(values, self.starts, axis=-1)


class _Sums(NamedTuple):
    """The terms of a set of measurements in the log density, arrays of shape (…).

    Parameters
    ----------
    size : ndarray
        Number of measurements.
    log_determinant : ndarray
        Log determinant of their covariance without the curve.
    form : ndarray, shape (triangle, …)
        Quadratic form in the curve's coefficients and the residual.
    """

    size: Array
    log_determinant: Array
    form: Array

    def log_density(self, shared: int) -> Array:
        if not shared:
            whole = self.size * LOG_2PI + self.log_determinant + self.form[-1]
            return np.asarray(-0.5 * whole)
        form, invertible = self._invertible_form(shared)
        square, of_curve = eliminate(form, [1.0] * shared)
        density = -0.5 * (self.size * LOG_2PI + self.log_determinant + of_curve + square[-1])
        return np.where(invertible, density, np.nan)

    def _invertible_form(self, shared: int) -> tuple[Array, NDArray[np.bool_]]:
        """Return the form, set to 0 where the curve's precision cannot be inverted, and where not.

        If there are few measurements, only the prior determines a part of the curve. At extremely
        small noise its precision of 1 is lost by rounding against that of the rest.
        """
        finite = np.isfinite(self.form).all(axis=0)
        form = np.where(finite, self.form, 0.0)
        values = np.linalg.eigvalsh(np.eye(shared) + matrices(form)[..., :shared, :shared])
        invertible = finite & (values[..., -1] < LARGEST_CONDITION * values[..., 0])
        return np.where(invertible, form, 0.0), invertible


@dataclass(frozen=True)
class Grouped:
    """M measurements in G groups, for W sets of parameters at once.

    Parameters
    ----------
    groups : Groups
        Groups of the measurements.
    residual : ndarray, shape (W, M)
        r, the measured values minus their means.
    variance : ndarray, shape (W, M)
        d, the variance of each measurement's own error; its squared scale if it is Student-t.
    moved : ndarray, shape (R, W, M)
        u, the shift of a measurement by one standard deviation (or scale) of each of a group's R
        deviations.
    """

    groups: Groups
    residual: Array
    variance: Array
    moved: Array


@dataclass(frozen=True)
class GroupedNormal(Grouped):
    """Measurements with a joint normal density.

    Parameters
    ----------
    columns : ndarray, shape (M, K), or None
        B, the columns of the shared curve; None without one.
    """

    columns: Array | None = None

    def log_density(self) -> Array:
        """Return the log density of all measurements; nan where it overflows, shape (W,)."""
        size, log_determinant, form = self._group_sums()
        whole = _Sums(size.sum(axis=-1), log_determinant.sum(axis=-1), form.sum(axis=-1))
        density = whole.log_density(self._shared)
        # At a noise of 1e-80 a difference of sums overflows to a density of +inf.
        return np.where(density < np.inf, density, np.nan)

    def group_log_density(self) -> Array:
        """Return the log density of each group given all others, shape (W, G)."""
        own = self._group_sums()
        if not self._shared:  # groups are independent
            return own.log_density(0)
        whole = _Sums(*(part.sum(axis=-1, keepdims=True) for part in own))
        rest = _Sums(*(total - part for total, part in zip(whole, own, strict=True)))
        return whole.log_density(self._shared) - rest.log_density(self._shared)

    def single_log_density(self) -> Array:
        """Return the log density of each measurement given all others, shape (W, M).

        References
        ----------
        P.-C. Bürkner, J. Gabry, A. Vehtari, "Efficient leave-one-out cross-validation
        for Bayesian non-factorized normal and Student-t models", Computational
        Statistics 36 (2021).
        """
        score, precision = self._given_the_rest
        return np.asarray(0.5 * (np.log(precision) - LOG_2PI - score**2 / precision))

    def single_cdf(self, sign: Array | float = 1.0) -> Array:
        """Return the CDF of each measurement at its value given all others, shape (W, M).

        Parameters
        ----------
        sign : ndarray, shape (M,), or float
            −1 for a measurement whose order is reversed, else 1.
        """
        score, precision = self._given_the_rest
        return np.asarray(ndtr(sign * (score / np.sqrt(precision))))

    def group_cdf(self) -> Array:
        """Return a distribution function value for each group's data, given all other groups.

        It is that of the scalar uᵀ P (r − m), with P the group's precision matrix and m the mean of
        its residuals r given the others, and u their shifts by the group's first deviation.

        Returns
        -------
        ndarray, shape (W, G)
            NaN for a group that the first deviation does not shift.
        """
        own, shared = list(self.moved), self._shared
        columns = [*own, *self._curve, self.moved[0], self.residual]
        form, _ = eliminate(gram(columns, 1 / self.variance, self.groups.total), [1.0] * len(own))
        whole = matrices(form)  # in the curve, the shifts of the first deviation, and the residual
        square, score = whole[..., -2, -2], whole[..., -2, -1]
        if shared:
            curve_precision = np.eye(shared) + whole[..., :shared, :shared].sum(axis=-3)
            seen = whole[..., :shared, -1].sum(axis=-2)
            across = whole[..., :shared, -2]
            score = score - (across @ np.linalg.solve(curve_precision, seen[..., None]))[..., 0]
            square = square - np.einsum(
                "...gk,...kl,...gl->...g", across, np.linalg.inv(curve_precision), across
            )
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(ndtr(np.where(square > 0, score / np.sqrt(square), np.nan)))

    def draw_again(self, rng: np.random.Generator) -> Array:
        """Draw a replicate of each measurement given all others, minus its own value, (W, M).

        Parameters
        ----------
        rng : Generator
            Source of randomness.
        """
        score, precision = self._given_the_rest
        return np.asarray(rng.standard_normal(score.shape) / np.sqrt(precision) - score / precision)

    def numbers(self) -> tuple[Array, Array]:
        """Return the posterior of each group's deviations, without a shared curve.

        Returns
        -------
        mean, covariance : ndarray, shape (W, G, R) and (W, G, R, R)
            The priors are N(0, 1). NaN if the measurements are so precise that rounding errors
            prevent an inversion.
        """
        return self._numbers(self.groups.total(self._shown()))

    def numbers_without_each(self) -> tuple[Array, Array]:
        """Return :meth:`numbers` of each measurement's group without it, (W, M, …)."""
        own = self._shown()
        return self._numbers(self.groups.total(own)[..., self.groups.of_each] - own)

    def _shown(self) -> Array:
        """Return each measurement's quadratic form in its group's deviations and the residual."""
        return gram([*self.moved, self.residual], 1 / self.variance, np.asarray)

    def _numbers(self, form: Array) -> tuple[Array, Array]:
        rank = len(self.moved)
        whole = matrices(form)
        precision = np.eye(rank) + whole[..., :rank, :rank]
        finite = np.asarray(np.isfinite(precision).all(axis=(-2, -1)))
        precision = np.where(finite[..., None, None], precision, np.eye(rank))
        values = np.linalg.eigvalsh(precision)
        invertible = finite & (values[..., -1] < LARGEST_CONDITION * values[..., 0])
        precision = np.where(invertible[..., None, None], precision, np.eye(rank))
        covariance = np.where(invertible[..., None, None], np.linalg.inv(precision), np.nan)
        mean = (covariance @ whole[..., :rank, rank:])[..., 0]
        return np.asarray(mean), np.asarray(covariance)

    def drawn(self, rng: np.random.Generator) -> "GroupedNormal":
        """Return the same density with residuals drawn from it.

        Parameters
        ----------
        rng : Generator
            Source of randomness.
        """
        residual = np.sqrt(self.variance) * rng.standard_normal(self.residual.shape)
        of_group = (*self.moved.shape[:2], len(self.groups.starts))
        group = rng.standard_normal(of_group)[..., self.groups.of_each]
        residual = residual + (self.moved * group).sum(axis=0)
        if self.columns is not None:
            residual += rng.standard_normal((len(residual), self._shared)) @ self.columns.T
        return replace(self, residual=residual)

    @property
    def _shared(self) -> int:
        return 0 if self.columns is None else self.columns.shape[1]

    @property
    def _curve(self) -> list[Array]:
        return [] if self.columns is None else list(self.columns.T)

    @cached_property
    def _given_the_rest(self) -> tuple[Array, Array]:
        """Return Σ⁻¹r and the diagonal of Σ⁻¹, both of shape (W, M)."""
        own, of_each = list(self.moved), self.groups.of_each
        numbers = [*own, *self._curve]
        solved = [column / self.variance for column in (*numbers, self.residual)]
        precision = 1 / self.variance

        def within(values: Array) -> Array:
            return self.groups.total(values)[..., of_each]

        def over_all(values: Array) -> Array:
            return np.asarray(values.sum(axis=-1, keepdims=True))

        for place, column in enumerate(numbers):  # one Sherman–Morrison update for each column
            total: Callable[[Array], Array] = within if place < len(own) else over_all
            along = solved[place]
            gain = 1 + total(column * along)
            precision = precision - along**2 / gain
            for later in range(place + 1, len(solved)):
                solved[later] = solved[later] - along * (total(column * solved[later]) / gain)
        return solved[-1], precision

    def _group_sums(self) -> _Sums:
        """Return the terms of each group, arrays of shape (…, W, G)."""
        own = list(self.moved)
        form = gram([*own, *self._curve, self.residual], 1 / self.variance, self.groups.total)
        form, of_group = eliminate(form, [1.0] * len(own))
        size = self.groups.total(np.ones(self.groups.count))
        log_determinant = of_group + self.groups.total(np.log(self.variance))
        return _Sums(np.broadcast_to(size, log_determinant.shape), log_determinant, form)
