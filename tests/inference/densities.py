"""Densities of known integral, and chains of them."""

from typing import NamedTuple

import numpy as np
from inference.conjugate import LinearGaussian
from scipy.special import gammaln

from bayesfric.analysis import Sampler
from bayesfric.inference.laplace import Laplace, laplace_approximation
from bayesfric.inference.sampling import sample

SETTINGS = Sampler(walkers=36, burn=80, steps=320, thin=4)


class Known(NamedTuple):
    """A log density of points (W, D), not normalised, and the log of its integral."""

    log_density: object
    size: int
    log_evidence: float

    def laplace(self) -> Laplace:
        return laplace_approximation(self.log_density, np.full(self.size, 0.1), np.ones(self.size))

    def chains(self, seed, settings=SETTINGS):
        return sample(self.log_density, self.laplace(), settings, seed).z


def conjugate(size, measurements=30, seed=7):
    """The posterior of a linear model; coefficients in units of their priors."""
    rng = np.random.default_rng(seed)
    design = rng.normal(size=(measurements, size))
    noise = np.diag(rng.uniform(0.5, 2.0, measurements)) + 0.2
    model = LinearGaussian(design, np.ones(size), noise)
    measured = design @ rng.normal(size=size) + rng.multivariate_normal(
        np.zeros(measurements), noise
    )
    precision = np.linalg.inv(noise)
    _, log_determinant = np.linalg.slogdet(2 * np.pi * noise)

    def log_density(z):
        residual = measured - z @ design.T
        square = np.einsum("wi,ij,wj->w", residual, precision, residual)
        prior = -0.5 * (np.log(2 * np.pi) + z**2).sum(axis=1)
        return prior - 0.5 * (square + log_determinant)

    return Known(log_density, size, model.log_evidence(measured))


def log_gammas(size, shape=3.0):
    """Independent logarithms of gamma variables, mixed linearly: skewed and correlated."""
    mixing = np.eye(size) + 0.5 * np.eye(size, k=1) - 0.3 * np.eye(size, k=-1)

    def log_density(z):
        u = z @ mixing.T
        with np.errstate(over="ignore"):  # −inf far out
            return (shape * u - np.exp(u)).sum(axis=1)

    _, log_determinant = np.linalg.slogdet(mixing)
    return Known(log_density, size, size * float(gammaln(shape)) - float(log_determinant))


def student(size, freedom=5.0, log_evidence=-4.0):
    """A multivariate Student-t."""
    normaliser = (
        gammaln((freedom + size) / 2) - gammaln(freedom / 2) - 0.5 * size * np.log(freedom * np.pi)
    )

    def log_density(z):
        power = 0.5 * (freedom + size)
        tail = np.log1p((z**2).sum(axis=1) / freedom)
        return log_evidence + normaliser - power * tail

    return Known(log_density, size, log_evidence)


def banana(size, bend=0.4, log_evidence=2.5):
    """Independent normals, one bent by the square of another: a change of volume 1."""

    def log_density(z):
        straight = z.copy()
        straight[:, 1] -= bend * (z[:, 0] ** 2 - 1)
        return log_evidence - 0.5 * (np.log(2 * np.pi) + straight**2).sum(axis=1)

    return Known(log_density, size, log_evidence)


def two_modes(size, apart, share=0.5):
    """Unit normals `apart` from each other in every coordinate."""

    def log_density(z):
        parts = [
            np.log(weight) - 0.5 * (np.log(2 * np.pi) + (z - place) ** 2).sum(axis=1)
            for weight, place in ((share, 0.0), (1 - share, apart))
        ]
        return np.logaddexp(*parts)

    return Known(log_density, size, 0.0)
