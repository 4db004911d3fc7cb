"""What runs of an axis share, where effects scatter along: against dense normals."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from bayesfric.rigs.single_axis.deviations import (
    COLUMNS,
    SHARED,
    WAVES,
    Levels,
    Shared,
    deviating_columns,
    map_spectrum,
)

RUN = np.repeat(np.arange(5), 7)
SETUP = np.array([0, 0, 1, 1, 2])
ERROR = 0.05


@pytest.fixture(scope="module")
def rows():
    """Friction of 1.5, with a curve that is large over half of the rows."""
    rng = np.random.default_rng(8)
    position = rng.uniform(-0.2, 0.3, RUN.size)
    law = np.full(RUN.size, 1.5)
    effect = np.where(np.arange(RUN.size) % 2, 0.9, 0.0)
    time = rng.uniform(0.0, 5.0, RUN.size)
    columns = deviating_columns(position, law + effect, law, time)
    return columns, rng.standard_normal((RUN.size, 3))


def levels(run, setup, slow=2e-3):
    spectrum = map_spectrum(0.1, 2.0)[0]
    in_time = map_spectrum(0.3, 1.0, WAVES)[0]
    return Levels(run, setup, 1e-4 * spectrum, 4e-4 * spectrum, slow * in_time)


def shared(rows, at):
    columns, further = rows
    z = np.column_stack([columns, further])
    grams = np.stack([columns[run == RUN].T @ z[run == RUN] / ERROR**2 for run in range(5)])
    return Shared(grams, further.T @ further / ERROR**2, SETUP, at)


def dense(rows, at):
    """Return the covariance: what all runs have in common is the law's friction alone."""
    columns, _ = rows
    moved, cosines, law = columns[:, 0], columns[:, 1 : SHARED - 1], columns[:, SHARED - 1]
    in_time = columns[:, SHARED:]
    same_run = np.equal.outer(RUN, RUN)
    of_row = SETUP[RUN]
    of_runs = at.run * np.eye(5) + at.setup * np.equal.outer(SETUP, SETUP)
    every = 1 / np.linalg.inv(of_runs).sum()  # the variance of the best mean
    deviation = at.run * same_run + at.setup * np.equal.outer(of_row, of_row) - every
    covariance = deviation * np.outer(moved, moved) + every * np.outer(law, law)
    covariance += (cosines * at.machine_map) @ cosines.T + same_run * (
        (cosines * at.run_map) @ cosines.T
    )
    covariance += same_run * ((in_time * at.slow) @ in_time.T)
    return covariance + ERROR**2 * np.eye(RUN.size)


def test_the_density_is_that_of_a_dense_normal_whose_common_part_is_the_laws(rows):
    at = levels(0.03, 0.02)
    deviations = shared(rows, at)
    covariance = dense(rows, at)
    further = rows[1]
    np.testing.assert_allclose(
        deviations.rest, further.T @ np.linalg.solve(covariance, further), rtol=1e-7
    )
    y = further[:, 0]
    density = deviations.constant - 0.5 * deviations.rest[0, 0]
    density -= 0.5 * RUN.size * np.log(2 * np.pi * ERROR**2)
    expected = multivariate_normal(np.zeros(RUN.size), covariance).logpdf(y)
    assert density == pytest.approx(expected, rel=1e-9)


def test_moments_are_derivatives_of_the_density(rows):
    mixed = np.array([[1.0], [0.0], [0.0]])

    def density(run, setup, slow=2e-3):
        deviations = shared(rows, levels(run, setup, slow))
        return 2 * deviations.constant - float(mixed[:, 0] @ deviations.rest @ mixed[:, 0])

    run, setup, _, _, slow = shared(rows, levels(0.03, 0.02)).moments(mixed)
    step = 1e-6
    moved = density(0.03 + step, 0.02) - density(0.03 - step, 0.02)
    assert run == pytest.approx(moved / (2 * step), rel=1e-5)
    moved = density(0.03, 0.02 + step) - density(0.03, 0.02 - step)
    assert setup == pytest.approx(moved / (2 * step), rel=1e-5)
    moved = density(0.03, 0.02, 2e-3 + step) - density(0.03, 0.02, 2e-3 - step)
    in_time = map_spectrum(0.3, 1.0, WAVES)[0]
    assert in_time @ slow == pytest.approx(moved / (2 * step), rel=1e-5)


def test_rows_without_what_deviates_are_those_of_the_dense_inverse(rows):
    at = levels(0.03, 0.02)
    columns, further = rows
    deviations, covariance = shared(rows, at), dense(rows, at)
    numbers, taken = deviations.of_rows()
    assert numbers.shape == (5, COLUMNS, 3)
    lent = np.column_stack([columns, further]) / ERROR**2
    left = lent[:, COLUMNS:] - np.einsum("wk,wkm->wm", lent[:, :COLUMNS], numbers[RUN])
    np.testing.assert_allclose(left, np.linalg.solve(covariance, further), rtol=1e-6)
    inverse = np.linalg.inv(covariance)
    for run in range(5):
        mine = run == RUN
        pulled = lent[mine, :COLUMNS]
        own = np.eye(mine.sum()) / ERROR**2 - pulled @ taken[run] @ pulled.T
        np.testing.assert_allclose(own, inverse[np.ix_(mine, mine)], rtol=1e-6, atol=1e-6)


def test_a_curve_that_all_runs_have_is_no_scatter(rows):
    """However large the scatter is, a curve that runs have in common costs what errors say."""
    columns, _ = rows
    law, curve = columns[:, SHARED - 1], columns[:, 0] - columns[:, SHARED - 1]
    away = curve - law * (curve @ law) / (law @ law)
    nothing = 0 * map_spectrum(0.1, 2.0)[0]
    for scatter in (1e-4, 1.0, 1e4):
        at = Levels(scatter, scatter, nothing, nothing, np.zeros(WAVES))
        rest = shared((columns, np.column_stack([law, curve])), at).rest
        cost = rest[1, 1] - rest[0, 1] ** 2 / rest[0, 0]
        assert cost > 0.9 * (away @ away) / ERROR**2
