"""The command line: what each verb writes, prints and returns."""

import dataclasses
import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from altered import by_acceleration, of_size, with_trials
from typer.testing import CliRunner

from bayesfric.claims import registered
from bayesfric.cli import app
from bayesfric.recording import write_recording
from bayesfric.recording.tables import Gravity
from bayesfric.results import read_json
from bayesfric.schemas import ClaimsFile, FitFile, TimingsFile

SHORT = "seed = 5\n[sampler]\nburn = 10\nsteps = 80\nthin = 2\nextensions = 0\n"


def bayesfric(*arguments, cwd, **environment):
    """Run the installed command from a folder."""
    command = Path(sys.executable).with_name("bayesfric")
    variables = {k: v for k, v in os.environ.items() if k != "SOURCE_DATE_EPOCH"} | environment
    return subprocess.run(
        [command, *map(str, arguments)],
        cwd=cwd,
        env=variables,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(scope="module")
def board(small_recording, tmp_path_factory):
    """One size on the gravity board, by accelerations, beside a short analysis.toml."""
    folder = tmp_path_factory.mktemp("a folder with spaces")
    small = with_trials(small_recording, of_size(small_recording, "small"))
    write_recording(by_acceleration(small), folder / "board")
    (folder / "analysis.toml").write_text(SHORT)
    return folder


@pytest.fixture(scope="module")
def ran(board, no_processes):
    """One whole run on it."""
    arguments = ("run", "board", "--config", "analysis.toml", "-o", "first")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(board)
        runner = CliRunner(env={"FORCE_COLOR": "1"})
        done = runner.invoke(app, [*arguments, "--junit", "ci/claims.xml"])
    assert done.exit_code == 0, done.stderr
    return done


def test_run_writes_the_claims_as_test_cases(board, ran):
    stored = read_json(ClaimsFile, board / "first" / "claims.json")
    suite = ElementTree.parse(board / "ci" / "claims.xml").getroot()
    assert [case.get("name") for case in suite] == [claim.id for claim in stored.claims]
    refuted = [claim.id for claim in stored.claims if claim.verdict == "refuted"]
    assert [case.get("name") for case in suite if case.find("failure") is not None] == refuted


def test_claims_are_listed_without_a_recording():
    listed = CliRunner().invoke(app, ["claims", "--list"])
    assert [line.partition(":")[0] for line in listed.stdout.splitlines()] == [
        claim.name for claim in registered()
    ]
    statement = "The friction of a cable that a falling weight drives does not grow with speed."
    assert statement in listed.stdout
    missing = CliRunner().invoke(app, ["claims"])
    assert missing.exit_code == 2
    assert "a RECORDING, or --list" in missing.stderr


def test_run_writes_results_and_report(board, ran):
    expected = {
        ".stages.json",  # by which the same run, started again, computes nothing
        "claims.json",
        "claims.nc",
        "diagnosis.json",
        "diagnosis.nc",
        "draws.nc",
        "fit.json",
        "predictive.nc",
        "report.html",
        "report.pdf",
        "summary.md",
        "timings.json",
    }
    assert {path.name for path in (board / "first").iterdir()} == expected
    seconds = read_json(TimingsFile, board / "first" / "timings.json").seconds
    assert {"claims", "diagnosis", "report"} < set(seconds)
    assert len(seconds) > 4  # beside the stages of the fit
    entry = read_json(FitFile, board / "first" / "fit.json").pulleys["small"]["c1"]
    (line,) = [row for row in ran.stdout.splitlines() if row.startswith("small") and " c1 " in row]
    assert f"{entry.mean:.4g}" in line


def test_a_log_has_a_line_where_a_stage_begins_and_where_it_is_done(ran):
    """Standard error is no terminal, though FORCE_COLOR is set, as in many a CI job."""
    lines = [line for line in ran.stderr.split("\n") if not line.startswith("attention: ")]
    lines = [line for line in lines if not line.endswith(" to go")]  # on a slow machine
    lines = [line for line in lines if not line.startswith("note: ")]
    assert lines == [
        "sampling small-recording: started",
        "sampling small-recording: done",
        "comparing the claims with their rivals: started",
        "comparing the claims with their rivals: done",
        "weighing the effects that the baseline leaves out: started",
        "weighing the effects that the baseline leaves out: done",
        "writing the report: started",
        "writing the report: done",
        "first/report.pdf",
        "",
    ]


@pytest.mark.nightly
def test_same_seed_same_bytes(board, ran):
    """In two processes: JSON and all three forms of the report."""
    again = bayesfric("run", "board", "--config", "analysis.toml", "-o", "again", cwd=board)
    assert again.returncode == 0
    assert again.stdout == ran.stdout
    for name in (
        "fit.json",
        "claims.json",
        "diagnosis.json",
        "report.pdf",
        "report.html",
        "summary.md",
    ):
        assert (board / "first" / name).read_bytes() == (board / "again" / name).read_bytes(), name


@pytest.mark.nightly
def test_report_needs_the_folder_alone(board, ran, tmp_path):
    stored = ("fit.json", "draws.nc", "predictive.nc", "claims.json", "claims.nc")
    for name in (*stored, "diagnosis.json", "diagnosis.nc"):
        (tmp_path / name).write_bytes((board / "first" / name).read_bytes())
    done = bayesfric("report", ".", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "report.pdf").read_bytes() == (board / "first" / "report.pdf").read_bytes()


@pytest.mark.nightly
def test_fit_leaves_other_files_alone(board, ran):
    (board / "kept").mkdir()
    (board / "kept" / "mine.txt").write_text("mine")
    done = bayesfric(
        "fit", "board", "--config", "analysis.toml", "-o", "kept", "--csv", "--quiet", cwd=board
    )
    assert done.returncode == 0
    assert done.stderr == ""
    names = {path.name for path in (board / "kept").iterdir()}
    assert names == {
        "draws.csv",
        "draws.nc",
        "fit.json",
        "mine.txt",
        "predictive.nc",
        "timings.json",
    }
    kept, first = board / "kept" / "fit.json", board / "first" / "fit.json"
    assert kept.read_bytes() == first.read_bytes()


def test_unconverged_is_in_the_exit_status_and_still_written(board, monkeypatch):
    (board / "few.toml").write_text(
        "[sampler]\nburn = 10\nsteps = 50\nthin = 2\nwalkers = 34\nextensions = 0\n"
    )
    arguments = ("fit", "board", "--config", "few.toml", "-o", "few")
    arguments += ("--fail-on", "unconverged,attention")
    monkeypatch.chdir(board)
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 1
    assert "has not converged" in done.stderr
    assert done.stderr.endswith("failed: unconverged\nfailed: attention\n")
    assert not read_json(FitFile, board / "few" / "fit.json").converged


def test_too_few_walkers_for_the_parameters_are_refused(board, tmp_path, monkeypatch):
    """How many there must be is known only when the recording is."""
    monkeypatch.chdir(board)
    (tmp_path / "few.toml").write_text("[sampler]\nwalkers = 10\n")
    where = ("--config", str(tmp_path / "few.toml"), "-o", str(tmp_path / "out"))
    done = CliRunner().invoke(app, ("fit", "board", *where))
    assert done.exit_code == 2
    assert "sampler.walkers: found '10', expected at least" in done.stderr
    assert not (tmp_path / "out" / "fit.json").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("fit", "nowhere"), "nowhere"),
        (("fit", "board", "--config", "none.toml"), "none.toml"),
        (("fit", "board", "--fail-on", "rain"), "--fail-on: found 'rain'"),
        (("report", "board"), "a folder for results; this one is a recording"),
        (("fit",), "recording"),
        (("fit", "board", "--colour"), "--colour"),
        (("simulate", "board"), "board"),
        (("simulate", "new", "--protocol", "long"), "long"),
    ],
)
def test_bad_use_ends_in_2_and_writes_nothing(board, arguments, message, monkeypatch):
    before = sorted(board.rglob("*"))
    monkeypatch.chdir(board)
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 2
    assert message.lower() in done.stderr.lower()
    assert "Traceback" not in done.stderr
    assert sorted(board.rglob("*")) == before


def test_faults_of_a_recording_are_all_told(board, tmp_path):
    for path in (board / "board").iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    trials = tmp_path / "gravity_trials.csv"
    lines = trials.read_text().splitlines()
    names = lines[0].split(",")
    first, second = lines[1].split(","), lines[2].split(",")
    first[names.index("wrap_angle_deg")] = "190"
    second[names.index("mass_drive_kg")] = "heavy"
    trials.write_text("\n".join([lines[0], ",".join(first), ",".join(second), *lines[3:]]) + "\n")
    done = CliRunner().invoke(app, ["validate", str(tmp_path)])
    assert done.exit_code == 2
    assert "gravity_trials.csv, row 2, wrap_angle_deg: found '190'" in done.stderr
    assert "gravity_trials.csv, row 3, mass_drive_kg: found 'heavy'" in done.stderr


def test_validate_prints_what_is_there(board):
    done = CliRunner().invoke(app, ["validate", str(board / "board")])
    assert done.exit_code == 0
    assert "16 trials" in done.stdout
    assert "small" in done.stdout
    assert "sensor clocks" not in done.stdout  # trials by acceleration alone


def test_validate_tells_by_how_much_the_clocks_of_two_sensors_differ(small_recording, tmp_path):
    gravity = small_recording.gravity
    late = np.where(gravity.events["sensor"] == "load", 0.05, 0.0)
    events = gravity.events.assign(time_s=gravity.events["time_s"] + late)
    apart = dataclasses.replace(small_recording, gravity=Gravity(gravity.trials, events))
    write_recording(small_recording, tmp_path / "one")
    write_recording(apart, tmp_path / "two")
    done = CliRunner().invoke(app, ["validate", str(tmp_path / "one")])
    assert done.exit_code == 0
    (line,) = (line for line in done.stdout.splitlines() if line.startswith("sensor clocks"))
    assert "trials; the fit estimates each trial's offset, up to 4.9 ms" in line
    for verb, *more in (["validate"], ["fit", "-o", str(tmp_path / "fitted")]):
        done = CliRunner().invoke(app, [verb, str(tmp_path / "two"), *more])
        assert done.exit_code == 2
        assert "ms (load late) in" in done.stderr
        assert "no cable explains more than 4.9 ms" in done.stderr


@pytest.mark.nightly
def test_simulate_is_reproducible_and_dated_only_when_told(board):
    """In two processes."""
    arguments = ["simulate", "--protocol", "quick", "--seed", "3"]
    for name in ("one/x", "two/x", "dated/x"):
        (board / name).parent.mkdir()
    done = bayesfric(*arguments, "two/x", cwd=board)
    assert done.returncode == 0, done.stderr
    for name, date in (("one/x", {}), ("dated/x", {"SOURCE_DATE_EPOCH": "86400"})):
        simulated = CliRunner(env=date).invoke(app, [*arguments, str(board / name)])
        assert simulated.exit_code == 0, simulated.stderr
    for path in (board / "one/x").iterdir():
        assert path.read_bytes() == (board / "two/x" / path.name).read_bytes()
    package = (board / "dated/x/datapackage.json").read_text()
    assert '"created": "1970-01-02T00:00:00Z"' in package
    assert "created" not in (board / "one/x/datapackage.json").read_text()


@pytest.mark.parametrize("verb", ["run", "validate", "simulate", "fit", "claims", "report", "info"])
def test_every_verb_has_help_with_an_example(verb):
    done = CliRunner().invoke(app, [verb, "--help"])
    assert done.exit_code == 0
    assert f"Example: bayesfric {verb}" in done.stdout


def test_help_loads_nothing_heavy():
    code = (
        "import sys; import bayesfric.cli.verbs; "
        "print([m for m in ('numpy', 'pandas', 'scipy', 'pydantic') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
