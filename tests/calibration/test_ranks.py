"""Ranks of a conjugate normal: its posterior passes, a posterior that is wrong is flagged."""

import numpy as np
import pytest
from scipy import stats

from bayesfric.analysis import Analysis
from bayesfric.calibration.ranks import band_of, rank_of
from bayesfric.calibration.running import RANKED_DRAWS, calibration_of

CASES = 500


def ranks_of(seed, *, width=1.0, shift=0.0, count=CASES):
    """Truths from N(0, 1), data from N(truth, 0.5²); a posterior so much too wide or off."""
    rng = np.random.default_rng(seed)
    ranks = []
    for _ in range(count):
        truth = rng.standard_normal()
        measured = truth + 0.5 * rng.standard_normal()
        sd = np.sqrt(1 / (1 + 4))
        draws = 0.8 * measured + sd * (shift + width * rng.standard_normal(RANKED_DRAWS))
        ranks.append(rank_of(truth, draws))
    return np.array(ranks)


def found_of(ranks):
    cases = [
        {"ranks": {"mu": int(rank)}, "r_hat": 1.0, "stalled": 0, "trials": 10} for rank in ranks
    ]
    return calibration_of(cases, Analysis(), planned=len(cases))


def test_a_right_posterior_is_inside_as_often_as_the_level_says():
    band = band_of(100, RANKED_DRAWS + 1, 0.95)
    inside = [band.p_value(ranks_of(seed, count=100)) >= 0.05 for seed in range(100)]
    assert 88 <= sum(inside) <= 100  # 95 of 100, ± 3 sd


@pytest.mark.parametrize(
    "wrong", [{"width": 0.5}, {"width": 2.0}, {"shift": 0.5}, {"shift": -0.5}], ids=str
)
def test_a_wrong_posterior_is_flagged(wrong):
    assert found_of(ranks_of(1)).calibrated
    calibrated = found_of(ranks_of(1, **wrong))
    assert not calibrated.calibrated
    assert calibrated.quantities[0].p_value < 1e-3
    assert "mu" in calibrated.attention[0]


def test_half_the_sd_is_flagged_by_fifty_cases():
    assert not found_of(ranks_of(2, width=0.5, count=50)).calibrated


def test_the_band_holds_the_ecdf_of_uniform_ranks_as_often_as_it_says():
    """Drawn from outside: inverse transform instead of multinomial counts."""
    band = band_of(200, 100, 0.9)
    rng = np.random.default_rng(5)
    ranks = (rng.uniform(size=(2000, 200)) * 100).astype(int)
    differences = np.array([band.difference(sample) for sample in ranks])
    edge = 1e-12
    inside = ((differences >= band.low - edge) & (differences <= band.high + edge)).all(axis=1)
    # Whole counts make it conservative; the p-value decides likewise.
    assert 0.88 < inside.mean() < 0.94
    alike = [
        (band.p_value(sample) >= 0.1) == within
        for sample, within in zip(ranks, inside, strict=True)
    ]
    assert np.mean(alike) > 0.99


def test_difference_and_tails_by_hand():
    band = band_of(4, 5, 0.95)
    ranks = np.array([0, 0, 3, 4])
    expected = np.array([2, 2, 2, 3]) / 4 - np.array([0.2, 0.4, 0.6, 0.8])
    assert band.difference(ranks) == pytest.approx(expected, abs=1e-12)
    below = stats.binom.sf(1, 4, 0.2) * 2  # two of four below 0.2: the farthest out
    assert band.p_value(ranks) == pytest.approx(
        (band.extremes <= below * (1 + 1e-9)).mean(), abs=1e-3
    )
