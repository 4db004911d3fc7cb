"""``bayesfric margins``: what it writes, prints and returns."""

import subprocess
import sys
from pathlib import Path

import pytest
from margins.loops import write_draws
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.resources import data_folder
from bayesfric.results import read_json
from bayesfric.schemas import MarginsFile

TEMPLATE = data_folder() / "loops" / "template.toml"


def bayesfric(*arguments, cwd):
    command = Path(sys.executable).with_name("bayesfric")
    return subprocess.run(
        [command, *map(str, arguments)], cwd=cwd, capture_output=True, text=True, check=False
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("a folder with spaces")
    write_draws(folder / "draws.nc", n=200)
    text = TEMPLATE.read_text(encoding="utf-8")
    text = text.replace('signal = "measured"', 'signal = "reference"')
    text = text.replace("[0.1, 10.0]", "[0.0, 0.0]")  # held at rest: quick
    (folder / "joint.toml").write_text(text, encoding="utf-8")
    return folder


def test_it_writes_prints_and_repeats_to_the_byte(folder):
    arguments = ["margins", "joint.toml", "--draws", "draws.nc", "--seed", "4", "-o"]
    first = bayesfric(*arguments, "one", cwd=folder)
    assert first.returncode == 0, first.stderr
    assert [path.name for path in (folder / "one").iterdir()] == ["margins.json"]
    found = read_json(MarginsFile, folder / "one" / "margins.json")
    assert first.stdout.startswith(f"my-joint: {found.loops[0].answer}\n")
    assert "warning: my-joint: Assumed" in first.stderr
    assert found.seed == 4
    again = bayesfric(*arguments, "two", "--quiet", cwd=folder)
    assert again.stderr == ""
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
