"""A stored fit: what it says, that ArviZ opens it, that it is whole and repeats."""

import csv
import dataclasses
import json

import numpy as np
import pytest
import xarray as xr
from altered import by_acceleration, of_size, with_trials
from report.hostile import IN_CELLS

import bayesfric as bf
from bayesfric.analysis import Analysis, Sampler
from bayesfric.chains import by_walker
from bayesfric.errors import InputError
from bayesfric.fitting.inference_data import write_csv
from bayesfric.results import read_json, read_tree
from bayesfric.rigs.protocols import Protocol
from bayesfric.schemas import FitFile
from bayesfric.simulate import simulate_recording

SCATTER = {"tau", "omega", "omega_intercept", "wander", "wander_length"}
SCATTER_AND_NOISE = (*sorted(SCATTER), "sigma_x", "sigma_t")
SHORT = Sampler(burn=10, steps=80, thin=3, extensions=0)


def test_public_names_are_the_functions():
    assert bf.fit.__module__ == "bayesfric.notebook.calls"
    assert set(bf.__all__) <= set(dir(bf))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        bf.nothing  # noqa: B018


def test_written_files_say_what_the_fit_says(small_fit, tmp_path):
    small_fit.write(tmp_path, csv=True)
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["draws.csv", "draws.nc", "fit.json", "predictive.nc", "timings.json"]
    assert read_json(FitFile, tmp_path / "fit.json") == small_fit.summary
    posterior = read_tree(tmp_path / "draws.nc")["posterior"]
    for size, coefficients in small_fit.summary.pulleys.items():
        for name, entry in coefficients.items():
            draws = posterior[name].sel(pulley=size).to_numpy()
            assert entry.mean == pytest.approx(draws.mean(), rel=1e-12)
            quantiles = np.quantile(draws, [0.05, 0.5, 0.95])
            assert [entry.q05, entry.q50, entry.q95] == pytest.approx(quantiles, rel=1e-12)
            assert entry.mcse_mean == pytest.approx(draws.std() / np.sqrt(entry.ess_bulk), rel=1e-9)
    text = (tmp_path / "fit.json").read_text("utf-8")
    assert "NaN" not in text
    assert "Infinity" not in text
    assert json.loads(text)["schema"] == "bayesfric.fit/1"


def test_draws_say_what_was_tested_and_informed(small_fit, small_recording, tmp_path):
    small_fit.write(tmp_path)
    attributes = read_tree(tmp_path / "draws.nc").attrs
    trials = small_recording.gravity.trials
    for size, coefficients in small_fit.summary.pulleys.items():
        trials_of_size = trials[trials["pulley_size"] == size]
        for key, column in (("n_pulleys", "n_pulleys"), ("wrap_angle_deg", "wrap_angle_deg")):
            low, high = attributes[f"tested.{size}.{key}"]
            assert (low, high) == (trials_of_size[column].min(), trials_of_size[column].max())
        # both masses hang in the cable: between their mean weight and a little beside it
        low, high = attributes[f"tested.{size}.tension_n"]
        weight = 9.81 * (trials_of_size["mass_drive_kg"] + trials_of_size["mass_load_kg"]) / 2
        assert low == pytest.approx(weight.min(), rel=0.05)
        assert high == pytest.approx(weight.max(), rel=0.05)
        informed = " ".join(
            name for name, coefficient in coefficients.items() if coefficient.informed
        )
        assert attributes[f"informed.{size}"] == informed


def test_csv_has_the_draws(small_fit, tmp_path):
    small_fit.write(tmp_path, csv=True)
    with (tmp_path / "draws.csv").open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    posterior = small_fit.draws["posterior"]
    assert len(rows) == posterior.sizes["chain"] * posterior.sizes["draw"]
    last = posterior["c2"].isel(chain=-1, draw=-1).sel(pulley="medium").item()
    assert float(rows[-1][header.index("c2[medium]")]) == last
    assert float(rows[0][header.index("tau")]) == posterior["tau"].isel(chain=0, draw=0).item()


def test_no_cell_of_the_csv_starts_a_formula(small_fit, tmp_path):
    """A header is a parameter with its size after it, whatever a hundred sizes are named."""
    draws = small_fit.draws.isel(draw=slice(0, 2), chain=slice(0, 2))
    posterior = draws["posterior"].to_dataset().isel(pulley=np.zeros(len(IN_CELLS), dtype=int))
    draws["posterior"] = xr.DataTree(posterior.assign_coords(pulley=list(IN_CELLS)))
    write_csv(draws, tmp_path / "draws.csv")
    with (tmp_path / "draws.csv").open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert {f"c1[{text}]" for text in IN_CELLS} <= set(header)
    assert not [name for name in header if name.startswith(("=", "+", "-", "@", "\t", "\r"))]
    assert np.isfinite(np.array(rows, dtype=np.float64)).all()  # numbers alone, signs and all


def test_pointwise_likelihood_is_that_of_the_draws(small_fit, small_recording):
    """The assemblies' densities add up to the density of the whole."""
    from rigs.hall import gravity_likelihood

    from bayesfric.rigs.gravity_board.screening import screen_trials

    screened = screen_trials(small_recording.gravity, small_recording.rig)
    likelihood = gravity_likelihood(screened.gravity, small_recording.rig, Analysis())
    pointwise = small_fit.draws["log_likelihood"]["assembly"]
    draw = int(pointwise["draw"][-1])
    point = small_fit.draws["posterior"].sel(draw=draw).isel(chain=3)
    theta = {
        f"{c}[{size}]": point[c].sel(pulley=size).to_numpy()[None]
        for c in ("c1", "c2", "c3")
        for size in likelihood.sizes
    }
    theta |= {n: point[n].to_numpy()[None] for n in SCATTER_AND_NOISE}
    stored = pointwise.sel(draw=draw).isel(chain=3)
    assert float(stored.sum()) == pytest.approx(likelihood.log_likelihood(theta)[0], rel=1e-12)


def test_sensitivity_is_that_of_priors_and_likelihood(small_recording, small_fit):
    """Both densities of the stored draws, worked out again: priors by SciPy."""
    from rigs.hall import gravity_likelihood
    from scipy import stats

    from bayesfric.inference.diagnostics import power_scaling
    from bayesfric.rigs.gravity_board.screening import screen_trials

    posterior = by_walker(small_fit.draws["posterior"].to_dataset())
    screened = screen_trials(small_recording.gravity, small_recording.rig)
    likelihood = gravity_likelihood(screened.gravity, small_recording.rig, Analysis())
    widths = {"c1": 0.01, "c2": 0.04, "tau": 0.05, "omega": 0.05, "sigma_x": 1e-4, "sigma_t": 1e-4}
    widths |= {"omega_intercept": 0.05, "wander": 0.02}
    ensembles, walkers = (getattr(small_fit.summary.sampler, n) for n in ("ensembles", "walkers"))

    def by_ensemble(values):  # smoothed weights depend on what counts as a chain
        walks = values.to_numpy().reshape(ensembles, walkers, -1)
        return walks.swapaxes(1, 2).ravel()

    theta = {n: by_ensemble(posterior[n]) for n in SCATTER_AND_NOISE}
    for size in likelihood.sizes:
        of_size = posterior.sel(pulley=size)
        theta |= {f"{c}[{size}]": by_ensemble(of_size[c]) for c in ("c1", "c2", "c3")}
    log_prior = sum(
        stats.norm(0, 0.005 * theta[name.replace("c3", "c1")]).logpdf(values)
        if name.startswith("c3")
        else stats.lognorm(0.5, scale=0.1).logpdf(values)
        if name == "wander_length"
        else stats.halfnorm(scale=widths[name.partition("[")[0]]).logpdf(values)
        for name, values in theta.items()
    )
    log_likelihood = likelihood.log_likelihood(theta)
    for size, coefficients in small_fit.summary.pulleys.items():
        for name, entry in coefficients.items():
            values = theta[f"{name}[{size}]"].reshape(ensembles, -1, 1)
            of_prior = power_scaling(values, log_prior.reshape(ensembles, -1))
            of_likelihood = power_scaling(values, log_likelihood.reshape(ensembles, -1))
            assert entry.prior_sensitivity == pytest.approx(of_prior[0], rel=1e-6)
            assert entry.likelihood_sensitivity == pytest.approx(of_likelihood[0], rel=1e-6)
    assert all(scatter.prior_sensitivity is None for scatter in small_fit.summary.scatter.values())


@pytest.fixture(scope="module")
def fast(small_recording):
    """One size of it by accelerations, of which a fit takes a second."""
    return by_acceleration(with_trials(small_recording, of_size(small_recording, "small")))


@pytest.mark.nightly
def test_same_seed_same_result(fast):
    first, again, other = (bf.fit(fast, Analysis(seed=seed, sampler=SHORT)) for seed in (5, 5, 6))
    assert again.summary == first.summary
    assert again.draws.identical(first.draws)
    assert again.predictive.identical(first.predictive)
    assert other.summary.pulleys != first.summary.pulleys


def test_date_comes_from_the_environment_or_the_recording(fast, monkeypatch):
    dated = dataclasses.replace(fast, created="2026-11-01T00:00:00Z")
    assert bf.fit(dated, Analysis(sampler=SHORT)).summary.created == "2026-11-01T00:00:00Z"
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    assert bf.fit(dated, Analysis(sampler=SHORT)).summary.created == "1970-01-02T00:00:00Z"
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "yesterday")
    with pytest.raises(InputError, match="SOURCE_DATE_EPOCH"):
        bf.fit(dated, Analysis(sampler=SHORT))


def test_without_replicates_the_reader_is_told():
    design = Protocol({(5, 85.0): 1, (9, 85.0): 1, (9, 50.0): 1}, (6.0, 16.0), (6.0, 16.0), 2)
    recording = by_acceleration(simulate_recording(design, seed=2))
    summary = bf.fit(recording, Analysis(sampler=SHORT)).summary
    assert summary.data_quality.replicated_cells == 0
    assert any("assembled twice" in line for line in summary.attention)


def test_too_few_draws_are_called_unconverged(fast):
    few = Sampler(walkers=34, burn=10, steps=50, thin=2, extensions=0)
    summary = bf.fit(fast, Analysis(sampler=few)).summary
    assert not summary.converged
    assert any("has not converged" in line for line in summary.attention)
    assert not any(line[0].islower() for line in summary.attention)


def test_what_the_prior_drives_is_not_told_from_draws_that_have_not_converged():
    """`informed` is judged at their median, which may be anywhere."""
    design = Protocol({(5, 85.0): 1, (9, 85.0): 2}, (6.0, 16.0, 28.0), (), 2)
    recording = by_acceleration(simulate_recording(design, seed=2))
    summary = bf.fit(recording, Analysis(sampler=SHORT)).summary
    assert not summary.converged
    assert not summary.pulleys["small"]["c3"].informed
    assert not any("prior, not by these data" in line for line in summary.attention)


def test_recording_without_a_board_is_refused(small_recording):
    bare = dataclasses.replace(small_recording, gravity=None, motor=None)
    with pytest.raises(InputError, match=r"gravity_trials\.csv or motor_runs\.csv"):
        bf.fit(bare)


@pytest.mark.parametrize(
    ("rigs", "message"),
    [(["motor"], "the rig 'motor'"), (["lathe"], "one of gravity, motor"), ([], "one of gravity")],
)
def test_rigs_that_are_not_there_are_refused(small_recording, rigs, message):
    with pytest.raises(InputError, match=message):
        bf.fit(dataclasses.replace(small_recording, motor=None), rigs=rigs)


@pytest.mark.nightly
def test_both_rigs_share_the_coefficients_and_not_the_scatter(small_recording, small_fit):
    """The joint posterior is narrower than either, and knows the torque constant."""
    both = bf.fit(small_recording, Analysis(seed=5, sampler=SHORT), rigs=("motor", "gravity"))
    assert both.summary.rigs == ("gravity", "motor")
    assert both.summary.data_quality.motor_runs == 460
    factor = both.summary.parameters["torque_constant_factor"]
    assert abs(factor.mean - 1.0) < 4 * factor.sd
    assert factor.sd < 0.005  # 1 % would be 8 to 35 % of friction
    of_runs = {"tau_motor", "omega_motor", "omega_intercept_motor"}
    assert SCATTER | of_runs == set(both.summary.scatter)
    assert both.summary.pulleys["small"]["c3"].sd < small_fit.summary.pulleys["small"]["c3"].sd
    ids = both.draws["log_likelihood"]["setup"].to_numpy()
    assert sum(name.startswith("motor/") for name in ids) == 15
    assert sum(name.startswith("gravity/") for name in ids) == 12


def test_outputs_are_replaced_whole_or_not_at_all(small_fit, tmp_path):
    from bayesfric.results import replace_outputs

    small_fit.write(tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def broken(path):
        path.write_text("half")
        raise OSError("disk full")

    with pytest.raises(InputError, match="can be written"):
        replace_outputs(tmp_path, {"fit.json": lambda p: p.write_text("new"), "draws.nc": broken})
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
