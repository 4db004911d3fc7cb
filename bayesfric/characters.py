"""Which characters of a user's text are shown, and what stands for one that is not.

What a user wrote may hold anything, so no character may act on the terminal, reorder the words
around it, stop a report or vanish from it: it is shown by its code, ``[U+202E]``. A name by
which rows are told apart may hold none of these to begin with: two names that look alike would
be two trials.
"""

import re
import unicodedata

_LINE_END = re.compile(r"\r\n|[\n\r]")
_UNSEEN = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})  # controls, marks, halves, ends of lines
_FILLERS = frozenset("\u034f\u115f\u1160\u17b4\u17b5\u180b\u180c\u180d\u180f\u3164\uffa0")
"""Letters and marks that Unicode lets nobody see."""
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


def invisible_in(name: str) -> str:
    """Return which character of a name nobody sees, or acts, as the end of an error; else nothing.

    Parameters
    ----------
    name : str
        Printable text and blanks are what it may hold.
    """
    if name.isascii() and name.isprintable():
        return ""
    unseen = (c for c in name if c in _FILLERS or unicodedata.category(c) in _UNSEEN)
    return next((f"; {code_of(c)[1:-1]} cannot be" for c in unseen), "")
