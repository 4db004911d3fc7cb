"""Map a function over many cases, each saved when it is done.

A killed campaign goes on where it stopped. Knows nothing of friction. Works on any
:class:`concurrent.futures.Executor`: processes on one machine, or a cluster's.
"""

import json
from collections.abc import Callable, Mapping
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from typing import Any, TypeVar

__all__ = ["processes", "run_campaign"]

Case = TypeVar("Case")
Result = dict[str, Any]


def processes(workers: int) -> ProcessPoolExecutor:
    """Return an executor over `workers` processes of this machine.

    Each starts a fresh interpreter: a copy of a process that has threads can wait for
    ever on a lock that one of them held.
    """
    return ProcessPoolExecutor(workers, mp_context=get_context("spawn"))


def run_campaign(
    function: Callable[[Case], Result],
    cases: Mapping[str, Case],
    folder: Path,
    executor: Executor,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Result]:
    """Run the cases that are not done yet and return all of them.

    Parameters
    ----------
    function : callable
        Of one case; pure, picklable, returning plain JSON types.
    cases : mapping of str to case
        Name to argument. A name is also a file name.
    folder : Path
        Where ``NAME.json`` of each case is kept; created if it is not there.
    executor : Executor
        Where the cases run, in any order.
    progress : callable or None
        Called with the cases done and the cases in all.

    Returns
    -------
    dict of str to dict
        Results in the order of `cases`, whatever the order in which they finished.
    """
    folder.mkdir(parents=True, exist_ok=True)
    missing = [name for name in cases if not (folder / f"{name}.json").exists()]
    running = {executor.submit(function, cases[name]): name for name in missing}
    done = len(cases) - len(missing)
    for future in as_completed(running):
        name = running[future]
        partial = folder / f"{name}.json.partial"
        partial.write_text(json.dumps(future.result(), allow_nan=False), encoding="utf-8")
        partial.replace(folder / f"{name}.json")
        done += 1
        if progress is not None:
            progress(done, len(cases))
    return {
        name: json.loads((folder / f"{name}.json").read_text(encoding="utf-8")) for name in cases
    }
