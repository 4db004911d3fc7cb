"""Fits that several tests read and none changes."""

import gc
import os
import pickle
import time
from concurrent.futures import Executor, Future
from contextlib import nullcontext
from pathlib import Path

# One BLAS thread a process, here and in what the tests start: the matrices are small.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest
from diagnosis.driven_axis import fitted_axis

from bayesfric.analysis import Analysis, Sampler
from bayesfric.claims import checking
from bayesfric.diagnosis import diagnosing
from bayesfric.fitting import pooled, posterior
from bayesfric.fitting.posterior import fit
from bayesfric.invariants import broken, check_record
from bayesfric.margins import computing
from bayesfric.results import identified
from bayesfric.rigs.protocols import Protocol
from bayesfric.rigs.single_axis import entering
from bayesfric.simulate import simulate_recording

# All draws are stored, and no walker stays where it is for all of them.
QUICK_SAMPLER = Sampler(burn=20, steps=75, thin=3, extensions=0, independence_share=0.7)


@pytest.hookimpl(tryfirst=True)
def pytest_collection():
    """Look for no garbage in what is imported and collected, which stays to the end."""
    gc.disable()


def pytest_collection_finish():
    """Look for garbage again, but not in what is there by now: that took a twentieth of all."""
    gc.freeze()
    gc.enable()


@pytest.fixture(autouse=True)
def no_date_from_outside(monkeypatch):
    """Results carry a date only where a test asks for one."""
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)


@pytest.fixture(scope="session", autouse=True)
def no_result_contradicts_itself():
    """Hold what is true of every result against each that a test computes."""

    def looked_at(record):
        identified_record = identified(record)
        faults = broken(check_record(identified_record.model_dump(mode="json", by_alias=True)))
        checks = getattr(identified_record, "checks", ())
        assert not faults, faults
        assert all(check.holds for check in checks), checks
        return identified_record

    with pytest.MonkeyPatch.context() as patch:
        for module in (posterior, pooled, checking, diagnosing, computing):
            patch.setattr(module, "identified", looked_at)
        yield


def shared(tmp_path_factory, name, make):
    """Return what the first worker that asks has made; others wait for it and read it."""
    if "PYTEST_XDIST_WORKER" not in os.environ:
        return make()
    kept = tmp_path_factory.getbasetemp().parent / f"{name}.pickle"
    while not kept.exists():
        try:
            kept.with_suffix(".begun").touch(exist_ok=False)
        except FileExistsError:
            time.sleep(0.05)
            continue
        try:
            made = pickle.dumps(make())
        except BaseException:
            kept.with_suffix(".begun").unlink()
            raise
        kept.with_suffix(".whole").write_bytes(made)
        kept.with_suffix(".whole").rename(kept)
    return pickle.loads(kept.read_bytes())


class AtOnce(Executor):
    """Computes where it is asked, in the place of processes, each of which imports everything."""

    def submit(self, function, /, *arguments, **options):
        future = Future()
        try:
            future.set_result(function(*arguments, **options))
        except Exception as error:
            future.set_exception(error)
        return future


@pytest.fixture
def lengths_not_searched(monkeypatch):
    """Open an axis without the search for lengths of play and springs: two thirds of its time.

    For tests of what stands before it: windows, the rough law, clocks, limits, what a gear carries.
    """
    monkeypatch.setattr(entering, "with_lengths", lambda readings, table, measures, rig: measures)


@pytest.fixture(scope="module")
def no_processes():
    """Let verbs that are called by these tests start no process of their own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("bayesfric.campaign.processes", lambda workers: nullcontext(AtOnce()))
        yield


@pytest.fixture(scope="session")
def small_recording(tmp_path_factory):
    """A recording of three sizes, two angles, a replicate: 48 trials in 12 setups."""
    design = Protocol({(9, 85.0): 2, (15, 50.0): 1, (5, 135.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
    name = "small-recording"
    return shared(tmp_path_factory, name, lambda: simulate_recording(design, seed=21, name=name))


@pytest.fixture(scope="session")
def small_fit(small_recording, tmp_path_factory):
    """Its fit, with a short run."""
    os.environ.pop("SOURCE_DATE_EPOCH", None)
    analysis = Analysis(seed=5, sampler=QUICK_SAMPLER)
    return shared(tmp_path_factory, "small-fit", lambda: fit(small_recording, analysis))


@pytest.fixture(scope="session")
def driven_axis(tmp_path_factory):
    """An axis that a script of the tests simulated, and its law: for ``model_of_axis``."""
    folder = tmp_path_factory.mktemp("driven")
    return shared(tmp_path_factory, "driven-axis", lambda: fitted_axis(folder))


@pytest.fixture(scope="session")
def root():
    """The root of the source tree."""
    return Path(__file__).resolve().parents[1]


@pytest.fixture(scope="session")
def wrap_fit(tmp_path_factory):
    """A fit of both boards, with two numbers of pulleys at three wrap angles each."""
    os.environ.pop("SOURCE_DATE_EPOCH", None)
    cells = {(n, angle): 1 for n in (9, 15) for angle in (50.0, 85.0, 135.0)}
    design = Protocol(cells, (8.0, 16.0, 28.0), (8.0, 16.0, 28.0), 2)
    recording = simulate_recording(design, seed=4, name="wrap-recording")
    sampler = QUICK_SAMPLER.model_copy(update={"steps": 100, "thin": 2})  # quantiles are read
    analysis = Analysis(seed=5, sampler=sampler)
    rigs = ("gravity", "motor")
    return shared(tmp_path_factory, "wrap-fit", lambda: fit(recording, analysis, rigs=rigs))
