"""Figures on data that the fit has not seen: squares, folds and laws that are known."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnosis.boards import model_of

from bayesfric.diagnosis import diagnose
from bayesfric.diagnosis.chance import redrawn
from bayesfric.diagnosis.held_out import IN_NONE, Squares, extrapolated, folds_of, gap_row
from bayesfric.diagnosis.recalibrating import recalibrated, refit_of
from bayesfric.diagnosis.residuals import residuals_of
from bayesfric.diagnosis.stored import floor_disagrees
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import simulate_recording

PROTOCOL = Protocol({(9, 85.0): 1, (15, 50.0): 2, (5, 140.3): 1}, (6.0, 16.0, 28.0), (6.0, 28.0), 2)


@pytest.fixture(scope="module")
def boards():
    """A model without discrepancy, its windows, and local numbers of another law."""
    model = model_of(protocol=PROTOCOL, discrepancy=False)
    residuals = residuals_of(model, model.noise.start)
    local = np.zeros((3, model.layout.local))
    local[:, :3] = model.prior(())[0][:9].reshape(3, 3)
    local[:, :3] += np.random.default_rng(3).normal(0, 0.2, (3, 3))
    exact = residuals.residual_n - residuals.left(local)
    return model, replace(residuals, residual_n=exact), local


def test_a_law_that_explains_all_forces_is_found(boards):
    """Up to the prior, which counts as one assembly beside many."""
    model, residuals, local = boards
    everywhere = np.ones(residuals.size.size, dtype=bool)
    refit = refit_of(model, residuals, everywhere)
    factors = recalibrated(refit, residuals, np.zeros_like(local))
    left = residuals.left(factors)
    assert np.sqrt((residuals.weight * left**2).sum()) < 2e-3
    assert np.abs(residuals.without_law(residuals.residual_n)).max() < 1e-6


def test_windows_that_are_left_out_do_not_enter(boards):
    model, residuals, local = boards
    rows = residuals.setup % 3 > 0
    wild = replace(residuals, residual_n=np.where(rows, residuals.residual_n, 1e3))
    refit = refit_of(model, residuals, rows)
    np.testing.assert_array_equal(
        recalibrated(refit, wild, local), recalibrated(refit, residuals, local)
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
    expected = {trial for table in tables for trial in table["trial"][table[column] == value]}
    rows = extrapolated(residuals)[name]
    assert {residuals.names[trial] for trial in residuals.trial[rows]} == expected
    assert not np.isin(residuals.trial[~rows], residuals.trial[rows]).any()


def windows(setup, size, trial):
    return SimpleNamespace(setup=np.array(setup), size=np.array(size), trial=np.array(trial))


def test_folds_keep_assemblies_together():
    setup = np.repeat(np.arange(13), 3)
    rows = windows(setup, np.zeros(39, dtype=int), np.arange(39))
    fold = folds_of(rows, np.random.default_rng(0))
    for assembly in range(13):
        assert np.unique(fold[setup == assembly]).size == 1
    assert np.unique(fold).size == 5


@pytest.mark.parametrize("seed", range(20))
def test_no_fold_has_all_windows_of_a_size(seed):
    """Of six assemblies in five folds two share one, which may be both that a size has."""
    setup = np.repeat(np.arange(6), 4)
    rows = windows(setup, setup // 2, np.arange(24))
    fold = folds_of(rows, np.random.default_rng(seed))
    for size in range(3):
        assert np.unique(fold[rows.size == size]).size == 2


def test_a_size_with_one_assembly_has_its_trials_held_out():
    rows = windows([0] * 6 + [1] * 6, [0] * 6 + [1] * 6, np.arange(12) // 2)
    fold = folds_of(rows, np.random.default_rng(0))
    for size in range(2):
        own = rows.size == size
        assert np.unique(fold[own]).size == 3
        for trial in np.unique(rows.trial[own]):
            assert np.unique(fold[rows.trial == trial]).size == 1


def test_a_size_with_one_trial_is_in_no_fold():
    rows = windows([0, 0, 1, 1, 2, 2], [0, 0, 0, 0, 1, 1], [0, 0, 1, 1, 2, 2])
    fold = folds_of(rows, np.random.default_rng(0))
    assert (fold[rows.size == 1] == IN_NONE).all()
    assert (fold[rows.size == 0] >= 0).all()


def few_runs(runs_of_each):
    """The motor board, one assembly of each size, by an exact law but for friction's scatter."""
    motor = simulate_recording("quick", seed=7, rigs=("motor",))
    runs = motor.motor.runs
    first = runs.groupby("pulley_size")["setup"].transform("first") == runs["setup"]
    kept = runs[first].groupby("pulley_size").head(runs_of_each).reset_index(drop=True)
    return diagnose(replace(motor, motor=replace(motor.motor, runs=kept))).summary


def test_a_size_with_one_assembly_is_not_missed_by_all_of_its_friction():
    summary = few_runs(12)
    (row,) = (row for row in summary.gap.held_out if row.name == "folds over assemblies")
    assert summary.gap.friction_rms < 5  # N: of one load, whose tension differs by friction alone
    assert row.before.q50 < 0.2 * summary.gap.friction_rms
    assert summary.gap.floor_disagreement is None


def test_nothing_is_held_out_of_one_run_of_each_size():
    summary = few_runs(1)
    assert summary.gap.held_out == ()
    assert "No data could be held out" in summary.sentence


def squares(before, after, floor, count=60):
    rng = np.random.default_rng(1)
    ratios = rng.chisquare(20, (3, count)) / 20 / count
    return Squares(None, before * ratios[0], after * ratios[1], floor * ratios[2], np.arange(count))


def row(squared, why=None):
    return gap_row(
        "folds", squared, no_shrink=why, shipped_why="none", rng=np.random.default_rng(2)
    )


def test_a_gap_that_is_closed_shrinks_by_all_of_it():
    gap = row(squares(9.0, 1.0, 1.0))
    assert gap.before.q50 == pytest.approx(3.0, rel=0.05)
    assert gap.shrink.q50 == pytest.approx(1.0, abs=0.05)
    assert gap.below_floor == 0.0


def test_no_gap_no_shrink_and_never_more_than_there_was():
    assert "probability" in row(squares(1.0, 1.0, 1.0)).shrink_why
    assert row(squares(9.0, 1.0, 1.0), "nothing was named").shrink_why == "nothing was named"
    # More taken away than lies above the floor: the floor is not what it is said to be.
    assert (
        "with the causes in the law, the error is smaller than scatter"
        in row(squares(9.0, 0.2, 3.0)).shrink_why
    )


def test_forces_are_redrawn_with_the_covariance_that_is_said(drawn):
    _, residuals, _ = drawn
    again = redrawn(residuals, 4000, np.random.default_rng(2))
    whole = residuals.scattered(np.eye(residuals.size.size))
    sd = np.sqrt(np.diag(whole))
    off = (np.cov(again) - whole) / np.outer(sd, sd)
    assert np.abs(off).max() < 5.5 * np.sqrt(2 / 4000)


@pytest.fixture(scope="module")
def drawn():
    """Residual forces of chance alone, drawn anew many times around the same board."""
    model = model_of(protocol=PROTOCOL, discrepancy=False)
    residuals = residuals_of(model, model.noise.start)
    rng = np.random.default_rng(11)
    identity = np.eye(residuals.size.size)
    covariance = residuals.scattered(identity)
    root = np.linalg.cholesky(covariance + 1e-12 * np.trace(covariance) * identity)
    return model, residuals, root @ rng.standard_normal((len(root), 4000))


@pytest.mark.parametrize("where", ["a fold", "in sample", "top tension"])
def test_a_law_that_is_right_leaves_the_floor(drawn, where):
    """Held out, extrapolated to or fitted to: chance leaves what is said of each window."""
    model, residuals, chance = drawn
    out = {
        "a fold": residuals.setup % 5 == 0,
        "in sample": np.zeros(residuals.size.size, dtype=bool),
        "top tension": extrapolated(residuals)["top tension"],
    }[where]
    refit = refit_of(model, residuals, ~out)
    rows = out if out.any() else ~out
    left2 = (refit.kept(chance)[rows] ** 2).mean(axis=1)
    expected = refit.chance2(residuals, np.zeros((rows.size, 0)))[rows]
    np.testing.assert_allclose(left2, expected, rtol=0.15)
    assert left2.sum() == pytest.approx(expected.sum(), rel=0.03)
    if where != "in sample":
        assert expected.sum() > 1.05 * residuals.chance2[rows].sum()


def test_what_the_law_is_uncertain_by_is_its_scatter_over_redrawn_boards(drawn):
    model, residuals, chance = drawn
    refit = refit_of(model, residuals, residuals.setup % 5 > 0)
    further = residuals.columns[:, -1:]
    spread = refit.spread(residuals, further)
    moved = refit.smoothing @ (chance - further * np.random.default_rng(1).normal(size=4000))
    expected = np.cov(refit.sd[:, None] * moved)
    np.testing.assert_allclose(np.diag(spread @ spread.T), np.diag(expected), rtol=0.1)


@pytest.mark.parametrize(("left", "word"), [(1.0, None), (4.0, "more"), (0.05, "less")])
def test_data_and_floor_that_contradict_each_other_are_told(left, word):
    """A floor of 1 and a gap of 0.2 that is left; sixty assemblies of like friction."""
    by_chance = np.random.default_rng(4).chisquare(60, 400) / 60
    warning = floor_disagrees(left, by_chance, np.full(100, 0.2))
    assert warning is None if word is None else f", {word} than" in warning
    assert floor_disagrees(left, by_chance, np.full(100, 0.2), unnoticed2=5.0) is None


def test_windows_scatter_as_the_parts_say(drawn):
    """Two trials of an assembly share its scatter, those of two assemblies nothing."""
    _, residuals, _ = drawn
    whole = residuals.scattered(np.eye(residuals.size.size))
    np.testing.assert_allclose(np.diag(whole), residuals.chance2)
    window = 0
    other = int(np.flatnonzero((residuals.setup == 0) & (residuals.trial != 0))[0])
    shared = np.sqrt(residuals.scatter[[window, other], 1]) * residuals.friction_n[[window, other]]
    assert whole[window, other] == pytest.approx(shared.prod())
    assert not whole[residuals.setup == 0][:, residuals.setup != 0].any()
