"""Recordings of another hand than the package and its engines: a world to tune on.

The world is a module that is no part of the project, named by ``BAYESFRIC_SECOND_WORLD``. It
has ``effects()``, ``unlisted()`` (outsiders, which no file of the package describes) and
``make(folder, effect, seed, strength=…)``, which writes a recording of both boards.
"""

import hashlib
import importlib.util
import os
import tempfile
from functools import cache
from pathlib import Path

from campaigns.evidence import Gathered
from campaigns.promises import Outcome, rate
from scipy.stats import binomtest

from bayesfric.analysis import Analysis
from bayesfric.campaign import run_on_processes
from bayesfric.diagnosis import diagnose
from bayesfric.recording import read_recording

FINGERPRINT = ("effects", "diagnosis.gravity", "diagnosis.motor", "whole.gravity", "whole.motor")
WORLD = "BAYESFRIC_SECOND_WORLD"
FIRST = int(os.environ.get("BAYESFRIC_SECOND_FIRST", "1"))
SEEDS = range(FIRST, FIRST + int(os.environ.get("BAYESFRIC_SECOND_SEEDS", "20")))
STRENGTHS = (1.0, 0.3)
LEAST_RIGHT = {"full": 0.95, "weak": 0.85, "outsiders": 0.9, "empty": 1.0}
WORKERS = 1
PRACTICAL = 0.005
FLOOR, SHRINK, LEAST = (0.005, 0.04), (-0.05, 1.2), 0.003  # what is not absurd


@cache
def world():
    """Return the module."""
    assert WORLD in os.environ, f"the world is no part of the project: {WORLD}=PATH names it"
    spec = importlib.util.spec_from_file_location("second", os.environ[WORLD])
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def digest():
    """Return the SHA-256 of the world's file."""
    return hashlib.sha256(Path(os.environ[WORLD]).read_bytes()).hexdigest()


def cases():
    """Return kind, strength and seed of every case, by name."""
    kinds = [*world().effects(), *world().unlisted()]
    return {
        f"{seed:02d}-{strength:g}-{kind}": (kind, strength, seed)
        for seed in SEEDS
        for strength in STRENGTHS
        for kind in kinds
        if kind != "none" or strength == 1.0
    }


def case(given):
    """Diagnose a board; say what was found, and whether it is right."""
    kind, strength, seed = given
    rules = Analysis().diagnosis.model_copy(update={"practical_share": PRACTICAL})
    analysis = Analysis().model_copy(update={"diagnosis": rules})
    with tempfile.TemporaryDirectory() as folder:
        world().make(Path(folder) / "board", kind, seed, strength=strength)
        summary = diagnose(read_recording(Path(folder) / "board"), analysis).summary
    friction = summary.gap.friction_rms
    shrink = None if summary.gap.shrink is None else summary.gap.shrink.q50
    alike = [
        set(group.effects) for group in summary.unseparated if group.reason.startswith("identical")
    ]
    result = {
        "kind": kind,
        "strength": strength,
        "seed": seed,
        "verdict": summary.verdict,
        "probability": summary.verdict_probability,
        "causes": {cause.effect: cause.strength for cause in summary.causes},
        "possible": [cause.effect for cause in summary.possible],
        "present": [cause.effect for cause in summary.present],
        "remainder": summary.remainder.significant,
        "gap": summary.gap.systematic.q50 / friction,
        "floor": summary.gap.floor.q50 / friction,
        "shrink": shrink,
    }
    twins = {kind} | {name for group in alike if kind in group for name in group}
    return result | {"right": right(result, twins), "absurd": absurd(result)}


def right(record, truth):
    """Return whether a verdict is right where one of `truth` is there, or nothing that is known."""
    named = record["verdict"] == "named"
    if record["kind"] == "none":
        return record["verdict"] in ("no-gap", "undecided")
    if record["kind"] in world().unlisted():
        return record["verdict"] == "unknown" or record["remainder"]
    # An error of sensors acts without making a gap: no gap, and told beside it.
    if record["verdict"] == "no-gap" and truth & set(record["present"]):
        return True
    exactly = named and len(record["causes"]) == 1 and set(record["causes"]) <= truth
    listed = bool(truth & {*record["causes"], *record["possible"]}) and not named
    return exactly or (listed and record["strength"] < 1.0)


def absurd(record):
    """Return which figures cannot be."""
    wrong = []
    if not FLOOR[0] <= record["floor"] <= FLOOR[1]:
        wrong.append("floor")
    if record["shrink"] is not None and not SHRINK[0] <= record["shrink"] <= SHRINK[1]:
        wrong.append("shrink")
    if any(strength < LEAST for strength in record["causes"].values()):
        wrong.append("cause")
    return wrong


def needs():
    """Return what is missing to run the campaign, or nothing."""
    return "" if WORLD in os.environ else f"{WORLD}=PATH names the world"


def share(done):
    """Return how many cases are right, of how many, with Wilson's interval."""
    count = sum(record["right"] for record in done)
    interval = binomtest(count, len(done)).proportion_ci(0.95, method="wilson")
    return {"right": count, "of": len(done), "95": [interval.low, interval.high]}


def group_of(done):
    """Return the group in which a case is counted."""
    if done["kind"] == "none":
        return "empty"
    if done["kind"] in world().unlisted():
        return "outsiders"
    return "full" if done["strength"] == 1.0 else "weak"


def figures(done):
    """Return how many are right in each group, and what is wrong or cannot be."""
    groups = {
        name: [record for record in done.values() if group_of(record) == name]
        for name in LEAST_RIGHT
    }
    wrong = {
        name: [record["verdict"], sorted(record["causes"])]
        for name, record in done.items()
        if not record["right"]
    }
    return {name: share(own) for name, own in groups.items()} | {
        "wrong": wrong,
        "absurd": {name: record["absurd"] for name, record in done.items() if record["absurd"]},
        "world_sha256": digest(),
    }


def gather(folder):
    """Run the campaign.

    ``BAYESFRIC_SECOND_SEEDS=6`` runs six seeds, from ``BAYESFRIC_SECOND_FIRST`` on. With
    ``BAYESFRIC_SECOND_SO_FAR`` what is done is scored, and no more is run.
    """
    asked = cases()
    if "BAYESFRIC_SECOND_SO_FAR" in os.environ:
        asked = {
            name: record for name, record in asked.items() if (folder / f"{name}.json").exists()
        }
    done = run_on_processes(case, asked, folder, WORKERS)
    seeds = sorted({record["seed"] for record in done.values()})
    return Gathered(
        seeds=[seeds[0], seeds[-1]],
        figures=figures(done),
        cases=done,
        command=f"{WORLD}=PATH make release-evidence CAMPAIGNS=second_world",
    )


def promises(figures):
    """Return what was promised beside what was found."""
    return [
        *(
            rate(
                f"{name}: the verdict is right",
                figures[name]["right"],
                figures[name]["of"],
                least=least,
            )
            for name, least in LEAST_RIGHT.items()
        ),
        Outcome("boards with a figure that cannot be", len(figures["absurd"]), most=0),
    ]
