"""Several recordings fitted together: what is refused, written, printed and reported."""

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

from bayesfric.analysis import Analysis, Sampler
from bayesfric.cli.verbs import app
from bayesfric.errors import InputError
from bayesfric.fitting.pooled import check_boards, pool
from bayesfric.margins.posterior import read_draws
from bayesfric.recording import write_recording
from bayesfric.report.writing import write_report
from bayesfric.results import read_json, write_netcdf
from bayesfric.rigs.protocols import Protocol
from bayesfric.schemas import FitFile
from bayesfric.simulate import simulate_recording

SHORT = Sampler(burn=60, steps=80, thin=3, extensions=0)


@pytest.fixture(scope="module")
def folder(small_recording, small_fit, tmp_path_factory):
    """The same data taken for two boards: what the arithmetic makes of it is known."""
    recordings = {"monday": small_recording, "friday": small_recording}
    fits = dict.fromkeys(recordings, small_fit)
    pooled = pool(recordings, fits, Analysis(seed=5, sampler=SHORT))
    folder = tmp_path_factory.mktemp("pooled")
    pooled.write(folder, csv=True, inputs={"recording": ["a", "b"]})
    return folder


def test_boards_with_the_same_data_stay_where_they_are(folder, small_fit):
    summary = read_json(FitFile, folder / "fit.json")
    assert summary.schema_ == "bayesfric.fit/1"
    for size, coefficients in summary.pulleys.items():
        for name, entry in coefficients.items():
            alone = small_fit.summary.pulleys[size][name]
            pooled = summary.pooled.pulleys[size][name]
            assert abs(entry.mean - alone.mean) < 0.5 * alone.sd, (size, name)
            for board in pooled.boards.values():
                # Its own data twice would have its sd over the root of two where scatter is known.
                # It is not: a Student-t's variance is ν/(ν − 2) in units of its scale, and twice
                # the assemblies have more than twice the ν: from ν = 3 on no ratio is below 1/√6.
                assert 0.41 * alone.sd < board.pooled.sd < 1.1 * alone.sd
                assert board.alone.mean == pytest.approx(alone.mean, abs=0.1 * alone.sd)
            assert pooled.new_board.sd > entry.sd
            assert pooled.between.q50 < 0.05  # the prior's median is 0.034, and boards are alike


def test_draws_hold_the_population_and_each_board(folder):
    summary = read_json(FitFile, folder / "fit.json")
    with xr.open_datatree(folder / "draws.nc", engine="netcdf4") as tree:
        posterior = tree["posterior"].to_dataset().load()
    assert posterior["c1"].dims == ("chain", "draw", "pulley")
    assert posterior["board_c1"].dims == ("chain", "draw", "board", "pulley")
    assert list(posterior["board"].to_numpy()) == ["monday", "friday"]
    for size, entries in summary.pulleys.items():
        assert float(posterior["c2"].sel(pulley=size).mean()) == pytest.approx(entries["c2"].mean)
        board = posterior["board_c3"].sel(pulley=size, board="friday")
        coefficient = summary.pooled.pulleys[size]["c3"].boards["friday"].pooled
        assert float(board.mean()) == pytest.approx(coefficient.mean)
    header = (folder / "draws.csv").read_text().splitlines()[0].split(",")
    assert "c1[small]" in header
    assert "board_c1[friday" in ",".join(header)


def test_report_has_the_population_on_page_one_and_a_table_of_boards(folder, tmp_path):
    shutil.copytree(folder, tmp_path / "run")
    write_report(tmp_path / "run")
    page_one = (tmp_path / "run" / "summary.md").read_text()
    assert "The population of 2 boards" in page_one
    html = (tmp_path / "run" / "report.html").read_text()
    summary = json.loads((folder / "fit.json").read_text())
    shrinkage = summary["pooled"]["pulleys"]["small"]["c1"]["boards"]["friday"]["shrinkage"]
    assert f"{100 * shrinkage:.0f}\u202f%" in html
    assert "boards/friday" in html


def test_margins_are_those_of_a_board_that_was_not_measured(folder, small_fit, tmp_path):
    """Its coefficients are new_board's; its assemblies scatter as those of either board."""
    shutil.copytree(folder, tmp_path / "pooled")
    path = tmp_path / "pooled" / "draws.nc"
    for board, omega in (("monday", 0.01), ("friday", 0.03)):
        draws = small_fit.draws.copy(deep=True)
        draws["posterior"]["omega"][:] = omega
        (path.parent / "boards" / board).mkdir(parents=True)
        write_netcdf(draws, path.parent / "boards" / board / "draws.nc")
    posterior, discrepancy = read_draws(path)
    with xr.open_datatree(path.with_name("predictive.nc"), engine="netcdf4") as tree:
        c1 = tree["new_board"]["c1"].sel(pulley="small").to_numpy()
    assert posterior.coefficients["small"].c1 == pytest.approx(
        c1[:, :: -(-c1.size // 4000)].ravel()
    )
    assert np.unique(posterior.omega["small"]).tolist() == [0.01, 0.03]
    assert posterior.omega["small"].mean() == pytest.approx(0.02, rel=1e-3)
    assert discrepancy.sd == 0.0  # the scatter between boards is in the draws
    assert "not measured" in discrepancy.source


def test_margins_of_several_boards_need_each(folder):
    with pytest.raises(InputError, match=r"monday/draws\.nc"):
        read_draws(folder / "draws.nc")


def test_a_recording_counts_once(small_recording):
    board = replace(small_recording, sha256="the same")
    with pytest.raises(InputError, match="other data than those of monday"):
        check_boards({"monday": board, "copy": board}, Analysis(), None)


def test_other_pulley_sizes_are_refused(small_recording):
    gravity = small_recording.gravity
    keep = gravity.trials["pulley_size"] != "large"
    trials = gravity.trials[keep]
    events = gravity.events[gravity.events["trial"].isin(trials["trial"])]
    less = replace(
        small_recording, gravity=replace(gravity, trials=trials, events=events), sha256="other"
    )
    with pytest.raises(InputError, match=r"found 'small, medium', expected the pulley sizes of a "):
        check_boards({"a": small_recording, "b": less}, Analysis(), None)


def test_other_rigs_are_refused(small_recording):
    design = Protocol({(9, 85.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
    motor = simulate_recording(design, seed=3, name="motor")
    motor = replace(motor, gravity=None, sha256="other")
    with pytest.raises(InputError, match="data of the rigs gravity, as the others"):
        check_boards({"a": small_recording, "b": motor}, Analysis(), None)


@pytest.mark.parametrize("verb", ["claims", "diagnose", "run", "validate"])
def test_other_verbs_say_why_they_take_one_recording(verb):
    refused = CliRunner().invoke(app, [verb, "a", "b"])
    assert refused.exit_code == 2
    assert f"what `{verb}` says is of one board" in " ".join(refused.output.split())


def test_one_folder_twice_is_refused_before_any_work(tmp_path, small_recording):
    write_recording(small_recording, tmp_path / "board")
    again = str(tmp_path / "board" / ".." / "board")
    output = tmp_path / "out"
    refused = CliRunner().invoke(app, ["fit", str(tmp_path / "board"), again, "-o", str(output)])
    assert refused.exit_code == 2
    assert "each recording once: it would count twice" in refused.output
    other = CliRunner().invoke(
        app, ["fit", str(tmp_path / "board"), str(tmp_path / "x" / "board"), "-o", str(output)]
    )
    assert other.exit_code == 2
    assert "a folder of another name" in other.output
    assert not (output / "fit.json").exists()


@pytest.mark.nightly
def test_two_recordings_are_fitted_reported_and_rerun(tmp_path):
    design = Protocol({(9, 85.0): 1, (15, 50.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
    for seed, name in ((1, "monday"), (2, "friday")):
        recording = simulate_recording(design, seed=seed, name=name)
        write_recording(recording, tmp_path / name)
    config = tmp_path / "analysis.toml"
    config.write_text("[sampler]\nburn = 60\nsteps = 80\nthin = 3\nextensions = 0\n")
    runner = CliRunner()
    boards = [str(tmp_path / name) for name in ("monday", "friday")]
    output = tmp_path / "pooled"
    fitted = runner.invoke(app, ["fit", *boards, "-o", str(output), "--config", str(config)])
    assert fitted.exit_code == 0, fitted.output
    lines = [line for line in fitted.output.splitlines() if line.startswith(("small", "large"))]
    summary = read_json(FitFile, output / "fit.json")
    assert f"{summary.pulleys['small']['c1'].mean:.4g} ± " in lines[0]
    assert np.isclose(
        read_json(FitFile, output / "boards" / "friday" / "fit.json").pulleys["small"]["c1"].mean,
        summary.pooled.pulleys["small"]["c1"].boards["friday"].alone.mean,
        rtol=1e-2,
    )
    assert runner.invoke(app, ["report", str(output)]).exit_code == 0
    again = runner.invoke(app, ["rerun", str(output)])
    assert again.exit_code == 0, again.output
    assert "no difference" in again.output
