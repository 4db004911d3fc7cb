"""Formulas and what they are altered to, by room, in ``altered_formulas.txt``.

A line is a file of the package, a text that it holds and another text; ``file#1`` means the second
place where the text stands. They were chosen by reading the files, without looking at what the
fingerprint holds: each is a slip of a sign, a factor, an exponent or a term that a rewrite could
make.
"""

from pathlib import Path
from typing import NamedTuple

__all__ = ["Altered", "altered_formulas"]

LIST = Path(__file__).with_suffix(".txt")


class Altered(NamedTuple):
    """One altered formula: its room, file, text, other text, and which place of the text."""

    room: str
    file: str
    old: str
    new: str
    place: int


def altered_formulas() -> list[Altered]:
    """Return all altered formulas."""
    formulas, room = [], ""
    for line in LIST.read_text(encoding="utf-8").splitlines():
        if line.startswith("["):
            room = line.strip("[]")
        elif line:
            where, old, new = line.split(" | ")
            file, _, place = where.partition("#")
            formulas.append(Altered(room, file, old, new, int(place or 0)))
    return formulas
