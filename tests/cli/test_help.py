"""Help texts: types that people know, whole summaries, an example, and what can happen."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from typer.main import get_command
from typer.testing import CliRunner

from bayesfric.cli.exits import CAN_HAPPEN, FAILURES, check_fail_on
from bayesfric.cli.verbs import app
from bayesfric.errors import InputError
from bayesfric.physics.laws import BASELINES

VERBS = [command.name or command.callback.__name__ for command in app.registered_commands]


def help_of(*verb):
    done = CliRunner().invoke(app, [*verb, "--help"], terminal_width=80, env={"COLUMNS": "80"})
    assert done.exit_code == 0, done.output
    return done.output


@pytest.mark.parametrize("verb", VERBS)
def test_a_verb_shows_types_that_people_know_and_an_example(verb):
    said = help_of(verb)
    assert f"Example: bayesfric {verb}" in said
    taking = re.findall(r"^  (?:-\w, )?--[\w-]+ (\S+)", said.split("Options:")[-1], re.MULTILINE)
    types = {"PATH", "INTEGER", "NUMBER", "LAW", "ADDRESS", "N"}
    names = {"NAME", "NAME,…", "NAME[=STRENGTH]", "MODULE:OBJECT", "MODEL", "LOG=MODEL"}
    choices = set(re.findall(r"<[\w|]+\|[\w|]+>", said))  # spelled out
    assert set(taking) <= types | names | choices
    assert max(map(len, said.splitlines())) <= 80


@pytest.mark.parametrize("verb", ["run", "fit", "claims", "diagnose"])
def test_every_law_that_can_be_asked_for_is_explained(verb):
    said = " ".join(help_of(verb).split("--baseline LAW")[1].split("[default")[0].split())
    for law in BASELINES:
        assert re.search(rf"\b{law} \(", said), law


def test_summaries_are_whole_sentences():
    listed = help_of().split("Commands:")[1]
    assert "..." not in listed
    for verb in VERBS:
        summary = re.split(r"\n  \w", listed.split(f"\n  {verb} ")[1])[0].strip()
        assert summary.endswith("."), verb


@pytest.mark.parametrize("verb", CAN_HAPPEN)
def test_a_verb_lists_what_can_happen_in_it(verb):
    text = " ".join(help_of(verb).split())
    said = re.search(r"--fail-on NAME,… (.*?) --help", text).group(1)
    assert {name for name in FAILURES if re.search(rf"\b{name}\b", said)} == set(CAN_HAPPEN[verb])


def test_what_a_verb_never_has_is_told_and_what_nobody_has_is_refused(capsys):
    check_fail_on("unconverged, spec", "fit")
    assert capsys.readouterr().err == (
        "note: --fail-on spec never happens in `fit`, which can report: unconverged, attention\n"
    )
    with pytest.raises(InputError, match="found 'rain'"):
        check_fail_on("rain", "fit")


def test_every_verb_that_computes_takes_the_options_of_the_contract():
    """Settings, seed, chatter and what fails a job; results go to one folder without a word."""
    verbs = get_command(app).commands
    computing = ("run", "simulate", "fit", "claims", "diagnose", "margins", "blind", "calibrate")
    for name in computing:
        options = {option for param in verbs[name].params for option in param.opts}
        assert {"--seed", "--config", "--quiet", "--fail-on"} <= options, name
        output = [param.default for param in verbs[name].params if param.name == "output"]
        assert output == ([] if name == "simulate" else [Path("bayesfric-run")]), name


def test_a_shell_completes_verbs():
    """As the script of --install-completion asks for them."""
    asked = {
        "_BAYESFRIC_COMPLETE": "complete_bash",
        "COMP_WORDS": "bayesfric di",
        "COMP_CWORD": "1",
    }
    code = "import sys; sys.argv = ['bayesfric']; from bayesfric.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | asked, capture_output=True, text=True
    )
    assert done.stdout.split() == ["diagnose"]
