"""The proposal that is fitted to draws."""

import numpy as np
import pytest
from scipy import stats

from bayesfric.inference.evidence.proposal import Proposal, fit_proposal

COVARIANCE = np.array([[2.0, 0.6], [0.6, 1.0]])


def test_mean_and_covariance_are_those_asked_for():
    proposal = Proposal(np.array([1.0, -2.0]), COVARIANCE, 8)
    drawn = proposal.draw(100_000, np.random.default_rng(1))
    assert drawn.mean(axis=0) == pytest.approx([1.0, -2.0], abs=0.02)
    assert np.cov(drawn.T) == pytest.approx(COVARIANCE, rel=0.05)
    expected = stats.multivariate_t([1.0, -2.0], COVARIANCE * 6 / 8, df=8).logpdf(drawn[:5])
    assert proposal.log_density(drawn[:5]) == pytest.approx(expected)


@pytest.mark.parametrize(("freedom", "fitted"), [(4, {4, 8}), (8, {8}), (None, {64, 1024})])
def test_tails_are_fitted(freedom, fitted):
    rng = np.random.default_rng(2)
    draws = rng.standard_normal((20_000, 3))
    if freedom is not None:
        draws /= np.sqrt(rng.chisquare(freedom, (20_000, 1)) / freedom)
    assert fit_proposal(draws).freedom in fitted


def test_single_points_and_single_coordinates_keep_their_shape():
    proposal = Proposal(np.zeros(1), np.eye(1), 8)
    assert proposal.draw(1, np.random.default_rng(3)).shape == (1, 1)
    assert proposal.log_density(np.zeros((1, 1))).shape == (1,)


def test_widths_may_differ_by_any_factor():
    """The density of coordinates in other units is that in these, over the units."""
    unit = np.array([1.0, 1e-9])
    proposal = Proposal(np.array([1.0, -2e-9]), COVARIANCE * np.outer(unit, unit), 8)
    drawn = proposal.draw(20_000, np.random.default_rng(4)) / unit
    assert drawn.mean(axis=0) == pytest.approx([1.0, -2.0], abs=0.05)
    assert np.cov(drawn.T) == pytest.approx(COVARIANCE, rel=0.1)
    expected = stats.multivariate_t([1.0, -2.0], COVARIANCE * 6 / 8, df=8).logpdf(drawn[:5])
    assert proposal.log_density(drawn[:5] * unit) == pytest.approx(expected - np.log(1e-9))


def test_a_singular_covariance_is_refused():
    with pytest.raises(np.linalg.LinAlgError):
        Proposal(np.zeros(2), np.ones((2, 2)), 8)
