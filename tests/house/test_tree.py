"""What no file of the project may hold, and what the settings must."""

import ast
import os
import re
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from house.lock import pins
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
HIDDEN_BUT_OURS = {".ci", ".github"}
MADE_BY_TOOLS = {"__pycache__", "bayesfric-run", "build", "dist"}

# With brackets, or this file would break its own rules.
MACHINE_PATH = re.compile(rb"(?<![\w.~-])/(?:work|root|home|Users)/")
REGISTRY = re.compile(rb"py[p]i\.org|python[h]osted\.org|(?:index|find)[-](?:url|links)")
UNFINISHED = re.compile(rb"\b(?:TO[D]O|FIX[M]E|XX[X])\b")


def project_files():
    """Every file of the project, tracked or about to be."""
    paths = []
    for folder, names, files in os.walk(ROOT):
        directory = Path(folder)
        names[:] = [
            name
            for name in names
            if (not name.startswith(".") or name in HIDDEN_BUT_OURS)
            and name not in MADE_BY_TOOLS
            and not name.endswith(".egg-info")
            and not (directory / name / "pyvenv.cfg").exists()
            and directory / name != ROOT / "reports" / "latest"
        ]
        paths += [directory / name for name in files if name != ".git"]  # of a linked work tree
    return sorted(paths)


def files_with(pattern):
    return [
        str(file.relative_to(ROOT)) for file in project_files() if pattern.search(file.read_bytes())
    ]


def test_the_walk_finds_the_project():
    assert {ROOT / "pyproject.toml", ROOT / ".ci" / "run", Path(__file__)} <= set(project_files())


@pytest.mark.parametrize(
    ("pattern", "text"),
    [
        (MACHINE_PATH, "see /{}/someone/x".format("home")),
        (REGISTRY, "https://{}.org".format("py" + "pi")),
        (UNFINISHED, "# {}: later".format("TO" + "DO")),
    ],
    ids=["machine path", "registry", "unfinished"],
)
def test_no_file_holds(pattern, text):
    assert pattern.search(text.encode())
    assert files_with(pattern) == []


def test_only_the_command_line_prints():
    def prints(file):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        names = (node.func for node in ast.walk(tree) if isinstance(node, ast.Call))
        return any(isinstance(name, ast.Name) and name.id == "print" for name in names)

    package = ROOT / "bayesfric"
    files = [file for file in package.rglob("*.py") if package / "cli" not in file.parents]
    assert [str(file) for file in files if prints(file)] == []


def test_warnings_are_errors():
    first, *others = SETTINGS["tool"]["pytest"]["ini_options"]["filterwarnings"]
    assert first == "error"
    # An exception names the message and the category that it lets pass.
    assert [rule for rule in others if not re.fullmatch(r"ignore:.{8,}:\w+Warning", rule)] == []


def test_no_test_switches_warnings_off():
    blanket = re.compile(rb"(?:filterwarnings|simplefilter)\(\s*['\"]ignore['\"]\s*\)")
    assert [file for file in files_with(blanket) if file.startswith("tests/")] == []


def requirements():
    """Everything that the package, its tools and its build need, here."""
    project = SETTINGS["project"]
    waiting = [*project["dependencies"], *project["optional-dependencies"]["dev"]]
    waiting = [Requirement(line) for line in [*waiting, *SETTINGS["build-system"]["requires"]]]
    seen = set()
    while waiting:
        requirement = waiting.pop()
        name = canonicalize_name(requirement.name)
        key = (name, frozenset(requirement.extras))
        if key in seen:
            continue
        seen.add(key)
        for line in metadata.requires(name) or ():
            other = Requirement(line)
            extras = requirement.extras | {""}
            if not other.marker or any(other.marker.evaluate({"extra": x}) for x in extras):
                waiting.append(other)
    return {name for name, _ in seen}


def test_nothing_floats():
    pinned = pins()
    installed = {name: metadata.version(name) for name in requirements()}
    assert {name: pinned.get(name) for name in installed} == installed
