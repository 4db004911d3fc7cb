"""Mistakes on the command line: each is one line that names it, before any work."""

import pytest
from recording.mini import Mini
from typer.testing import CliRunner

from bayesfric.cli.verbs import app
from bayesfric.errors import InputError
from bayesfric.recording import write_recording
from bayesfric.results import read_json
from bayesfric.schemas import DiagnosisFile

MISTAKES = {
    "a misspelt verb": ("diagnoze board", "Did you mean 'diagnose'?"),
    "an option of another verb": ("fit board --junit x.xml", "an option of `run`, `claims`"),
    "an empty folder": (["fit", "board", "-o", ""], "an empty value of -o: is a variable"),
    "an empty recording": (["validate", ""], "an empty value"),
    "empty rigs": (["fit", "board", "--rigs", ""], "an empty value of --rigs"),
    "a misspelt rig": ("claims board --rigs gravty", "is 'gravity' meant?"),
    "a rig twice": ("fit board --rigs gravity,gravity", "each rig once"),
    "a misspelt law": ("fit board --baseline papr", "is 'paper' meant?"),
    "a misspelt effect": ("simulate new --effect viscus=1", "is 'viscous' meant?"),
    "an effect in capitals": ("simulate new --effect Viscous", "is 'viscous' meant?"),
    "what cannot happen": ("fit board --fail-on unconvergd", "is 'unconverged' meant?"),
    "results into the recording": ("fit board -o board", "this one is a recording"),
    "a report of the recording": ("report board", "this one is a recording"),
    "a simulation over a recording": ("simulate board", "empty or does not exist yet"),
    "claims into a folder": ("claims board --junit empty", "this is a folder"),
    "a fit by its file": ("diagnose board --shipped empty/a.toml", "this is a file in it"),
    "a folder of draws": ("margins raven-elbow --draws empty", "whole (a folder)"),
    "a misspelt loop": ("margins raven-elbo --draws x.nc", "is 'raven-elbow' meant?"),
    "no draws": ("margins raven-elbow", "found '1 loops, no --draws'"),
    "a misspelt format": ("export empty --to mjfc", "is 'mjcf' meant?"),
    "a misspelt engine": ("blind -o new --engine mujco", "is 'mujoco' meant?"),
    "a misspelt family": ("fit board --config empty/b.toml", "is 'half-normal' meant?"),
    "no family": ("fit board --config empty/c.toml", "priors.c1.family: expected this key"),
    "a misspelt key": ("fit board --config empty/a.toml", "is 'sampler.steps' meant?"),
    "nothing to run again": ("rerun empty -o new", "fit.json, claims.json or diagnosis.json"),
}


@pytest.fixture(scope="module")
def place(small_recording, tmp_path_factory):
    folder = tmp_path_factory.mktemp("mistakes")
    write_recording(small_recording, folder / "board")
    (folder / "empty").mkdir()
    (folder / "empty/a.toml").write_text("[sampler]\nstep = 800\n")
    (folder / "empty/b.toml").write_text('priors.c1 = {family = "halfnormal", scale = 1}\n')
    (folder / "empty/c.toml").write_text("priors.c1 = {scale = 1}\n")
    return folder


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_named_in_one_line_and_leaves_nothing(place, mistake, monkeypatch):
    monkeypatch.chdir(place)
    given, said = MISTAKES[mistake]
    before = sorted(place.rglob("*"))
    done = CliRunner().invoke(app, given.split() if isinstance(given, str) else given)
    assert done.exit_code == 2, done.output
    (line,) = [
        line_of_error
        for line_of_error in done.stderr.splitlines()
        if line_of_error.lower().startswith("error")
    ]
    assert said in line
    assert "simulating" not in done.stderr or "effect" in mistake  # which needs what is simulated
    assert sorted(place.rglob("*")) == before


def test_a_misspelt_key_of_the_rig_is_named_where_it_is_missing(tmp_path):
    mini = Mini()
    mini.package["rig"]["hal_spacing_m"] = mini.package["rig"].pop("hall_spacing_m")
    done = CliRunner().invoke(app, ["validate", str(mini.write(tmp_path))])
    assert done.exit_code == 2
    assert "is 'hal_spacing_m' meant?" in done.stderr


def test_an_empty_list_of_failures_is_no_mistake(place, monkeypatch):
    """A workflow without an entry hands over an empty string."""
    monkeypatch.chdir(place)
    done = CliRunner().invoke(app, ["simulate", "board", "--fail-on", ""])
    assert "an empty value" not in done.stderr


def test_a_file_of_another_schema_is_one_line(tmp_path):
    path = tmp_path / "fit.json"
    path.write_text('{"schema": "bayesfric.fit/1"}')
    with pytest.raises(
        InputError, match=r"found 'bayesfric.fit/1', .* bayesfric.diagnosis/2"
    ) as caught:
        read_json(DiagnosisFile, path)
    assert len(caught.value.faults) == 1
