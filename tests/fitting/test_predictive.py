"""What the figures draw, each number against another way to it."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from altered import of_size, with_trials
from scipy import special, stats

from bayesfric.analysis import Analysis, Sampler
from bayesfric.fitting.posterior import fit
from bayesfric.report.assembly import build_document
from bayesfric.report.content import Figure
from bayesfric.report.stored import StoredFit, StoredResults
from bayesfric.rigs.protocols import Protocol
from bayesfric.rigs.remaking import remake
from bayesfric.rigs.residuals import check_residuals, measuring_order
from bayesfric.simulate import simulate_recording

TO_SD = 2 * stats.norm.ppf(0.95)  # widths of a 90 % interval


def chosen(data, dim, **wanted):
    """The rows of a Dataset whose columns have these values."""
    matching = np.all([data[name].to_numpy() == value for name, value in wanted.items()], axis=0)
    return data.isel({dim: np.flatnonzero(matching)})


def law_draws(fitted, size):
    posterior = fitted.draws["posterior"].sel(pulley=size)
    return {name: posterior[name].to_numpy().ravel() for name in ("c1", "c2", "c3")}


def mean_of(fitted, name):
    return float(fitted.draws["posterior"][name].mean())


def test_slopes_are_those_of_the_trials(wrap_fit):
    trials = wrap_fit.predictive["trials"].to_dataset()
    lines = wrap_fit.predictive["tension_lines"].to_dataset()
    assert lines.sizes["cell"] == 3 * 6
    for place in range(lines.sizes["cell"]):
        cell = lines.isel(cell=place)
        key = {n: cell[n].item() for n in ("pulley_size", "n_pulleys", "wrap_angle_deg")}
        some = chosen(trials, "trial", **key)
        slope, intercept = np.polyfit(some["tension_n"], some["friction_n"], 1)
        assert cell["slope"].item() == pytest.approx(slope, rel=0.01)
        assert cell["intercept_n"].item() == pytest.approx(intercept, rel=0.03)
        assert cell["trials"].item() == some.sizes["trial"]
        assert cell["upright"].item() == (key["wrap_angle_deg"] == 85.0)
    assert float(lines["least_r_squared"]) == lines["r_squared"].to_numpy().min()


def test_a_slope_made_again_scatters_as_assemblies_and_trials_do(wrap_fit):
    """In closed form: the assembly scales the whole line, each trial tilts it by its weight."""
    trials = wrap_fit.predictive["trials"].to_dataset()
    lines = wrap_fit.predictive["tension_lines"].to_dataset()
    key = {"pulley_size": "medium", "n_pulleys": 9, "wrap_angle_deg": 50.0}
    some = chosen(trials, "trial", **key)
    tension, friction = some["tension_n"].to_numpy(), some["law_n"].to_numpy()[:, 1]
    apart = tension - tension.mean()
    weights = apart / (apart**2).sum()
    law = law_draws(wrap_fit, "medium")
    by_law = 9 * np.std(law["c1"] - 35 * law["c3"])
    # friction tilts the nominal tension by a hundredth of itself: left out
    by_assembly = mean_of(wrap_fit, "omega") * (weights @ friction)
    by_trial = mean_of(wrap_fit, "tau") * np.sqrt((weights**2) @ (friction**2))
    low, middle, high = chosen(lines, "cell", **key)["slope_again"].to_numpy()[0]
    expected = np.sqrt(by_law**2 + by_assembly**2 + by_trial**2)
    assert (high - low) / TO_SD == pytest.approx(expected, rel=0.12)
    assert middle == pytest.approx(9 * np.median(law["c1"] - 35 * law["c3"]), rel=0.01)


def test_bands_of_the_law_are_n_times_the_coefficients(wrap_fit):
    lines = wrap_fit.predictive["tension_lines"].to_dataset().sel(pulley="small")
    count = lines["n"].to_numpy()
    assert (count[0], count[-1]) == (0, 15)
    law = law_draws(wrap_fit, "small")
    for name, column in (("slope_law", law["c1"]), ("intercept_law_n", law["c2"])):
        expected = count[:, None] * np.quantile(column, (0.05, 0.5, 0.95))
        assert lines[name].to_numpy() == pytest.approx(expected, rel=0.01)
    assert lines["slope_paper"].to_numpy() == pytest.approx(0.0128 * count)
    assert lines["intercept_paper_n"].to_numpy() == pytest.approx(0.0261 * count)


def test_friction_against_wrap_is_read_off_the_lines_in_tension(wrap_fit):
    lines = wrap_fit.predictive["tension_lines"].to_dataset()
    wraps = wrap_fit.predictive["wrap_lines"].to_dataset()
    trials = wrap_fit.predictive["trials"].to_dataset()
    tensions = trials["tension_n"].to_numpy()
    levels = wraps["level"].to_numpy()
    assert tensions.min() < levels[0] < 9
    assert 25 < levels[-1] < tensions.max()
    law = law_draws(wrap_fit, "large")
    for place in np.flatnonzero(wraps["pulley_size"].to_numpy() == "large"):
        line = wraps.isel(line=place)
        n, tension = line["n_pulleys"].item(), line["tension_n"].item()
        cells = chosen(lines, "cell", pulley_size="large", n_pulleys=n)
        angle = cells["wrap_angle_deg"].to_numpy()
        friction = cells["slope"].to_numpy() * tension + cells["intercept_n"].to_numpy()
        assert line["wrap_angle_deg"].to_numpy()[: len(angle)] == pytest.approx(angle)
        assert line["friction_n"].to_numpy()[: len(angle)] == pytest.approx(friction)
        assert line["slope_n_per_deg"].item() == pytest.approx(np.polyfit(angle, friction, 1)[0])
        at_50 = n * ((law["c1"] - 35 * law["c3"]) * tension + law["c2"])
        expected = np.quantile(at_50, (0.05, 0.5, 0.95))
        assert line["law_n"].to_numpy()[0] == pytest.approx(expected, rel=0.01)
        # nine in ten of what is made again, about the law
        low, middle, high = line["slope_again_n_per_deg"].to_numpy()
        assert middle == pytest.approx(n * tension * np.median(law["c3"]), rel=0.15)
        assert low < line["slope_n_per_deg"].item() < high


def test_law_of_the_wrap_slope_is_n_times_tension_times_c3(wrap_fit):
    wraps = wrap_fit.predictive["wrap_lines"].to_dataset().sel(pulley="medium")
    c3 = np.quantile(law_draws(wrap_fit, "medium")["c3"], (0.05, 0.5, 0.95))
    n, tension = wraps["n"].to_numpy(), wraps["tension"].to_numpy()
    for place, level in enumerate(wraps["level"].to_numpy()):
        expected = n[:, None] * level * c3
        law = wraps["law_against_n"].isel(level=place).to_numpy()
        assert law == pytest.approx(expected, rel=0.03, abs=1e-9)
    for place, count in enumerate(wraps["count"].to_numpy()):
        expected = count * tension[:, None] * c3
        law = wraps["law_against_tension"].isel(count=place).to_numpy()
        assert law == pytest.approx(expected, rel=0.03, abs=1e-9)


def test_a_recording_of_one_tension_has_no_lines_and_still_a_report():
    recording = simulate_recording(Protocol({(9, 85.0): 1}, (16.0,), (), 2), seed=3)
    recording = with_trials(recording, of_size(recording, "medium"))
    fitted = fit(recording, Analysis(sampler=Sampler(burn=20, steps=80, thin=2, extensions=0)))
    for group in ("tension_lines", "wrap_lines"):
        assert not fitted.predictive[group].data_vars
    document = build_document(
        StoredResults(StoredFit(fitted.summary, fitted.draws, fitted.predictive))
    )
    labels = {block.label for block in document.every_block if isinstance(block, Figure)}
    assert "tension" in labels
    assert not labels & {"pulleys", "wrap", "wrap-slopes"}


def test_one_wrap_angle_a_number_of_pulleys_gives_no_wrap_lines(small_fit):
    assert not small_fit.predictive["wrap_lines"].data_vars
    assert small_fit.predictive["tension_lines"].sizes["cell"] == 9


def scatter_draws(fitted):
    posterior = fitted.draws["posterior"]
    return posterior["tau"].to_numpy().ravel(), posterior["omega"].to_numpy().ravel()


def test_z_is_the_distance_in_units_of_both_scatters(wrap_fit):
    trials = wrap_fit.predictive["trials"].to_dataset()
    posterior = wrap_fit.draws["posterior"]
    law = trials["law_n"].to_numpy()
    c2 = posterior["c2"].sel(pulley=trials["pulley_size"].to_numpy()).to_numpy()
    share = trials["n_pulleys"].to_numpy() * c2.reshape(-1, len(law)) / law[:, 1]
    intercept = posterior["omega_intercept"].to_numpy().reshape(-1, 1) * share
    tau, omega = (values[:, None] for values in scatter_draws(wrap_fit))
    deviation = np.tile(np.sqrt(tau**2 + omega**2 + intercept**2), (16, 1))  # quantiles are read
    deviation = deviation * np.random.default_rng(0).standard_normal(deviation.shape)
    low, high = np.quantile(deviation, (0.05, 0.95), axis=0)
    sd = np.hypot((high - low) * law[:, 1], law[:, 2] - law[:, 0]) / TO_SD
    expected = (trials["friction_n"].to_numpy() - law[:, 1]) / sd
    assert trials["z"].to_numpy() == pytest.approx(expected, rel=0.12, abs=0.16)


def test_coverage_counts_trials_and_expects_assemblies_to_move_together(wrap_fit):
    trials = wrap_fit.predictive["trials"].to_dataset()
    z = trials["z"].to_numpy()
    inside = (np.abs(z) < stats.norm.ppf(0.95)).mean()
    assert float(trials["covered_share"]) == pytest.approx(inside, abs=2 / len(z))
    rng = np.random.default_rng(0)
    tau, omega = (values[:, None] for values in map(rng.permutation, scatter_draws(wrap_fit)))
    _, setup = np.unique(trials["setup"].to_numpy(), return_inverse=True)
    shift = omega * rng.standard_normal((len(omega), setup.max() + 1))[:, setup]
    deviation = shift + tau * rng.standard_normal(shift.shape)
    low, high = np.quantile(deviation, (0.05, 0.95))
    share = ((low < deviation) & (deviation < high)).mean(axis=1)
    expected = np.quantile(share, (0.05, 0.5, 0.95))
    assert trials["covered_expected"].to_numpy() == pytest.approx(expected, abs=0.04)


def test_runs_of_the_motor_board_are_checked_with_the_noise_of_the_current(wrap_fit):
    runs = wrap_fit.predictive["runs"].to_dataset()
    assert runs["z"].to_numpy().std() == pytest.approx(1, abs=0.25)
    low, _, high = runs["covered_expected"].to_numpy()
    assert low <= float(runs["covered_share"]) <= high


def test_an_outlier_is_beyond_what_one_recording_in_twenty_has():
    def draw_observed(named, deviation, rng):
        return 10 * (1 + deviation)

    def draw_scatter(named, rng, *, together):
        assert together
        return np.broadcast_to([0.0, 0.0, 0.5], (10_000, 3))  # the third alone leaves its interval

    fake = SimpleNamespace(draw_observed=draw_observed, draw_scatter=draw_scatter)
    deviation = 0.2 * np.repeat(stats.norm.ppf(np.arange(0.5e-4, 1, 1e-4))[:, None], 3, axis=1)
    limit = stats.norm.ppf(1 - 0.05 / 6)
    observed = np.array([12.0, 10 + 2 * (limit - 0.01), 10 - 2 * (limit + 0.01)])
    remade = remake(fake, {}, deviation, np.random.default_rng(0))
    checked = check_residuals("trial", remade, observed)
    assert checked["z"][1] == pytest.approx([1, limit - 0.01, -limit - 0.01], rel=1e-3)
    assert checked["z_limit"] == pytest.approx(limit)
    assert checked["outlier"][1].tolist() == [False, False, True]
    assert checked["covered_share"] == pytest.approx(1 / 3)
    assert checked["covered_expected"][1] == pytest.approx([2 / 3] * 3)


def test_order_is_the_recorded_one_else_that_of_the_file():
    recorded = pd.DataFrame({"trial": list("abc"), "order": [30, 10, 20]})
    table = pd.DataFrame({"trial": ["c", "a"]})
    assert measuring_order(recorded, table).tolist() == [20, 30]
    assert measuring_order(recorded[["trial"]], table).tolist() == [3, 1]


def test_densities_are_the_prior_and_a_histogram_of_the_draws(small_fit):
    table = small_fit.predictive["densities"].to_dataset()
    entry = table.sel(parameter="c1[medium]")
    edge, height = entry["value"].to_numpy(), entry["posterior"].to_numpy()
    draws = law_draws(small_fit, "medium")["c1"]
    assert edge[[0, -1]] == pytest.approx(np.quantile(draws, (5e-4, 1 - 5e-4)))
    assert height @ np.diff(edge) == pytest.approx(0.999, abs=1e-3)
    below = np.searchsorted(np.sort(draws), edge[20]) / len(draws) - 5e-4
    assert height[:20] @ np.diff(edge)[:20] == pytest.approx(below, abs=1e-3)
    assert entry["prior"].to_numpy() == pytest.approx(stats.halfnorm(scale=0.01).pdf(edge))
    wrap = table.sel(parameter="c3[large]")
    # A half-normal times a normal: the Bessel function K0 of their product.
    scale = 0.01 * 0.005
    expected = special.k0(np.abs(wrap["value"]) / scale) / (np.pi * scale)
    assert wrap["prior"].to_numpy() == pytest.approx(expected.to_numpy(), rel=0.02)
    assert [entry["unit"].item(), wrap["unit"].item()] == ["1", "1/deg"]
