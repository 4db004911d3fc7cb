"""Closed forms of the linear model against dense normals of the same data."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from bayesfric.inference.information import Information


@pytest.fixture
def linear():
    """Data that are linear in five numbers: the design, what was measured, a prior."""
    rng = np.random.default_rng(3)
    design, measured = rng.standard_normal((12, 5)), rng.standard_normal(12)
    return design, measured, rng.standard_normal(5), np.array([0.5, 2.0, 0.0, 1.0, 1.0])


def information(design, measured):
    constant = -0.5 * (len(measured) * np.log(2 * np.pi) + measured @ measured)
    return Information(design.T @ design, design.T @ measured, constant)


def dense(design, measured, mean, sd):
    covariance = design @ np.diag(sd**2) @ design.T + np.eye(len(measured))
    return multivariate_normal.logpdf(measured, design @ mean, covariance)


def test_evidence_is_that_of_a_dense_normal(linear):
    design, measured, mean, sd = linear
    reduced = information(design, measured).reduced(mean, sd, np.array([], dtype=int))
    assert reduced.log_evidence == pytest.approx(dense(design, measured, mean, sd), abs=1e-10)


def test_candidates_stay_and_the_rest_is_integrated_out(linear):
    """At any amplitudes the form gives the density with these held."""
    design, measured, mean, sd = linear
    reduced = information(design, measured).reduced(mean, sd, np.array([3, 4]))
    for amplitudes in ([0.0, 0.0], [0.7, -1.2]):
        at = np.array(amplitudes)
        held = np.append(mean[:3], at), np.append(sd[:3], [0.0, 0.0])
        value = reduced.log_evidence + reduced.slope @ at - 0.5 * at @ reduced.precision @ at
        assert value == pytest.approx(dense(design, measured, *held), abs=1e-10)


def test_posterior_is_that_of_bayes(linear):
    design, measured, mean, sd = linear
    posterior_mean, covariance = information(design, measured).posterior(mean, sd)
    prior = np.diag(sd**2)
    gain = prior @ design.T @ np.linalg.inv(design @ prior @ design.T + np.eye(12))
    np.testing.assert_allclose(posterior_mean, mean + gain @ (measured - design @ mean), atol=1e-10)
    np.testing.assert_allclose(covariance, prior - gain @ design @ prior, atol=1e-10)


def test_independent_data_add_up(linear):
    design, measured, mean, sd = linear
    halves = [information(design[rows], measured[rows]) for rows in (slice(7), slice(7, None))]
    whole = (halves[0] + halves[1]).reduced(mean, sd, np.array([], dtype=int))
    assert whole.log_evidence == pytest.approx(dense(design, measured, mean, sd), abs=1e-10)


def test_rounding_takes_nothing_from_the_prior(linear):
    """Precision of 10¹⁴ along one direction, from which rounding took 30 along another."""
    _, _, mean, _ = linear
    direction, other = np.linalg.qr(np.random.default_rng(5).standard_normal((5, 2)))[0].T
    exact = 1e14 * np.outer(direction, direction)
    rounded = exact - 30.0 * np.outer(other, other)
    slope, sd = exact @ (mean + 0.3 * direction), np.ones(5)
    with np.errstate(all="raise"):
        posterior_mean, covariance = Information(rounded, slope, 0.0).posterior(mean, sd)
    # Known along the one direction, where it is 0.3 from the prior's mean; elsewhere the prior.
    np.testing.assert_allclose((posterior_mean - mean) @ direction, 0.3, atol=1e-3)
    np.testing.assert_allclose(covariance @ other, other, atol=2e-2)
    assert other @ covariance @ other == pytest.approx(1, abs=2e-2)
    still, nothing = np.zeros(5), np.array([], dtype=int)
    reduced = Information(rounded, still, 0.0).reduced(still, sd, nothing)
    assert reduced.log_evidence == pytest.approx(-0.5 * np.log(1e14), abs=0.02)


def test_one_factor_gives_evidence_mean_and_covariance(linear):
    design, measured, mean, sd = linear
    said = information(design, measured)
    value, centre, covariance = said.integrated(mean, sd)
    assert value == pytest.approx(dense(design, measured, mean, sd))
    expected = said.posterior(mean, sd)
    np.testing.assert_allclose(centre, expected[0])
    np.testing.assert_allclose(covariance, expected[1], atol=1e-14)
