"""Exit statuses, the same for every verb, and what is said on the way out.

0 done; 1 done, and something named in ``--fail-on`` happened; 2 bad input or usage, or a
place that cannot be read or written; 3 interrupted; 70 a fault of our own.
"""

import os
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from itertools import chain
from types import FrameType
from typing import ParamSpec

import typer

from bayesfric.cli.printing import say
from bayesfric.cli.surroundings import prepare
from bayesfric.errors import Fault, InputError, one_of
from bayesfric.files import handling

P = ParamSpec("P")
SHOWN_FAULTS = 50
CAN_HAPPEN = {
    "run": ("refuted", "unconverged", "attention", "gap", "undecided", "spec"),
    "simulate": (),
    "fit": ("unconverged", "attention"),
    "claims": ("refuted", "attention"),
    "diagnose": ("attention", "gap", "undecided"),
    "blind": ("gap", "undecided"),
    "calibrate": ("uncalibrated", "attention"),
    "margins": ("attention", "spec"),
    "compare": ("changed",),
    "rerun": ("changed",),
}
"""What can happen in each verb that ``--fail-on`` can name."""
FAILURES = tuple(dict.fromkeys(chain.from_iterable(CAN_HAPPEN.values())))
"""What ``--fail-on`` can name in any verb."""
VERDICT_FAILURES = {
    "named": {"gap"},
    "unseparated": {"gap"},
    "unknown": {"gap"},
    "undecided": {"undecided"},
    "no-gap": set[str](),
}
"""Which of :data:`FAILURES` each verdict of a diagnosis is."""


def exit_status(verb: Callable[P, set[str] | None]) -> Callable[P, None]:
    """Turn what a verb raises, and what happened in it, into messages and an exit status.

    A verb returns which failures happened; where it takes ``--fail-on``, as `fail_on_list`,
    those that are named there end it with status 1.
    """

    @wraps(verb)
    def guarded(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            with handling(_interrupt):  # so that a verb cleans up
                prepare()
                names = str(kwargs.get("fail_on_list", ""))
                if names:
                    check_fail_on(names, verb.__name__)
                fail_on(names, verb(*args, **kwargs) or set())
        except InputError as error:
            for fault in error.faults[:SHOWN_FAULTS]:
                say(f"error: {fault}", err=True)
            if len(error.faults) > SHOWN_FAULTS:
                say(f"error: and {len(error.faults) - SHOWN_FAULTS:,} more faults", err=True)
            raise typer.Exit(2) from error
        except KeyboardInterrupt as error:
            say("interrupted", err=True)
            raise typer.Exit(3) from error
        except (typer.Exit, typer.Abort, typer.BadParameter, BrokenPipeError):
            raise
        except OSError as error:
            _cannot(error)
            raise typer.Exit(2) from error
        except Exception as error:
            for line in traceback.format_exc().splitlines():
                say(line, err=True)
            say("error: this is a bug in bayesfric; please report it", err=True)
            raise typer.Exit(70) from error

    return guarded


@contextmanager
def unprinted() -> Iterator[None]:
    """End with status 2 where what is to be printed cannot be, as on a full disk."""
    try:
        yield
    except OSError as error:
        _cannot(error)
        sys.exit(2)
    finally:
        try:
            sys.stdout.flush()
        except OSError:
            _forget_what_is_unprinted()


def _cannot(error: OSError) -> None:
    place = error.filename if isinstance(error.filename, str) else "standard output"
    expected = f"a place that can be read and written ({error.strerror or error})"
    say(f"error: {Fault(place, expected)}", err=True)


def _forget_what_is_unprinted() -> None:
    """Send what is left in the buffer nowhere, or Python would complain on its way out."""
    standard = sys.__stdout__
    if standard is not None and sys.stdout is standard:
        os.dup2(os.open(os.devnull, os.O_WRONLY), standard.fileno())


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt


def check_fail_on(names: str, verb: str) -> None:
    """Refuse unknown names before the work, and tell those that this verb never has.

    Parameters
    ----------
    names : str
        The value of ``--fail-on``: names of :data:`FAILURES`, separated by commas.
    verb : str
        A key of :data:`CAN_HAPPEN`.

    Raises
    ------
    InputError
        A name is unknown.
    """
    given = sorted(_names_of(names))
    faults = [
        Fault("command line", one_of(FAILURES, name), column="--fail-on", value=name)
        for name in given
        if name not in FAILURES
    ]
    if faults:
        raise InputError(faults)
    can_happen = ", ".join(CAN_HAPPEN[verb]) or "none of them"
    for name in given:
        if name not in CAN_HAPPEN[verb]:
            note = f"--fail-on {name} never happens in `{verb}`, which can report: {can_happen}"
            say(f"note: {note}", err=True)


def fail_on(names: str, happened: set[str]) -> None:
    """Exit with status 1 where something that the user named has happened; all of it is told.

    Parameters
    ----------
    names : str
        The value of ``--fail-on``, as checked.
    happened : set of str
        Which of :data:`FAILURES` came true.
    """
    named = _names_of(names)
    failed = [name for name in FAILURES if name in named and name in happened]
    for name in failed:
        say(f"failed: {name}", err=True)
    if failed:
        raise typer.Exit(1)


def _names_of(names: str) -> set[str]:
    return {name.strip() for name in names.split(",") if name.strip()}
