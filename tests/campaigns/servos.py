"""Hobby servos of which commands alone are logged: what is told of them holds.

Half of them carry a payload that was weighed, on an arm of known length, in two of four runs:
their numbers are told in newton metres. Of the other half all are over the servo's stiffness.
The simulation is ``rigs/servos.py`` of the tests, which shares no code with the package; the
campaign that plays them is ``joint_rounds``.
"""

import numpy as np
from campaigns.promises import Outcome, rate
from rigs.servos import Servo

from bayesfric.diagnosis import diagnose

SEEDS = range(60)
FIXED_SEEDS = (0, 1)
PER_K = " per K"
LATEST_S = 0.04
PAYLOAD_KG = 0.3
NAMES = ("coulomb", "viscous", "gravity", "inertia")


def servo(seed):
    """Return a random servo; every third has no arm that gravity pulls."""
    rng = np.random.default_rng(seed)
    stiffness = float(np.exp(rng.uniform(np.log(6.0), np.log(40.0))))
    return Servo(
        stiffness=stiffness,
        inertia=stiffness * float(rng.uniform(0.0008, 0.003)),
        coulomb=stiffness * float(np.exp(rng.uniform(np.log(0.004), np.log(0.04)))),
        damping=stiffness * float(rng.uniform(0.015, 0.06)),
        gravity=stiffness * float(rng.uniform(0.02, 0.12)) * float(seed % 3 > 0),
        hangs=float(rng.uniform(-0.5, 0.5)),
        late_s=float(rng.uniform(0.0, LATEST_S)),
        rate_hz=float(rng.choice([30.0, 50.0, 100.0])),
        band_hz=float(rng.uniform(0.6, 1.2)),
        seconds=15.0,
    )


def is_loaded(seed):
    """Return whether a servo carries a payload that was weighed."""
    return seed % 2 == 1


def recorded(seed):
    """Return the log of a servo."""
    given = servo(seed)
    if is_loaded(seed):
        payloads = (0.0, PAYLOAD_KG, 0.0, PAYLOAD_KG)
        return given.recording(seed + 1, payloads, payload_arm_m=given.arm)
    return given.recording(seed + 1)


def case(seed):
    """Diagnose a servo.

    Parameters
    ----------
    seed : int
        Of the servo and its log.

    Returns
    -------
    dict
        Of each number its truth, its interval and its unit; the verdict, and what was named.
    """
    given, summary = servo(seed), diagnose(recorded(seed)).summary
    unit = summary.gap.unit
    over = given.stiffness if unit.endswith(PER_K) else 1.0
    truths = {
        "inertia": given.inertia / over,
        "coulomb": given.coulomb / over,
        "viscous": given.damping / over,
        "gravity": given.gravity / over,
    }
    intervals = {name: number.after for name, number in summary.law.items()}
    units = {name: number.unit for name, number in summary.law.items()}
    for cause in summary.causes:
        if cause.effect == "gravity-torque":
            intervals["gravity"] = cause.parameters["torque"]
            units["gravity"] = cause.parameters["torque"].unit
    return {
        "seed": seed,
        "loaded": is_loaded(seed),
        "numbers": {
            name: [truth, intervals[name].q05, intervals[name].q50, intervals[name].q95]
            for name, truth in truths.items()
            if name in intervals
        },
        "relative": all(own.endswith(PER_K) for own in units.values()),
        "absolute": not any(own.endswith(PER_K) for own in units.values()),
        "verdict": summary.verdict,
        "named": [cause.effect for cause in summary.causes],
        "false": [
            cause.effect
            for cause in summary.causes
            if not (cause.effect == "gravity-torque" and given.gravity)
        ],
        "sentence": summary.sentence,
    }


def inside(cases, name):
    """Return whether the truth of a number lies inside its 90 % interval, of those with it."""
    numbers = [record["numbers"][name] for record in cases if name in record["numbers"]]
    return [low <= truth <= high for truth, low, _, high in numbers]


def figures(cases):
    """Return shares of truths inside, and how far the middles are off, in the median."""
    reported = {}
    for name in NAMES:
        held = inside(cases, name)
        numbers = [record["numbers"][name] for record in cases if name in record["numbers"]]
        off = [abs(middle / truth - 1) for truth, _, middle, _ in numbers if truth]
        reported[name] = {
            "inside": sum(held),
            "of": len(held),
            "median_off": float(np.median(off)) if off else None,
        }
    loaded = [record for record in cases if record["loaded"]]
    free = [record for record in cases if not record["loaded"]]
    return {
        "numbers": reported,
        "relative": [sum(record["relative"] for record in free), len(free)],
        "absolute": [sum(record["absolute"] for record in loaded), len(loaded)],
        "false": [record["seed"] for record in cases if record["false"]],
    }


def promises(figures):
    """Return what was promised beside what was found."""
    held = {name: figures["numbers"][name] for name in ("coulomb", "viscous", "gravity")}
    return [
        *(
            rate(f"truths of {name} inside", own["inside"], own["of"], least=0.85, most=0.95)
            for name, own in held.items()
        ),
        rate("without a payload all is over K", *figures["relative"], least=1),
        rate("with one all is in newtons", *figures["absolute"], least=1),
        Outcome("false names", len(figures["false"]), most=0),
    ]
