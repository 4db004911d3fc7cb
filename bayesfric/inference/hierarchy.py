"""Several boards as draws of one population: normal approximations and their correction.

The posterior of each board is approximated by a normal density. Divided by its prior, it is a
likelihood of the board's coefficients with their correlations. The mean and the scatter of the
population are drawn with the boards integrated out in closed form. A second stage evaluates the
exact density of each board at boards drawn for every population, and accepts or rejects by it. The
result is exact for any approximation; a poor one needs more draws.

References
----------
J. A. Christen, C. Fox, "Markov chain Monte Carlo using an approximation", Journal of
Computational and Graphical Statistics 14 (2005).
C. Andrieu, G. O. Roberts, "The pseudo-marginal approach for efficient Monte Carlo
computations", Annals of Statistics 37 (2009).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bayesfric.arrays import Array
from bayesfric.inference.model import Model

LEAST_PRECISION = 0.01  # least precision of a likelihood in any direction; that of the prior is 1
FREEDOM, INFLATION = 6.0, 1.3  # degrees of freedom of a board's proposals, and variance factor


@dataclass(frozen=True)
class NormalBoard:
    """A board's posterior as a normal density, in the coordinates of its model.

    Parameters
    ----------
    model : Model
        Model of the board, with D parameters, K of them coefficients.
    places : ndarray of int, shape (D,)
        Indices of the parameters in the model, the coefficients first.
    centre : ndarray, shape (D,)
        Mean of the posterior, in the order of `places`.
    root : ndarray, shape (D, D)
        Lower triangular Cholesky factor of the posterior covariance, in the order of `places`.
    likely : ndarray, shape (K,)
        Maximum of the likelihood of the coefficients.
    precision_root : ndarray, shape (K, K)
        G, with G Gᵀ the precision of that likelihood.
    """

    model: Model
    places: NDArray[np.intp]
    centre: Array
    root: Array
    likely: Array
    precision_root: Array

    @classmethod
    def of(cls, model: Model, theta: Array, names: Sequence[str]) -> "NormalBoard":
        """Fit a normal density to draws of a board's posterior.

        Parameters
        ----------
        model : Model
            Model of the board.
        theta : ndarray, shape (S, D)
            Draws of its posterior, in the parameters' units.
        names : sequence of str
            Names of the K coefficients.
        """
        first = [model.names.index(name) for name in names]
        places = np.array(first + [k for k in range(len(model.names)) if k not in first])
        x = model.coordinates(model.sampling(theta))[:, places]
        centre, covariance = x.mean(axis=0), np.atleast_2d(np.cov(x, rowvar=False))
        middle = model.natural(np.zeros(len(places)))[first]
        width = np.array([model.parameters[place].width() for place in first])
        count = len(first)
        # In units of the prior, whose precision is then 1 in every direction.
        variance, axes = np.linalg.eigh(covariance[:count, :count] / np.outer(width, width))
        precision = np.maximum(1 / variance - 1, LEAST_PRECISION)
        moved = axes.T @ ((centre[:count] - middle) / width)
        return cls(
            model=model,
            places=places,
            centre=centre,
            root=np.asarray(np.linalg.cholesky(covariance), dtype=np.float64),
            likely=middle + width * (axes @ (moved / (variance * precision))),
            precision_root=axes * np.sqrt(precision) / width[:, None],
        )

    def log_marginal(self, mean: Array, sd: Array) -> Array:
        """Return the log density of the board given its population, up to a constant.

        Parameters
        ----------
        mean, sd : ndarray, shape (W, K)
            Mean and standard deviation of each coefficient in W populations.

        Returns
        -------
        ndarray, shape (W,)
        """
        scaled = sd[..., None] * self.precision_root
        lower = np.linalg.cholesky(np.eye(mean.shape[1]) + np.swapaxes(scaled, 1, 2) @ scaled)
        off = np.linalg.solve(lower, ((mean - self.likely) @ self.precision_root)[..., None])
        log_root = np.log(np.diagonal(lower, axis1=1, axis2=2)).sum(axis=1)
        return np.asarray(-log_root - 0.5 * (off[..., 0] ** 2).sum(axis=1))

    def draw(
        self, mean: Array, sd: Array, tries: int, rng: np.random.Generator
    ) -> tuple[Array, Array]:
        """Draw boards of given populations, with weights by the board's own density.

        Parameters
        ----------
        mean, sd : ndarray, shape (W, K)
            Mean and standard deviation of each coefficient in W populations.
        tries : int
            Number of boards for each population.
        rng : Generator
            Source of randomness.

        Returns
        -------
        theta : ndarray, shape (W, tries, D)
            Parameters in the units and the order of the model.
        log_weight : ndarray, shape (W, tries)
            Log weights. The mean weight estimates the density of the board's data given the
            population, with the constant of :meth:`log_marginal`.
        """
        count, size = mean.shape[1], len(self.places)
        scaled = sd[..., None] * self.precision_root
        inner = np.linalg.inv(np.eye(count) + scaled @ np.swapaxes(scaled, 1, 2))
        inner = sd[:, :, None] * inner * sd[:, None, :]  # the conditional covariance
        precise = self.precision_root @ self.precision_root.T
        centre = mean + np.einsum("wij,wj->wi", inner, (self.likely - mean) @ precise)
        widths = np.sqrt(np.diagonal(inner, axis1=1, axis2=2))
        # Widths may differ by any factor, so the Cholesky factor is that of the correlations.
        near = np.linalg.cholesky(inner / (widths[:, :, None] * widths[:, None, :]))
        near = INFLATION**0.5 * widths[..., None] * near
        normal = rng.standard_normal((len(mean), tries, size))
        far = np.sqrt(FREEDOM / rng.chisquare(FREEDOM, (len(mean), tries, 1)))
        student = normal * far
        x = np.empty_like(student)
        x[..., :count] = centre[:, None] + np.einsum("wij,wtj->wti", near, student[..., :count])
        # Other parameters depend on the coefficients as in the board's own posterior.
        along = self.root[count:, :count] @ np.linalg.inv(self.root[:count, :count])
        own = INFLATION**0.5 * self.root[count:, count:]
        x[..., count:] = (
            self.centre[count:]
            + (x[..., :count] - self.centre[:count]) @ along.T
            + student[..., count:] @ own.T
        )
        log_proposed = -0.5 * (FREEDOM + size) * np.log1p(
            (student**2).sum(axis=-1) / FREEDOM
        ) - np.log(np.diagonal(near, axis1=1, axis2=2)).sum(axis=1, keepdims=True)
        off = (x[..., :count] - mean[:, None]) / sd[:, None]
        log_population = -0.5 * (off**2).sum(axis=-1) - np.log(sd).sum(axis=1)[:, None]
        theta, log_likelihood = self._density(x.reshape(-1, size))
        log_weight = log_likelihood.reshape(off.shape[:2]) + log_population - log_proposed
        return theta.reshape(x.shape), log_weight

    def _density(self, x: Array) -> tuple[Array, Array]:
        """Return points in the model's units and order, and their log density, shape (W,).

        It does not contain the prior of the coefficients, because the population is their prior.
        """
        points = np.empty_like(x)
        points[:, self.places] = x
        with np.errstate(all="ignore"):  # beyond a prior's bounds there is no density
            z = self.model.from_coordinates(points)
            density = self.model.log_posterior(z) - self.model.coordinates_log_slope(z)
            theta = self.model.natural(z)
            coefficients = self.places[: len(self.likely)]
            density = density - self.model.log_priors(theta)[:, coefficients].sum(axis=1)
        return theta, np.where(np.isfinite(density), density, -np.inf)


def second_stage(log_weight: Array, rng: np.random.Generator) -> NDArray[np.intp]:
    """Accept or reject independent proposals by their weights.

    Parameters
    ----------
    log_weight : ndarray, shape (chains, N)
        Log ratio of target density to proposal density, in the order of each chain's proposals.
    rng : Generator
        Source of randomness.

    Returns
    -------
    ndarray of int, shape (chains, N)
        Index of the proposal at which each chain is at each step.
    """
    threshold = np.log(rng.uniform(size=log_weight.shape))
    at = np.zeros(log_weight.shape, dtype=np.intp)
    for row, weights in enumerate(log_weight):
        current = 0  # if its weight is −inf, any finite weight is accepted
        for step in range(1, len(weights)):
            if weights[step] - threshold[row, step] > weights[current]:
                current = step
            at[row, step] = current
    return at
