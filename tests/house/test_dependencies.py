"""Pins, their hashes and their licences agree; lower bounds are those of pyproject.toml."""

import importlib.util
import re
import subprocess
import sys
import tomllib
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]
ELSEWHERE = {"colorama"}  # on Windows alone, where no pin is tested


def licences():
    spec = importlib.util.spec_from_file_location("licences", ROOT / "docs" / "licences.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_pin_has_its_hashes():
    text = (ROOT / "constraints-hashed.txt").read_text(encoding="utf-8")
    entries = [one for one in re.split(r"\n(?=\S)", text.replace("\\\n", " ")) if one.strip()]
    hashed = {}
    for entry in entries:
        wanted = Requirement(entry.partition(" --hash")[0])
        (pin,) = wanted.specifier
        assert pin.operator == "=="
        hashed[wanted.name] = pin.version
        assert re.search(r"--hash=sha256:[0-9a-f]{64}\b", entry), wanted.name
    assert {name: v for name, v in hashed.items() if name not in ELSEWHERE} == dict(
        licences().pins()
    )


def test_the_page_of_licences_is_current():
    page = (ROOT / "docs" / "licences.md").read_text(encoding="utf-8")
    assert page == licences().page(), "run: python docs/licences.py"


def test_each_package_has_one_licence():
    """What metadata say of packages whose licences are known."""
    page = (ROOT / "docs" / "licences.md").read_text(encoding="utf-8")
    rows = licences().rows_of(page)
    said = {name: [cell.strip() for cell in row.split("|")][3] for (name, _), row in rows.items()}
    assert set(said) == {"package", *dict(licences().pins())}
    assert said["numpy"].startswith("BSD-3-Clause")
    assert said["emcee"] == "MIT License"
    assert said["typst"] == "Apache-2.0"
    assert all(said.values())


def test_the_lowest_versions_are_the_bounds():
    done = subprocess.run(
        [sys.executable, ".ci/lowest"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = [*project["dependencies"], *project["optional-dependencies"]["dev"]]
    pins = dict(line.split("==") for line in done.stdout.splitlines())
    assert pins["numpy"] == "2.1"
    assert pins["typst"] == "0.15"
    assert all(f">={pins[Requirement(one).name]}" in one for one in wanted)
    assert len(pins) == len(wanted)
