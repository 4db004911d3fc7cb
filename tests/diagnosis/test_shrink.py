"""The gap's arithmetic on squares that are made up."""

import numpy as np
import pytest
from scipy import stats

from bayesfric.diagnosis.shrink import DRAWS, Squares, explained, folds_of, gap_row, systematic_gap

SETUPS = np.repeat(np.arange(60), 4)


def squares(before, after, floor, shipped=None):
    size = SETUPS.size

    def each(rms):
        return np.full(size, rms**2 / size)

    known = None if shipped is None else each(shipped)
    return Squares(known, each(before), each(after), each(floor), SETUPS)


def row(found, *, no_shrink=None):
    rng = np.random.default_rng(0)
    return gap_row("it", found, no_shrink=no_shrink, shipped_why="-", rng=rng)


def test_four_figures_are_root_mean_squares():
    found, systematic, _ = row(squares(0.5, 0.35, 0.3, shipped=0.9))
    for value, expected in (
        (found.as_shipped.q50, 0.9),
        (found.before.q50, 0.5),
        (found.after.q50, 0.35),
    ):
        assert value == pytest.approx(expected, rel=1e-9)
    # The floor is as uncertain as a variance of 60 assemblies is.
    assert found.floor.q50 == pytest.approx(0.3, rel=0.02)
    assert systematic.q50 == pytest.approx(0.4, rel=0.02)


def is_a_quantile(value, share, freedom):
    """Of χ² over its degrees of freedom, to three standard errors of one of 400 draws."""
    exact = stats.chi2.ppf(share, freedom)
    error = np.sqrt(share * (1 - share) / DRAWS) / stats.chi2.pdf(exact, freedom)
    return value == pytest.approx(exact / freedom, abs=3 * error / freedom)


def test_the_floor_is_as_uncertain_as_the_assemblies_that_make_it_are_few():
    few = np.where(SETUPS < 16, 1.0, 0.0)  # sixteen alike of sixty
    found, _, _ = row(Squares(None, few, few, few / few.sum(), SETUPS))
    for value, share in ((found.floor.q05, 0.05), (found.floor.q50, 0.5), (found.floor.q95, 0.95)):
        assert is_a_quantile(value**2, share, 16)
    # Half of the squares in one assembly: 1 / (1/4 + 59 (1/118)²), which is fewer than four.
    one = np.where(SETUPS == 0, 0.5 / 4, 0.5 / 59 / 4)
    lone, _, _ = row(Squares(None, one, one, one, SETUPS))
    assert is_a_quantile(lone.floor.q95**2, 0.95, 1 / (1 / 4 + 59 / 118**2))


def test_shrink_is_of_squares_above_the_floor():
    found, _, _ = row(squares(0.5, 0.35, 0.3))
    assert found.shrink.q50 == pytest.approx((0.25 - 0.1225) / (0.25 - 0.09), rel=1e-6)


def test_no_shrink_without_a_cause_or_a_gap():
    without, _, _ = row(squares(0.5, 0.5, 0.3), no_shrink="no cause")
    assert without.shrink is None
    assert without.shrink_why == "no cause"
    below, systematic, _ = row(squares(0.3, 0.3, 0.31))
    assert below.shrink is None
    assert "above the floor" in below.shrink_why
    assert systematic.q05 == 0.0


def test_folds_keep_assemblies_together_and_even():
    fold = folds_of(SETUPS, np.random.default_rng(1))
    for setup in range(60):
        assert np.ptp(fold[setup == SETUPS]) == 0
    assert np.bincount(fold).tolist() == [48] * 5


def test_what_the_causes_take_away_is_the_difference_of_squares():
    """In every draw of assemblies, where each has the same; never below nothing."""
    taken = explained(squares(0.5, 0.35, 0.3), np.random.default_rng(0))
    np.testing.assert_allclose(taken, np.sqrt(0.25 - 0.1225), rtol=1e-9)
    assert not explained(squares(0.3, 0.31, 0.3), np.random.default_rng(0)).any()


LITTLE, LARGE = np.full(100, 0.01), np.full(100, 0.2)
PERHAPS = np.where(np.arange(100) < 30, 0.3, 0.0)  # from a floor that is hardly known


@pytest.mark.parametrize(
    ("distance", "taken", "predicted", "expected"),
    [
        (PERHAPS, LITTLE, True, LITTLE),
        (PERHAPS, LITTLE, False, LITTLE),  # more than half of the time there is no distance
        (LARGE, LITTLE, True, LARGE),  # there is a gap that the causes do not explain
        (LITTLE, LARGE, True, LARGE),
        (LARGE, np.zeros(100), False, LARGE),
    ],
)
def test_which_gap_decides(distance, taken, predicted, expected):
    assert systematic_gap(distance, taken, predicted=predicted) is expected
