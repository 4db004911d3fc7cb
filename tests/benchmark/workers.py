"""What a campaign on processes costs beside its cases, and whether memory grows in a process."""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from benchmark.compare import at_least, within
from benchmark.memory import resident_mib
from benchmark.verbs import BUNDLED, COMMAND, measured

from bayesfric.analysis import Analysis
from bayesfric.campaign import run_on_processes
from bayesfric.diagnosis import diagnose
from bayesfric.simulate import simulate_recording

CASES = 12
MANY = 39  # diagnoses of one process, from whose growth that of 1,000 is told
SEED = 1
SPEEDUP, OVERHEAD, GROWTH_MIB = 1.9, 0.05, 50.0
VERBS = {"claims": ["claims", BUNDLED], "blind": ["blind"], "calibrate": ["calibrate"]}
OF_A_CAMPAIGN = 8  # cases of a verb that makes recordings itself


def case(seed):
    """Diagnose one board; return its processor time and its wall time."""
    began, clock = time.process_time(), time.perf_counter()
    diagnose(simulate_recording("quick", seed=seed), Analysis(seed=seed))
    return {"cpu_s": time.process_time() - began, "wall_s": time.perf_counter() - clock}


def ran(workers, cases):
    """Return the wall time of a campaign and the results of its cases."""
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        results = run_on_processes(case, cases, Path(folder), workers)
        return time.perf_counter() - began, list(results.values())


def seconds_of_verbs():
    """Return the wall seconds of each verb with one and with two workers."""
    seconds = {}
    for verb, words in VERBS.items():
        cases = [] if verb == "claims" else ["--n", str(OF_A_CAMPAIGN)]
        with tempfile.TemporaryDirectory() as folder:
            seconds[verb] = [
                measured([*COMMAND, *words, *cases, "-o", f"{folder}/{n}", "--workers", str(n)])[0]
                for n in (1, 2)
            ]
    return seconds


def targets():
    """Return a row a target, and the figures behind them."""
    cases = {str(seed): seed for seed in range(CASES)}
    one_worker_s, alone = ran(1, cases)
    two_workers_s, _ = ran(2, cases)
    inside = sum(result["wall_s"] for result in alone)
    with tempfile.TemporaryDirectory() as folder:
        kept = Path(folder) / "memory.json"
        subprocess.run([sys.executable, "-m", "benchmark.workers", str(kept)], check=True)
        held = np.array(json.loads(kept.read_text()))
    third = len(held) // 3  # in the first of which all is loaded that ever is
    grown = 1000 * float(held[-third:].mean() - held[third : 2 * third].mean()) / third
    rows = [
        at_least(
            "two workers over one, times as fast",
            two_workers_s,
            one_worker_s,
            one_worker_s / two_workers_s,
            SPEEDUP,
        ),
        within("executor, share of a campaign's time", 1 - inside / one_worker_s, OVERHEAD),
        within(f"1,000 quick diagnoses by {len(held)}, growth in MiB", grown, GROWTH_MIB),
    ]
    of_verbs = seconds_of_verbs()
    rows += [
        at_least(f"{verb}, two workers over one", double, single, single / double, SPEEDUP)
        for verb, (single, double) in of_verbs.items()
    ]
    figures = {
        "one_s": one_worker_s,
        "two_s": two_workers_s,
        "inside_s": inside,
        "held_mib": held.tolist(),
    }
    return rows, figures | {"verbs_s": of_verbs}


if __name__ == "__main__":
    held_mib = []
    for _ in range(MANY):
        case(SEED)  # one board again and again, since boards differ in what they take
        held_mib.append(resident_mib())
    Path(sys.argv[1]).write_text(json.dumps(held_mib))
