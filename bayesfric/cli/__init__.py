"""The command ``bayesfric``: one thin verb a file over the public functions.

Until a verb begins there is nothing to clean up: an interrupt ends the process at once.
"""

import atexit
import os
import signal
import sys
from types import FrameType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bayesfric.cli.verbs import app as app  # for mypy; else by __getattr__

__all__ = ["app", "main"]

INTERRUPTED = 3


def main() -> None:
    """Run the command line; see :mod:`bayesfric.cli.exits` for the exit status."""
    _open_closed_streams()
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) is not signal.SIG_IGN:  # as for a job in the background
            signal.signal(number, _end)
            # Registered first, called last: all is written by then, and an interpreter that
            # shuts down would die of the signal as if nothing had been.
            atexit.register(signal.signal, number, signal.SIG_IGN)
    from bayesfric.cli.exits import unprinted
    from bayesfric.cli.verbs import app

    with unprinted():
        app()


def _open_closed_streams() -> None:
    """Let streams that the caller closed lead nowhere: else the next file would be one of them."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            stream = os.fdopen(os.open(os.devnull, os.O_RDWR), mode, encoding="utf-8")
            setattr(sys, name, stream)
            setattr(sys, f"__{name}__", stream)


def _end(number: int, frame: FrameType | None) -> None:
    os.write(2, b"interrupted\n")
    os._exit(INTERRUPTED)


def __getattr__(name: str) -> Any:
    if name != "app":
        raise AttributeError(f"module 'bayesfric.cli' has no attribute {name!r}")
    from bayesfric.cli.verbs import app

    return app
