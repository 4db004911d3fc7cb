"""A campaign saves each case, goes on after a stop, and keeps the order of its cases."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import active_children
from pathlib import Path

import pytest
from local_cluster import local_cluster

from bayesfric.campaign import (
    WorkerDiedError,
    cluster,
    processes,
    run_campaign,
    run_on_processes,
)
from bayesfric.errors import Fault, InputError


def square(case):
    return {"square": case**2}


def test_results_are_in_the_order_of_the_cases(tmp_path):
    with ThreadPoolExecutor(2) as executor:
        results = run_campaign(square, {"b": 2, "a": 3}, tmp_path, executor)
    assert list(results.items()) == [("b", {"square": 4}), ("a", {"square": 9})]
    assert json.loads((tmp_path / "a.json").read_text()) == {"square": 9}


def test_finished_cases_are_not_run_again(tmp_path):
    ran, fatal = [], {2}

    def counted(case):
        ran.append(case)
        if case in fatal:
            raise RuntimeError("killed")
        return square(case)

    cases = {"one": 1, "two": 2, "three": 3}
    with ThreadPoolExecutor(1) as executor, pytest.raises(RuntimeError, match="killed"):
        run_campaign(counted, cases, tmp_path, executor)
    done = {path.stem for path in tmp_path.glob("*.json")}
    assert "two" not in done
    ran.clear()
    fatal.clear()
    with ThreadPoolExecutor(1) as executor:
        results = run_campaign(counted, cases, tmp_path, executor)
    assert sorted(ran) == sorted(cases[name] for name in set(cases) - done)
    assert results["three"] == {"square": 9}


def test_progress_starts_from_what_is_done(tmp_path):
    (tmp_path / "one.json").write_text('{"square": 1}')
    seen = []
    with ThreadPoolExecutor(1) as executor:
        run_campaign(
            square, {"one": 1, "two": 2}, tmp_path, executor, lambda *step: seen.append(step)
        )
    assert seen == [(2, 2)]


def test_a_result_that_is_not_json_is_refused(tmp_path):
    with ThreadPoolExecutor(1) as executor, pytest.raises(ValueError, match="not JSON compliant"):
        run_campaign(lambda _: {"x": float("nan")}, {"one": 1}, tmp_path, executor)
    assert not (tmp_path / "one.json").exists()


def on_worker(case):
    """Die, or wait for a death, on the way; a file tells the tries of a case apart."""
    name, folder, kind = case
    first = not (folder / name).exists()
    with (folder / name).open("a") as stream:
        stream.write(f"{os.getpid()}\n")
    if kind == "fatal" or (kind == "dies" and first):
        os.kill(os.getpid(), signal.SIGKILL)
    if kind == "waits" and first:
        time.sleep(60)  # until it is killed from outside
    return {"name": name}


def tries_of(folder, name):
    return (folder / name).read_text().split()


def test_a_dead_process_costs_one_more_try_of_what_it_ran(tmp_path):
    notes = tmp_path / "notes"
    notes.mkdir()
    kinds = {"one": "plain", "two": "dies", "three": "plain", "four": "dies", "five": "plain"}
    cases = {name: (name, notes, kind) for name, kind in kinds.items()}
    results = run_on_processes(on_worker, cases, tmp_path / "done", 1)
    assert list(results.values()) == [{"name": name} for name in cases]
    assert [len(tries_of(notes, name)) for name in cases] == [1, 2, 1, 2, 1]


def test_a_case_that_kills_each_worker_is_named_and_the_rest_is_kept(tmp_path):
    notes = tmp_path / "notes"
    notes.mkdir()
    cases = {"good": ("good", notes, "plain"), "bad": ("bad", notes, "fatal")}
    with pytest.raises(WorkerDiedError, match="case bad"):
        run_on_processes(on_worker, cases, tmp_path / "done", 1)
    assert len(tries_of(notes, "bad")) == 2
    assert [path.stem for path in (tmp_path / "done").glob("*.json")] == ["good"]


def test_workers_end_with_who_started_them(tmp_path):
    code = (
        "import sys; from pathlib import Path; from test_campaign import on_worker;"
        "from bayesfric.campaign import run_on_processes\n"
        "if __name__ == '__main__':\n"
        "    notes = Path(sys.argv[1])\n"
        "    cases = {'one': ('one', notes, 'waits')}\n"
        "    run_on_processes(on_worker, cases, notes / 'done', 1)\n"
    )
    script = tmp_path / "campaign_of_one.py"
    script.write_text(code)
    path = os.pathsep.join([str(Path(__file__).parent), *sys.path])
    started = subprocess.Popen(
        [sys.executable, script, tmp_path], env=os.environ | {"PYTHONPATH": path}
    )
    wait_for(tmp_path / "one")
    worker = int(tries_of(tmp_path, "one")[0])
    started.kill()
    started.wait()
    deadline = time.monotonic() + 20
    while is_there(worker) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not is_there(worker)


def is_there(process):
    try:
        os.kill(process, 0)  # asks, and does nothing
    except ProcessLookupError:
        return False
    return True


def wait_for(path):
    deadline = time.monotonic() + 60
    while not (path.exists() and path.read_text().strip()):
        assert time.monotonic() < deadline
        time.sleep(0.05)


def test_a_cluster_of_processes_survives_the_death_of_one(tmp_path):
    notes = tmp_path / "notes"
    notes.mkdir()
    kinds = {"waiting": "waits"} | {f"plain-{k}": "plain" for k in range(6)}
    cases = {name: (name, notes, kind) for name, kind in kinds.items()}
    with local_cluster() as address:

        def kill():
            wait_for(notes / "waiting")
            os.kill(int(tries_of(notes, "waiting")[0]), signal.SIGKILL)

        killer = threading.Thread(target=kill)
        killer.start()
        with cluster(address) as executor:
            results = run_campaign(on_worker, cases, tmp_path / "done", executor)
        killer.join()
    assert list(results) == list(cases)
    assert len(set(tries_of(notes, "waiting"))) == 2  # two processes had it
    assert len({pid for name in cases for pid in tries_of(notes, name)}) >= 2


@pytest.mark.parametrize("address", ["nowhere:x", "tcp://127.0.0.1:1", "tcp://"])
def test_a_scheduler_that_is_not_there_is_an_error(address):
    expected = f"--scheduler: found '{address}', expected the address of a Dask scheduler"
    with pytest.raises(InputError, match=expected), cluster(address):
        pass


def test_an_error_ends_the_workers_instead_of_waiting_for_them():
    with pytest.raises(ValueError, match="mine"), processes(1) as executor:  # noqa: PT012
        executor.submit(time.sleep, 3600)
        (worker,) = active_children()
        raise ValueError("mine")
    # The executor's own thread may collect the worker first: its exit code stands a moment later.
    ends = time.monotonic() + 60
    while worker.exitcode is None and time.monotonic() < ends:
        time.sleep(0.01)
    assert worker.exitcode == -signal.SIGTERM


def refuse(case):
    raise InputError([Fault("board.csv", "a number", row=case, value="x")])


def test_faults_of_input_come_back_from_a_worker_as_they_were():
    with processes(1) as executor, pytest.raises(InputError) as caught:
        executor.submit(refuse, 3).result()
    assert caught.value.faults == (Fault("board.csv", "a number", row=3, value="x"),)
