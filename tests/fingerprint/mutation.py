"""``make fingerprint-mutation``: does the fingerprint alone notice formulas that are altered?

Each of :mod:`fingerprint.altered_formulas` is put into a copy of the package, and the
fingerprint is computed up to the first number that moves. Where fewer than 95 % are noticed the
exit status is 1. Names of files or rooms on the command line choose some.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

from fingerprint.altered_formulas import altered_formulas
from fingerprint.copies import altered, copied, restored, run
from fingerprint.parts import PARTS

LEAST = 0.95
SOON = {
    "evidence": ("evidence", "claims"),
    "diagnosis": ("diagnosis", "whole"),
    "margins": ("margins",),
    "simulators": ("simulators",),
}
SECONDS = 900.0  # a loop that no longer ends is noticed too


def main(chosen: list[str]) -> int:
    """Print each altered formula with what noticed it."""
    noticed = tried = 0
    with tempfile.TemporaryDirectory() as name:
        folder = copied(Path(name))
        if by := _noticed(folder, ""):
            raise SystemExit(f"the fingerprint does not hold where nothing is altered: {by}")
        for room, file, old, new, place in altered_formulas():
            if chosen and room not in chosen and file not in chosen:
                continue
            altered(folder, file, old, new, place)
            by = _noticed(folder, room)
            restored(folder, file)
            tried, noticed = tried + 1, noticed + bool(by)
            sys.stdout.write(f"{by or 'SURVIVED':24} {file}: {old}  →  {new}\n")
            sys.stdout.flush()
    sys.stdout.write(f"noticed: {noticed} of {tried}\n")
    return 0 if noticed >= LEAST * tried else 1


def _noticed(folder: Path, room: str) -> str:
    """Return what noticed: the part whose number moved, ``fault`` or ``endless``; else nothing."""
    try:
        told = run(folder, "--first", *_ordered(room), seconds=SECONDS)
    except subprocess.TimeoutExpired:
        return "endless"
    if told.returncode == 0:
        return ""
    last = (told.stdout.strip().splitlines() or [""])[-1]
    return last.removeprefix("moved: ") if last.startswith("moved: ") else "fault"


def _ordered(room: str) -> list[str]:
    """Return all parts, those first that a room's formulas are likely to move."""
    soon = [part for part in PARTS if part.split(".")[0] in SOON.get(room, ())]
    return [*soon, *(part for part in PARTS if part not in soon)]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
