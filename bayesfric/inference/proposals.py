"""Student-t proposals for ensembles and importance samples, fitted to a density.

A proposal is fitted in the coordinates of a :class:`Chart`, to points of an importance sample
around the mode. If no such sample is reliable, :mod:`bayesfric.inference.sampling` fits it to pilot
runs.

References
----------
O. Cappé, A. Guillin, J.-M. Marin, C. P. Robert, "Population Monte Carlo", Journal of
Computational and Graphical Statistics 13 (2004), on importance samples that refit their
proposal.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln, logsumexp

from bayesfric.arrays import Array
from bayesfric.inference.laplace import Laplace
from bayesfric.inference.laplace import LogDensity as LogDensity
from bayesfric.inference.pareto import smooth_weights
from bayesfric.inference.sampling_rules import SAMPLING_RULES

Random = np.random.RandomState | np.random.Generator  # emcee uses the former

FREEDOMS = (6.0, 12.0, 24.0, 48.0)  # degrees of freedom that are tried
INFLATION = 1.1  # factor on a fitted covariance, for posteriors that are not normal
POINTS = 1000  # points of an importance sample
PASSES = 5  # importance samples, each from a proposal fitted to the previous one
LEAST_EFFECTIVE = 0.25  # least effective sample size, relative to the number of points
LEAST_A_COORDINATE = 2  # least effective sample size for each dimension of a covariance
SLOPE_STEP = 1e-4  # step of a chart's numerical derivative [sd]
LEAST_SPREAD = 1e-10  # relative spread of a coordinate below which it is rounding error


class StudentT:
    """A multivariate Student-t distribution.

    Parameters
    ----------
    location : ndarray, shape (D,)
        Centre.
    scale : ndarray, shape (D, D)
        Scale matrix.
    freedom : float
        Degrees of freedom.
    """

    def __init__(self, location: Array, scale: Array, freedom: float = FREEDOMS[0]) -> None:
        self.location = location
        self.freedom = freedom
        self._root = np.linalg.cholesky(scale)
        size = location.size
        self._log_normaliser = float(
            gammaln((freedom + size) / 2)
            - gammaln(freedom / 2)
            - 0.5 * size * np.log(freedom * np.pi)
            - np.log(np.diag(self._root)).sum()
        )

    @classmethod
    def around(cls, points: Array) -> "StudentT":
        """Fit the distribution to points of shape (N, D).

        The degrees of freedom are those of the highest likelihood. In many dimensions, most
        proposals from tails that are too heavy would be rejected.
        """
        location = points.mean(axis=0)
        covariance = INFLATION * np.atleast_2d(np.cov(points, rowvar=False))
        candidates = [
            cls(location, covariance * (freedom - 2) / freedom, freedom) for freedom in FREEDOMS
        ]
        return max(candidates, key=lambda student: float(student.log_density(points).sum()))

    def wider(self, factor: float) -> "StudentT":
        """Return one with the same centre, `factor` times as wide, and the heaviest tails."""
        root = factor * self._root
        return StudentT(self.location, root @ root.T)

    def draw(self, size: int, rng: Random, inflation: float = 1.0) -> Array:
        """Return draws of shape (size, D), with their spread multiplied by `inflation`."""
        normal = rng.standard_normal((size, self.location.size))
        stretch = np.sqrt(self.freedom / rng.chisquare(self.freedom, size))
        return self.location + inflation * stretch[:, None] * (normal @ self._root.T)

    def log_density(self, points: Array) -> Array:
        """Return the log density of points of shape (W, D), shape (W,)."""
        white = np.linalg.solve(self._root, (points - self.location).T)
        distance2: Array = (white**2).sum(axis=0)
        power = 0.5 * (self.freedom + self.location.size)
        return self._log_normaliser - power * np.log1p(distance2 / self.freedom)


@dataclass(frozen=True)
class Chart:
    """Coordinates in which a density may be closer to normal.

    A narrow ridge may be straight in one chart and curved in another, in which no Student-t
    distribution fits it.

    Parameters
    ----------
    forward : callable
        From points of the sampling space to their coordinates, both of shape (W, D).
    inverse : callable
        From coordinates to points; not finite if there is no such point.
    log_slope : callable
        From points to the log determinant of the derivative of `forward`, shape (W,).
    """

    forward: Callable[[Array], Array]
    inverse: Callable[[Array], Array]
    log_slope: Callable[[Array], Array]


SAMPLING_SPACE = Chart(lambda z: z, lambda x: x, lambda z: np.zeros(len(z)))


@dataclass(frozen=True)
class Proposal:
    """A distribution of points of the sampling space, Student-t in the coordinates of a chart.

    Parameters
    ----------
    student : StudentT
        Distribution of the coordinates.
    chart : Chart
        The coordinates.
    """

    student: StudentT
    chart: Chart = SAMPLING_SPACE

    @classmethod
    def around(cls, points: Array, chart: Chart) -> "Proposal":
        """Fit a proposal to points of the sampling space, shape (N, D).

        If a coordinate of the chart has no spread, it is fitted in the sampling space itself.
        """
        coordinates = chart.forward(points)
        if not _has_spread(coordinates.mean(axis=0), coordinates.std(axis=0)):
            return cls(StudentT.around(points))
        return cls(StudentT.around(coordinates), chart)

    @classmethod
    def at_mode(cls, laplace: Laplace, chart: Chart) -> "Proposal":
        """Transform a normal approximation to the coordinates of a chart, with heavier tails.

        If a coordinate of the chart has no spread, it stays in the sampling space.
        """
        mode, sd = laplace.mode, np.sqrt(np.diag(laplace.covariance))
        shifts = SLOPE_STEP * np.diag(sd)
        rise = chart.forward(mode + shifts) - chart.forward(mode - shifts)
        slope = rise.T / (2 * SLOPE_STEP * sd)
        scale = slope @ laplace.covariance @ slope.T
        centre = chart.forward(mode[None])[0]
        if not _has_spread(centre, np.sqrt(np.diag(scale))):
            return cls(StudentT(mode, laplace.covariance))
        return cls(StudentT(centre, scale), chart)

    def draw(
        self, size: int, rng: Random, inflation: float = 1.0
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Return draws, shape (size, D), and which of them are finite points, shape (size,)."""
        z = self.chart.inverse(self.student.draw(size, rng, inflation))
        return z, np.asarray(np.isfinite(z).all(axis=1))

    def log_density(self, z: Array) -> Array:
        """Return the log density of points of the sampling space, shape (W,)."""
        return self.student.log_density(self.chart.forward(z)) + self.chart.log_slope(z)

    def propose(self, walkers: Array, rng: np.random.RandomState) -> tuple[Array, Array]:
        """Return proposals and log q(walkers) − log q(proposals), as emcee requires."""
        z, possible = self.draw(len(walkers), rng)
        z = np.where(possible[:, None], z, walkers)
        factor = self.log_density(walkers) - self.log_density(z)
        return z, np.where(possible, factor, -np.inf)


def _has_spread(centre: Array, sd: Array) -> bool:
    """Return whether each coordinate varies by more than rounding errors.

    Far in the tail of its prior, a positive parameter underflows, and all its draws are 0.
    """
    return bool((sd > LEAST_SPREAD * np.abs(centre)).all())


def importance_points(
    log_density: LogDensity,
    laplace: Laplace,
    chart: Chart,
    rng: Random,
    least_effective: float = LEAST_EFFECTIVE,
    size: int = POINTS,
) -> Array | None:
    """Draw points of a density by importance sampling around its mode.

    The first sample is drawn from the normal approximation with heavier tails. Each further sample
    is drawn from a proposal that is fitted to the previous sample.

    Parameters
    ----------
    log_density : callable
        Unnormalised; points of shape (W, D) to log densities of shape (W,).
    laplace : Laplace
        Normal approximation of the density.
    chart : Chart
        Coordinates in which proposals are fitted.
    rng : RandomState or Generator
        Source of randomness.
    least_effective : float
        Least effective sample size, relative to `size`.
    size : int
        Points of each sample. Their number must suffice for a D × D covariance.

    Returns
    -------
    ndarray, shape (size, D), or None
        Points of the sampling space, some of them repeated; None if the weights of no sample are
        reliable.
    """
    proposal = Proposal.at_mode(laplace, chart)
    for _ in range(PASSES):
        sample = _resampled(log_density, proposal, size, rng)
        if sample is None:
            return None
        if sample.pareto_k < SAMPLING_RULES.pareto_k and sample.effective > least_effective * size:
            return sample.points
        proposal = Proposal.around(sample.points, chart)
    return None


def more_points(
    log_density: LogDensity, points: Array, chart: Chart, rng: Random, size: int
) -> Array:
    """Draw a larger importance sample from a proposal that is fitted to a smaller one.

    A covariance in D dimensions has D (D + 1) / 2 entries. From a thousand points it is so
    inexact that ensembles reject half of the proposals.

    Parameters
    ----------
    log_density, chart, rng
        As for :func:`importance_points`.
    points : ndarray, shape (N, D)
        The result of :func:`importance_points`.
    size : int
        Points of the larger sample.

    Returns
    -------
    ndarray, shape (size, D)
        Points of the sampling space, some of them repeated; `points` if the weights of the larger
        sample are unreliable.
    """
    sample = _resampled(log_density, Proposal.around(points, chart), size, rng)
    if sample is None or sample.pareto_k >= SAMPLING_RULES.pareto_k:
        return points
    return sample.points


class _Resampled(NamedTuple):
    """An importance sample, resampled by its weights, and its effective sample size."""

    points: Array
    pareto_k: float
    effective: float


def _resampled(
    log_density: LogDensity, proposal: Proposal, size: int, rng: Random
) -> _Resampled | None:
    """Draw an importance sample; None if its effective size is too small for a covariance."""
    z, possible = proposal.draw(size, rng)
    z = z[possible]
    log_weights, k = smooth_weights(log_density(z) - proposal.log_density(z))
    if not np.isfinite(log_weights).any():
        return None
    weights = np.exp(log_weights - logsumexp(log_weights))
    effective = 1 / (weights**2).sum()
    # Few points may hold most of the weight, and their covariance would be singular.
    weights = np.minimum(weights, 1 / np.sqrt(size))
    if weights.sum() ** 2 / (weights**2).sum() < LEAST_A_COORDINATE * z.shape[1]:
        return None
    return _Resampled(z[resampled(weights, size, rng)], k, float(effective))


def resampled(weights: Array, size: int, rng: Random) -> NDArray[np.intp]:
    """Return indices of points, drawn in proportion to their weights by systematic resampling.

    Parameters
    ----------
    weights : ndarray, shape (N,)
        Weights of the points, up to a common factor.
    size : int
        Number of draws.
    rng : RandomState or Generator
        Source of randomness.

    Returns
    -------
    ndarray of int, shape (size,)
        Ascending.
    """
    cumulative = np.cumsum(weights)
    levels = (np.arange(size) + rng.uniform()) / size * cumulative[-1]
    return np.asarray(np.minimum(np.searchsorted(cumulative, levels), len(weights) - 1))
