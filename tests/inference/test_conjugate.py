"""The closed form of the linear model against its definition."""

import numpy as np
import pytest
from inference.conjugate import LinearGaussian
from scipy import integrate, stats

DESIGN = np.array([[1.0, 0.5], [1.0, -0.3], [1.0, 2.0], [1.0, 0.1]])
NOISE = np.diag([0.5, 0.8, 0.4, 1.0]) + 0.1
PRIOR_SD = np.array([1.5, 0.7])
MEASURED = np.array([0.3, -0.2, 1.9, 0.4])
MODEL = LinearGaussian(DESIGN, PRIOR_SD, NOISE)


def joint(b):
    """Density of the measurements and of coefficients of shape (…, 2)."""
    noise = stats.multivariate_normal(np.zeros(4), NOISE).logpdf(MEASURED - b @ DESIGN.T)
    return np.exp(noise + stats.norm(0, PRIOR_SD).logpdf(b).sum(axis=-1))


def test_one_coefficient_by_quadrature():
    model = LinearGaussian(DESIGN[:, 1:], PRIOR_SD[1:], NOISE)

    def density(b):
        noise = stats.multivariate_normal(DESIGN[:, 1] * b, NOISE).logpdf(MEASURED)
        return np.exp(noise + stats.norm(0, PRIOR_SD[1]).logpdf(b))

    value, _ = integrate.quad(density, -10, 10, epsabs=0, epsrel=1e-12)
    assert model.log_evidence(MEASURED) == pytest.approx(np.log(value), abs=1e-10)


def test_two_coefficients_by_quadrature():
    mean, covariance = MODEL.posterior(MEASURED)
    root = np.linalg.cholesky(covariance)
    grid = np.linspace(-9, 9, 91)  # the trapezoidal rule of a normal is exact to rounding
    points = np.stack([axis.ravel() for axis in np.meshgrid(grid, grid)], axis=-1)
    total = joint(mean + points @ root.T).sum()
    log_evidence = np.log(total * np.linalg.det(root) * (grid[1] - grid[0]) ** 2)
    assert MODEL.log_evidence(MEASURED) == pytest.approx(log_evidence, abs=1e-10)


def test_posterior_is_evidence_times_density():
    """Bayes' theorem at a point."""
    mean, covariance = MODEL.posterior(MEASURED)
    point = np.array([0.2, -0.4])
    posterior = stats.multivariate_normal(mean, covariance).logpdf(point)
    assert posterior + MODEL.log_evidence(MEASURED) == pytest.approx(
        np.log(joint(point)), abs=1e-12
    )


def test_conditionals_are_those_of_the_joint_normal():
    group = np.array([True, False, True, False])
    rest = ~group
    covariance = MODEL.covariance
    gain = covariance[np.ix_(group, rest)] @ np.linalg.inv(covariance[np.ix_(rest, rest)])
    conditional = stats.multivariate_normal(
        gain @ MEASURED[rest],
        covariance[np.ix_(group, group)] - gain @ covariance[np.ix_(rest, group)],
    )
    log_conditional = MODEL.log_conditional(MEASURED, group)
    assert log_conditional == pytest.approx(conditional.logpdf(MEASURED[group]), abs=1e-12)


@pytest.mark.parametrize(
    ("design", "prior_sd", "noise"),
    [(DESIGN, PRIOR_SD[:1], NOISE), (DESIGN, PRIOR_SD, NOISE[:2, :2])],
)
def test_shapes_that_do_not_fit_are_refused(design, prior_sd, noise):
    with pytest.raises(ValueError, match="do not fit together"):
        LinearGaussian(design, prior_sd, noise)
