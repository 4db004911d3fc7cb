"""Figures on data that the fit has not seen: squares, folds and laws that are known."""

from dataclasses import replace

import numpy as np
import pytest
from diagnosis.boards import model_of

from bayesfric.diagnosis.held_out import Squares, extrapolated, folds_of, gap_row
from bayesfric.diagnosis.residuals import recalibrated, residuals_of
from bayesfric.rigs.protocols import Protocol

PROTOCOL = Protocol({(9, 85.0): 1, (15, 50.0): 2, (5, 140.3): 1}, (6.0, 16.0, 28.0), (6.0, 28.0), 2)


@pytest.fixture(scope="module")
def boards():
    """A model without discrepancy, its windows, and local numbers of another law."""
    model = model_of(protocol=PROTOCOL, discrepancy=False)
    residuals = residuals_of(model, model.start)
    local = np.zeros((3, model.layout.local))
    local[:, :3] = model.prior(())[0][:9].reshape(3, 3)
    local[:, :3] += np.random.default_rng(3).normal(0, 0.2, (3, 3))
    exact = residuals.residual_n - residuals.left(local)
    return model, replace(residuals, residual_n=exact), local


def test_a_law_that_explains_all_forces_is_found(boards):
    """Up to the prior, which counts as one assembly beside many."""
    model, residuals, local = boards
    everywhere = np.ones(residuals.size.size, dtype=bool)
    found = recalibrated(model, residuals, everywhere, np.zeros_like(local))
    left = residuals.left(found)
    assert np.sqrt((residuals.weight * left**2).sum()) < 2e-3
    assert np.abs(residuals.without_law(residuals.residual_n)).max() < 1e-6


def test_windows_that_are_left_out_do_not_enter(boards):
    model, residuals, local = boards
    rows = residuals.setup % 3 > 0
    wild = replace(residuals, residual_n=np.where(rows, residuals.residual_n, 1e3))
    np.testing.assert_array_equal(
        recalibrated(model, wild, rows, local), recalibrated(model, residuals, rows, local)
    )


@pytest.mark.parametrize(
    ("name", "column", "value"),
    [
        ("largest number of pulleys", "n_pulleys", 15),
        ("extreme wrap angle", "wrap_angle_deg", 140.3),
    ],
)
def test_every_window_of_an_extreme_trial_is_left_out(boards, name, column, value):
    """Though means over windows differ from the value by rounding."""
    model, residuals, _ = boards
    tables = [rig.rows.table for rig in model.rigs]
    expected = {one for table in tables for one in table["trial"][table[column] == value]}
    rows = extrapolated(residuals)[name]
    assert {residuals.names[trial] for trial in residuals.trial[rows]} == expected
    assert not np.isin(residuals.trial[~rows], residuals.trial[rows]).any()


def test_folds_keep_assemblies_together():
    setup = np.repeat(np.arange(13), 3)
    fold = folds_of(setup, np.random.default_rng(0))
    for one in range(13):
        assert np.unique(fold[setup == one]).size == 1
    assert np.unique(fold).size == 5


def squares(before, after, floor, count=60):
    rng = np.random.default_rng(1)
    each = rng.chisquare(20, (3, count)) / 20 / count
    return Squares(None, before * each[0], after * each[1], floor * each[2], np.arange(count))


def row(one, why=None):
    return gap_row("folds", one, no_shrink=why, shipped_why="none", rng=np.random.default_rng(2))


def test_a_gap_that_is_closed_shrinks_by_all_of_it():
    found = row(squares(9.0, 1.0, 1.0))
    assert found.before.q50 == pytest.approx(3.0, rel=0.05)
    assert found.shrink.q50 == pytest.approx(1.0, abs=0.05)
    assert found.below_floor == 0.0


def test_no_gap_no_shrink_and_never_more_than_there_was():
    assert "probability" in row(squares(1.0, 1.0, 1.0)).shrink_why
    assert row(squares(9.0, 1.0, 1.0), "nothing was named").shrink_why == "nothing was named"
    # More taken away than lies above the floor: the floor is not what it is said to be.
    assert "floor" in row(squares(9.0, 0.2, 3.0)).shrink_why
