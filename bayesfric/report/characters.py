"""Which characters the fonts of the PDF have."""

import re
import unicodedata
from functools import cache
from importlib import resources

from bayesfric.characters import code_of, legible


def printable(text: str, lines: bool = False) -> str:
    """Replace what cannot be seen, and what the fonts of the PDF do not have, by its code.

    PDF/A allows no empty boxes, so a single such character would stop the report.
    """
    shown = unicodedata.normalize("NFC", legible(text, lines))
    return _unprintable().sub(lambda match: code_of(match[0]), shown)


@cache
def _unprintable() -> re.Pattern[str]:
    text = resources.files(__package__).joinpath("glyphs.txt").read_text(encoding="utf-8")
    # The file's hexadecimal ranges are ranges of a character class already.
    ranges = " ".join(line for line in text.splitlines() if not line.startswith("#")).split()
    glyphs = "".join("-".join(f"\\U{int(end, 16):08X}" for end in r.split("-")) for r in ranges)
    # A combining mark needs a font that has both the mark and the letter before it.
    return re.compile(f"[^\n{glyphs}\u0300-\u036f]|(?<![A-Za-zΑ-Ωα-ω])[\u0300-\u036f]")
