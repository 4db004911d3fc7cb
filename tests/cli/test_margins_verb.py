"""``bayesfric margins``: what it writes, prints and returns."""

import subprocess
import sys
from pathlib import Path

import pytest
from margins.loops import write_draws
from margins.test_diagnosed import beside
from scipy.io import loadmat
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.cli.margins import _answer
from bayesfric.errors import InputError
from bayesfric.margins import read_loop
from bayesfric.margins.answer import what_to_measure
from bayesfric.resources import loop_template
from bayesfric.results import json_bytes, read_json
from bayesfric.schemas import MarginsFile, TimingsFile

TEMPLATE = loop_template()


def bayesfric(*arguments, cwd):
    command = Path(sys.executable).with_name("bayesfric")
    return subprocess.run(
        [command, *map(str, arguments)], cwd=cwd, capture_output=True, text=True, check=False
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("a folder with spaces")
    write_draws(folder / "draws.nc", n=60)
    text = TEMPLATE.read_text(encoding="utf-8")
    text = text.replace('signal = "measured"', 'signal = "reference"')
    text = text.replace("[0.1, 10.0]", "[0.0, 0.0]")  # held at rest: quick
    (folder / "joint.toml").write_text(text, encoding="utf-8")
    return folder


def test_it_writes_prints_and_repeats_to_the_byte(folder, monkeypatch):
    """In this process, and in another."""
    arguments = ["margins", "joint.toml", "--draws", "draws.nc", "--seed", "4", "-o"]
    monkeypatch.chdir(folder)
    first = CliRunner().invoke(app, [*arguments, "one", "--verbose"])
    assert first.exit_code == 0, first.stderr
    assert [path.name for path in (folder / "one").iterdir()] == ["margins.json"]
    stored = read_json(MarginsFile, folder / "one" / "margins.json")
    answer = stored.loops[0].answer
    law, said = first.stdout.split("\n", 1)
    assert law == "Margins of the law as it was fitted: no diagnosis lies beside the draws."
    assert said.startswith(
        "my-joint: safe from hunting at γ = 1, and meets its spec.\n  Up to γ = "
    )
    assert "\n  " + answer.replace(". ", ".\n  ") + "\n" in said
    assert answer.count(". ") >= 1  # a sentence a line
    assert "warning: my-joint: Assumed" in first.stderr
    assert stored.seed == 4
    again = bayesfric(*arguments, "two", "--quiet", "--mat", "two/loops.mat", cwd=folder)
    assert again.stderr == ""
    on_one_screen = again.stdout.splitlines()
    assert {*on_one_screen} < {*first.stdout.splitlines()}
    assert answer.partition(". ")[0] in again.stdout
    assert "Not examined" in said
    assert "Not examined" not in again.stdout
    assert loadmat(folder / "two" / "loops.mat", simplify_cells=True)["loops"]["name"] == "my-joint"
    first_bytes, second_bytes = (
        (folder / name / "margins.json").read_bytes() for name in ("one", "two")
    )
    assert first_bytes == second_bytes


@pytest.mark.parametrize(
    ("change", "options", "said"),
    [
        (("inertia_kg_m2 = 0.1 ", "inertia_kg_m2 = -0.1 "), [], "joint.inertia_kg_m2"),
        (("tension_known_at", "# tension_known_at"), [], "runs.0.tension_known_at"),
        (("length_m = 1.2", "length_mm = 1200"), [], "cable.length_mm"),
        (('"medium"', '"large"'), [], "runs.0.pulley_size"),
        (("delay_s = 0.001", "delay_s = 0.05"), [], "stable without friction"),
        (("", ""), ["--draws", "nowhere.nc"], "nowhere.nc"),
        (("", ""), ["--config", "nowhere.toml"], "nowhere.toml"),
    ],
    ids=["negative", "unstated", "unknown", "size", "unstable", "draws", "config"],
)
def test_bad_input_is_one_clear_error(folder, tmp_path, change, options, said):
    text = (folder / "joint.toml").read_text(encoding="utf-8").replace(*change, 1)
    (folder / "bad.toml").write_text(text, encoding="utf-8")
    arguments = ["margins", folder / "bad.toml", "--draws", folder / "draws.nc", *options]
    done = CliRunner().invoke(app, [*map(str, arguments), "-o", str(tmp_path / "bad")])
    assert done.exit_code == 2
    assert said in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "bad").exists()


def test_run_refuses_a_bad_loop_before_the_work(tmp_path):
    bad, output = tmp_path / "bad.toml", tmp_path / "out"
    bad.write_text("name = 3\n", encoding="utf-8")
    done = CliRunner().invoke(app, ["run", "-o", str(output), "--loop", str(bad)])
    assert done.exit_code == 2
    assert "bad.toml, name" in done.stderr
    assert not output.exists()


def test_what_was_verified_is_told(folder, tmp_path):
    arguments = ["margins", folder / "joint.toml", "--draws", folder / "draws.nc", "--verify", "2"]
    done = CliRunner().invoke(app, [*map(str, arguments), "-o", str(tmp_path)])
    assert done.exit_code == 0, done.stderr
    (loop,) = read_json(MarginsFile, tmp_path / "margins.json").loops
    assert loop.verification is not None
    held = [metric for metric in loop.verification.held if metric.share is not None]
    assert held
    for metric in held:
        holds = sum(1 for k in range(metric.draws + 1) if k / metric.draws <= metric.share) - 1
        assert f"    {metric.what}: agrees in {holds} of {metric.draws} draws" in done.stdout


def with_bound(folder, name, metres):
    """A loop whose only spec is its steady error, of a fraction of a millimetre."""
    text = (folder / "joint.toml").read_text(encoding="utf-8").partition("[spec]")[0]
    path = folder / name
    path.write_text(f"{text}[spec]\nsteady_error_max_m = {metres}\n", encoding="utf-8")
    return path


def test_a_named_cause_beside_the_draws_is_never_passed_over_in_silence(folder, tmp_path):
    beside(tmp_path)
    arguments = ["margins", folder / "joint.toml", "--draws", tmp_path / "draws.nc", "-o", tmp_path]
    command = list(map(str, arguments))
    done = CliRunner().invoke(app, command)
    assert done.exit_code == 0, done.stderr
    assert done.stdout.startswith("Margins of the law refitted with stribeck, which diagnosis.json")
    assert "attention" not in done.stderr
    alone = CliRunner().invoke(app, [*command, "--law", "fitted", "--fail-on", "attention,spec"])
    assert alone.exit_code == 1
    assert alone.stdout.startswith("Margins of the law as it was fitted: diagnosis.json names")
    (line,) = [line for line in alone.stderr.splitlines() if line.startswith("attention:")]
    assert "c2[small] 68% too high" in line
    assert "failed: attention" in alone.stderr
    assert CliRunner().invoke(app, [*command, "--law", "other"]).exit_code == 2


@pytest.mark.nightly
@pytest.mark.parametrize(("metres", "status"), [(1e-6, 1), (1.0, 0)], ids=["missed", "met"])
def test_fail_on_spec(folder, tmp_path, metres, status):
    loop = with_bound(folder, "judged.toml", metres)
    arguments = ["margins", loop, "--draws", folder / "draws.nc", "-o", tmp_path / "out"]
    done = CliRunner().invoke(app, [*map(str, arguments), "--fail-on", "spec"])
    assert done.exit_code == status, done.stderr
    assert ("P: steady error of the servo (P" in done.stdout) == bool(status)
    assert ("failed: spec" in done.stderr) == bool(status)
    assert (tmp_path / "out" / "margins.json").is_file()
    assert CliRunner().invoke(app, list(map(str, arguments))).exit_code == 0


@pytest.mark.nightly
@pytest.mark.parametrize(("metres", "status"), [(1e-6, 1), (1.0, 0)], ids=["missed", "met"])
def test_fail_on_spec_of_a_run(folder, tmp_path, monkeypatch, metres, status):
    """The verbs before the margins stand still: they have tests of their own."""

    def fitted(recording, output, asked, **options):
        write_draws(output / "draws.nc", n=200)
        (output / "timings.json").write_bytes(json_bytes(TimingsFile(seconds={})))
        return set()

    monkeypatch.setattr("bayesfric.cli.run.fit_into", fitted)
    for name in ("claims_into", "diagnose_into"):
        monkeypatch.setattr(f"bayesfric.cli.run.{name}", lambda *_, **__: set())
    monkeypatch.setattr("bayesfric.report.writing.write_report", lambda *_, **__: None)
    loop = with_bound(folder, "judged.toml", metres)
    arguments = ["run", "-o", tmp_path / "out", "--loop", loop, "--fail-on", "spec", "--quiet"]
    arguments += ["--workers", "1"]  # no diagnosis begins beside the fit
    assert CliRunner().invoke(app, list(map(str, arguments))).exit_code == status


def test_a_template_is_written_once(tmp_path):
    path = tmp_path / "mine.toml"
    done = CliRunner().invoke(app, ["margins", "--template", str(path)])
    assert done.exit_code == 0, done.stderr
    assert path.read_bytes() == TEMPLATE.read_bytes()
    path.write_text("changed\n", encoding="utf-8")
    again = CliRunner().invoke(app, ["margins", "--template", str(path)])
    assert again.exit_code == 2
    assert "mine.toml" in again.stderr
    assert path.read_text(encoding="utf-8") == "changed\n"


def test_bundled_loops_are_listed_and_found_by_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # where no data/ is
    listed = CliRunner().invoke(app, ["margins", "--list-loops"])
    assert listed.exit_code == 0, listed.stderr
    assert "raven-elbow  RAVEN II arm, elbow\n" in listed.stdout
    assert "template" not in listed.stdout
    assert read_loop(Path("raven-grasp")).title == "RAVEN II instrument, wrist or grasp, Kp and Ki"
    nameless = CliRunner().invoke(app, ["margins", "raven-grasp", "--draws", "nowhere.nc"])
    assert "\nerror: nowhere.nc" in nameless.stderr  # the loop was found
    Path("raven-grasp").write_text("name = 3\n", encoding="utf-8")
    with pytest.raises(InputError, match="raven-grasp, name"):  # a file that is there comes first
        read_loop(Path("raven-grasp"))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["nosuch", "--draws", "draws.nc"], "raven-elbow"),
        (["raven-elbow"], "--draws"),
        ([], "--template"),
        (["raven-elbow", "--list-loops"], "no loop beside"),
        (["raven-elbow", "--draws", "draws.nc", "--mat", "loops.m"], "ends in .mat"),
    ],
    ids=["no such loop", "no draws", "nothing", "both", "no such file"],
)
def test_what_is_missing_is_said(folder, tmp_path, arguments, said):
    arguments = [
        str(folder / argument) if argument == "draws.nc" else argument for argument in arguments
    ]
    done = CliRunner().invoke(app, ["margins", *arguments, "-o", str(tmp_path / "out")])
    assert done.exit_code == 2
    assert said in done.stderr
    assert not (tmp_path / "out").exists()


def test_the_terminal_keeps_what_to_measure_first():
    """Of the sentences of an answer, which the terminal shortens."""
    (sentence,) = what_to_measure({"gamma_necessary": {"drive.friction_n_m": 0.9}})
    assert sentence.endswith("90% of the variance of friction: measure it.")
    assert _answer(f"Meets its spec. Much more. {sentence}", verbose=False) == (
        f"Meets its spec. {sentence}"
    )
