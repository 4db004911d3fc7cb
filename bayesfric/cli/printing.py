"""What the verbs print, with nothing in it that a terminal would obey."""

from contextlib import suppress

import typer

from bayesfric.characters import legible

__all__ = ["say"]


def say(text: str, *, err: bool = False) -> None:
    """Print one line, on standard error if asked.

    Raises
    ------
    OSError
        Standard output cannot be written. Chatter that nobody can read is no fault.
    """
    with suppress(*((OSError,) if err else ())):
        typer.echo(legible(text), err=err)
