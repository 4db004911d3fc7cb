"""``python -m benchmark [PEERS_PYTHON [PROBLEM …]]``: all that the project promises of speed.

Samplers side by side, in processor time; what size costs, the evidence, commands, campaigns.

Writes ``reports/evidence/benchmark.json`` and ``docs/benchmark.md``. Without PEERS_PYTHON the
targets that need no peer are printed, and nothing is written. ``tests`` is on the path.
"""

import os
import pickle
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from benchmark import compare, kernels, marginal, page, problems, sizes, verbs, workers
from campaigns import evidence
from campaigns.promises import rate

HERE = Path(__file__).resolve().parent
FINGERPRINT = ("likelihood.gravity", "fit.gravity")
PEERS = ("NumPyro NUTS", "BlackJAX NUTS", "nutpie NUTS")
EVIDENCE = "trial-medium"
REPEATS = int(os.environ.get("REPEATS", "3"))
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


@contextmanager
def one_core():
    """Keep processes that are started here on one core, where the system can.

    Peers start as many threads as there are cores, whatever their settings say.
    """
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(cores)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, cores)


def run(python, sampler, posterior, result, seed):
    """Run a sampler in a process of its own, cold, and return what it stored."""
    ours = posterior.suffix == ".pickle"
    script = ["-m", "benchmark.ours"] if ours else [str(HERE / "peers.py")]
    environment = os.environ | ONE_THREAD
    if not ours:
        environment.pop("PYTHONPATH", None)
    command = [python, *script, sampler, str(posterior), str(result), str(seed)]
    subprocess.run(command, check=True, env=environment)
    with np.load(result) as stored:
        return dict(stored)


def side_by_side(name, peers_python, folder):
    """Return the targets, the figures and the plain results of one posterior."""
    model, arrays = problems.model_of(problems.PROBLEMS[name])
    posterior = folder / f"{name}.npz"
    np.savez(posterior, **arrays)
    pickled = folder / f"{name}.pickle"
    pickled.write_bytes(pickle.dumps(model))
    coefficients = sum(parameter.kind == "coefficient" for parameter in model.parameters)
    runs = {"ours": (sys.executable, pickled), "limit": (sys.executable, pickled)}
    runs |= dict.fromkeys(PEERS, (peers_python, posterior))
    repeats, kept = ({sampler: [] for sampler in runs} for _ in range(2))
    events = problems.PROBLEMS[name].events
    for seed in range(1, (1 if events else REPEATS) + 1):  # peers take half an hour for events
        for sampler, (python, stored) in runs.items():
            result = run(python, sampler, stored, folder / "result.npz", seed)
            repeats[sampler].append(compare.figures_of(result, coefficients))
            kept[sampler].append(result)
    figures = {
        sampler: {key: compare.spread([row[key] for row in rows]) for key in rows[0]}
        for sampler, rows in repeats.items()
    }
    draws = {sampler: compare.pooled(results) for sampler, results in kept.items()}
    z = {other: compare.largest_z(draws["ours"], draws[other]) for other in ("limit", *PEERS)}
    return compare.targets(name, figures, z), figures


def printed(targets):
    """Print targets in a line each, as soon as they are there, and return them."""
    for row in targets:
        sys.stdout.write(page.line(row) + "\n")
    sys.stdout.flush()
    return targets


def without_peers():
    """Return the targets and the figures of all that needs no other sampler, by name."""
    rows, figures = [], {}
    for name, own in {
        # First, since the peak of a command counts from that of this process.
        "commands": lambda: verbs.targets(REPEATS),
        "kernels": kernels.targets,
        "campaigns": workers.targets,
        "evidence": lambda: marginal.targets(problems.model_of(problems.PROBLEMS[EVIDENCE])[0]),
        "sizes": sizes.targets,
    }.items():
        targets, figures[name] = own()
        rows += printed(targets)
    return rows, figures


def main(peers_python, names):
    """Run the posteriors and write what was found."""
    rows, cases = [], {}
    with tempfile.TemporaryDirectory() as folder, one_core():
        for name in names:
            targets, cases[name] = side_by_side(name, peers_python, Path(folder))
            rows += printed(targets)
    own, figures = without_peers()
    gathered = evidence.Gathered(
        seeds=[1, REPEATS],
        figures={"targets": rows + own, "samplers": cases},
        cases=figures,
        command="make bench",
    )
    evidence.write("benchmark", sys.modules[__name__], gathered)
    page.write(evidence.read("benchmark"))


def promises(figures):
    """Return what was promised beside what was found."""
    targets = figures["targets"]
    met = sum(row["met"] for row in targets)
    return [rate("a target of speed is met", met, len(targets), least=1)]


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(sys.argv[1], sys.argv[2:] or list(problems.PROBLEMS))
    else:
        without_peers()
        sys.stdout.write("no Python of peers was named: nothing is written\n")
