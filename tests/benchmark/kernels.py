"""Small kernels, timed by pytest-benchmark in tests that are marked ``bench``.

The tests stand with those of what they time, and state in what time it is to be done.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from benchmark.compare import at_least, within

ROOT = Path(__file__).resolve().parents[2]
ROUNDS = 7


def timed(benchmark, name, function, *args, within_s=None):
    """Time a function, its first call aside, and return what it returned.

    Parameters
    ----------
    benchmark : BenchmarkFixture
        Of pytest-benchmark.
    name : str
        Of the row in the table of targets.
    function : callable
        Called with `args` a few times.
    within_s : float or None
        The most that the median is to be [s]; None where a peer's time is stated instead, as
        ``peer_s`` with its ``goal`` in the fixture's ``extra_info``.
    """
    benchmark.extra_info.update(name=name, within_s=within_s)
    return benchmark.pedantic(function, args, rounds=ROUNDS, warmup_rounds=1)


def targets():
    """Return a row a kernel, and all figures."""
    with tempfile.TemporaryDirectory() as folder:
        stored = Path(folder) / "kernels.json"
        subprocess.run(
            [
                *(sys.executable, "-m", "pytest", "-q", "-m", "bench"),
                *("--benchmark-enable", "--benchmark-timer=time.process_time"),
                f"--benchmark-json={stored}",
            ],
            check=True,
            cwd=ROOT,
            stdout=subprocess.DEVNULL,
        )
        benchmarks = json.loads(stored.read_text(encoding="utf-8"))["benchmarks"]
    figures = {
        benchmark["extra_info"]["name"]: {
            key: benchmark["stats"][key] for key in ("median", "min", "max", "rounds")
        }
        for benchmark in benchmarks
    }
    return [
        row(benchmark["extra_info"], benchmark["stats"]["median"]) for benchmark in benchmarks
    ], figures


def row(said, median):
    """Return the row of a kernel of which a test said name and limit, or peer and goal."""
    if said["within_s"] is None:
        return at_least(said["name"], median, said["peer_s"], said["peer_s"] / median, said["goal"])
    return within(f"{said['name']}, seconds", median, said["within_s"])
