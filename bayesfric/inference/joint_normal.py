"""Measurements that all hang together: one normal, taken apart so that it stays cheap.

The M measurements have the covariance

    Σ = A + B Bᵀ,   A = diag(d) + blocks u uᵀ, one for each group,

with u what an assembly's own deviation moves and B the K columns of a curve that all
measurements share, scaled to coefficients of prior N(0, 1). A is inverted group by
group (Sherman–Morrison) and Σ by way of the K × K matrix I + BᵀA⁻¹B (Woodbury), so
that everything but that matrix is a sum over groups: what one group adds can be taken
off again to leave the group out.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bayesfric.inference.scatter import LOG_2PI, SetupIndex

__all__ = ["JointNormal"]

Array = NDArray[np.float64]
LARGEST_CONDITION = 1e12  # of the curve's precision; rounding would be felt beyond


class _Sums(NamedTuple):
    """What a set of measurements adds to the density, arrays of shape (…)."""

    size: Array  # measurements
    log_determinant: Array  # of A
    square: Array  # rᵀA⁻¹r
    right: Array  # (…, K) BᵀA⁻¹r
    inner: Array  # (…, K, K) BᵀA⁻¹B

    def log_density(self) -> Array:
        whole, known = self._precision()
        solved = np.linalg.solve(whole, self.right[..., None])[..., 0]
        square = self.square - (self.right * solved).sum(axis=-1)
        log_determinant = self.log_determinant + np.linalg.slogdet(whole)[1]
        density = -0.5 * (self.size * LOG_2PI + log_determinant + square)
        return np.where(known, density, np.nan)

    def _precision(self) -> tuple[Array, NDArray[np.bool_]]:
        """Return I + BᵀA⁻¹B, and where it can be inverted; the identity elsewhere.

        Few measurements leave a part of the curve to its prior, whose 1 is lost beside
        the precision of the rest when the noise is far below what anyone would record.
        """
        identity = np.eye(self.inner.shape[-1])
        finite = np.asarray(np.isfinite(self.inner).all(axis=(-2, -1)))
        whole = identity + np.where(finite[..., None, None], self.inner, 0.0)
        values = np.linalg.eigvalsh(whole)
        known = finite & (values[..., -1] < LARGEST_CONDITION * values[..., 0])
        return np.where(known[..., None, None], whole, identity), known


@dataclass(frozen=True)
class JointNormal:
    """M measurements in G groups, for W sets of parameters at once.

    Parameters
    ----------
    index : SetupIndex
        Groups of the measurements.
    columns : ndarray, shape (M, K)
        B, the shared curve.
    residual : ndarray, shape (W, M)
        r, what was measured less its mean.
    variance : ndarray, shape (W, M)
        d, of the errors that each measurement has to itself.
    moved : ndarray, shape (W, M)
        u, by how much one standard deviation of the group's own moves a measurement.
    """

    index: SetupIndex
    columns: Array
    residual: Array
    variance: Array
    moved: Array

    def log_density(self) -> Array:
        """Return the log density of all measurements; nan where it overflows, shape (W,)."""
        density = _Sums(*(part.sum(axis=1) for part in self._group_sums())).log_density()
        # At a noise of 1e-80 a difference of sums overflows to a density of +inf.
        return np.where(density < np.inf, density, np.nan)

    def group_log_density(self) -> Array:
        """Return the log density of each group given all others, shape (W, G)."""
        own = self._group_sums()
        whole = [part.sum(axis=1, keepdims=True) for part in own]
        rest = _Sums(*(total - part for total, part in zip(whole, own, strict=True)))
        return _Sums(*whole).log_density() - rest.log_density()

    def single_log_density(self) -> Array:
        """Return the log density of each measurement given all others, shape (W, M).

        References
        ----------
        P.-C. Bürkner, J. Gabry, A. Vehtari, "Efficient leave-one-out cross-validation
        for Bayesian non-factorized normal and Student-t models", Computational
        Statistics 36 (2021).
        """
        score, precision = self._given_the_rest()
        return np.asarray(0.5 * (np.log(precision) - LOG_2PI - score**2 / precision))

    def single_z(self) -> Array:
        """Return the standard score of each measurement given all others, shape (W, M)."""
        score, precision = self._given_the_rest()
        return np.asarray(score / np.sqrt(precision))

    def made_again(self, rng: np.random.Generator) -> "JointNormal":
        """Return the same normal with residuals drawn from it.

        Parameters
        ----------
        rng : Generator
            Source of randomness.
        """
        walkers, shared = len(self.residual), self.columns.shape[1]
        own = rng.standard_normal(self.residual.shape)
        group = rng.standard_normal((walkers, len(self.index.starts)))
        curve = rng.standard_normal((walkers, shared)) @ self.columns.T
        residual = np.sqrt(self.variance) * own + self.moved * group[:, self.index.of_trial] + curve
        return replace(self, residual=residual)

    def _given_the_rest(self) -> tuple[Array, Array]:
        """Return Σ⁻¹r and the diagonal of Σ⁻¹, both of shape (W, M)."""
        along = self.moved / self.variance
        gain = (1 + self.index.total(along * self.moved))[:, self.index.of_trial]

        def solve(values: Array) -> Array:  # A⁻¹ over the last axis
            amount = self.index.total(along * values)[:, self.index.of_trial]
            return np.asarray(values / self.variance - along * amount / gain)

        basis = np.stack([solve(column) for column in self.columns.T], axis=1)  # (W, K, M)
        inner = np.eye(self.columns.shape[1]) + basis @ self.columns
        white = np.linalg.solve(inner, basis)
        right = basis @ self.residual[:, :, None]
        precision = 1 / self.variance - along**2 / gain - (basis * white).sum(axis=1)
        score = solve(self.residual) - (white * right).sum(axis=1)
        return score, precision

    def _group_sums(self) -> _Sums:
        """Return what each group adds, arrays of shape (W, G, …)."""
        total, columns = self.index.total, self.columns.T
        weight = 1 / self.variance
        along, weighted = self.moved * weight, self.residual * weight
        gain = 1 + total(along * self.moved)
        along_residual = total(along * self.residual)
        along_columns = np.stack([total(along * column) for column in columns], axis=-1)
        inner = np.empty((*along_columns.shape, len(columns)))
        for i in range(len(columns)):
            for j in range(i + 1):
                inner[..., i, j] = inner[..., j, i] = total(weight * (columns[i] * columns[j]))
        share = along_columns / gain[..., None]
        right = np.stack([total(weighted * column) for column in columns], axis=-1)
        return _Sums(
            np.broadcast_to(total(np.ones(self.index.trials)), gain.shape),
            np.log(gain) - total(np.log(weight)),
            total(weighted * self.residual) - along_residual**2 / gain,
            right - share * along_residual[..., None],
            inner - share[..., :, None] * along_columns[..., None, :],
        )
