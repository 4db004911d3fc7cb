"""Closed forms of the scatter against SciPy's multivariate normal and quadrature."""

import numpy as np
import pytest
from scipy import stats
from scipy.integrate import quad

from bayesfric.inference.scatter import (
    SetupIndex,
    setup_log_density,
    trial_cdf,
    trial_log_density,
)
from bayesfric.inference.student import (
    student_setup_log_density,
    student_trial_cdf,
    student_trial_log_density,
)

MU = np.array([0.9, 1.4, 2.2, 0.7, 3.0, 1.1])
OBSERVED = np.array([0.92, 1.38, 2.31, 0.69, 2.95, 1.12])
VARIANCE = np.array([1e-4, 2e-4, 1e-5, 3e-4, 1e-3, 1e-5])
INDEX = SetupIndex(np.array([0, 3, 5]), 6)
GROUPS = (slice(0, 3), slice(3, 5), slice(5, 6))
TAU, OMEGA = 0.02, 0.03


def covariance(rows):
    mu = MU[rows]
    return np.diag((TAU * mu) ** 2 + VARIANCE[rows]) + OMEGA**2 * np.outer(mu, mu)


def arguments():
    return INDEX, OBSERVED, VARIANCE, MU, np.array([TAU]), np.array([OMEGA])


def test_assembly_is_a_multivariate_normal():
    expected = [
        stats.multivariate_normal(MU[rows], covariance(rows)).logpdf(OBSERVED[rows])
        for rows in GROUPS
    ]
    assert setup_log_density(*arguments()) == pytest.approx(expected, abs=1e-11)


def test_trial_given_the_rest_is_a_ratio_of_densities():
    expected = []
    for rows in GROUPS:
        places = np.arange(6)[rows]
        joint = stats.multivariate_normal(MU[rows], covariance(rows)).logpdf(OBSERVED[rows])
        for left_out in range(len(places)):
            rest = np.delete(np.arange(len(places)), left_out)
            marginal = 0.0
            if rest.size:
                marginal = stats.multivariate_normal(
                    MU[rows][rest], covariance(rows)[np.ix_(rest, rest)]
                ).logpdf(OBSERVED[rows][rest])
            expected.append(joint - marginal)
    assert trial_log_density(*arguments()) == pytest.approx(expected, abs=1e-11)


def test_probability_of_less_friction_is_that_of_the_conditional_normal():
    expected = []
    for rows in GROUPS:
        noise, off = covariance(rows), OBSERVED[rows] - MU[rows]
        for left_out in range(len(off)):
            rest = np.delete(np.arange(len(off)), left_out)
            gain = noise[left_out, rest] @ np.linalg.inv(noise[np.ix_(rest, rest)])
            variance = noise[left_out, left_out] - gain @ noise[rest, left_out]
            expected.append(stats.norm.cdf((off[left_out] - gain @ off[rest]) / variance**0.5))
    assert trial_cdf(*arguments()) == pytest.approx(expected, abs=1e-11)


def test_walkers_are_independent_rows():
    tau, omega = np.array([[0.01], [0.02]]), np.array([[0.03], [0.01]])
    mu = np.stack([MU, 1.01 * MU])
    both = setup_log_density(INDEX, OBSERVED, VARIANCE, mu, tau, omega)
    alone = setup_log_density(INDEX, OBSERVED, VARIANCE, mu[1], tau[1], omega[1])
    assert both[1] == pytest.approx(alone, abs=1e-12)


def student_by_quadrature(rows, freedom):
    mu, y, variance = MU[rows], OBSERVED[rows], VARIANCE[rows]
    scale = np.sqrt((TAU * mu) ** 2 + variance)

    def integrand(eta):
        trials = stats.t(freedom, mu * (1 + eta), scale).logpdf(y)
        return np.exp(stats.norm(0, OMEGA).logpdf(eta) + trials.sum())

    return np.log(quad(integrand, -0.4, 0.4, points=[0.0], epsabs=0, epsrel=1e-10, limit=400)[0])


@pytest.mark.parametrize("freedom", [3.0, 8.0])
def test_student_assembly_against_quadrature(freedom):
    expected = [student_by_quadrature(rows, freedom) for rows in GROUPS]
    found = student_setup_log_density(*arguments(), freedom=freedom)
    assert found == pytest.approx(expected, abs=1e-5)


def test_student_trial_given_the_rest_against_quadrature():
    found = student_trial_log_density(*arguments(), freedom=4.0)
    expected = [student_by_quadrature(slice(0, 3), 4.0) - student_by_quadrature([0, 1], 4.0)]
    assert found[2] == pytest.approx(expected[0], abs=1e-4)
    # A trial alone on its assembly has no rest: its density is the assembly's.
    assert found[5] == pytest.approx(student_by_quadrature(slice(5, 6), 4.0), abs=1e-4)


def test_student_with_many_degrees_of_freedom_is_normal():
    # The t differs from the normal by O(1/ν): at ν = 1e6 by some 1e-6 a trial.
    found = student_setup_log_density(*arguments(), freedom=1e6)
    assert found == pytest.approx(setup_log_density(*arguments()), abs=1e-4)


def test_student_probability_of_less_friction_against_quadrature():
    mu, y, variance = MU[:3], OBSERVED[:3], VARIANCE[:3]
    scale = np.sqrt((TAU * mu) ** 2 + variance)

    def integral(of):
        def integrand(eta):
            rest = stats.t(4.0, mu[:2] * (1 + eta), scale[:2]).logpdf(y[:2]).sum()
            return np.exp(stats.norm(0, OMEGA).logpdf(eta) + rest) * of(eta)

        return quad(integrand, -0.4, 0.4, points=[0.0], epsabs=0, epsrel=1e-10, limit=400)[0]

    below = integral(lambda eta: stats.t(4.0, mu[2] * (1 + eta), scale[2]).cdf(y[2]))
    found = student_trial_cdf(*arguments(), freedom=4.0)
    assert found[2] == pytest.approx(below / integral(lambda eta: 1.0), abs=1e-5)
    assert student_trial_cdf(*arguments(), freedom=1e6) == pytest.approx(
        trial_cdf(*arguments()), abs=1e-4
    )
