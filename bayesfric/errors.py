"""The one kind of error that means "your input is wrong".

Every reader (recordings, ``analysis.toml``) collects all the faults it can see
and raises them together, so that a user mends a file in one go.
"""

from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

LONGEST_VALUE = 120  # characters of a value


@dataclass(frozen=True)
class Fault:
    """One fault of an input file.

    Parameters
    ----------
    file : str
        File name, relative to what the user named.
    expected : str
        What was expected there, as a sentence fragment.
    row : int or None
        Line of the file, the header being line 1; None where no line applies.
    column : str or None
        Column of a table, or dotted key of a JSON or TOML file.
    value : str or None
        The value found, as written; None where something is missing.
    like : int
        Further faults like it, which are not listed.
    """

    file: str
    expected: str
    row: int | None = None
    column: str | None = None
    value: str | None = None
    like: int = 0

    def __str__(self) -> str:
        place = self.file
        if self.row is not None:
            place += f", row {self.row}"
        if self.column is not None:
            place += f", {self.column}"
        value = "" if self.value is None else f" found {_short(self.value)!r},"
        more = f"; and {self.like:,} like it" if self.like else ""
        return f"{place}:{value} expected {self.expected}{more}"


def _short(value: str) -> str:
    return value if len(value) <= LONGEST_VALUE else value[:LONGEST_VALUE] + "…"


class InputError(ValueError):
    """Input that cannot be used, with every fault that was found.

    Parameters
    ----------
    faults : sequence of Fault
        At least one.
    """

    def __init__(self, faults: list[Fault] | tuple[Fault, ...]) -> None:
        self.faults = tuple(faults)
        super().__init__("\n".join(str(fault) for fault in self.faults))

    def __reduce__(self) -> tuple[type["InputError"], tuple[tuple[Fault, ...]]]:
        """Travel between processes with the faults, not with their text."""
        return InputError, (self.faults,)


def near(name: str, among: Iterable[str]) -> str:
    """Return the question whether one of these names, which is nearly `name`, is meant."""
    small = {other.casefold(): other for other in among if other}
    matches = get_close_matches(name.casefold(), small, n=1, cutoff=0.75)
    return f"; is {small[matches[0]]!r} meant?" if matches else ""


def one_of(names: Collection[str], value: str) -> str:
    """Return what is expected where one of these names was, and which of them may be meant."""
    return f"one of {', '.join(names)}{near(value, names)}"


def first_of(names: Collection[str], most: int) -> str:
    """Return the first names of many, and how many more there are."""
    more = len(names) - most
    return ", ".join(list(names)[:most]) + (f" and {more:,} more" if more > 0 else "")


@contextmanager
def writable(folder: Path | str) -> Iterator[None]:
    """Raise an InputError where something cannot be written into a folder."""
    try:
        yield
    except OSError as error:
        expected = f"a folder that can be written ({error.strerror or error})"
        raise InputError([Fault(str(folder), expected)]) from error


@contextmanager
def needs_extra(
    extra: str, installation: str, place: str, column: str | None = None, value: str | None = None
) -> Iterator[None]:
    """Raise an InputError that says what to install where a library of an extra is absent."""
    try:
        yield
    except ImportError as error:
        expected = f'{installation}: pip install ".[{extra}]" in a clone'
        raise InputError([Fault(place, expected, column=column, value=value)]) from error
