"""Which characters of a user's text are shown, and what stands for one that is not.

A name that a user chose may hold anything, so no character may act on the terminal, reorder
the words around it, stop a report or vanish from it: it is shown by its code, ``[U+202E]``.
"""

import re
import unicodedata

__all__ = ["code_of", "legible"]

_LINE_END = re.compile(r"\r\n|[\n\r]")
_BLANKS = re.compile(r"[\t\n\v\f\r\x85\u2028\u2029]+")


def legible(text: str, lines: bool = False) -> str:
    r"""Replace what cannot be seen: controls, marks of direction, halves of surrogate pairs.

    Parameters
    ----------
    text : str
    lines : bool
        Whether line ends (``\n``, ``\r`` or both) are kept; else they become blanks, as tabs do.

    Returns
    -------
    str
        Of characters that Unicode calls printable, and blanks of any width.
    """
    if lines:
        return "\n".join(legible(line.expandtabs(4)) for line in _LINE_END.split(text))
    if text.isprintable():
        return text
    return "".join(
        char if char.isprintable() or unicodedata.category(char) == "Zs" else code_of(char)
        for char in _BLANKS.sub(" ", text)
    )


def code_of(char: str) -> str:
    """Return what stands for a character: its number in Unicode."""
    return f"[U+{ord(char):04X}]"
