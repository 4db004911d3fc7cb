"""The results of long campaigns, kept under ``reports/evidence/NAME.json``.

Each file says the commit of which it was made, and under ``code`` the rooms that its numbers
come from, with a hash of each: evidence that is older than its code is told.
``python -m campaigns.evidence``, with ``tests`` on the path, prints how old each file is.
"""

import ast
import hashlib
import json
import subprocess
import sys
from functools import cache
from pathlib import Path

from house.imports import imports_of

ROOT = Path(__file__).resolve().parents[2]
EVIDENCE = ROOT / "reports" / "evidence"
WORK = EVIDENCE / "cases"  # cases of a campaign under way; not tracked
PACKAGE = ROOT / "bayesfric"
COMMAND = "make test-long"
STORES_AND_SHOWS = {"campaign", "checkpoint", "errors", "plots", "resources", "results", "schemas"}
"""Rooms that pass numbers on, and make none."""
BESIDE = {"paper": "data/paper"}
"""Data that a room reads."""
DIGITS = 16  # of a SHA-256, in hexadecimal


def commit():
    """Return the commit that is checked out, marked where code differs from it."""
    head = _git("rev-parse", "--short=12", "HEAD")
    changed = _git("status", "--porcelain", "--", ".", ":!reports/evidence")
    return f"{head}-dirty" if head and changed else head or None


def _git(*arguments):
    found = subprocess.run(
        ["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False
    )
    return found.stdout.strip()


def code_of(campaign, root=ROOT):
    """Return the paths whose contents decide the numbers of a campaign.

    Parameters
    ----------
    campaign : Path
        The file that has its cases.
    root : Path
        Of the source tree.

    Returns
    -------
    list of str
        Relative to the root: the file itself, the helpers of tests that it imports, and
        every room of the package that it imports, directly or by another room, save those
        that make no number. A room counts whole, since rigs, effects and claims are found
        by being there; of the rigs those alone that the campaign names under ``RIGS``,
        where its recordings hold no other.
    """
    files = {campaign} | _helpers_imported(campaign, root)
    rooms, waiting = set(), set()
    for file in files:
        waiting |= _rooms_imported(file.parent, file, root)
    while waiting:
        room = waiting.pop()
        if room in rooms or room in STORES_AND_SHOWS:
            continue
        rooms.add(room)
        place = root / "bayesfric" / room
        for file in place.rglob("*.py") if place.is_dir() else [place.with_suffix(".py")]:
            waiting |= _rooms_imported(root / "bayesfric", file, root)
    folder = {room: (root / "bayesfric" / room).is_dir() for room in rooms}
    paths = {f"bayesfric/{room}" if folder[room] else f"bayesfric/{room}.py" for room in rooms}
    named = _rigs_of(campaign)
    if named and "bayesfric/rigs" in paths:
        paths.remove("bayesfric/rigs")
        shared = (root / "bayesfric" / "rigs").glob("*.py")
        paths |= {f"bayesfric/rigs/{rig}" for rig in named}
        paths |= {file.relative_to(root).as_posix() for file in shared}
    paths |= {BESIDE[room] for room in rooms & set(BESIDE)}
    return sorted(paths | {file.relative_to(root).as_posix() for file in files})


def _rigs_of(campaign):
    """Return what a campaign assigns to ``RIGS``, without importing it."""
    for line in ast.parse(campaign.read_text(encoding="utf-8")).body:
        if isinstance(line, ast.Assign) and getattr(line.targets[0], "id", "") == "RIGS":
            return ast.literal_eval(line.value)
    return ()


def _helpers_imported(file, root):
    modules = (found.module.split(".")[:2] for found in imports_of(file.parent, file))
    files = {(root / "tests").joinpath(*parts).with_suffix(".py") for parts in modules}
    return {one for one in files if one.is_file() and one.name != Path(__file__).name}


def _rooms_imported(base, file, root):
    modules = (found.module.split(".") for found in imports_of(base, file))
    rooms = {rest[0] for library, *rest in modules if library == "bayesfric" and rest}
    package = root / "bayesfric"
    return {one for one in rooms if (package / one).is_dir() or (package / f"{one}.py").is_file()}


@cache
def digest(path, root=ROOT):
    """Return a hash of a file, or of the names and contents of all files of a folder."""
    place = root / path
    files = sorted(place.rglob("*")) if place.is_dir() else [place]
    whole = hashlib.sha256()
    for file in files:
        if file.is_file() and "__pycache__" not in file.parts:
            contents = hashlib.sha256(file.read_bytes()).hexdigest()
            whole.update(f"{file.relative_to(root).as_posix()} {contents}\n".encode())
    return whole.hexdigest()[:DIGITS]


def work(name, campaign):
    """Return the folder of the cases of a campaign: those of other code are no cases of it."""
    code = "".join(digest(path) for path in code_of(Path(campaign.__file__)))
    return WORK / f"{name}-{hashlib.sha256(code.encode()).hexdigest()[:DIGITS]}"


def write(name, campaign, *, seeds, figures, cases, command=COMMAND):
    """Write the evidence of a campaign.

    Parameters
    ----------
    name : str
        Of its file.
    campaign : module
        The module that has its cases.
    seeds : list of int
        First and last.
    figures, cases : dict or list
        What was found, and in which cases; of plain JSON types.
    command : str
        That repeats it.
    """
    record = {
        "name": name,
        "commit": commit(),
        "code": {path: digest(path) for path in code_of(Path(campaign.__file__))},
        "command": command,
        "seeds": seeds,
        "figures": figures,
        "cases": cases,
    }
    text = json.dumps(record, indent=1, allow_nan=False) + "\n"
    (EVIDENCE / f"{name}.json").write_text(text, encoding="utf-8")


def read(name):
    """Return the evidence of a campaign."""
    path = EVIDENCE / f"{name}.json"
    assert path.is_file(), f"no evidence of {name}: `{COMMAND}` makes it"
    return json.loads(path.read_text(encoding="utf-8"))


def names():
    """Return the names of the campaigns that have evidence."""
    return sorted(path.stem for path in EVIDENCE.glob("*.json"))


def changed(record, root=ROOT):
    """Return the paths of a record's code whose contents are no longer those it was made of.

    A path that is gone has changed. A record that names no code was made before records
    did, and counts as changed in all of the package.
    """
    code = record.get("code")
    if not code:
        return ["bayesfric"]
    return [
        path
        for path, then in code.items()
        if not (root / path).exists() or digest(path, root) != then
    ]


def age(record):
    """Return in one line how old a record is, and whether its code has changed since."""
    made = (record["commit"] or "").removesuffix("-dirty")
    day = made and _git("log", "-1", "--format=%cs", made)
    since = made and _git("rev-list", "--count", f"{made}..HEAD")
    when = f"{record['commit'] or 'no commit'}" + (f", {day}, {since} commits ago" if since else "")
    stale = changed(record)
    return f"{when}; " + (f"older than {', '.join(stale)}" if stale else "of this code")


if __name__ == "__main__":
    sys.stdout.write(
        "How old the evidence of the campaigns is (told here, judged by the nightly job):\n"
    )
    for name in names():
        sys.stdout.write(f"{name:18} {age(read(name))}\n")
