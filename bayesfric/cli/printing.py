"""What the verbs print, with nothing in it that a terminal would obey."""

import logging
from collections.abc import Sequence
from contextlib import suppress

import typer

from bayesfric.characters import legible
from bayesfric.progress import LOGGER


def say(text: str, *, err: bool = False) -> None:
    """Print one line, on standard error if asked.

    Raises
    ------
    OSError
        Standard output cannot be written. Chatter that nobody can read is no fault.
    """
    with suppress(*((OSError,) if err else ())):
        typer.echo(legible(text), err=err)


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
