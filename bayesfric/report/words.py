"""What stands within a line: words, plain or marked, symbols, links and references."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from bayesfric.report import formula

__all__ = [
    "Code",
    "Emphasis",
    "Inline",
    "Link",
    "Math",
    "Reference",
    "Strong",
    "Text",
    "inlines",
    "require",
    "require_text",
]


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
    """A symbol or a short formula within a line.

    Parameters
    ----------
    source : str
        The notation of `bayesfric.report.formula`, a small part of LaTeX:
        ``"c_1"``, ``"f_c = n_p c_2"``.
    alt : str, optional
        What is read aloud; the formula in plain characters if left out.

    Raises
    ------
    ValueError
        If the source is not of that notation.
    """

    source: str
    alt: str = ""

    def __post_init__(self) -> None:
        plain = formula.to_plain(formula.parse(self.source))
        if not self.alt:
            object.__setattr__(self, "alt", plain)


@dataclass(frozen=True)
class Link:
    """Words that lead to a web address (http, https, doi or mailto)."""

    text: str
    url: str

    def __post_init__(self) -> None:
        require(
            self.url.startswith(("https://", "http://", "mailto:")),
            f"link: expected a web address, got {self.url!r}",
        )
        require_text(self.text, "link")


@dataclass(frozen=True)
class Reference:
    """The number of a labelled heading, figure, table or equation: "Figure 3"."""

    label: str


Inline: TypeAlias = str | Emphasis | Strong | Code | Math | Link | Reference
Text: TypeAlias = Inline | Sequence[Inline]


def inlines(text: Text) -> tuple[Inline, ...]:
    """Return a text as a sequence of inlines, whichever way it was written."""
    if isinstance(text, str) or not isinstance(text, Sequence):
        return (text,)
    return tuple(text)


def require(condition: bool, message: str) -> None:
    """Raise a ValueError with this message unless the condition holds."""
    if not condition:
        raise ValueError(message)


def require_text(text: Text, place: str) -> None:
    """Raise a ValueError if a text is empty."""
    require(text != "" and text != () and text != [], f"{place}: expected a text, got none")
