"""A reading far from all others counts little: what is named is what is named without it."""

from types import SimpleNamespace

import numpy as np
import pytest
from diagnosis.driven_axis import model_of_axis
from diagnosis.test_held_out_density import points_model
from rigs.friction_points import recorded
from scipy.stats import multivariate_normal

import bayesfric as bf
from bayesfric.diagnosis import strays
from bayesfric.diagnosis.residuals import residuals_of, spread_numbers
from bayesfric.diagnosis.strays import stray_weights


def table(seed, viscous, stray=None):
    """Return 17 points of a joint, one of them 40 % too large."""
    rng = np.random.default_rng(seed)
    speed = np.linspace(0.05, 1.0, 17)
    friction = (8 + viscous * speed) * (1 + 0.01 * rng.standard_normal(17))
    if stray is not None:
        friction[stray] *= 1.4
    return {"velocity_m_s": speed, "friction_n": friction}


def found_of(folder, *what):
    return bf.diagnose(recorded(folder / "bench", table(*what))).summary


@pytest.fixture(scope="module")
def clean(tmp_path_factory):
    return found_of(tmp_path_factory.mktemp("clean"), 1, 3.0)


def slope_of(summary):
    (cause,) = summary.causes
    assert cause.effect == "viscous"
    return cause.parameters["slope"]


@pytest.mark.parametrize(
    "stray", [0, *(pytest.param(n, marks=pytest.mark.nightly) for n in (1, 9)), 15]
)
def test_points_with_one_stray_are_named_as_without_it(tmp_path, clean, stray):
    with_stray = found_of(tmp_path, 1, 3.0, stray)
    assert with_stray.verdict == clean.verdict == "named"
    expected = slope_of(clean)
    assert slope_of(with_stray).mean == pytest.approx(expected.mean, abs=expected.sd)
    (line,) = [remark for remark in with_stray.attention if "little weight" in remark]
    assert line.endswith(f": r{stray:03d}")


def test_a_stray_alone_is_no_gap(tmp_path):
    assert found_of(tmp_path, 2, 0.0, 9).verdict == "no-gap"


def test_a_table_without_one_says_nothing_of_strays(clean):
    assert not any("little weight" in remark for remark in clean.attention)


def test_a_stray_has_the_weight_of_a_student_t_density():
    """Of robust standard deviation 1: at 10, (4 + 1) / (4 + 100)."""
    off = np.append(np.linspace(-1.5, 1.5, 99) * 0.8994, 10.0)
    spread = 1.4826 * np.median(np.abs(off))
    weight = stray_weights(off)
    np.testing.assert_array_equal(weight[:99], 1.0)
    assert weight[99] == pytest.approx(5 / (4 + (10 / spread) ** 2))


@pytest.mark.parametrize(
    "off",
    [
        np.append(np.zeros(30), 5.0),  # no scatter to be far from
        np.append(np.linspace(-1, 1, 6), 50.0),  # too few rows
        np.random.default_rng(1).standard_normal(3000),
        np.zeros(0),
    ],
)
def test_what_is_no_stray_counts_as_all_others(off):
    np.testing.assert_array_equal(stray_weights(off), np.ones(off.size))


def test_one_in_six_far_away_are_a_force_and_no_strays():
    assert stray_weights(np.append(np.linspace(-1, 1, 40), np.full(8, 20.0))) is None


def test_the_farthest_reading_alone_is_taken_at_a_time():
    """It may have pulled its neighbours away."""
    off = np.append(np.linspace(-1, 1, 60), [9.0, -30.0, 8.0])
    weight = stray_weights(off, np.ones(63))
    assert list(np.flatnonzero(weight < 1)) == [61]
    assert list(np.flatnonzero(stray_weights(off, weight) < 1)) == [60, 61]


def test_readings_with_weights_have_the_density_of_a_normal_with_their_variance(tmp_path):
    model, at, acting = points_model(tmp_path, 2.0)
    weight = np.ones(60)
    weight[[4, 17, 59]] = 0.01, 0.3, 2.0
    weighted = model.around(model.laws, model.candidates, row_weights={"steady-points": weight})
    mean, sd = weighted.prior([weighted.amplitude_prior(law) for law in acting.laws])
    windows = residuals_of(weighted, at.psi)
    plain = residuals_of(model, at.psi)
    np.testing.assert_allclose(windows.chance2[17] / plain.chance2[17], 1 / 0.3, rtol=1e-3)
    local = spread_numbers(weighted, np.vstack([mean, np.diag(sd)]), weighted.mixing(acting))
    middle, *columns = local[:, 0] @ windows.columns.T
    covariance = np.transpose(columns) @ np.array(columns) + np.diag(windows.chance2)
    expected = multivariate_normal(middle, covariance).logpdf(windows.residual_n)
    value = weighted.evaluate(at.psi, acting).value - weighted.log_prior(at.psi, acting)[0]
    assert value == pytest.approx(expected, abs=1e-6)


@pytest.mark.nightly
def test_rows_of_an_axis_with_weights_have_so_much_less_error(driven_axis):
    """All rows with a weight of a quarter are rows whose own errors are twice as large."""
    model, psi = model_of_axis(driven_axis, lambda effect: [])
    (rig,) = model.rigs
    quarter = np.full(rig.rows.readings.count, 0.25)
    (weighted,) = model.around(model.laws, (), row_weights={rig.rows.name: quarter}).rigs
    noise = model.noise.named(psi)
    larger = noise | {
        name: 2 * noise[name] for name in ("sigma_position", "sigma_force", "wander_axis")
    }
    nothing = np.zeros((0, 0))
    information = weighted.evaluate(noise, nothing).information
    expected = rig.evaluate(larger, nothing).information
    assert information.constant == pytest.approx(expected.constant, abs=1e-6)
    np.testing.assert_allclose(information.slope, expected.slope, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(information.precision, expected.precision, rtol=1e-7, atol=1e-9)
    weighted_windows, other = (
        part.windows(level) for part, level in ((weighted, noise), (rig, larger))
    )
    np.testing.assert_allclose(weighted_windows.covariance[0], other.covariance[0])


def test_rows_of_the_papers_boards_count_alike_and_are_not_looked_at(monkeypatch):
    monkeypatch.setattr(strays, "residuals_of", None)  # which takes as long as all hypotheses
    boards = [
        SimpleNamespace(rig=SimpleNamespace(words=SimpleNamespace(paper=True))) for _ in range(2)
    ]
    whole = SimpleNamespace(row_weights={})
    model = SimpleNamespace(data=SimpleNamespace(rigs=boards), full=whole)
    assert strays.without_strays(model, "hypotheses", None) == (model, "hypotheses")
