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

from bayesfric.analysis import Analysis
from bayesfric.diagnosis import diagnose
from bayesfric.recording import read_recording

RIGS = ("gravity_board", "motor_board")
WORLD = "BAYESFRIC_SECOND_WORLD"
FIRST = int(os.environ.get("BAYESFRIC_SECOND_FIRST", "1"))
SEEDS = range(FIRST, FIRST + int(os.environ.get("BAYESFRIC_SECOND_SEEDS", "20")))
STRENGTHS = (1.0, 0.3)
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
        found = diagnose(read_recording(Path(folder) / "board"), analysis).summary
    friction = found.gap.friction_rms
    shrink = None if found.gap.shrink is None else found.gap.shrink.q50
    alike = [set(one.effects) for one in found.unseparated if one.reason.startswith("identical")]
    result = {
        "kind": kind,
        "strength": strength,
        "seed": seed,
        "verdict": found.verdict,
        "probability": found.verdict_probability,
        "causes": {cause.effect: cause.strength for cause in found.causes},
        "possible": [cause.effect for cause in found.possible],
        "remainder": found.remainder.significant,
        "gap": found.gap.systematic.q50 / friction,
        "floor": found.gap.floor.q50 / friction,
        "shrink": shrink,
    }
    twins = {kind} | {name for one in alike if kind in one for name in one}
    return result | {"right": right(result, twins), "absurd": absurd(result)}


def right(found, truth):
    """Return whether a verdict is right where one of `truth` is there, or nothing that is known."""
    named = found["verdict"] == "named"
    if found["kind"] == "none":
        return found["verdict"] in ("no-gap", "undecided")
    if found["kind"] in world().unlisted():
        return found["verdict"] == "unknown" or found["remainder"]
    exactly = named and len(found["causes"]) == 1 and set(found["causes"]) <= truth
    told = bool(truth & {*found["causes"], *found["possible"]}) and not named
    return exactly or (told and found["strength"] < 1.0)


def absurd(found):
    """Return which figures cannot be."""
    wrong = []
    if not FLOOR[0] <= found["floor"] <= FLOOR[1]:
        wrong.append("floor")
    if found["shrink"] is not None and not SHRINK[0] <= found["shrink"] <= SHRINK[1]:
        wrong.append("shrink")
    if any(strength < LEAST for strength in found["causes"].values()):
        wrong.append("cause")
    return wrong
