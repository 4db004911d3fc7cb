"""A stage is told: as a bar on a terminal and in a notebook, else to the log."""

import builtins
import logging
import os
import pty
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from types import ModuleType

import pytest
from rigs.friction_points import joint, recorded
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.progress import LOGGER, stage

POINTS = ("simulate", "points", "--protocol", "points")


def test_the_package_logs_and_whoever_runs_it_decides_where_to(capfd, caplog, monkeypatch):
    monkeypatch.setattr(LOGGER, "handlers", [])  # a verb of an earlier test had one put there
    with caplog.at_level(logging.INFO, "bayesfric"), stage("dig [red]\x1b[31m{x}") as progress:
        progress(1, 2)
    assert [(record.name, record.levelname, record.message) for record in caplog.records] == [
        ("bayesfric", "INFO", "dig [red]\x1b[31m{x}: started"),
        ("bayesfric", "INFO", "dig [red]\x1b[31m{x}: done"),
    ]
    assert capfd.readouterr() == ("", "")
    code = (
        "import logging, bayesfric.progress as p; print(p.LOGGER.handlers, logging.root.handlers)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[] []\n"


@pytest.mark.parametrize(
    ("seconds", "done", "said"),
    [
        (4.0, 1, []),  # too early to say
        (6.0, 1, ["dig: about 54 s to go"]),
        (60.0, 1, ["dig: about 9 min to go"]),
        (6.0, 8, []),  # soon over
        (6.0, 0, []),
        (6.0, 0.9, []),  # less than a tenth
    ],
)
def test_a_log_says_once_how_long_a_long_stage_takes(monkeypatch, caplog, seconds, done, said):
    now = iter([0.0, seconds, 2 * seconds])
    monkeypatch.setattr("bayesfric.progress.monotonic", lambda: next(now))
    with caplog.at_level(logging.INFO, "bayesfric"), stage("dig") as progress:
        progress(done, 10)
        progress(10, 10)
    assert [record.message for record in caplog.records][1:-1] == said


def test_of_steps_of_which_the_longest_come_first_a_bound_is_told(monkeypatch, caplog):
    now = iter([0.0, 60.0])
    monkeypatch.setattr("bayesfric.progress.monotonic", lambda: next(now))
    with caplog.at_level(logging.INFO, "bayesfric"), stage("dig", longest_first=True) as progress:
        progress(1, 10)
    assert caplog.records[1].message == "dig: less than 9 min to go"


def test_a_stage_that_fails_is_not_done(caplog):
    with (
        caplog.at_level(logging.INFO, "bayesfric"),
        pytest.raises(ZeroDivisionError),
        stage("dig"),
    ):
        raise ZeroDivisionError
    assert [record.message for record in caplog.records] == ["dig: started"]


def test_a_stage_is_done_when_its_results_are_written(tmp_path, monkeypatch, caplog):
    """An interrupt while they are written leaves a stage that will be done again."""

    def interrupted(self, folder):
        raise KeyboardInterrupt

    recorded(tmp_path / "joint", joint(3.0))
    monkeypatch.setattr("bayesfric.diagnosis.Diagnosed.write", interrupted)
    with caplog.at_level(logging.INFO, "bayesfric"):
        CliRunner().invoke(app, ["diagnose", str(tmp_path / "joint"), "-o", str(tmp_path / "a")])
    (message,) = [record.message for record in caplog.records]
    assert message.endswith(": started")


def run(*arguments, cwd, stderr):
    command = Path(sys.executable).with_name("bayesfric")
    environment = os.environ | {"TERM": "xterm", "COLUMNS": "80"}
    return subprocess.run(
        [command, *arguments], cwd=cwd, env=environment, stderr=stderr, check=True
    )


def test_quiet_has_no_line(tmp_path):
    assert run(*POINTS, "--quiet", cwd=tmp_path, stderr=subprocess.PIPE).stderr == b""


def written(ours):
    """Return all that was written to a terminal whose other end is closed; in several reads."""
    parts = []
    with suppress(OSError):  # which is how such a terminal ends
        while part := os.read(ours, 100_000):
            parts.append(part)
    os.close(ours)
    return b"".join(parts).decode()


def test_a_terminal_has_a_bar(tmp_path):
    """And no line that says what the bar says."""
    ours, theirs = pty.openpty()
    run(*POINTS, cwd=tmp_path, stderr=theirs)
    os.close(theirs)
    shown = written(ours)
    assert "simulating \x1b[" in shown  # followed by a coloured bar
    assert "started" not in shown


def test_a_name_is_no_markup_on_a_terminal(monkeypatch, capfd):
    ours, theirs = pty.openpty()
    with os.fdopen(theirs, "w") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        monkeypatch.setenv("TERM", "xterm")
        with stage("dig [red]\x1b[31m{x}") as progress:
            progress(1, 4)
    shown = written(ours)
    assert "dig [red][U+001B][31m{x}" in shown
    assert "25%" in shown


def test_a_notebook_has_a_line_that_is_brought_up_to_date(monkeypatch):
    """Of the kernel of a notebook what is asked of it; it is no dependency."""
    shown = []

    class Handle:
        def update(self, data, *, raw):
            shown.append(data)

    def display(data, *, raw, display_id):
        shown.append(data)
        return Handle()

    kernel = ModuleType("IPython.display")
    kernel.display = display
    monkeypatch.setitem(sys.modules, "IPython", ModuleType("IPython"))
    monkeypatch.setitem(sys.modules, "IPython.display", kernel)
    shell = type("ZMQInteractiveShell", (), {})
    monkeypatch.setattr(builtins, "get_ipython", shell, raising=False)
    with stage("sampling") as progress:
        progress(1, 4)
    assert shown == [{"text/plain": "sampling: started"}, {"text/plain": "sampling: 25%"}]
