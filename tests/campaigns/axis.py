"""Diagnoses of driven axes that a script of the tests simulated, one withheld effect each.

The controller sees the position two milliseconds late, through a quantised encoder. Sizes of
the effects were fixed before the first run: about a tenth of friction, rms.
"""

import tempfile
from pathlib import Path

from campaigns.evidence import Gathered
from campaigns.promises import rate
from rigs.driven_mass import Machine, simulate, write
from scipy.stats import binomtest

from bayesfric.campaign import run_on_processes
from bayesfric.diagnosis import diagnose
from bayesfric.recording import read_recording

FINGERPRINT = ("effects", "likelihood.axis", "diagnosis.axis", "whole.axis")
TEST_RUNS = (3, 4, 5)
EFFECTS = {
    "viscous": {"viscous": 0.8},
    "air-drag": {"air_drag": 2.0},
    "stribeck": {"stribeck": (0.4, 0.05)},
    "presliding": {"presliding": (0.6, 0.01)},
    "hysteresis": {"presliding": (0.6, 0.03)},
    "wear-drift": {"drift": 0.3},
    "direction-asymmetry": {"asymmetry": 0.1},
    "axis-bias": {"bias": 0.15},
    "payload": {"payload": 0.3, "test_runs": TEST_RUNS},
    "spring": {"spring": 2.0},
    "delay": {"delay_s": 0.008},
    "actuator-lag": {"lag_s": 0.010},
    "torque-saturation": {"limit": 3.5},
    "backlash": {"backlash": 0.002},
    "transmission-compliance": {"compliance": (8000.0, 0.05, 0.3)},
    "gravity-torque": {"gravity": (0.6, 0.4), "stroke": 1.0, "top_speed": 2.5},
    "cogging": {"cogging": (0.25, 0.02, 0.7)},
    "empty": {},
}
SEEDS = {name: range(100, 105) for name in EFFECTS} | {"empty": range(100, 115)}
"""A hundred recordings."""
LATENCY = {"delay", "actuator-lag"}
LEAST_NAMED = 0.9
FIXED = (
    "viscous-100",
    "stribeck-100",
    "presliding-100",
    "payload-100",
    "axis-bias-100",
    "delay-100",
    "spring-100",
    "wear-drift-100",
    "gravity-torque-100",
    "cogging-100",
    "empty-100",
)
"""Cases that the nightly job repeats."""


def cases():
    """Return effect and seed of every case, by name."""
    pairs = [(seed, name) for name, seeds in SEEDS.items() for seed in seeds]
    return {f"{name}-{seed}": (name, seed) for seed, name in sorted(pairs)}


def case(given):
    """Diagnose one axis; say what was named, and how far mass and friction are off."""
    name, seed = given
    machine = Machine(**EFFECTS[name])
    table, samples = simulate(machine, runs=6, seconds=8.0, seed=seed)
    rotary = {"rotary": True} if name == "gravity-torque" else {}
    with tempfile.TemporaryDirectory() as folder:
        written = write(Path(folder) / "axis", machine, table, samples, **rotary)
        summary = diagnose(read_recording(written)).summary
    named = [cause.effect for cause in summary.causes]
    twins = [
        set(group.effects) for group in summary.unseparated if group.reason.startswith("identical")
    ]
    alike = {name}.union(*(twin for twin in twins if name in twin))
    right = not named if name == "empty" else bool(alike & set(named))
    return {
        "effect": name,
        "seed": seed,
        "verdict": summary.verdict,
        "causes": named,
        "right": right,
        "further": sorted(set(named) - alike),
        "mass_off": summary.law["inertia"].after.mean / machine.mass - 1,
        "friction_off": summary.law["coulomb"].after.mean / machine.coulomb - 1,
        "falsely_viscous": name != "viscous" and "viscous" in named,
    }


def figures(records):
    """Return how many cases are right, of those that are there, and of how many that are asked for.

    Parameters
    ----------
    found : list of dict
        As of :func:`case`.
    """
    acted = [record for record in records if record["effect"] != "empty"]
    empty = [record for record in records if record["effect"] == "empty"]
    right = sum(record["right"] for record in acted)
    interval = binomtest(right, len(acted)).proportion_ci(0.95)
    return {
        "cases": len(records),
        "cases_asked_for": len(cases()),
        "named": right,
        "of": len(acted),
        "interval": [interval.low, interval.high],
        "named_and_nothing_else": sum(
            record["right"] and not record["further"] for record in acted
        ),
        "falsely_named": sum(bool(record["causes"]) for record in empty),
        "of_empty": len(empty),
        "latency_called_viscous": sum(
            record["falsely_viscous"] for record in acted if record["effect"] in LATENCY
        ),
        "of_latency": sum(record["effect"] in LATENCY for record in acted),
        "mass_within_2_percent": sum(abs(record["mass_off"]) < 0.02 for record in records),
        "friction_within_5_percent": sum(abs(record["friction_off"]) < 0.05 for record in records),
    }


def gather(folder):
    """Run the campaign."""
    done = run_on_processes(case, cases(), folder, workers=2)
    seeds = [record["seed"] for record in done.values()]
    return Gathered(
        seeds=[min(seeds), max(seeds)],
        figures=figures(list(done.values())),
        cases=list(done.values()),
        fixed={name: done[name] for name in FIXED},
    )


def promises(figures):
    """Return what was promised beside what was found."""
    return [
        rate("a withheld effect is named", figures["named"], figures["of"], least=LEAST_NAMED),
        rate(
            "an axis without an effect has one named",
            figures["falsely_named"],
            figures["of_empty"],
            most=0,
        ),
        rate(
            "latency is called viscous friction",
            figures["latency_called_viscous"],
            figures["of_latency"],
            most=0,
        ),
    ]
