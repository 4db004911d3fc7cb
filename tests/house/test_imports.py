"""Imports go one way: a room imports only rooms above it (ARCHITECTURE.md).

The graph is read from the source, so an import inside a function counts too.
"""

import subprocess
import sys
from pathlib import Path

import pytest
from house.imports import Import, imports_of, room_of

import bayesfric

ROOT = Path(__file__).parents[2]

# From the base up. Rooms of one row may import each other, in one direction.
ROWS = (
    (
        "arrays",
        "errors",
        "characters",
        "docstrings",
        "files",
        "resources",
        "hypothesis",
        "link_shapes",
        "probabilities",
        "rules",
        "source_date",
    ),
    ("recording",),
    ("logs",),
    ("paper", "families", "priors", "analysis", "diagnosis_rules", "schemas"),
    ("physics", "robots", "invariants"),
    ("campaign", "checkpoint", "progress"),
    ("inference",),
    ("effects", "simulators"),
    ("observation",),
    ("rigs",),
    ("simulate",),
    ("stored_names", "chains"),
    ("results", "attention"),
    ("fitting", "testing"),
    ("calibration",),
    ("claims",),
    ("diagnosis",),
    ("margins", "planning"),
    ("comparing", "readiness"),
    ("export", "blind/engines"),
    ("replaying",),
    ("blind",),
    ("plots",),
    ("report",),
    ("notebook",),
    ("cli",),
    ("__init__", "__main__"),
)
LEVEL = {room: level for level, row in enumerate(ROWS) for room in row}
BASE = set(ROWS[0])

# Rooms that may import fewer of ours than their place allows (the base always).
ONLY = {
    "arrays": set(),
    "errors": set(),
    "characters": set(),
    "stored_names": set(),  # any tree
    "chains": set(),  # any draws
    "files": set(),
    "resources": set(),
    "hypothesis": set(),
    "link_shapes": set(),
    "probabilities": set(),
    "rules": set(),
    "source_date": set(),
    "campaign": set(),  # maps any function over any cases
    "checkpoint": set(),  # any computation
    "progress": set(),  # any stage
    "robots": set(),  # any chain of rigid links
    "invariants": {"schemas", "diagnosis_rules"},  # any stored result
    "families": set(),  # densities, of whatever
    "inference": {"families", "analysis", "checkpoint"},  # any density; analysis has its settings
    "blind/engines": {"recording"},  # realities of another hand share no physics with us
}
ONLY_LIBRARIES = {
    "export": {"numpy", "scipy", "xarray"},
    "blind/engines": {"numpy", "scipy", "mujoco"},
}

# Libraries that belong to one room or two.
OWNERS = {
    "arviz": set(),  # for users; here arviz_base and arviz_stats
    "arviz_base": {"results", "inference"},
    "arviz_stats": {"results", "inference"},
    "control": {"margins"},
    "corner": {"plots"},
    "dask": {"campaign", "cli"},
    "distributed": {"campaign", "cli"},
    "emcee": {"inference"},
    "jinja2": {"report"},
    "IPython": {"progress"},
    "matplotlib": {"plots", "notebook"},  # the latter names its Figure in annotations
    "mujoco": {"blind/engines", "robots"},
    "rosbags": {"logs"},
    "typer": {"cli"},
    "typst": {"report"},
}
# Extras, and corner, which imports ArviZ where it is installed: imported where they are used.
INSIDE_FUNCTIONS = {"IPython", "control", "corner", "dask", "distributed", "mujoco", "rosbags"}

# Effects do not import each other; these files are what they have in common.
SHARED_BY_EFFECTS = {"__init__", "base", "candidates", "state", "terms"}


def broken_rules(package: Path) -> list[str]:
    """Return what is wrong with the imports of a package, a sentence each."""
    wrong = []
    between: dict[tuple[str, str], str] = {}
    for file in sorted(package.rglob("*.py")):
        room = room_of(file.relative_to(package).parts)
        if room not in LEVEL:
            wrong.append(f"{file.relative_to(package)}: belongs to no room")
            continue
        for imported in imports_of(package, file):
            place = f"{imported.file}:{imported.line}"
            library, *rest = imported.module.split(".")
            if library == "bayesfric":
                other = room_of(tuple(rest)) if rest else "__init__"
                # `from bayesfric import x`, where x is no room, is a public name of __init__.
                other = other if other in LEVEL else "__init__"
                wrong.extend(f"{place}: {fault}" for fault in _inside(imported, room, other, rest))
                if room != other:
                    between[room, other] = place
            elif library not in sys.stdlib_module_names:
                wrong.extend(f"{place}: {fault}" for fault in _outside(imported, room, library))
    for (room, other), place in between.items():
        if (other, room) in between and LEVEL[room] == LEVEL[other]:
            wrong.append(f"{place}: {room} and {other} import each other")
    return wrong


def _inside(imported: Import, room: str, other: str, rest: list[str]) -> list[str]:
    faults = []
    if room in LEVEL and LEVEL[other] > LEVEL[room]:
        faults.append(f"{room} imports {other}, which is below it")
    if room in ONLY and other not in ONLY[room] | BASE | {room}:
        faults.append(f"{room} imports {other}")
    if room == "__init__" and imported.at_once and other != "__init__":
        faults.append(f"__init__ imports {other} at once, and is to be lazy")
    if room == other == "effects":
        own, effect = imported.file.stem, rest[1] if len(rest) > 1 else "__init__"
        file = Path(bayesfric.__file__).parent / "effects" / f"{effect}.py"
        is_effect = effect not in SHARED_BY_EFFECTS and not effect.startswith("_")
        if own not in SHARED_BY_EFFECTS and is_effect and effect != own and file.exists():
            faults.append(f"effect {own} imports effect {effect}")
    return faults


def _outside(imported: Import, room: str, library: str) -> list[str]:
    faults = []
    if library in OWNERS and room not in OWNERS[library]:
        faults.append(f"{room} imports {library}")
    if library in INSIDE_FUNCTIONS and imported.at_once:
        faults.append(f"{library} is imported at once, and is to be imported inside a function")
    if room in ONLY_LIBRARIES and library not in ONLY_LIBRARIES[room]:
        faults.append(f"{room} imports {library}")
    return faults


def test_the_package_keeps_the_rules():
    assert broken_rules(ROOT / "bayesfric") == []


@pytest.mark.parametrize(
    ("file", "source", "fault"),
    [
        ("attic.py", "", "no room"),
        ("attic/x.py", "", "no room"),
        ("recording/x.py", "from bayesfric.inference.sampling import sample", "below it"),
        ("recording/x.py", "from bayesfric import inference", "below it"),
        ("recording/x.py", "from ..inference import sampling", "below it"),
        ("recording/x.py", "from .. import inference", "below it"),
        ("recording/x.py", "def f():\n    import bayesfric.cli.run", "below it"),
        ("diagnosis/x.py", "from bayesfric import fit", "below it"),
        ("diagnosis/x.py", "import bayesfric", "below it"),
        ("campaign.py", "from bayesfric.physics.friction import Law", "campaign imports physics"),
        (
            "inference/x.py",
            "from bayesfric.physics.friction import Law",
            "inference imports physics",
        ),
        ("export/x.py", "import pandas", "export imports pandas"),
        ("blind/engines/x.py", "from bayesfric.physics import a", "engines imports physics"),
        ("blind/engines/x.py", "import pandas", "engines imports pandas"),
        ("fitting/x.py", "import emcee", "fitting imports emcee"),
        ("results.py", "import arviz as az", "results imports arviz"),
        ("plots/x.py", "from corner import corner", "inside a function"),
        ("report/x.py", "def f():\n    from matplotlib import pyplot", "report imports matplotlib"),
        ("__init__.py", "from bayesfric.fitting.posterior import fit", "to be lazy"),
    ],
)
def test_a_broken_rule_is_noticed(tmp_path, file, source, fault):
    path = tmp_path / file
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(source)
    (wrong,) = broken_rules(tmp_path)
    assert fault in wrong


def test_two_rooms_of_a_row_importing_each_other_are_noticed(tmp_path):
    (tmp_path / "paper.py").write_text("from bayesfric import analysis")
    (tmp_path / "analysis.py").write_text("from bayesfric import paper")
    assert any("each other" in wrong for wrong in broken_rules(tmp_path))


@pytest.mark.parametrize(
    ("file", "source"),
    [
        ("fitting/x.py", "from bayesfric import inference, errors\nimport numpy, json"),
        ("recording/x.py", "from . import tables\nfrom .tables import Table"),
        ("plots/x.py", "def f():\n    import corner"),
        ("margins/x.py", "if TYPE_CHECKING:\n    import control"),
        ("__init__.py", "def __getattr__(name):\n    from bayesfric import fitting"),
    ],
)
def test_what_is_allowed_is_let_be(tmp_path, file, source):
    path = tmp_path / file
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(source)
    assert broken_rules(tmp_path) == []


def test_importing_the_package_loads_no_library():
    code = (
        "import sys; before = set(sys.modules); import bayesfric;"
        "new = {name.partition('.')[0] for name in set(sys.modules) - before};"
        "print(*sorted(new - sys.stdlib_module_names))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert done.stdout.split() == ["bayesfric"]


def test_describing_a_recording_loads_nothing_that_only_fits_and_figures_need():
    code = (
        "import sys; from bayesfric.rigs import all_rigs; from bayesfric.rigs.opening import *;"
        "from bayesfric.recording import read_recording; all_rigs();"
        "print(*{'scipy', 'xarray', 'matplotlib', 'arviz_stats', 'emcee'} & set(sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert done.stdout.split() == []


def test_no_public_name_is_the_name_of_a_room():
    assert not set(getattr(bayesfric, "__all__", ())) & set(LEVEL)
