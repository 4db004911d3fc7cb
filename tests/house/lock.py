"""The lock file, read: what is installed beside the package, and the hashes of its files."""

import re
from dataclasses import dataclass
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]
ELSEWHERE = {"colorama"}  # on Windows alone, where no pin is tested


@dataclass(frozen=True)
class Entry:
    """A package of the lock: its requirement, and the options after it."""

    requirement: Requirement
    options: tuple[str, ...]

    @property
    def version(self):
        (pin,) = self.requirement.specifier
        assert pin.operator == "==", self.requirement
        return pin.version


def entries():
    """Return every package of the lock, in its order."""
    text = (ROOT / "requirements.lock").read_text(encoding="utf-8")
    lines = text.replace("\\\n", " ").splitlines()
    pinned = []
    for line in lines:
        requirement, *options = re.split(r"\s+(?=--)", line.strip())
        pinned.append(Entry(Requirement(requirement), tuple(options)))
    return pinned


def pins():
    """Return the version of each package by its name, without those of other systems."""
    return {
        entry.requirement.name: entry.version
        for entry in entries()
        if entry.requirement.name not in ELSEWHERE
    }
