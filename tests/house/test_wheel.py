"""The wheel carries everything, and works where the source tree is not."""

import os
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest
from altered import with_trials

from bayesfric.recording import write_recording

ROOT = Path(__file__).parents[2]
VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]


def run(*command, cwd):
    env = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    done = subprocess.run(
        [str(part) for part in command], cwd=cwd, env=env, capture_output=True, text=True
    )
    assert done.returncode == 0, f"{done.args}\n{done.stdout}\n{done.stderr}"
    return done.stdout.strip()


@pytest.fixture(scope="session")
def wheel(tmp_path_factory):
    """Build the source distribution, and the wheel from that, as pip would."""
    out = tmp_path_factory.mktemp("dist")
    hatchling = [sys.executable, "-m", "hatchling", "build", "-d", out]
    run(*hatchling, "-t", "sdist", cwd=ROOT)
    (sdist,) = out.glob("*.tar.gz")
    with tarfile.open(sdist) as archive:
        archive.extractall(out, filter="data")
    run(*hatchling, "-t", "wheel", cwd=out / sdist.name.removesuffix(".tar.gz"))
    (wheel,) = out.glob("*.whl")
    return wheel


@pytest.fixture(scope="session")
def elsewhere(wheel, tmp_path_factory):
    """Install the wheel into an empty environment; return its folder.

    The libraries are lent by a .pth file, so that no registry is needed. What such a file
    names is searched after the environment's own packages, and its .pth files (one leads to
    the source tree) are not followed.
    """
    folder = tmp_path_factory.mktemp("elsewhere") / "venv"
    venv.create(folder, with_pip=False)
    packages = sysconfig.get_path("purelib", vars={"base": str(folder)})
    lent = {sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}
    (Path(packages) / "lent.pth").write_text("\n".join(sorted(lent)) + "\n")
    pip = [sys.executable, "-m", "pip", "--python", folder]
    run(*pip, "install", "--no-deps", "--no-index", "--no-warn-script-location", wheel, cwd=folder)
    return folder


def tracked(folder):
    """Paths of the files under a folder of the project, as they stand in it."""
    files = (file for file in (ROOT / folder).rglob("*") if file.is_file())
    return {
        file.relative_to(ROOT).as_posix()
        for file in files
        if "__pycache__" not in file.parts and not file.name.startswith(".")
    }


def test_the_wheel_holds_the_package_and_its_data(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if ".dist-info/" not in name}
    data = tracked("data") | tracked("reports/reference")
    assert data
    assert names == tracked("bayesfric") | {f"bayesfric/_data/{name}" for name in data}
    assert "bayesfric/py.typed" in names


def test_it_is_the_wheel_that_runs(elsewhere, tmp_path):
    code = (
        "import bayesfric, bayesfric.resources as r\n"
        "print(bayesfric.__file__, r.data_folder(), r.reference_folder(), sep='\\n')"
    )
    python = elsewhere / "bin" / "python"
    for path in run(python, "-c", code, cwd=tmp_path).splitlines():
        assert Path(path).resolve().is_relative_to(elsewhere.resolve())


@pytest.mark.parametrize("arguments", [["--version"], ["info"]])
def test_the_command_runs_in_an_empty_folder(elsewhere, tmp_path, arguments):
    assert VERSION in run(elsewhere / "bin" / "bayesfric", *arguments, cwd=tmp_path)
    assert list(tmp_path.iterdir()) == []


SHORT = "[sampler]\nburn = 10\nsteps = 80\nthin = 2\nextensions = 0\n"


def test_the_bundled_recording_is_read(elsewhere, tmp_path):
    where = "import bayesfric.resources as r; print(r.bundled_recording())"
    recording = run(elsewhere / "bin" / "python", "-c", where, cwd=tmp_path).strip()
    said = run(elsewhere / "bin" / "bayesfric", "validate", recording, cwd=tmp_path)
    assert "medium" in said


@pytest.mark.nightly
def test_a_recording_is_fitted_and_reported(elsewhere, small_recording, tmp_path):
    """With few draws of few trials; `tests/test_reference_run.py` has the bundled one."""
    (tmp_path / "analysis.toml").write_text(SHORT)
    write_recording(with_trials(small_recording, slice(0, 12)), tmp_path / "board")
    command = elsewhere / "bin" / "bayesfric"
    options = ["-o", "results", "--config", "analysis.toml", "--quiet"]
    run(command, "fit", "board", *options, cwd=tmp_path)
    run(command, "report", "results", "--quiet", cwd=tmp_path)
    written = {path.name for path in (tmp_path / "results").iterdir()}
    assert {"fit.json", "draws.nc", "report.pdf", "report.html", "summary.md"} <= written
    assert (tmp_path / "results" / "report.pdf").read_bytes().startswith(b"%PDF")
