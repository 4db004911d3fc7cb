"""Exit statuses, the same for every verb, and what is said on the way out.

0 done; 1 done, and something named in ``--fail-on`` happened; 2 bad input or usage;
3 interrupted; 70 a fault of our own.
"""

import traceback
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec

import typer

from bayesfric.errors import Fault, InputError

__all__ = ["FAILURES", "exit_status", "fail_on", "failures_of"]

P = ParamSpec("P")
SHOWN_FAULTS = 50
FAILURES = ("refuted", "unconverged", "gap", "undecided")
"""What ``--fail-on`` can name."""
VERDICT_FAILURES = {
    "named": {"gap"},
    "unseparated": {"gap"},
    "unknown": {"gap"},
    "undecided": {"undecided"},
    "no-gap": set[str](),
}


def exit_status(verb: Callable[P, None]) -> Callable[P, None]:
    """Turn what a verb raises into one clear message and an exit status."""

    @wraps(verb)
    def guarded(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            verb(*args, **kwargs)
        except InputError as error:
            for fault in error.faults[:SHOWN_FAULTS]:
                typer.echo(f"error: {fault}", err=True)
            if len(error.faults) > SHOWN_FAULTS:
                typer.echo(f"error: and {len(error.faults) - SHOWN_FAULTS} faults more", err=True)
            raise typer.Exit(2) from error
        except KeyboardInterrupt as error:
            typer.echo("interrupted", err=True)
            raise typer.Exit(3) from error
        except (typer.Exit, typer.Abort, typer.BadParameter, BrokenPipeError):
            raise
        except Exception as error:
            traceback.print_exc()
            typer.echo("error: this is a fault of bayesfric itself; please report it", err=True)
            raise typer.Exit(70) from error

    return guarded


def fail_on(names: str, happened: set[str]) -> None:
    """Exit with status 1 where something that the user named has happened.

    Parameters
    ----------
    names : str
        The value of ``--fail-on``: names of :data:`FAILURES`, separated by commas.
    happened : set of str
        Which of them came true.

    Raises
    ------
    InputError
        A name is unknown.
    """
    wanted = {name.strip() for name in names.split(",") if name.strip()}
    for name in sorted(wanted - set(FAILURES)):
        expected = f"one of {', '.join(FAILURES)}"
        raise InputError([Fault("command line", expected, column="--fail-on", value=name)])
    for name in sorted(wanted & happened):
        typer.echo(f"failed: {name}", err=True)
        raise typer.Exit(1)


def failures_of(verdict: str) -> set[str]:
    """Return which of :data:`FAILURES` a verdict of a diagnosis is."""
    return VERDICT_FAILURES[verdict]
