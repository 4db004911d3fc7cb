"""Along which axis a diagnosis says that the gap lies, on boards, axes and points of known truth.

Boards are of the blind engine, an effect or an outsider each at strength 1, and of the second
world where ``BAYESFRIC_SECOND_WORLD`` names it; axes are those of :mod:`campaigns.axis`; points
are tables of friction at speeds and temperatures, one force each. Seeds and sizes were fixed
before the first run. ``BAYESFRIC_WHERE_SEEDS`` says how many seeds of each are run, from
``BAYESFRIC_WHERE_FIRST`` on; with ``BAYESFRIC_WHERE_SO_FAR`` what is done is scored, and no
more is run.
"""

import os
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from campaigns import axis as axes
from campaigns import second_world
from campaigns.evidence import Gathered
from campaigns.promises import rate
from rigs.driven_mass import Machine, simulate, write
from rigs.friction_points import recorded as write_points
from scipy.stats import binomtest

from bayesfric.blind.case import engine_of
from bayesfric.blind.engines.outsiders import OUTSIDERS
from bayesfric.campaign import run_on_processes
from bayesfric.diagnosis import diagnose
from bayesfric.effects import all_effects
from bayesfric.recording import read_recording

FINGERPRINT = (
    "diagnosis.gravity",
    "diagnosis.motor",
    "diagnosis.points",
    "diagnosis.axis",
    "whole.gravity",
    "whole.motor",
    "whole.points",
    "whole.axis",
)
FIRST = int(os.environ.get("BAYESFRIC_WHERE_FIRST", "1"))
SEEDS = range(FIRST, FIRST + int(os.environ.get("BAYESFRIC_WHERE_SEEDS", "2")))
OUTSIDE = {outsider.name: outsider.axes for outsider in OUTSIDERS} | {
    "x-detent": ("displacement",),
    "x-tension-velocity": ("velocity", "tension"),
    "x-log-velocity": ("velocity",),
}
"""Axes along which an outsider's force varies, by its name."""
POINTS = {
    "viscous": "velocity",
    "stribeck": "velocity",
    "hump": "velocity",
    "warmth": "temperature_c",
    "drift": "order",
}
"""Forces that tables of points are made with, and the axis of each."""
AT_LEAST = {"named": 0.95, "unknown": 0.85}


def cases():
    """Return where a recording is from, what acts in it and its seed, by name."""
    reference = engine_of("reference").effect_names()
    kinds = {
        "reference": [*reference, *(outsider.name for outsider in OUTSIDERS)],
        "axis": list(axes.EFFECTS),
        "points": list(POINTS),
    }
    if second_world.WORLD in os.environ:
        world = second_world.world()
        kinds["second"] = [*world.effects(), *world.unlisted()]
    ordered = [
        (place / len(own), source, kind)
        for source, own in kinds.items()
        for place, kind in enumerate(own)
        if kind not in ("none", "empty")
    ]
    # Sources in turn, so that a part of a campaign has some of each.
    return {
        f"{seed:02d}-{source}-{kind}": (source, kind, seed)
        for seed in SEEDS
        for _, source, kind in sorted(ordered)
    }


def recorded(source, kind, seed, folder):
    """Return the recording of a case."""
    if source == "second":
        second_world.world().make(folder / "board", kind, seed)
        return read_recording(folder / "board")
    if source == "axis":
        machine = Machine(**axes.EFFECTS[kind])
        table, samples = simulate(machine, runs=6, seconds=8.0, seed=seed)
        rotary = {"rotary": True} if kind == "gravity-torque" else {}
        return read_recording(write(folder / "axis", machine, table, samples, **rotary))
    if source == "points":
        return write_points(folder / "points", points(kind, seed))
    engine = engine_of("reference")
    form = "outsider" if kind in OUTSIDE else "effect"
    made = engine.make(engine.Withheld(form, ((kind, 1.0),), "random"), seed)
    return replace(made.recording, metadata={})


def points(kind, seed):
    """Return friction of a joint at speeds and temperatures, drawn at random."""
    rng = np.random.default_rng([seed, sorted(POINTS).index(kind)])
    count = 90
    speed, warm = rng.uniform(0.02, 1.0, count), rng.uniform(15.0, 45.0, count)
    force = 0.8 * (1 + 0.008 * rng.standard_normal(count))
    rank = np.linspace(-0.5, 0.5, count)
    force *= {
        "viscous": 1 + 0.4 * speed,
        "stribeck": 1 + 0.5 * np.exp(-speed / 0.1),
        "hump": 1 + 0.25 * np.exp(-(((speed - 0.5) / 0.15) ** 2)),
        "warmth": 1 - 0.2 * (warm - 30) / 15,
        "drift": 1 + 0.3 * rank,
    }[kind]
    return {"velocity_m_s": speed, "friction_n": force, "temperature_c": warm}


def case(given):
    """Diagnose one recording; say where its gap is said to lie, and whether that is right."""
    source, kind, seed = given
    with tempfile.TemporaryDirectory() as place:
        summary = diagnose(recorded(source, kind, seed, Path(place))).summary
    first = next((axis for axis in summary.where if axis.share is not None), None)
    causes = [cause.effect for cause in summary.causes]
    shares = [axis.share.mean for axis in summary.where if axis.share is not None]
    return {
        "source": source,
        "kind": kind,
        "verdict": summary.verdict,
        "causes": causes,
        "practical": summary.gap.probability_above_practical,
        "first": None if first is None else first.axis,
        "share": None if first is None else first.share.q50,
        "leads": first is not None and first.leads,
        "told": "It varies most with" in summary.sentence,
        "whole": sum(shares) + summary.unexplained.mean,
        "least": min(shares, default=0.0),
        "right": first is not None
        and first.axis in right_axes(kind, summary.verdict, causes, source),
    }


def right_axes(kind, verdict, causes, source):
    """Return the axes of which the first has to be one: of what is named, or else of the truth."""
    if verdict == "named":
        return set().union(*(all_effects(None)[effect].axes for effect in causes))
    if source == "points":
        return {POINTS[kind]}
    return set(OUTSIDE[kind]) if kind in OUTSIDE else set(all_effects(None)[kind].axes)


def group_of(record):
    """Return what a case counts for: a verdict of practical size, or nothing."""
    if record["verdict"] == "named" and record["practical"] >= 0.9:
        return "named"
    beyond = record["kind"] in OUTSIDE or record["source"] == "points"
    return "unknown" if record["verdict"] == "unknown" and beyond else None


def figures(done):
    """Return how often the first axis is right, by group and source, and what is not.

    Parameters
    ----------
    done : dict of str to dict
        Cases by name, as of :func:`case`.
    """
    rates = {}
    for group in AT_LEAST:
        own = [record for record in done.values() if group_of(record) == group]
        rates[group] = _rate(own)
        for source in sorted({record["source"] for record in own}):
            rates[f"{group}, {source}"] = _rate(
                [record for record in own if record["source"] == source]
            )
    return {
        "cases": len(done),
        "rates": rates,
        "wrong": {
            name: [record["verdict"], record["causes"], record["first"], record["leads"]]
            for name, record in done.items()
            if group_of(record) is not None and not record["right"]
        },
        "wrongly_told": sorted(
            name
            for name, record in done.items()
            if group_of(record) is not None and record["told"] and not record["right"]
        ),
        "not_whole": sorted(
            name
            for name, record in done.items()
            if abs(record["whole"] - 1) > 1e-6 or record["least"] < 0
        ),
    }


def _rate(records):
    right = sum(record["right"] for record in records)
    if not records:
        return {"right": 0, "of": 0, "95": [0.0, 1.0]}
    interval = binomtest(right, len(records)).proportion_ci(0.95, method="wilson")
    return {"right": right, "of": len(records), "95": [interval.low, interval.high]}


def gather(folder):
    """Run the campaign."""
    asked = cases()
    if "BAYESFRIC_WHERE_SO_FAR" in os.environ:
        asked = {
            name: record for name, record in asked.items() if (folder / f"{name}.json").exists()
        }
    done = run_on_processes(case, asked, folder, workers=2)
    return Gathered(
        seeds=[SEEDS.start, SEEDS.stop - 1], figures=figures(done), cases=list(done.values())
    )


def promises(figures):
    """Return what was promised beside what was found."""
    rates = figures["rates"]
    return [
        rate(
            f"the first axis is right where the verdict is {group}",
            rates[group]["right"],
            rates[group]["of"],
            least=least,
        )
        for group, least in AT_LEAST.items()
        if rates[group]["of"]
    ]
