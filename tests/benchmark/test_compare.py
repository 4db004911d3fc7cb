"""The figures of the benchmark, of runs whose figures are known."""

from types import SimpleNamespace

import numpy as np
import pytest
from benchmark import __main__ as command
from benchmark import compare, kernels, ours, page


def independent(mean, sd, seed, shape=(4, 1000)):
    return np.random.default_rng(seed).normal(mean, sd, (*shape, 2))


def test_effective_draws_of_independent_chains_are_their_number():
    run = {"theta": independent(0.0, 1.0, 1), "seconds": 2.0, "before": 3.0}
    figures_of_run = compare.figures_of(run, 2)
    assert figures_of_run["effective_draws"] == pytest.approx(4000, rel=0.1)
    assert figures_of_run["per_second"] == pytest.approx(2000, rel=0.1)
    assert figures_of_run["cold_s"] == pytest.approx(5.0, rel=0.1)


def test_effective_draws_of_weights_are_one_over_the_sum_of_squares():
    weights = np.array([0.5, 0.25, 0.25])
    run = {"theta": np.zeros((3, 2)), "weights": weights, "seconds": 1.0, "before": 0.0}
    assert compare.figures_of(run, 2)["effective_draws"] == pytest.approx(1 / 0.375)


@pytest.mark.parametrize(("mean", "sd"), [(0.15, 1.0), (0.0, 1.15)])
def test_a_mean_or_an_sd_that_differs_is_seen(mean, sd):
    """0.15 over √(2 / 4000) is 6.7 errors of a mean, and 0.15 over √(1 / 4000) more of an sd."""
    reference, same, other = (
        {"theta": independent(*of)} for of in ((0.0, 1.0, 1), (0.0, 1.0, 2), (mean, sd, 2))
    )
    assert compare.largest_z(reference, same) < 3 < 4.5 < compare.largest_z(reference, other)


def test_weights_enter_the_moments_and_their_errors():
    """Draws of N(0, 2²) are weighted to N(0, 1); the errors are known by quadrature."""
    size = 200_000
    theta = np.random.default_rng(1).normal(0.0, 2.0, (size, 1))
    ratio = 2 * np.exp(-0.5 * theta[:, 0] ** 2 * (1 - 0.25))
    (mean, sd), (error, sd_error) = compare.moments(
        {"theta": theta, "weights": ratio / ratio.sum()}
    )
    # The square of the ratio of the densities, times the proposal's.
    x = np.linspace(-10, 10, 20_001)
    weighed = 2 * np.exp(-(x**2) * (1 - 0.125)) / np.sqrt(2 * np.pi) * (x[1] - x[0])
    assert error[0] == pytest.approx(np.sqrt((weighed * x**2).sum() / size), rel=0.02)
    expected = np.sqrt((weighed * (x**2 - 1) ** 2).sum() / size) / 2
    assert sd_error[0] == pytest.approx(expected, rel=0.02)
    assert abs(mean[0]) < 4 * error[0]
    assert abs(sd[0] - 1) < 4 * sd_error[0]


def test_repeats_are_pooled_as_so_many_draws_more():
    runs = [
        {"theta": independent(0.0, 1.0, seed, (100,)), "weights": np.full(100, 0.01)}
        for seed in (1, 2)
    ]
    whole = compare.pooled(runs)
    assert whole["theta"].shape == (200, 2)
    assert whole["weights"].sum() == pytest.approx(1.0)
    np.testing.assert_allclose(
        compare.moments(whole)[0][0], np.mean([run["theta"].mean(axis=0) for run in runs], axis=0)
    )


def figures(rate, cold, r_hat=1.0):
    values = {"per_second": rate, "cold_s": cold, "r_hat": r_hat}
    return {key: compare.spread([value]) for key, value in values.items()}


def test_r_hat_tells_a_chain_that_is_elsewhere():
    theta = independent(0.0, 1.0, 1)
    assert compare.figures_of({"theta": theta, "seconds": 1.0, "before": 0.0}, 2)["r_hat"] < 1.01
    theta[0] += 1.0
    assert compare.figures_of({"theta": theta, "seconds": 1.0, "before": 0.0}, 2)["r_hat"] > 1.1


def test_targets_are_against_the_fastest_of_each():
    figures_by_sampler = {
        "ours": figures(600.0, 1.0),
        "limit": figures(1000.0, 0.5),
        "a": figures(100.0, 20.0),
        "b": figures(150.0, 30.0),
        "unconverged": figures(9e9, 1e-9, r_hat=1.2),
    }
    z = {"limit": 1.0, "a": 2.9, "b": 3.1, "unconverged": 9.0}
    rows = compare.targets("p", figures_by_sampler, z)
    assert [row["ratio"] for row in rows] == [4.0, 20.0, 0.6, 1.0, 2.9, 3.1]
    assert [row["met"] for row in rows] == [False, True, True, True, True, False]
    assert "b" in rows[0]["name"]
    assert "a" in rows[1]["name"]


def test_the_page_says_what_was_missed():
    rows = compare.targets("p", {"ours": figures(4.0, 1.0), "limit": figures(10.0, 1.0)}, {})
    record = {"figures": {"targets": rows, "samplers": {"p": {"ours": figures(4.0, 1.0)}}}}
    assert "| p: share of the limit | 4 | 10 | 0.4 | 0.5 | missed |" in page.text(record)


@pytest.mark.parametrize(("seconds", "met"), [(19.0, True), (21.0, False)])
def test_a_limit_is_met_from_below(seconds, met):
    row = compare.within("claims, seconds", seconds, 20.0)
    assert row["met"] is met
    assert page.line(row).endswith("met)" if met else "missed)")
    assert row["ratio"] == pytest.approx(seconds / 20.0)


def test_a_kernel_has_a_limit_or_a_peer():
    alone = kernels.row({"name": "k", "within_s": 0.5}, 0.25)
    beside = kernels.row({"name": "k", "within_s": None, "peer_s": 30.0, "goal": 100}, 0.25)
    assert (alone["ratio"], alone["met"]) == (0.5, True)
    assert (beside["ratio"], beside["met"]) == (120.0, True)
    assert not kernels.row({"name": "k", "within_s": 0.5}, 0.75)["met"]


@pytest.mark.parametrize(("extensions", "steps", "seconds"), [(0, 2, 4.0), (1, 2, 28.0)])
def test_seconds_are_those_of_the_steps_whose_draws_are_kept(extensions, steps, seconds):
    """Two ensembles: a step of burn-in takes 5 s and one after it 1 s; one of a later run 7 s."""
    settings = SimpleNamespace(ensembles=2, burn=1)
    draws = SimpleNamespace(extensions=extensions, steps=steps)
    taken = [5.0, 1.0, 1.0] * 2 + [7.0] * (2 * steps * extensions)
    clock = (100.0 + np.cumsum(taken)).tolist()
    assert ours.seconds_of_kept(clock, draws, settings) == pytest.approx(seconds)


def test_without_peers_each_target_is_printed_beside_its_goal(monkeypatch, capsys):
    parts = ("verbs", "kernels", "workers", "marginal", "sizes")
    for name in parts:
        row = compare.within(f"seconds of {name}", 3.0, 2.0)
        monkeypatch.setattr(
            getattr(command, name), "targets", lambda *_, row=row: ([row], {"all": 3.0})
        )
    monkeypatch.setattr(command.problems, "model_of", lambda _: (None,))
    rows, figures = command.without_peers()
    assert [row["met"] for row in rows] == [False] * len(parts)
    assert len(figures) == len(parts)
    assert "seconds of sizes: 3 to 2, ratio" in capsys.readouterr().out
