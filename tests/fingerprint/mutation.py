"""``make fingerprint-mutation``: does the fingerprint alone notice formulas that are altered?

Each of :mod:`fingerprint.altered_formulas` is put into a copy of the package, and the
fingerprint is computed up to the first number that moves. Where fewer than 95 % are noticed the
exit status is 1. Rooms or files on the command line choose some. Each formula has a process of its
own, which is a fork of this one: this one has imported libraries, and nothing of the package.
"""

import multiprocessing
import signal
import sys
import tempfile
from compileall import compile_dir
from importlib import import_module
from pathlib import Path

from fingerprint import stored
from fingerprint.altered_formulas import altered_formulas
from fingerprint.copies import altered, copied, restored

LEAST = 0.95
SECONDS = 900  # a loop that no longer ends is noticed too
LIBRARIES = (
    "scipy.stats scipy.optimize scipy.linalg pandas xarray pydantic emcee arviz_stats".split()
)
SOON = {
    "physics/": "physics",
    "effects/": "effects priors likelihood.points",
    "inference/": "priors likelihood.points left-out evidence diagnosis.points",
    "inference/evidence": "evidence claims",
    "inference/p": "priors evidence claims",
    "inference/laplace": "evidence",
    "claims/": "claims",
    "rigs/gravity_board": "likelihood.gravity left-out diagnosis.gravity",
    "rigs/motor_board": "likelihood.motor left-out diagnosis.motor",
    "rigs/steady_points": "likelihood.points left-out diagnosis.points",
    "observation/points.py": "diagnosis.points",
    "rigs/single_axis": "likelihood.axis diagnosis.axis",
    "diagnosis/": "diagnosis.points diagnosis.motor whole.motor diagnosis.gravity whole.points",
    "margins/": "margins",
    "simulators": "simulators",
}
"""By the beginning of a file, or the room: parts that are computed first, a later entry before."""


def main(chosen: list[str]) -> int:
    """Print each altered formula with what noticed it."""
    for library in LIBRARIES:
        import_module(library)
    noticed = tried = 0
    with tempfile.TemporaryDirectory() as name:
        folder = copied(Path(name))
        compile_dir(folder / "bayesfric", quiet=1)  # once, but for the file that is altered
        sys.path.insert(0, str(folder))
        for room, file, old, new, place in altered_formulas():
            if chosen and room not in chosen and file not in chosen:
                continue
            altered(folder, file, old, new, place)
            by = _noticed(_ordered(room, file))
            restored(folder, file)
            tried, noticed = tried + 1, noticed + bool(by)
            sys.stdout.write(f"{by or 'SURVIVED':20} {file}: {old}  →  {new}\n")
            sys.stdout.flush()
        if by := _noticed(list(stored.parts())):
            raise SystemExit(f"the fingerprint does not hold where nothing is altered: {by}")
    sys.stdout.write(f"noticed: {noticed} of {tried}\n")
    return 0 if noticed >= LEAST * tried else 1


def _ordered(room: str, file: str) -> list[str]:
    """Return all parts, those first that a formula is likely to move."""
    soon: list[str] = []
    for start, parts in SOON.items():
        if file.startswith(start) or room == start:
            soon = [*parts.split(), *soon]
    return list(dict.fromkeys([*soon, *stored.parts()]))


def _noticed(parts: list[str]) -> str:
    """Return what noticed: the part whose number moved, ``fault`` or ``endless``; else nothing."""
    fork = multiprocessing.get_context("fork")
    answers = fork.SimpleQueue()
    process = fork.Process(target=_look, args=(parts, answers))
    process.start()
    process.join()
    if process.exitcode == -signal.SIGALRM:
        return "endless"
    return answers.get() if not answers.empty() else "fault"


def _look(parts: list[str], answers: "multiprocessing.queues.SimpleQueue[str]") -> None:
    """Tell the first part of which a number has moved, or nothing; in a process of its own."""
    signal.alarm(SECONDS)
    sys.dont_write_bytecode = True
    command = import_module("fingerprint.__main__")
    package = import_module("bayesfric")
    assert package.__file__ is not None
    assert package.__file__.startswith(sys.path[0]), package.__file__
    answers.put(command.first_moved(parts))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
