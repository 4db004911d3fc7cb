"""How long the commands take, and the most memory that a process of theirs holds.

Wall time, cold, on as many cores as there are: what a user waits for.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmark.compare import within
from benchmark.problems import RECORDING
from campaigns import second_world

from bayesfric.recording import write_recording
from bayesfric.simulate import simulate_recording

COMMAND = [sys.executable, "-m", "bayesfric"]
BUNDLED = str(RECORDING)
WANTED_S = {
    "import bayesfric": 0.3,
    "--help": 0.5,
    "first use of bayesfric.fit": 0.7,
    "validate": 0.7,
    "fit": 4.0,
    "claims": 8.0,
    "diagnose": 6.0,
    "diagnose, quick": 3.0,
    "run": 16.0,
}
WANTED_MIB = 512  # of any process of a run
SECOND_S = 5.0  # of a board of the second world, where a file of it is named: the median
SEED = 1


def measured(command):
    """Run a command; return wall seconds and the peak of its largest process [MiB]."""
    began = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)  # with its children that ended
    if status:
        raise RuntimeError(f"{command}: status {status}")
    return time.perf_counter() - began, usage.ru_maxrss / 1024


def second_boards():
    """Return the wall seconds of a diagnosis of one board an effect of the second world."""
    seconds = {}
    if second_world.WORLD not in os.environ:
        return seconds
    with tempfile.TemporaryDirectory() as folder:
        for effect in second_world.world().effects():
            board, out = str(Path(folder) / effect), str(Path(folder) / f"{effect}-out")
            second_world.world().make(board, effect, SEED, strength=1.0)
            seconds[effect] = measured([*COMMAND, "diagnose", board, "-o", out])[0]
    return seconds


def targets(repeats):
    """Return a row a target, of the median of the repeats, and all figures."""
    with tempfile.TemporaryDirectory() as folder:
        quick, out = Path(folder) / "quick", str(Path(folder) / "out")
        write_recording(simulate_recording("quick", seed=SEED), quick)
        commands = {
            "import bayesfric": [sys.executable, "-c", "import bayesfric"],
            "--help": [*COMMAND, "--help"],
            "first use of bayesfric.fit": [sys.executable, "-c", "import bayesfric as b; b.fit"],
            "validate": [*COMMAND, "validate", BUNDLED],
            "fit": [*COMMAND, "fit", BUNDLED, "-o", f"{out}-fit"],
            "claims": [*COMMAND, "claims", BUNDLED, "-o", out],
            "diagnose": [*COMMAND, "diagnose", BUNDLED, "-o", out],
            "diagnose, quick": [*COMMAND, "diagnose", str(quick), "-o", out],
            "run": [*COMMAND, "run", BUNDLED, "-o", f"{out}-run"],
        }
        seconds_by_verb = {
            name: [measured(command) for _ in range(repeats)] for name, command in commands.items()
        }
    middle = {
        name: sorted(repeated)[len(repeated) // 2] for name, repeated in seconds_by_verb.items()
    }
    rows = [within(f"{name}, seconds", middle[name][0], limit) for name, limit in WANTED_S.items()]
    rows.append(within("run, MiB of its largest process", middle["run"][1], WANTED_MIB))
    seconds = second_boards()
    if seconds:
        median = statistics.median(seconds.values())
        name = "diagnose, a board of the second world, median of seconds"
        rows.append(within(name, median, SECOND_S))
    return rows, seconds_by_verb | {"second world": seconds}
