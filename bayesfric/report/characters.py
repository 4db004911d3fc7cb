"""Which characters a page can hold, and what stands for one that it cannot.

A report shows names that its users chose, so no character may stop it or vanish
from it: what cannot be set is shown by its code, ``[U+5C0F]``.
"""

import re
import unicodedata
from functools import cache
from importlib import resources

__all__ = ["legible", "printable"]

# Controls, halves of surrogate pairs, non-characters, the byte order mark, and the
# controls of writing direction, which could reorder the words around them.
_ILLEGIBLE = re.compile(
    "[\x00-\x1f\x7f-\x9f\ud800-\udfff\ufdd0-\ufdef\ufffe\uffff\ufeff\u202a-\u202e\u2066-\u2069]"
)
_LINE_ENDS = re.compile(r"[\t\n\v\f\r\x85\u2028\u2029]+")


def legible(text: str, lines: bool = False) -> str:
    """Replace what no page can hold.

    Parameters
    ----------
    text : str
    lines : bool
        Whether line ends are kept, as in a listing; else they become blanks.

    Returns
    -------
    str
    """
    if lines:
        return "\n".join(legible(line.expandtabs(4)) for line in text.splitlines())
    return _ILLEGIBLE.sub(_code, _LINE_ENDS.sub(" ", text))


def printable(text: str, lines: bool = False) -> str:
    """Replace, beside that, what the fonts of the PDF do not have.

    PDF/A allows no empty boxes, so a single such character would stop the report.
    """
    return _unprintable().sub(_code, unicodedata.normalize("NFC", legible(text, lines)))


def _code(found: re.Match[str]) -> str:
    return f"[U+{ord(found[0]):04X}]"


@cache
def _unprintable() -> re.Pattern[str]:
    text = resources.files(__package__).joinpath("glyphs.txt").read_text(encoding="utf-8")
    # The file's hexadecimal ranges are ranges of a character class already.
    ranges = " ".join(line for line in text.splitlines() if not line.startswith("#")).split()
    known = "".join("-".join(f"\\U{int(end, 16):08X}" for end in r.split("-")) for r in ranges)
    # A combining mark needs a font that has both the mark and the letter before it.
    return re.compile(f"[^\n{known}\u0300-\u036f]|(?<![A-Za-zΑ-Ωα-ω])[\u0300-\u036f]")
