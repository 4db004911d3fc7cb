"""Spellings of units in names of columns and rows of units, with SI prefixes."""

import re
import unicodedata
from dataclasses import dataclass

from bayesfric.logs.units import SLIDING, SPEEDS, STRAIGHT, TORQUES

SPELLINGS = {
    "position": {
        "deg": "deg", "degree": "deg", "degrees": "deg", "°": "deg", "rad": "rad",
        "radian": "rad", "radians": "rad", "mrad": "mrad", "m": "m", "cm": "cm", "mm": "mm",
        "um": "um", "turn": "turn", "turns": "turn", "rev": "turn", "revs": "turn",
        "tick": "tick", "ticks": "tick", "counts": "tick",
    },
    "velocity": {
        "rpm": "rpm", "deg/s": "deg/s", "°/s": "deg/s", "rad/s": "rad/s", "turn/s": "turn/s",
        "rev/s": "turn/s", "m/s": "m/s", "mm/s": "mm/s",
    },
    "force": {
        "n·m": "N·m", "nm": "N·m", "mn·m": "mN·m", "mnm": "mN·m", "n·mm": "N·mm", "nmm": "N·mm",
        "n·cm": "N·cm", "ncm": "N·cm", "kn·m": "kN·m", "knm": "kN·m", "kgf·cm": "kgf·cm",
        "kgf·m": "kgf·m", "n": "N", "mn": "mN", "kn": "kN", "kgf": "kgf", "a": "A", "amp": "A",
        "amps": "A", "ma": "mA", "milliamps": "mA", "v": "V", "volt": "V", "volts": "V",
        "mv": "mV", "%": "%", "percent": "%", "pct": "%", "raw": "raw",
    },
    "temperature": {"degc": "degC", "°c": "degC", "celsius": "degC"},
    "time": {
        "s": "s", "sec": "s", "secs": "s", "seconds": "s", "ms": "ms", "msec": "ms",
        "millis": "ms", "us": "us", "usec": "us", "micros": "us", "ns": "ns", "nsec": "ns",
    },
}  # fmt: skip
"""Spellings of units, in lower case with · and / between parts, by kind of column."""
QUANTITIES = {
    "position": {"enc": "tick"},
    "force": {"current": "A", "iq": "A", "voltage": "V", "pwm": "share", "duty": "share"},
}
"""Words for quantities that imply a unit if none is written."""
PREFIXES = ("da", *"kmguncdhp")
"""SI prefixes; a unit with a prefix that no spelling has is unknown."""
TELLING = {*TORQUES, *STRAIGHT, "A", "mA", *SPEEDS, *SLIDING, "rad", "mrad", "deg"}
"""Units that determine the kind of a column."""
MOST_PARTS = 3  # most parts of a unit
BEFORE_CAPITAL = re.compile(r"(?<=[a-zµ])(?=[A-Z])")
AXES = re.compile(r"\bi ([qd])\b")
MULTIPLES = re.compile(r"[kmuµ](?=[A-Z])")


@dataclass(frozen=True)
class Spelled:
    """A unit as spelled in a text.

    Parameters
    ----------
    unit : str or None
        A key of :mod:`bayesfric.logs.units`; None if its prefix is unknown.
    text : str
        The unit as written.
    """

    unit: str | None
    text: str


def words_of(name: str) -> list[str]:
    """Return the words of a name, also of ``jointPos2`` and ``tau1``; units are never split.

    The currents of a motor's axes, ``i_q`` and ``i_d``, are one word each.
    """
    words: list[str] = []
    for run in re.findall(r"[^\W\d_]+|[°%]", unicodedata.normalize("NFKC", name)):
        run = run.replace("\u03bc", "u")
        whole = run.lower()
        is_unit = any(_spelled(kind, whole) for kind in SPELLINGS)
        words += [whole] if is_unit else [word.lower() for word in BEFORE_CAPITAL.split(run)]
    return AXES.sub(r"i\1", " ".join(words)).split()


def unit_of_text(kind: str, text: str) -> Spelled | None:
    """Return the unit if the whole text is a unit of this kind; else None."""
    words = words_of(text)
    if not words or len(words) > MOST_PARTS:
        return None
    spelled = _joined(kind, words)
    return None if spelled is None else Spelled(spelled.unit, text.strip())


def is_unit(text: str) -> bool:
    """Return whether a text is a unit of any kind, possibly with a prefix."""
    return any(unit_of_text(kind, text) is not None for kind in SPELLINGS)


def unit_in_name(kind: str, name: str) -> Spelled | None:
    """Return the unit in the name of a column; None if it has none.

    The unit is searched for in brackets, then at the end, then in earlier words; words of one
    letter come last.

    Parameters
    ----------
    kind : str
        A key of :data:`SPELLINGS`; other kinds have no unit.
    name : str
        Name in the log.
    """
    if kind not in SPELLINGS:
        return None
    if spelled := _marked(kind, name):
        return spelled
    words = words_of(name)
    quantities = QUANTITIES.get(kind, {})
    for place in range(len(words) - 1, 0, -1):
        spelled = _ends_with(kind, words[:place], "")
        if spelled is not None and len(spelled.text) > 1:
            return spelled
    word = next((word for word in reversed(words) if word in quantities), None)
    if word is not None:
        return Spelled(quantities[word], word)
    letter = next((word for word in reversed(words) if word in SPELLINGS[kind]), None)
    return None if letter is None else Spelled(SPELLINGS[kind][letter], letter)


def kind_of_unit(name: str) -> str | None:
    """Return the kind of the longest unit at the end of a name, or in brackets.

    A unit of one letter alone has no kind, nor has one of supplies and counters.
    """
    lengths: dict[str, int] = {}
    for kind in ("velocity", "force", "position"):
        spelled = _marked(kind, name)
        if spelled is not None and len(spelled.text) > 1 and spelled.unit in TELLING:
            lengths[kind] = len(words_of(spelled.text))
    return max(lengths, key=lambda kind: lengths[kind], default=None)


def _marked(kind: str, name: str) -> Spelled | None:
    """Return the unit in the last brackets with one, or at the end of a name."""
    for bracket in reversed(re.findall(r"[\[(]([^\])]*)[\])]", name)):
        if spelled := unit_of_text(kind, bracket):
            return spelled
    return _ends_with(kind, words_of(name), name)


def _ends_with(kind: str, words: list[str], name: str) -> Spelled | None:
    """Return the longest unit at the end of words, also one with an unknown prefix."""
    for parts in range(min(MOST_PARTS, len(words)), 0, -1):
        spelled = _joined(kind, words[-parts:])
        if spelled is not None:
            return Spelled(None, spelled.text) if _is_cut(name, words[-1]) else spelled
    return None


def _is_cut(name: str, last: str) -> bool:
    """Return whether a capital starts the last word, after a letter that may be its prefix."""
    return any(
        name[match.end() :].lower().startswith(last) and name[: match.start()][-1:].isalpha()
        for match in MULTIPLES.finditer(name)
    )


def _joined(kind: str, words: list[str]) -> Spelled | None:
    """Return the unit that words form together: parts of a product, or a length and a time."""
    bare = [word for word in words if word not in ("per", "p")]
    if len(bare) < len(words) and kind != "velocity":
        return None
    return _spelled(kind, ("/" if kind == "velocity" else "·").join(bare))


def _spelled(kind: str, text: str) -> Spelled | None:
    units = SPELLINGS[kind]
    if text in units:
        return Spelled(units[text], text)
    is_multiple = any(
        text.startswith(prefix) and text.removeprefix(prefix) in units for prefix in PREFIXES
    )
    return Spelled(None, text) if is_multiple and kind != "time" else None
