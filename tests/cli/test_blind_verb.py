"""``bayesfric blind``: exit statuses and what a bad command line is told."""

import pytest
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.recording import write_recording
from bayesfric.simulate import simulate_recording


def blind(*arguments):
    return CliRunner().invoke(app, ["blind", *map(str, arguments)])


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--engine", "gazebo"], "--engine: found 'gazebo', expected one of"),
        (["--engine", "dream"], "--engine: found 'dream'"),
        (["--seed", "9990", "--n", "20"], "--seed: found '9990', expected seeds of tuning"),
        (["--from", "somewhere"], "--answer: expected --from RECORDING and --answer FILE"),
        (["--answer", "somewhere"], "--from: expected"),
        (["--scheduler", "tcp://127.0.0.1:1"], "--scheduler: found 'tcp://127.0.0.1:1'"),
        (["--so-far"], "expected a case that is done"),
        (["--fail-on", "rain"], "rain"),
    ],
)
def test_bad_usage_is_one_clear_error(tmp_path, options, said):
    done = blind("-o", tmp_path / "out", *options)
    assert done.exit_code == 2
    assert said in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out" / "scorecard.json").exists()


def test_a_users_recording_is_diagnosed_and_scored(tmp_path):
    recording = simulate_recording("quick", seed=5, rigs=["motor"], effects={"viscous": 1.0})
    write_recording(recording, tmp_path / "board")
    answer = tmp_path / "answer.json"
    answer.write_text('{"withheld": [{"name": "viscous"}]}')
    out = tmp_path / "out"
    done = blind("-o", out, "--from", tmp_path / "board", "--answer", answer, "--fail-on", "gap")
    assert done.exit_code == 1, done.output
    assert done.stdout == "named (viscous): correct\n"
    assert (out / "scorecard.json").is_file()
