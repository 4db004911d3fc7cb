"""Imports are declared, declared packages are locked, locked ones have hashes and licences."""

import importlib.util
import re
import subprocess
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from house.imports import imports_of
from house.lock import entries, pins
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
FOR_PEOPLE = {"arviz", "dev", "docs"}  # extras that the package does not import
READ_AS_FILES = {"bokeh"}  # its scripts are copied into pages, and it is never imported
OF_NOTEBOOKS = {"IPython"}  # there where a notebook runs


def licences():
    spec = importlib.util.spec_from_file_location("licences", ROOT / "docs" / "licences.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def names_of(requirements):
    return {canonicalize_name(Requirement(line).name) for line in requirements}


def imported(package):
    """Return the distributions that a package imports: at once, and all of them."""
    distributions = metadata.packages_distributions()
    at_once, everywhere = set(), set()
    for file in package.rglob("*.py"):
        for statement in imports_of(package, file):
            library = statement.module.partition(".")[0]
            if library in sys.stdlib_module_names | OF_NOTEBOOKS | {"bayesfric"}:
                continue
            owners = {canonicalize_name(name) for name in distributions.get(library, [library])}
            if len(owners) > 1:  # of a package in parts, the one that has its name
                owners = {canonicalize_name(library)} & owners
            everywhere |= owners
            at_once |= owners if statement.at_once else set()
    return at_once, everywhere


def test_what_is_imported_is_declared_and_what_is_declared_is_imported():
    at_once, everywhere = imported(ROOT / "bayesfric")
    needed = names_of(PROJECT["dependencies"])
    optional = {
        name
        for extra, lines in PROJECT["optional-dependencies"].items()
        if extra not in FOR_PEOPLE
        for name in names_of(lines)
    }
    assert at_once - needed == set()
    assert everywhere - needed - optional == set()
    assert needed - everywhere - READ_AS_FILES == set()


@pytest.mark.parametrize("statement", ["import yaml", "from markupsafe import Markup"])
def test_an_import_is_seen(tmp_path, statement):
    (tmp_path / "x.py").write_text(f"{statement}\n\n\ndef f():\n    import h5py\n")
    name = {"yaml": "pyyaml"}.get(statement.split()[1], statement.split()[1])
    assert imported(tmp_path) == ({name}, {name, "h5py"})


def test_the_lock_is_pins_with_hashes_and_nothing_else():
    """Names and versions in order, and no address."""
    names = [entry.requirement.name for entry in entries()]
    assert names == sorted(set(names))
    for entry in entries():
        assert re.fullmatch(r"[a-z0-9.]+", entry.version)
        assert entry.requirement.url is None
        assert entry.options
        for option in entry.options:
            assert re.fullmatch(r"--hash=sha256:[0-9a-f]{64}", option), entry.requirement


def test_what_is_declared_is_locked():
    """All but ArviZ itself, which is left to users: the lock has the parts that are imported."""
    extras = PROJECT["optional-dependencies"]
    lines = [*PROJECT["dependencies"], *(line for group in extras.values() for line in group)]
    pinned = pins()
    assert names_of(lines) - set(pinned) == {"arviz"}
    for requirement in map(Requirement, lines):
        if requirement.name != "arviz":
            assert requirement.specifier.contains(pinned[canonicalize_name(requirement.name)])


def test_the_page_of_licences_is_current():
    page = (ROOT / "docs" / "licences.md").read_text(encoding="utf-8")
    assert page == licences().page(), "run: python docs/licences.py"


def test_each_package_has_one_licence():
    """What metadata say of packages whose licences are known."""
    page = (ROOT / "docs" / "licences.md").read_text(encoding="utf-8")
    rows = licences().rows_of(page)
    said = {name: [cell.strip() for cell in row.split("|")][3] for (name, _), row in rows.items()}
    assert set(said) == {"package", *pins()}
    assert said["numpy"].startswith("BSD-3-Clause")
    assert said["emcee"] == "MIT License"
    assert said["typst"] == "Apache-2.0"
    assert all(said.values())


def test_the_lowest_versions_are_the_bounds():
    done = subprocess.run(
        [sys.executable, ".ci/lowest"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    wanted = [*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["dev"]]
    lowest = dict(line.split("==") for line in done.stdout.splitlines())
    assert lowest["numpy"] == "2.1"
    assert lowest["typst"] == "0.15"
    assert all(f">={lowest[Requirement(line).name]}" in line for line in wanted)
    assert len(lowest) == len(wanted)
