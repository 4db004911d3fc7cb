"""Runs that are killed or interrupted at a random place, and called again.

A small recording of friction points goes through `run` and `blind`. Killed (SIGKILL), they
leave the old results, the new ones or what readers refuse; interrupted (SIGINT), they end
within seconds and say so. Called again they end with the bytes of a run that nobody disturbed.
"""

import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from campaigns.evidence import Gathered
from campaigns.promises import Outcome, rate

from bayesfric.cli import app
from bayesfric.errors import InputError
from bayesfric.report.stored import read_stored

SETTINGS = "seed = {seed}\n[sampler]\nburn = 10\nsteps = 60\nthin = 2\nextensions = 0\n"
ANSWER = {"withheld": []}
SETS = (
    ("fit.json", "draws.nc", "predictive.nc"),
    ("claims.json", "claims.nc"),
    ("diagnosis.json", "diagnosis.nc"),
    ("scorecard.json",),
)
FINGERPRINT = ("whole.points",)
SEEDS = {"run": range(10), "blind": range(10, 20), "interrupted": range(20, 30)}
PROMPT_S = 2.0  # within which an interrupted run ends
PROGRAM = str(app.info.name)  # of which the evidence speaks, and so of all that it imports


class Bench:
    """A recording, its settings, and what undisturbed runs make of it.

    Parameters
    ----------
    folder : Path
        Where all of it is made.
    """

    def __init__(self, folder):
        self.folder = folder
        self.call("simulate", "board", "--protocol", "points", "--seed", "3")
        for name, seed in (("old", 5), ("new", 6)):
            (folder / f"{name}.toml").write_text(SETTINGS.format(seed=seed))
        (folder / "answer.json").write_text(json.dumps(ANSWER))
        self.call(*self.command("run", "old", settings="old"))
        self.seconds, self.wanted = {}, {}
        for verb in ("run", "blind"):
            before = time.monotonic()
            self.call(*self.command(verb, f"whole-{verb}"))
            self.seconds[verb] = time.monotonic() - before
            self.wanted[verb] = digests(folder / f"whole-{verb}")

    def command(self, verb, output, settings="new"):
        """Return the arguments of a verb that writes into a folder."""
        if verb == "run":
            return ("run", "board", "--config", f"{settings}.toml", "-o", output)
        return ("blind", "--from", "board", "--answer", "answer.json", "-o", output)

    def start(self, *arguments):
        """Start the program."""
        return subprocess.Popen(
            [Path(sys.executable).with_name(PROGRAM), *arguments],
            cwd=self.folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            env={k: v for k, v in os.environ.items() if k != "SOURCE_DATE_EPOCH"},
            # A run in the background of a shell ignores interrupts, and so would its children.
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
            start_new_session=True,
        )

    def call(self, *arguments):
        """Run the program to its end; return what it said."""
        process = self.start(*arguments)
        _, said = process.communicate()
        assert process.returncode == 0, said
        return said

    def state(self, folder):
        """Return whether results are ``old``, ``new``, ``refused``, or neither: ``mixed``."""
        try:
            read_stored(folder)
        except InputError:
            return "refused"
        current, old = digests(folder), digests(self.folder / "old")
        states = set()
        for names in SETS:
            files = {name: current[name] for name in names if name in current}
            for state, whole in (("new", self.wanted["run"] | self.wanted["blind"]), ("old", old)):
                if files and files == {name: whole.get(name) for name in names}:
                    states.add(state)
                    break
            else:
                states |= {"mixed"} if files else set()
        return "mixed" if "mixed" in states else "+".join(sorted(states))


def digests(folder):
    """Return a hash of each result in a folder, timings aside."""
    return {
        file.relative_to(folder).as_posix(): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in sorted(folder.rglob("*"))
        if file.is_file() and file.name not in ("timings.json", "log.jsonl")
        if not any(part.startswith(".") for part in file.relative_to(folder).parts)
    }


def killed(bench, verb, seed):
    """Kill a verb at a random moment, and call it again."""
    folder = bench.folder / f"{verb}-{seed}"
    if verb == "run":
        shutil.copytree(bench.folder / "old", folder)
    after = float(np.random.default_rng(seed).uniform(0, bench.seconds[verb]))
    process = bench.start(*bench.command(verb, folder.name))
    time.sleep(after)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    state = bench.state(folder)
    bench.call(*bench.command(verb, folder.name))
    same = digests(folder) == bench.wanted[verb]
    return {"verb": verb, "seed": seed, "after_s": after, "state": state, "same_bytes": same}


def interrupted(bench, seed):
    """Interrupt `run` at a random moment, and call it again."""
    folder = bench.folder / f"interrupted-{seed}"
    after = float(np.random.default_rng(seed).uniform(0, bench.seconds["run"]))
    process = bench.start(*bench.command("run", folder.name))
    time.sleep(after)
    before = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, said = process.communicate()
    ended = time.monotonic() - before
    again = bench.call(*bench.command("run", folder.name))
    return {
        "verb": "run",
        "seed": seed,
        "after_s": after,
        "ended_after_s": ended,
        "status": process.returncode,
        "traceback": "Traceback" in said,
        # A run that had ended is begun anew when it is called again.
        "twice": sorted(lines(said, "done") & lines(again, "started"))
        if process.returncode
        else [],
        "same_bytes": digests(folder) == bench.wanted["run"],
    }


def lines(said, what):
    """Return the stages that a log says have been started, or are done."""
    end = f": {what}"
    return {line.removesuffix(end) for line in said.splitlines() if line.endswith(end)}


def figures(done, seconds):
    """Return how often each thing went wrong, and how long undisturbed runs took."""
    ended = [record["ended_after_s"] for record in done if record.get("status") == 3]
    return {
        "kills": sum("state" in record for record in done),
        "mixed": sum(record.get("state") == "mixed" for record in done),
        "interrupts": sum("status" in record for record in done),
        "of_them_running": len(ended),
        "other_statuses": sum(record.get("status", 0) not in (0, 3) for record in done),
        "slowest_end_s": max(ended, default=0.0),
        "tracebacks": sum(record.get("traceback", False) for record in done),
        "stages_done_twice": sum(len(record.get("twice", ())) for record in done),
        "other_bytes": sum(not record["same_bytes"] for record in done),
        "undisturbed_s": seconds,
    }


def gather(folder):
    """Run the campaign."""
    with tempfile.TemporaryDirectory() as place:
        bench = Bench(Path(place))
        done = [killed(bench, verb, seed) for verb in ("run", "blind") for seed in SEEDS[verb]]
        done += [interrupted(bench, seed) for seed in SEEDS["interrupted"]]
    return Gathered([0, 29], figures(done, bench.seconds), done)


def promises(figures):
    """Return what was promised beside what was found."""
    kills, interrupts = figures["kills"], figures["interrupts"]
    return [
        rate("a kill leaves results of two runs", figures["mixed"], kills, most=0),
        rate(
            "called again it ends with other bytes",
            figures["other_bytes"],
            kills + interrupts,
            most=0,
        ),
        rate("an interrupt ends with a traceback", figures["tracebacks"], interrupts, most=0),
        rate("its exit status is not 0 or 3", figures["other_statuses"], interrupts, most=0),
        Outcome("stages that are done twice", figures["stages_done_twice"], most=0),
        Outcome("slowest end after an interrupt, s", figures["slowest_end_s"], most=PROMPT_S),
    ]
