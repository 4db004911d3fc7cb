r"""Formulas as data: one source notation, a tree, and plain characters.

The notation is a small part of LaTeX. A letter is a variable and digits make a
number; Greek letters and signs are written as themselves (``θ``, ``·``, ``≤``,
``−``) or by name (``\theta``); ``_`` and ``^`` take one token or a ``{group}``;
and there are ``\frac{a}{b}``, ``\sqrt{a}``, ``\text{words}``, accents
(``\bar``, ``\hat``, ``\dot``, ``\ddot``, ``\tilde``), functions (``\log``, ``\sin``, …)
and brackets that grow with what they hold: ``(a)``, ``[a]``, ``|a|`` within a group.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

__all__ = [
    "Accent",
    "Bracket",
    "Formula",
    "Fraction",
    "Function",
    "Number",
    "Root",
    "Row",
    "Scripts",
    "Symbol",
    "Words",
    "parse",
    "to_plain",
]


@dataclass(frozen=True)
class Symbol:
    """A variable or an operator, one character."""

    character: str


@dataclass(frozen=True)
class Number:
    """Digits, with a decimal point or not."""

    digits: str


@dataclass(frozen=True)
class Words:
    """Upright words within a formula."""

    text: str


@dataclass(frozen=True)
class Function:
    """A named function such as log."""

    name: str


@dataclass(frozen=True)
class Row:
    """Terms side by side."""

    items: "tuple[Formula, ...]"


@dataclass(frozen=True)
class Bracket:
    """Terms within brackets that grow with them."""

    left: str
    body: "Formula"
    right: str


@dataclass(frozen=True)
class Fraction:
    """One formula over another."""

    above: "Formula"
    below: "Formula"


@dataclass(frozen=True)
class Root:
    """A square root."""

    body: "Formula"


@dataclass(frozen=True)
class Accent:
    """A formula with a mark over it, given as a combining character."""

    body: "Formula"
    mark: str


@dataclass(frozen=True)
class Scripts:
    """A formula with something at its foot, its head, or both."""

    base: "Formula"
    sub: "Formula | None"
    sup: "Formula | None"


Formula: TypeAlias = (
    Symbol | Number | Words | Function | Row | Bracket | Fraction | Root | Accent | Scripts
)

ACCENTS = {"bar": "\u0304", "hat": "\u0302", "dot": "\u0307", "ddot": "\u0308", "tilde": "\u0303"}
FUNCTIONS = frozenset({"log", "ln", "exp", "sin", "cos", "tan", "max", "min"})
BRACKETS = {"(": ")", "[": "]"}
NAMED = {
    **dict(zip(
        "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau "
        "phi chi psi omega Gamma Delta Theta Lambda Pi Sigma Phi Psi Omega".split(),
        "αβγδεζηθκλμνξπρστφχψωΓΔΘΛΠΣΦΨΩ",
        strict=True,
    )),
    "cdot": "·", "times": "×", "pm": "±", "le": "≤", "ge": "≥", "ne": "≠", "approx": "≈",
    "sim": "∼", "to": "→", "in": "∈", "infty": "∞", "partial": "∂", "sum": "∑", "int": "∫",
    "propto": "∝", "mid": "∣", "circ": "°",
}  # fmt: skip

_TOKEN = re.compile(r"\s+|\\[A-Za-z]+|\d+(?:\.\d+)?|.", re.DOTALL)


def parse(source: str) -> Formula:
    """Read a formula.

    Parameters
    ----------
    source : str
        In the notation of this module.

    Returns
    -------
    Formula

    Raises
    ------
    ValueError
        If a brace or bracket is left open, a command is unknown, or nothing is there.
    """
    reader = _Reader(source)
    body = reader.row(end=None)
    if body == Row(()):
        raise reader.error("a formula", "nothing")
    return body


class _Reader:
    def __init__(self, source: str) -> None:
        self.source = source
        self.tokens = _TOKEN.findall(source)
        self.place = 0

    def error(self, expected: str, found: str) -> ValueError:
        return ValueError(f"formula {self.source!r}: expected {expected}, found {found}")

    def next(self, expected: str) -> str:
        token = self.peek()
        if token == "":
            raise self.error(expected, "the end")
        self.place += 1
        return token

    def peek(self) -> str:
        while self.place < len(self.tokens) and self.tokens[self.place].isspace():
            self.place += 1
        return self.tokens[self.place] if self.place < len(self.tokens) else ""

    def row(self, end: str | None) -> Formula:
        items: list[Formula] = []
        while (token := self.peek()) != (end or ""):
            if token == "":
                raise self.error(repr(end), "the end")
            items.append(self.scripts())
        if end is not None:
            self.next(end)
        return items[0] if len(items) == 1 else Row(tuple(items))

    def scripts(self) -> Formula:
        base = self.atom()
        found: dict[str, Formula] = {}
        while (token := self.peek()) in ("_", "^"):
            if token in found:
                raise self.error(f"one {token} at a place", "two")
            self.next(token)
            found[token] = self.atom()
        return Scripts(base, found.get("_"), found.get("^")) if found else base

    def atom(self) -> Formula:
        token = self.next("a term")
        if token == "{":
            return self.row(end="}")
        if token in BRACKETS:
            return Bracket(token, self.row(end=BRACKETS[token]), BRACKETS[token])
        if token == "|":
            return Bracket(token, self.row(end="|"), "|")
        if token in "}])_^&$#%~`":
            raise self.error("a term", repr(token))
        if token[0] == "\\":
            return self.command(token[1:])
        if token[0].isascii() and token[0].isdigit():
            return Number(token)
        return Symbol("−" if token == "-" else "∗" if token == "*" else token)

    def command(self, name: str) -> Formula:
        if name in NAMED:
            return Symbol(NAMED[name])
        if name in FUNCTIONS:
            return Function(name)
        if name in ACCENTS:
            return Accent(self.group(), ACCENTS[name])
        if name == "frac":
            return Fraction(self.group(), self.group())
        if name == "sqrt":
            return Root(self.group())
        if name == "text":
            return Words(self.words())
        raise self.error("a known command", "\\" + name)

    def group(self) -> Formula:
        self.brace()
        return self.row(end="}")

    def words(self) -> str:
        # Blanks count here, so the tokens are taken as they stand.
        self.brace()
        start = self.place
        while self.next("'}'") != "}":
            pass
        return "".join(self.tokens[start : self.place - 1])

    def brace(self) -> None:
        token = self.next("'{'")
        if token != "{":
            raise self.error("'{'", repr(token))


_RELATIONS = frozenset("=≤≥≠≈∼→∈∝<>+−±·×")


def to_plain(formula: Formula) -> str:
    """Write a formula in plain characters, for speech and for plain text.

    Returns
    -------
    str
        For example ``f_c = n_p (c_1 T + c_2)``.
    """
    return "".join(_plain(formula)).strip()


def _plain(formula: Formula) -> Iterator[str]:
    match formula:
        case Symbol(character):
            yield f" {character} " if character in _RELATIONS else character
        case Number(text) | Words(text):
            yield text
        case Function(name):
            yield f"{name} "
        case Row(items):
            for item in items:
                yield from _plain(item)
        case Bracket(left, body, right):
            yield from (left, to_plain(body), right)
        case Fraction(above, below):
            yield f"{_grouped(above)}/{_grouped(below)}"
        case Root(body):
            yield f"√{_grouped(body)}"
        case Accent(body, mark):
            yield to_plain(body) + mark
        case Scripts(base, sub, sup):
            yield from _plain(base)
            if sub is not None:
                yield f"_{_grouped(sub)}"
            if sup is not None:
                yield f"^{_grouped(sup)}"


def _grouped(formula: Formula) -> str:
    text = to_plain(formula)
    return f"({text})" if isinstance(formula, Row) and len(text) > 1 else text
