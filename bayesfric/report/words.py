"""What stands within a line: words, plain or marked, symbols, links and references."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

from bayesfric.report.formulas import FORMULAS

SENTENCE_END = re.compile(r"(?<=[.]) (?=[A-Z0-9])")


@dataclass(frozen=True)
class Emphasis:
    """Words set in italics."""

    text: str


@dataclass(frozen=True)
class Strong:
    """Words set in bold."""

    text: str


@dataclass(frozen=True)
class Code:
    """A file name, a command or an identifier, set in a typewriter face."""

    text: str


@dataclass(frozen=True)
class Math:
    """A symbol within a line.

    Parameters
    ----------
    source : str
        Its TeX, one of `bayesfric.report.formulas.FORMULAS`: ``"c_1"``.

    Raises
    ------
    ValueError
        If it is not one of these.
    """

    source: str

    def __post_init__(self) -> None:
        require_formula(self.source)


@dataclass(frozen=True)
class Reference:
    """The number of a labelled heading, figure, table or equation: "Figure 3"."""

    label: str


Inline: TypeAlias = str | Emphasis | Strong | Code | Math | Reference
Text: TypeAlias = Inline | Sequence[Inline]


def inlines(text: Text) -> tuple[Inline, ...]:
    """Return a text as a sequence of inlines; a single inline becomes a sequence of one.

    Stored sentences are written for a terminal, with 12%, 1.6e-05 or c2[small]. A report shows
    12 %, 1.6 × 10⁻⁵ and c₂ (small) instead.
    """
    if isinstance(text, str) or not isinstance(text, Sequence):
        return (_set(text),)
    return tuple(_set(inline) for inline in text)


_PERCENT = re.compile(r"(?<=\d)[ \u00a0]?%")
_BOUND = re.compile(r"([<>≤≥]) (?=[\d−-])")  # its number stays on its line
_GAIN = re.compile(r"γ = (?=\d)")  # a symbol and its value stay on one line
_POWER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([+-])0*(\d+)(?![\w.]*\w)")
_COEFFICIENT = re.compile(r"(?<![\w./-])c([123])(?:\[(\w+)\])?(?![\w\[])")
_LOWERED = str.maketrans("123", "₁₂₃")
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def _set(inline: Inline) -> Inline:
    """Set per cent, bounds and powers of ten; never in code."""
    if isinstance(inline, Emphasis | Strong):
        return replace(inline, text=_typeset(inline.text))
    return _typeset(inline) if isinstance(inline, str) else inline


def _typeset(words: str) -> str:
    words = _PERCENT.sub("\u202f%", words)
    words = _BOUND.sub("\\1\u00a0", words)
    words = _GAIN.sub("γ\u00a0=\u00a0", words)
    words = _POWER.sub(
        lambda match: f"{match[1]} × 10{(match[2].strip('+') + match[3]).translate(RAISED)}",
        words,
    )
    words = _COEFFICIENT.sub(_coefficient, words)
    return words.replace("ω_n", "ωₙ")


def _coefficient(match: re.Match[str]) -> str:
    whose = f" ({match[2]})" if match[2] else ""
    return f"c{match[1].translate(_LOWERED)}{whose}"


_MARKS = re.compile(r"\$(.+?)\$|`(.+?)`|@([\w-]+)|\*\*(.+?)\*\*|(\{\})")


def prose(written: str, *fields: Inline) -> list[Inline]:
    """Return words of the report's own, which alone are read for marks.

    Parameters
    ----------
    written : str
        A literal: ``$c_1$`` is a symbol, `` `fit.json` `` code, ``@gap`` a reference, ``**so**``
        bold, and ``{}`` the next of the fields.
    *fields : inline
        Whatever comes from a result or a user; no mark in it is read.
    """
    parts: list[Inline] = []
    left, end = iter(fields), 0
    for match in _MARKS.finditer(written):
        kind = match.lastindex or 0
        inline = next(left) if kind == 5 else (Math, Code, Reference, Strong)[kind - 1](match[kind])
        parts += [written[end : match.start()], inline]
        end = match.end()
    parts.append(written[end:])
    require(next(left, None) is None, f"{written!r}: more fields than places for them")
    return [part for part in parts if part != ""]


def with_code(meaning: str) -> list[Inline]:
    """Return a meaning that the package has of a parameter, whose names in backticks are code."""
    pieces = enumerate(meaning.split("`"))
    return [Code(piece) if place % 2 else piece for place, piece in pieces if piece]


def sentences(text: str) -> list[str]:
    """Return the sentences of what a result says, each of which ends in a full stop."""
    return SENTENCE_END.split(text)


def require(condition: bool, message: str) -> None:
    """Raise a ValueError with this message unless the condition holds."""
    if not condition:
        raise ValueError(message)


def require_formula(source: str) -> None:
    """Raise a ValueError unless a formula is one that every form of the report can show."""
    require(source in FORMULAS, f"formula: expected one of {list(FORMULAS)}, got {source!r}")


def require_text(text: Text, place: str) -> None:
    """Raise a ValueError if a text is empty."""
    require(text != "" and text != () and text != [], f"{place}: expected a text, got none")


def codes(names: Sequence[str]) -> list[Code | str]:
    """Return names with "and" between."""
    parts: list[Code | str] = []
    for place, name in enumerate(names):
        if place:
            parts.append(" and " if place == len(names) - 1 else ", ")
        parts.append(Code(name))
    return parts
