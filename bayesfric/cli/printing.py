"""What the verbs print, with nothing in it that a terminal would obey."""

import logging
import re
import shutil
import sys
import textwrap
from collections.abc import Sequence
from contextlib import suppress

import typer

from bayesfric.characters import legible
from bayesfric.progress import LOGGER

NARROWEST = 40  # columns of a terminal, below which wrapped words would be a column of scraps
_LABEL = re.compile(r"( *\S+(?: \S+)* {2,})\S|( *)")


def say(text: str, *, err: bool = False) -> None:
    """Print one line, on standard error if asked; a terminal gets it wrapped between words.

    Raises
    ------
    OSError
        Standard output cannot be written. Chatter that nobody can read is no fault.
    """
    with suppress(*((OSError,) if err else ())):
        line = legible(text)
        if (sys.stderr if err else sys.stdout).isatty():
            line = wrapped(line, shutil.get_terminal_size().columns)
        typer.echo(line, err=err)


def wrapped(line: str, columns: int) -> str:
    """Break a line between words, with what follows below its text and not below its label.

    Parameters
    ----------
    line : str
        A label may stand before two or more blanks.
    columns : int
        Of the terminal.
    """
    if len(line) <= columns or columns < NARROWEST:
        return line
    matched = _LABEL.match(line)
    label, blanks = matched.groups() if matched else (None, "")
    if " " not in line[len(label or "") :].strip():
        return line  # one word, such as a checksum
    hang = len(label) if label and len(label) <= columns // 2 else len(blanks or "") + 2
    return textwrap.fill(
        line, columns, subsequent_indent=" " * hang, break_long_words=False, break_on_hyphens=False
    )


def say_attention(lines: Sequence[str], *, quiet: bool) -> set[str]:
    """Print every check that failed, and return what ``--fail-on`` calls it."""
    for line in () if quiet else lines:
        say(f"attention: {line}", err=True)
    return {"attention"} if lines else set()


class _Said(logging.Handler):
    """Says what the package logs, on standard error."""

    def emit(self, record: logging.LogRecord) -> None:
        say(record.getMessage(), err=True)


def show_log() -> None:
    """Print the package's log; only the command line turns that on."""
    if not any(isinstance(handler, _Said) for handler in LOGGER.handlers):
        LOGGER.addHandler(_Said())
    LOGGER.setLevel(logging.INFO)
