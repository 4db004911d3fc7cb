"""How the command ends: locks, signals, places that cannot be written, what it prints."""

import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.cli.locks import LOCK, hold
from bayesfric.errors import InputError
from bayesfric.recording import write_recording

COMMAND = (
    sys.executable,
    "-c",
    "import sys; sys.argv[0] = 'bayesfric'; from bayesfric.cli import main; main()",
)


def default_signals():
    """A child of a job in the background would ignore interrupts."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


def started(*arguments, **options):
    return subprocess.Popen([*COMMAND, *map(str, arguments)], preexec_fn=default_signals, **options)


@pytest.fixture(scope="module")
def board(small_recording, tmp_path_factory):
    folder = tmp_path_factory.mktemp("ways out")
    write_recording(small_recording, folder / "board")
    (folder / "long.toml").write_text("[sampler]\nsteps = 50000\n")
    return folder


def test_a_second_run_is_refused_and_told_whose_the_folder_is(board, tmp_path):
    with hold(tmp_path / "out", "fit"):
        done = CliRunner().invoke(app, ["fit", str(board / "board"), "-o", str(tmp_path / "out")])
        assert done.exit_code == 2
        assert f"process {os.getpid()} on" in done.stderr
        assert "bayesfric fit" in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_lock_of_a_process_that_is_gone_is_taken_over(tmp_path):
    code = (
        "import os, pathlib, sys; from bayesfric.cli.locks import hold\n"
        "with hold(pathlib.Path(sys.argv[1]), 'fit'): os._exit(9)"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "out")], check=False)
    assert (tmp_path / "out" / LOCK).is_file()  # it was killed with the lock in its hands
    out = tmp_path / "out"
    with hold(out, "fit"), pytest.raises(InputError, match="bayesfric fit"), hold(out, "report"):
        pytest.fail("two hold it")
    assert not (tmp_path / "out" / LOCK).exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_fit_with_3_and_no_traceback(board, tmp_path, number):
    out = tmp_path / "out"
    arguments = ("fit", board / "board", "--config", board / "long.toml", "-o", out)
    process = started(*arguments, stderr=subprocess.PIPE, text=True)
    while not (out / LOCK).exists():
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(number)
    _, said = process.communicate()
    assert process.returncode == 3
    assert said == "interrupted\n"
    assert not (out / LOCK).exists()


@pytest.mark.parametrize(
    "number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.nightly)]
)
def test_a_signal_while_the_interpreter_shuts_down_changes_nothing(number):
    """Where Python has put the signals' own handlers back, all is done."""
    late = f"""
import os, signal, sys
class Late:
    def __del__(self, kill=os.kill, process=os.getpid(), write=os.write):
        kill(process, {int(number)})
        write(1, b"late\\n")
late = Late()
sys.argv = ["bayesfric", "info"]
signal.signal(signal.SIGINT, signal.default_int_handler)
from bayesfric.cli import main
main()
"""
    done = subprocess.run([sys.executable, "-c", late], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.splitlines()[-1]) == (0, "late"), done.stderr


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_before_any_verb_begins_ends_with_3(number):
    """At the first import that the command makes, which no exit guards yet."""
    code = (
        "import os, sys, bayesfric.cli as cli\n"
        "class Interrupting:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        f"        if name == 'typer': os.kill(os.getpid(), {int(number)})\n"
        "sys.meta_path.insert(0, Interrupting())\n"
        "cli.main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        preexec_fn=default_signals,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (3, "interrupted\n")


@pytest.mark.parametrize("arguments", [["validate"], ["--help"]])
def test_output_that_cannot_be_printed_ends_with_2(board, arguments):
    if arguments == ["validate"]:
        arguments = ["validate", board / "board"]
    with Path("/dev/full").open("w") as full:
        process = started(*arguments, stdout=full, stderr=subprocess.PIPE, text=True)
        _, said = process.communicate()
    assert process.returncode == 2
    (line,) = [line for line in said.splitlines() if "error" in line]
    assert "standard output" in line
    assert os.strerror(errno.ENOSPC) in line
    assert "Traceback" not in said


@pytest.mark.parametrize("closed", [">&-", "<&- >&- 2>&-"])
def test_streams_that_the_caller_closed_change_no_status(closed):
    command = f'exec "$0" -m bayesfric --help {closed}'
    done = subprocess.run(
        ["sh", "-c", command, sys.executable], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize("verb", ["fit", "claims", "diagnose", "run"])
@pytest.mark.parametrize("place", ["a file", "below a file"])
def test_an_output_that_can_be_no_folder_ends_with_2(board, verb, place, tmp_path):
    (tmp_path / "file").write_text("mine")
    output = tmp_path / "file" if place == "a file" else tmp_path / "file" / "x"
    done = CliRunner().invoke(app, [verb, str(board / "board"), "-o", str(output)])
    assert done.exit_code == 2
    assert "file" in done.stderr
    assert "bug in bayesfric" not in done.stderr
    assert (tmp_path / "file").read_text() == "mine"


def test_a_full_disk_ends_with_2_and_leaves_no_result(board, tmp_path):
    """No file may grow beyond 1 KB: the checkpoint and the results cannot be written."""
    code = (
        "import resource, signal, sys; sys.argv[0] = 'bayesfric'\n"
        "from bayesfric.cli import main\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1024, 1024)); main()"
    )
    quick = tmp_path / "quick.toml"
    quick.write_text("[sampler]\nburn = 10\nsteps = 50\nthin = 2\nwalkers = 36\nextensions = 0\n")
    arguments = ("fit", board / "board", "--config", quick, "-o", tmp_path / "out")
    done = subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr
    assert "can be written" in done.stderr
    assert not (tmp_path / "out" / "fit.json").exists()
