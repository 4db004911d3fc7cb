"""``bayesfric diagnose``: what it writes, prints and returns."""

import pytest
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.recording import write_recording
from bayesfric.results import read_json
from bayesfric.schemas import DiagnosisFile
from bayesfric.simulate import simulate_recording


def bayesfric(*arguments):
    return CliRunner().invoke(app, arguments)


@pytest.fixture(scope="module")
def board(tmp_path_factory):
    """A recording of the motor board with more friction at low speed."""
    folder = tmp_path_factory.mktemp("a folder with spaces")
    recording = simulate_recording("quick", seed=11, rigs=["motor"], effects={"stribeck": 1.0})
    write_recording(recording, folder / "board")
    return folder


def test_it_writes_prints_and_fails_on_a_gap(board, monkeypatch, no_processes):
    monkeypatch.chdir(board)
    done = bayesfric("diagnose", "board", "-o", "out", "--fail-on", "gap")
    assert done.exit_code == 1, done.stderr
    assert {path.name for path in (board / "out").iterdir()} == {"diagnosis.json", "diagnosis.nc"}
    summary = read_json(DiagnosisFile, board / "out" / "diagnosis.json")
    assert [cause.effect for cause in summary.causes] == ["stribeck"]
    assert done.stdout.startswith(f"named: {summary.sentence}")
    listed = [line.split()[-1] for line in done.stdout.splitlines()[1:]]
    assert listed
    assert not {"0.000", "1.000"} & {*listed}  # a bound instead, as everywhere
    report = bayesfric("report", "out")
    assert report.exit_code == 0, report.stderr
    # A report says behind an effect's name what it is, and sets numbers in its own way.
    said = summary.sentence.split("; adding")[0].removeprefix("stribeck ").replace("%", "\u202f%")
    said = said.replace("> ", "\\>\u00a0")  # as Markdown has it
    assert said in (board / "out" / "summary.md").read_text()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--fixed", "c9"], "--fixed"),
        (["--effect-module", "nowhere.py"], "nowhere.py"),
        (["--shipped", "nowhere"], "fit.json"),
        (["--baseline", "nowhere"], "one of paper, recursive"),
        (["--fail-on", "rain"], "rain"),
    ],
)
def test_bad_usage_is_one_clear_error(board, options, said, monkeypatch):
    monkeypatch.chdir(board)
    done = CliRunner().invoke(app, ["diagnose", "board", "-o", "bad", *options])
    assert done.exit_code == 2
    assert said in done.stderr
    assert "Traceback" not in done.stderr
    assert not (board / "bad").exists()


def test_a_file_that_breaks_a_rule_is_refused(board, monkeypatch):
    (board / "broken.py").write_text("raise RuntimeError('no')\n")
    monkeypatch.chdir(board)
    arguments = ["diagnose", "board", "-o", "bad", "--effect-module", "broken.py"]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 2
    assert "broken.py" in done.stderr
