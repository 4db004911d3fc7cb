"""The effects are listed with what they need, and a new one passes the check as it is written."""

import pytest
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.effects import all_effects, effect_of_file
from bayesfric.testing import check_effect


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_every_effect_has_a_line_of_the_list():
    shown = CliRunner().invoke(app, ["effects"]).stdout.splitlines()
    for line, effect in zip(shown, all_effects(None).values(), strict=True):
        assert line.startswith(f"{effect.name} ")
        assert line.endswith(f" {effect.sentence}")


def test_every_effect_is_listed_with_its_prior_if_asked():
    shown = CliRunner().invoke(app, ["effects", "--verbose"]).output
    for effect in all_effects().values():
        assert f"\n{effect.name}  (on {effect.acts_on}" in f"\n{shown}"
    assert "prior half-normal(scale=0.15)" in shown


def test_a_new_effect_passes_the_check_as_it_is_written(folder):
    done = CliRunner().invoke(app, ["effects", "new", "oil-warmth"])
    assert done.exit_code == 0
    effect = effect_of_file(folder / "oil_warmth.py")
    assert effect.name == "oil-warmth"
    check_effect(effect)


@pytest.mark.parametrize("name", ["Oil Warmth", "viscous", "../oil"])
def test_a_name_that_cannot_be_is_refused_and_nothing_written(folder, name):
    assert CliRunner().invoke(app, ["effects", "new", name]).exit_code == 2
    assert list(folder.iterdir()) == []


def test_a_file_that_is_there_is_left_alone(folder):
    (folder / "oil_warmth.py").write_text("mine")
    assert CliRunner().invoke(app, ["effects", "new", "oil-warmth"]).exit_code == 2
    assert (folder / "oil_warmth.py").read_text() == "mine"
