"""`bayesfric rerun`: a stored run once more, and what differs."""

import json
import shutil

import pytest
from altered import by_acceleration, of_size, with_trials
from rigs.friction_points import joint, recorded
from typer.testing import CliRunner

from bayesfric.analysis import Analysis
from bayesfric.cli import app
from bayesfric.margins import compute_margins
from bayesfric.recording import write_recording
from bayesfric.resources import bundled_loops

SHORT = "seed = 5\n[sampler]\nburn = 10\nsteps = 50\nthin = 2\nwalkers = 36\nextensions = 0\n"


def bayesfric(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def ran(small_recording, tmp_path_factory):
    """A folder with the fit of one size."""
    folder = tmp_path_factory.mktemp("rerun")
    small = with_trials(small_recording, of_size(small_recording, "small"))
    write_recording(by_acceleration(small), folder / "board")
    (folder / "short.toml").write_text(SHORT)
    done = bayesfric("fit", folder / "board", "--config", folder / "short.toml", "-o", folder / "a")
    assert done.exit_code == 0, done.stderr
    return folder


def test_a_run_repeats_itself(ran, tmp_path):
    done = bayesfric("rerun", ran / "a", "-o", tmp_path / "b", "--fail-on", "changed")
    assert done.exit_code == 0, done.stderr
    assert "no difference: fit.json" in done.stdout
    for name in ("draws.nc", "predictive.nc"):
        assert f"{name}: the same bytes" in done.stdout
    assert (tmp_path / "b" / "fit.json").read_bytes() == (ran / "a" / "fit.json").read_bytes()


def test_results_that_do_not_come_out_again_are_told(ran, tmp_path):
    """A number that somebody moved, and draws of which a byte is not the run's."""
    shutil.copytree(ran / "a", ran / "moved")  # beside the board, where the run looks for it
    stored = json.loads((ran / "moved" / "fit.json").read_text())
    stored["pulleys"]["small"]["c1"]["mean"] += 1.0
    (ran / "moved" / "fit.json").write_text(json.dumps(stored))
    with (ran / "moved" / "draws.nc").open("ab") as draws:
        draws.write(b"\0")
    done = bayesfric("rerun", ran / "moved", "--fail-on", "changed")
    assert done.exit_code == 1
    assert "no difference" not in done.stdout
    assert "1 of " in done.stdout
    assert "fit.json  pulleys.small.c1" in done.stdout
    assert "draws.nc: other bytes" in done.stdout
    assert "predictive.nc: the same bytes" in done.stdout


@pytest.fixture(scope="module")
def with_margins(ran):
    """The fit, and margins of which a draw was verified and its motion simulated."""
    folder = ran / "margins"
    shutil.copytree(ran / "a", folder)
    compute_margins(
        "raven-tool-rotation", folder / "draws.nc", Analysis(seed=9), verify=1, ensembles=True,
        simulated=1,
    ).write(folder)  # fmt: skip
    return folder


def test_margins_are_repeated_with_what_they_were_asked_for(with_margins, tmp_path, monkeypatch):
    """The loop by its contents, the options by what the stored file shows."""
    asked = {}

    def kept(loops, draws, output, of_call, **options):
        seed, quiet = of_call.analysis.seed, of_call.quiet
        asked.update(options, loops=loops, draws=draws, seed=seed, quiet=quiet)

    monkeypatch.setattr("bayesfric.cli.rerun.margins_into", kept)
    done = bayesfric("rerun", with_margins, "-o", tmp_path / "b")
    assert done.exit_code == 0, done.stderr
    assert asked == {
        "loops": [bundled_loops()["raven-tool-rotation"]],
        "draws": tmp_path / "b" / "draws.nc",
        "seed": 9,
        "diagnosis": None,
        "law": "fitted",
        "verify": 1,
        "tune": False,
        "ensembles": True,
        "quiet": False,
    }


def test_margins_of_a_loop_that_is_nowhere_are_told(with_margins, tmp_path):
    stored = json.loads((with_margins / "margins.json").read_text())
    stored["loops"][0]["loop_sha256"] = "0" * 64
    shutil.copytree(with_margins, with_margins.parent / "gone")
    (with_margins.parent / "gone" / "margins.json").write_text(json.dumps(stored))
    done = bayesfric("rerun", with_margins.parent / "gone", "-o", tmp_path / "b")
    assert (
        "margins.json is not repeated: the loop files of raven-tool-rotation are not" in done.stderr
    )


@pytest.mark.nightly
def test_a_diagnosis_of_a_bench_repeats_itself(tmp_path):
    """With the priors that the rig has of its own, and with the values that were shipped."""
    recorded(tmp_path / "joint", joint(3.0))
    (tmp_path / "short.toml").write_text(SHORT)
    settings = ("--config", tmp_path / "short.toml", "--quiet")
    done = bayesfric("fit", tmp_path / "joint", *settings, "-o", tmp_path / "fit")
    assert done.exit_code == 0, done.stderr
    shipped = ("--shipped", tmp_path / "fit", "-o", tmp_path / "a")
    done = bayesfric("diagnose", tmp_path / "joint", *settings, *shipped)
    assert done.exit_code == 0, done.stderr
    again = ("-o", tmp_path / "b", "--recording", tmp_path / "joint", "--quiet")
    done = bayesfric("rerun", tmp_path / "a", *again, "--fail-on", "changed")
    assert done.exit_code == 0, done.stdout
    first, second = (
        json.loads((tmp_path / name / "diagnosis.json").read_text()) for name in ("a", "b")
    )
    assert first == second
    assert first["gap"]["as_shipped"] is not None
