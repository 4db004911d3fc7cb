"""Progress of a stage: a bar where a person looks on, two lines in a log elsewhere.

A terminal and a notebook have a bar. Elsewhere, as in the log of a CI job, the logger
``bayesfric`` is told at the level INFO when a stage begins, about how long a long one still
takes, and when it is done.
"""

import logging
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic

from bayesfric.characters import legible

LOGGER = logging.getLogger("bayesfric")
PATIENCE_S = 5.0  # until steps that are done say how long the rest takes
SHARE_BEFORE_ESTIMATE = 0.1  # of all steps


@contextmanager
def stage(
    title: str, *, quiet: bool = False, longest_first: bool = False
) -> Iterator[Callable[[int, int], None]]:
    """Show the progress of a stage that may take over a second.

    Parameters
    ----------
    title : str
        What is being done.
    quiet : bool
        Tell nothing.
    longest_first : bool
        Whether the longest steps come first, so that what is left takes less than its share:
        of the time to go, no more than a bound is told.

    Yields
    ------
    callable
        To be called with the steps done and the steps in all. Before the first call, a bar
        shows that something is done, and not how much.
    """
    from rich.console import Console

    console = Console(stderr=True)
    if quiet:
        yield lambda done, total: None
    elif console.is_jupyter:
        yield _in_notebook(title)
    elif sys.stderr.isatty() and not console.is_dumb_terminal:  # whatever FORCE_COLOR says
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn
        from rich.progress import TimeElapsedColumn as Elapsed
        from rich.progress import TimeRemainingColumn as Remaining

        name = TextColumn("{task.description}", markup=False)
        time = Elapsed() if longest_first else Remaining()
        columns = (name, BarColumn(), TaskProgressColumn(), time)
        with Progress(*columns, console=console) as bar:
            task = bar.add_task(legible(title), total=None)
            yield lambda done, total: bar.update(task, completed=done, total=total)
    else:
        LOGGER.info("%s: started", title)
        yield _in_log(title, "less than" if longest_first else "about")
        LOGGER.info("%s: done", title)


def _in_log(title: str, roughly: str) -> Callable[[int, int], None]:
    """Return a callback that logs once how long a stage will still take."""
    began, announced = monotonic(), False

    def tell(done: int, total: int) -> None:
        nonlocal announced
        passed = monotonic() - began
        left = passed * (total - done) / done if done else 0.0
        if (
            not announced
            and done >= SHARE_BEFORE_ESTIMATE * total
            and passed > PATIENCE_S
            and left > PATIENCE_S
        ):
            time = f"{left / 60:.0f} min" if left > 90.0 else f"{max(left, 10.0):.0f} s"
            LOGGER.info("%s: %s %s to go", title, roughly, time)
            announced = True

    return tell


def _in_notebook(title: str) -> Callable[[int, int], None]:
    """Show a line below the cell, and return a callback that updates it."""
    from IPython.display import display

    def line(state: str) -> dict[str, str]:
        return {"text/plain": f"{legible(title)}: {state}"}

    shown = display(line("started"), raw=True, display_id=True)
    return lambda done, total: shown.update(line(f"{done / total:.0%}"), raw=True)
