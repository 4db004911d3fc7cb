"""What the verbs print, with nothing in it that a terminal would obey."""

from contextlib import suppress

import typer

__all__ = ["escaped", "say"]


def escaped(text: str) -> str:
    r"""Return text with every character that is not printed written out, as in ``\x1b``.

    These are control characters, marks that turn the direction of writing, line
    separators and lone surrogates; line feeds are kept.
    """
    return "".join(
        char if char.isprintable() or char in "\n\u00a0" else char.encode("unicode_escape").decode()
        for char in text
    )


def say(text: str, *, err: bool = False) -> None:
    """Print a line, on standard error if asked.

    Raises
    ------
    OSError
        Standard output cannot be written. Chatter that nobody can read is no fault.
    """
    with suppress(*((OSError,) if err else ())):
        typer.echo(escaped(text), err=err)
