"""``draws.nc`` in the hands of its users: ArviZ 0.23, ArviZ 1 and corner, as they come."""

import json
import re
from pathlib import Path

import arviz_stats as azs
import numpy as np
import pytest
import xarray as xr
from altered import of_size, with_trials
from conftest import QUICK_SAMPLER
from fitting.generations import finished, python_of

from bayesfric.analysis import Analysis, HalfNormal, Priors
from bayesfric.fitting import fit
from bayesfric.results import read_tree

ROOT = Path(__file__).parents[2]
GROUPS = {
    "posterior",
    "prior",
    "posterior_predictive",
    "prior_predictive",
    "observed_data",
    "constant_data",
    "sample_stats",
    "log_likelihood",
    "log_prior",
}
OF_ONE_TRIAL = {"var_name": "friction"}


@pytest.fixture(scope="module")
def board(small_recording):
    """Trials of one size."""
    return with_trials(small_recording, of_size(small_recording, "medium"))


@pytest.fixture(scope="module")
def folder(board, tmp_path_factory):
    """A fit without a wander, whose long posterior importance sampling covers less well."""
    place = tmp_path_factory.mktemp("fit")
    priors = Priors(wander=HalfNormal(scale=1e-5))
    fit(board, Analysis(seed=5, sampler=QUICK_SAMPLER, priors=priors)).write(place, csv=True)
    return place


@pytest.fixture(scope="module")
def draws(folder):
    return read_tree(folder / "draws.nc")


def test_all_groups_speak_of_the_same_draws(draws):
    assert set(draws.children) == GROUPS
    of_draws = GROUPS - {"prior", "prior_predictive", "observed_data", "constant_data"}
    sizes = {(draws[name].sizes["chain"], draws[name].sizes["draw"]) for name in of_draws}
    assert sizes == {(4, 1000)}
    assert draws["posterior"]["ensemble"].to_numpy().tolist() == [0, 1, 2, 3]
    trials = draws["observed_data"]["trial"].to_numpy()
    for name in ("posterior_predictive", "prior_predictive", "log_likelihood"):
        assert draws[name]["friction"]["trial"].to_numpy().tolist() == trials.tolist()
    assert set(draws["posterior"]["c1"].dims) == {"chain", "draw", "pulley"}
    assert draws["log_likelihood"]["assembly"].dims == ("chain", "draw", "setup")
    assert draws["posterior"]["c3"].attrs["units"] == "1/deg"


def test_many_draws_are_thinned_alike():
    from bayesfric.fitting.inference_data import MOST_DRAWS, Stored

    z = np.arange(4 * 200 * 36, dtype=float).reshape(4, 200, 36)  # the place of each
    stored = Stored.of(z[..., None], -z[..., None], 2 * z, trials=600)
    assert MOST_DRAWS / 2 < stored.log_density.size <= MOST_DRAWS
    assert np.array_equal(stored.flat[:, 0], stored.log_density.ravel() / 2)
    assert np.array_equal(stored.theta, -stored.z)
    assert stored.z[37, :, 0].tolist() == z[1, :: 200 // 25, 1].tolist()
    assert stored.ensembles == 4
    fewer = Stored.of(z[..., None], z[..., None], z, trials=2000)
    assert fewer.log_density.size * 2000 <= 2_400_000


def test_the_likelihood_adds_up_to_that_of_the_whole(draws, board):
    """What power-scaling adds up, beside the likelihood worked out again."""
    from rigs.hall import gravity_likelihood

    from bayesfric.rigs.gravity_board.screening import screen_trials

    screened = screen_trials(board.gravity, board.rig)
    likelihood = gravity_likelihood(screened.gravity, board.rig, Analysis())
    point = draws["posterior"].to_dataset().isel(chain=3, draw=[7])
    theta = {}
    for parameter in likelihood.parameters:
        stem, _, size = parameter.name.removesuffix("]").partition("[")
        theta[parameter.name] = (point[stem].sel(pulley=size) if size else point[stem]).to_numpy()
    density = draws["log_likelihood"].to_dataset().isel(chain=3, draw=7)
    total = sum(float(density[name].sum()) for name in density.data_vars)
    assert total == pytest.approx(likelihood.log_likelihood(theta)[0], rel=1e-12)
    assert density["friction"].to_numpy() == pytest.approx(
        likelihood.given_rest(theta).trial[0], rel=1e-7
    )
    prior = sum(
        float(log_prior.isel(chain=3, draw=7).sum()) for log_prior in draws["log_prior"].values()
    )
    lp = float(draws["sample_stats"]["lp"].isel(chain=3, draw=7))
    assert lp == pytest.approx(total + prior, rel=1e-12)


def test_arviz_says_of_the_file_what_the_fit_says_of_it(draws, folder):
    """Every figure, to all digits: whoever reads the file finds what the report prints."""
    fit = json.loads((folder / "fit.json").read_text())
    summary = azs.summary(draws, round_to="none")
    entries = {f"{c}[medium]": entry for c, entry in fit["pulleys"]["medium"].items()}
    entries |= fit["scatter"] | fit["noise"]
    assert set(entries) == set(summary.index)
    for name, entry in entries.items():
        for figure in ("r_hat", "ess_bulk"):
            assert float(summary.loc[name, figure]) == pytest.approx(
                entry["stored"][figure], rel=1e-9
            )
        # QUICK_SAMPLER has so few draws that the file has them all
        assert entry["stored"]["r_hat"] == pytest.approx(entry["r_hat"], rel=1e-9)


def test_psense_is_that_of_the_fit(draws, folder):
    """The same method over ensembles instead of walkers: what the tail of weights is differs."""
    fit = json.loads((folder / "fit.json").read_text())
    sensitivity = azs.psense_summary(draws, round_to=12)
    assert np.isfinite(sensitivity[["prior", "likelihood"]].to_numpy(float)).all()
    for size, coefficients in fit["pulleys"].items():
        for name, entry in coefficients.items():
            row = sensitivity.loc[f"{name}[{size}]"]
            assert float(row["prior"]) == pytest.approx(entry["prior_sensitivity"], abs=0.003)
            assert float(row["likelihood"]) == pytest.approx(
                entry["likelihood_sensitivity"], rel=0.03
            )


def test_leave_one_out_is_that_of_the_fit(draws, folder):
    """Densities, and probabilities by drawing instead of by the normal distribution."""
    (trials, _) = json.loads((folder / "fit.json").read_text())["prediction"]
    assert trials["refitted"] <= 1  # whose importance weights are near the bound
    assert azs.loo(draws, **OF_ONE_TRIAL).elpd == pytest.approx(trials["elpd"], abs=0.1)
    pit = azs.loo_pit(draws)["friction"]
    exact = read_tree(folder / "predictive.nc")["trials"]["loo_pit"]
    error = np.sqrt(exact * (1 - exact) / 1000).to_numpy() + 1e-3  # effective draws, at least
    assert (np.abs(pit.to_numpy() - exact.to_numpy()) < 4 * error).all()


def test_the_summary_of_the_page_has_digits_that_say_something(draws, folder):
    page = (ROOT / "docs" / "draws.md").read_text(encoding="utf-8")
    (call,) = re.findall(r"^azs\.(summary\(.*?\))", page, flags=re.M)
    summary = eval(f"azs.{call}", {"azs": azs, "data": draws})
    fit = json.loads((folder / "fit.json").read_text())
    for size, coefficients in fit["pulleys"].items():
        for name, entry in coefficients.items():
            row = summary.loc[f"{name}[{size}]"].astype(float)
            assert row["mean"] == pytest.approx(entry["mean"], abs=entry["sd"] / 10)
            assert row["sd"] == pytest.approx(entry["sd"], rel=0.1)


@pytest.mark.filterwarnings("ignore:The inplace keyword")  # of pandas, inside the library
def test_compare_finds_the_worse_model(draws):
    """Of two models, one whose every trial is less likely by 1 nat."""
    worse = xr.DataTree.from_dict(
        {name: node.to_dataset() for name, node in draws.children.items()}
    )
    worse["log_likelihood"] = xr.DataTree(draws["log_likelihood"].to_dataset() - 1.0)
    table = azs.compare({"worse": worse, "ours": draws}, method="pseudo-bma", **OF_ONE_TRIAL)
    assert list(table.index) == ["ours", "worse"]
    count = draws["observed_data"].sizes["trial"]
    assert abs(float(table.loc["worse", "elpd_diff"])) == pytest.approx(count, abs=0.1)


def test_predictions_scatter_as_trials_do(draws):
    """Trials made again lie around what was measured as far as leave-one-out says."""
    again = draws["posterior_predictive"]["friction"]
    observed = draws["observed_data"]["friction"]
    score = (observed - again.mean(("chain", "draw"))) / again.std(("chain", "draw"))
    assert 0.7 < float(score.std()) < 1.3  # 48 trials: 1 ± 0.1
    before = draws["prior_predictive"]["friction"]
    assert float(before.std()) > 20 * float(again.std(("chain", "draw")).mean())


BEFORE = """
import warnings
warnings.simplefilter("error", UserWarning)  # Pareto k, shapes that do not fit
warnings.simplefilter("error", RuntimeWarning)  # NaN, overflow
"""
AFTER = {
    "0.23": """
import json
ends = ("hdi_3%", "hdi_97%")
loo = az.loo(data, var_name="friction").elpd_loo
pit = az.loo_pit(data, y="friction")
prior = az.psens(data, component="prior", var_names=["omega"])
table = az.compare({"a": data, "b": data}, var_name="friction", method="BB-pseudo-BMA")
""",
    "1": """
import json
ends = ("eti89_lb", "eti89_ub")
loo = az.loo(data, var_name="friction").elpd
pit = az.loo_pit(data)["friction"]
prior = az.psense_summary(data, var_names=["omega"], round_to=12).loc["omega", "prior"]
table = az.compare({"a": data, "b": data}, var_name="friction", method="pseudo-bma")
""",
}
PRINTED = """
means = {name: float(summary.loc[name, "mean"]) for name in summary.index}
low, high = (summary[end].astype(float) for end in ends)
numbers = float(loo), float(pit.sum()), float(prior), len(table), len(pairs.axes)
print(json.dumps([means, (high - low).to_dict(), *numbers]))
"""


def snippet(generation):
    """Return the block of the page on draws.nc for one generation of ArviZ."""
    page = (ROOT / "docs" / "draws.md").read_text(encoding="utf-8")
    (block,) = re.findall(
        rf"^## ArviZ {re.escape(generation)}\n.*?^```python\n(.*?)^```", page, flags=re.M | re.S
    )
    return block


@pytest.mark.nightly
@pytest.mark.parametrize("generation", AFTER)
def test_either_generation_of_arviz_reads_the_draws_as_the_page_says(draws, folder, generation):
    """Summary, prediction, leave-one-out and corner; numbers are those of this environment."""
    code = BEFORE + snippet(generation) + AFTER[generation] + PRINTED
    printed = finished(python_of(generation), "-c", code, cwd=folder)
    means, spreads, elpd, pit, sensitivity, compared, panels = json.loads(printed.splitlines()[-1])
    posterior = draws["posterior"].to_dataset()
    assert set(means) >= {"c1[small]", "c3[large]", "tau", "sigma_x"}
    for name, mean in means.items():
        stem, _, size = name.removesuffix("]").partition("[")
        values = posterior[stem].sel(pulley=size) if size else posterior[stem]
        assert mean == pytest.approx(float(values.mean()), rel=0.01)  # digits that say something
        assert 1 < spreads[name] / float(values.std()) < 5
    assert elpd == pytest.approx(azs.loo(draws, **OF_ONE_TRIAL).elpd, abs=0.02)
    assert pit == pytest.approx(float(azs.loo_pit(draws)["friction"].sum()), abs=0.05)
    modern = azs.psense_summary(draws, var_names=["omega"], round_to=12)
    assert sensitivity == pytest.approx(float(modern.loc["omega", "prior"]), rel=0.05)
    assert (compared, panels) == (2, 4)


def test_csv_is_what_r_expects(folder, draws):
    """Columns by which ``posterior::as_draws_df`` of R knows chains and iterations."""
    header, *rows = (folder / "draws.csv").read_text().splitlines()
    assert header.startswith("chain,draw,")
    posterior = draws["posterior"]
    assert len(rows) == posterior.sizes["chain"] * posterior.sizes["draw"]
    names = header.split(",")
    assert {"c1[medium]", "c3[medium]", "tau", "wander_length"} <= set(names)
    numbers = [float(cell) for cell in rows[1001].split(",")]
    assert numbers[:2] == [1, 1]
    column = names.index("c2[medium]")
    assert numbers[column] == float(posterior["c2"].isel(chain=1, draw=1).sel(pulley="medium"))
