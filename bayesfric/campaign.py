"""Map a function over many cases, each saved when it is done.

A killed campaign goes on where it stopped, and the cases of a worker that dies are tried
once more. The module knows nothing of friction, and works on any
:class:`concurrent.futures.Executor`: processes on one machine, or a Dask cluster.
"""

import hashlib
import json
import os
import signal
import socket
import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import urlsplit

from bayesfric.errors import Fault, InputError, needs_extra
from bayesfric.files import write_whole

Case = TypeVar("Case")
Result = dict[str, Any]
TRIES = 2  # of a case whose worker died
CONNECT_S = 10.0  # to wait for a scheduler


class WorkerDiedError(RuntimeError):
    """A case whose worker died each time that it was tried.

    Parameters
    ----------
    name : str
        Of the case.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        super().__init__(f"case {name}: its worker died {TRIES} times; what is done is kept")


@contextmanager
def processes(workers: int) -> Iterator[Executor]:
    """Lend an executor over `workers` processes of this machine.

    Each starts a fresh interpreter: a copy of a process that has threads can wait for
    ever on a lock that one of them held. Interrupts are for the parent alone, which then, and
    after any error, ends the workers instead of waiting for what they do.
    """
    executor = _Processes(workers, mp_context=get_context("spawn"), initializer=_end_with_parent)
    try:
        yield executor
    except BaseException:
        executor.shutdown(wait=False, cancel_futures=True)
        for process in active_children():
            process.terminate()
        raise
    executor.shutdown()


class _Processes(ProcessPoolExecutor):
    """Starts its workers with SIGINT blocked, which they inherit from their first moment.

    Windows blocks no signals: workers ignore SIGINT as soon as they have begun.
    """

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Any:
        if not hasattr(signal, "pthread_sigmask"):
            return super().submit(fn, *args, **kwargs)
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            return super().submit(fn, *args, **kwargs)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _end_with_parent() -> None:
    """Make a worker end when its parent process is killed, and leave interrupts to that."""
    if not hasattr(signal, "pthread_sigmask"):
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = parent_process()
    if parent is not None:

        def watch() -> None:
            parent.join()
            os._exit(1)

        threading.Thread(target=watch, daemon=True).start()


@contextmanager
def cluster(address: str) -> Iterator[Executor]:
    """Connect to a Dask cluster and lend an executor over its workers.

    Parameters
    ----------
    address : str
        Of its scheduler, as in ``tcp://host:8786``.

    Raises
    ------
    InputError
        Dask is not installed, or no scheduler answers there.
    """
    with needs_extra("dask", "an installation with Dask", "command line", "--scheduler", address):
        from distributed import Client
    try:
        # A client that finds nobody waits long to be closed: knock first.
        place = urlsplit(address if "://" in address else f"tcp://{address}")
        socket.create_connection((place.hostname, place.port), CONNECT_S).close()
        client = Client(address, timeout=CONNECT_S, set_as_default=False)  # type: ignore[no-untyped-call]
    except (OSError, ValueError, TypeError) as error:
        expected = "the address of a Dask scheduler that answers, as in tcp://host:8786"
        fault = Fault("command line", expected, column="--scheduler", value=address)
        raise InputError([fault]) from error
    with client:
        yield client.get_executor()  # type: ignore[no-untyped-call]


def case_folder(folder: Path, kind: str, key: Any) -> Path:
    """Return where a campaign's cases are kept; no campaign of another key shares it.

    Parameters
    ----------
    folder : Path
        Of its results.
    kind : str
        A folder in it.
    key : object
        Everything on which a case depends but its name, as JSON takes it.
    """
    digest = hashlib.sha256(json.dumps(key, sort_keys=True).encode()).hexdigest()
    return folder.resolve() / kind / digest[:12]


def run_cases(
    function: Callable[[Case], Result],
    cases: Mapping[str, Case],
    folder: Path,
    workers: int,
    scheduler: str | None,
    progress: Callable[[int, int], None] | None,
) -> dict[str, Result]:
    """Run cases on processes of this machine, or on the workers of a Dask scheduler.

    Parameters and result as of :func:`run_campaign`; `scheduler` is the address of one.
    """
    if scheduler is None:
        return run_on_processes(function, cases, folder, workers, progress)
    with cluster(scheduler) as executor:
        return run_campaign(function, cases, folder, executor, progress)


def run_on_processes(
    function: Callable[[Case], Result],
    cases: Mapping[str, Case],
    folder: Path,
    workers: int,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Result]:
    """Run cases on processes of this machine, and start them anew when one dies.

    A process that dies breaks its whole executor; the cases that were running then are
    tried once more. Parameters and result as of :func:`run_campaign`.

    Raises
    ------
    WorkerDiedError
        A case was running each time that a process died.
    """
    tries: Counter[str] = Counter()
    while True:
        with processes(workers) as executor:
            try:
                return _run(function, cases, folder, executor, progress, tries, workers)
            except BrokenExecutor:
                continue  # whose cases were running is in `tries`


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
        Where ``NAME.json`` of each case is kept; created if it is not there. One that does
        not read is run again.
    executor : Executor
        Where the cases run, in any order.
    progress : callable or None
        Called with the cases done and the cases in all.

    Returns
    -------
    dict of str to dict
        Results in the order of `cases`, whatever the order in which they finished.

    Raises
    ------
    WorkerDiedError
        On a cluster, each worker that had the case died.
    """
    return _run(function, cases, folder, executor, progress, Counter(), None)


def _run(
    function: Callable[[Case], Result],
    cases: Mapping[str, Case],
    folder: Path,
    executor: Executor,
    progress: Callable[[int, int], None] | None,
    tries: Counter[str],
    at_once: int | None,
) -> dict[str, Result]:
    """Run the missing cases, `at_once` at a time; count the tries that dead workers cost."""
    folder.mkdir(parents=True, exist_ok=True)
    missing = [name for name in cases if _kept(folder / f"{name}.json") is None]
    done = len(cases) - len(missing)
    missing.reverse()
    running: dict[Future[Result], str] = {}
    try:
        while missing or running:
            # No more than can run: who runs when a process dies is known that way.
            while missing and (at_once is None or len(running) < at_once):
                name = missing.pop()
                running[executor.submit(function, cases[name])] = name
            finished, _ = wait(running, return_when=FIRST_COMPLETED)
            # What is good is saved before anything is raised.
            for future in sorted(finished, key=lambda case: case.exception() is not None):
                name = running[future]
                try:
                    result = future.result()
                except _killed_worker() as fault:
                    _count(tries, name, fault)
                    missing.append(name)
                else:
                    write_whole(
                        folder / f"{name}.json", json.dumps(result, allow_nan=False).encode()
                    )
                    done += 1
                    if progress is not None:
                        progress(done, len(cases))
                del running[future]
    except BrokenExecutor as fault:
        for name in running.values():
            _count(tries, name, fault)
        raise
    return {name: _kept(folder / f"{name}.json") or {} for name in cases}


def _kept(path: Path) -> Result | None:
    """Return a result that is done, None where there is none or it is damaged."""
    try:
        kept = json.loads(path.read_bytes())
    except (OSError, ValueError, RecursionError):
        return None
    return kept if isinstance(kept, dict) else None


def _count(tries: Counter[str], name: str, fault: BaseException) -> None:
    tries[name] += 1
    if tries[name] >= TRIES:
        raise WorkerDiedError(name) from fault


def _killed_worker() -> tuple[type[BaseException], ...]:
    """Return the exception of Dask for a case whose workers died; none if Dask is not in use."""
    if "distributed" not in sys.modules:
        return ()
    from distributed import KilledWorker

    return (KilledWorker,)
