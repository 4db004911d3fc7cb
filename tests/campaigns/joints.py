"""Random joints with load and motion: γ, steady error and limit cycle against a simulation.

The simulation is ``margins/two_masses.py`` of the tests, which shares no physics with the
package: motor and joint on an elastic cable that rubs at both ends, in small steps.
"""

from itertools import pairwise

import numpy as np
from campaigns.evidence import gathered_over_seeds
from campaigns.promises import rate
from margins import two_masses
from margins.loops import loop, posterior

from bayesfric.margins.answer import largest_safe_gain
from bayesfric.margins.assembly import nominal_assembly
from bayesfric.margins.describing import effective_damping, natural_frequency, steady_error
from bayesfric.margins.hunting import run_length
from bayesfric.margins.reflecting import at_shaft
from bayesfric.margins.scanning import run
from bayesfric.margins.thresholds import GAMMA_MAX, find_hunting

FINGERPRINT = ("margins",)
SEEDS = range(50)
FIXED_SEEDS = range(3)  # that the nightly job repeats
WITHIN = 0.10
SHARES = (0.6, 0.7, 0.8, 0.9, 1.1, 1.2, 1.3, 1.5)
CREEP = 0.02
"""Of friction, what damping makes of the creeping reference's speed."""
STAYS = (0.0, 0.8, 0.85, 0.9, 0.95, 1.05, 1.1, 1.15, 1.2, 1.3)
"""Of the package's steady error, at which it is tried whether the motor stays."""
STAYS_S = 0.3
NEARLY = 0.999
BEYOND = 1.3
"""Over the γ that hunts, where the limit cycle is compared."""
LEAST_RATIO = 4.0
"""Of the cable's ringing to the loop's natural frequency."""
CYCLES = 6.0
LONGEST_S = 20.0


def joint(seed):
    """Return a random joint at its shaft, one draw, damped and with a cable that is stiff enough.

    Parameters
    ----------
    seed : int
        Of the joint.
    """
    rng = np.random.default_rng(seed)
    while True:
        changes = {
            "joint.inertia_kg_m2": 0.1 * np.exp(0.4 * rng.standard_normal()),
            "joint.load_n_m": rng.uniform(-0.1, 0.1),
            "drive.friction_n_m": rng.uniform(0.001, 0.004),
            "runs.0.count": int(rng.integers(2, 9)),
            "runs.0.tension_n": rng.uniform(8.0, 25.0),
            "cable.length_m": 10 ** rng.uniform(-1.7, -0.4),
            "controller.kp_n_m_per_rad": rng.uniform(0.01, 0.04),
            "controller.kd_n_m_s_per_rad": rng.uniform(3e-4, 1.5e-3),
            "controller.delay_s": float(rng.choice([0.0, 1e-3, 2e-3])),
            "controller.gravity_compensation": float(rng.choice([0.0, 1.0])),
            "stiction_ratio": float(rng.choice([1.0, 1.2])),
            "compensation.estimate_n_m": rng.uniform(0.002, 0.006),
            "kick.reference_range_rad_s": [speed := rng.uniform(0.2, 4.0), speed],
        }
        settings = loop(changes)
        shaft = at_shaft(settings, nominal_assembly(settings, posterior()))
        # nominal draws are one: the mean of the posterior
        damping = effective_damping(shaft) / (2 * np.sqrt(shaft.kp * shaft.inertia))
        stiff = (ringing(shaft) > LEAST_RATIO * natural_frequency(shaft))[0]
        if stiff and 0.15 < damping[0] < 0.7 and shaft.taut.all():
            return shaft


def ringing(shaft):
    """Return the frequency at which both ends ring on the cable [rad/s]."""
    return np.sqrt(shaft.stiffness * (1 / shaft.load_inertia + 1 / shaft.motor_inertia))


def case(seed):
    """Compare one joint.

    Parameters
    ----------
    seed : int
        Of the joint.

    Returns
    -------
    dict
        What the package says, and what the simulation does.
    """
    shaft = joint(seed)
    hunting = find_hunting(shaft, 1, 0.05)
    threshold = float(hunting.threshold[0])
    conditions = hunting.conditions or hunting.speeds
    condition = conditions[max(int(hunting.condition[0]), 0)]
    speed, kick = float(condition.speed_of(shaft)[0]), float(condition.kick_of(shaft)[0])
    duration = float(run_length(shaft.sampled(), speed).duration[0])
    record = {
        "seed": seed,
        "speed_rad_s": speed,
        "ringing_over_natural": float((ringing(shaft) / natural_frequency(shaft))[0]),
        "behind_over_friction": float((shaft.lost_motion * shaft.stiffness / shaft.friction)[0]),
        "load_over_friction": float(abs(shaft.net_load[0]) / shaft.friction[0]),
        "gamma": threshold if np.isfinite(threshold) else None,
        "steady_error": steady(shaft),
        "dragged_error": dragged(shaft),
    }
    if duration > LONGEST_S:
        return record | {"skipped": "a run takes too long", "gamma_over": None, "cycle": None}
    gammas = [GAMMA_MAX] if np.isinf(threshold) else [s * threshold for s in SHARES]
    hunts = [lasts(outside(shaft, gamma, kick, speed, duration), shaft) for gamma in gammas]
    if np.isinf(threshold):
        return record | {"none_outside": not hunts[0], "gamma_over": None, "cycle": None}
    first = hunts.index(True) if any(hunts) else None
    safe = largest_safe_gain(hunting, 0.05, 1.0).gamma
    record["safe"] = safe
    if safe is not None:
        record["safe_hunts"] = lasts(outside(shaft, safe, kick, speed, duration), shaft)
    record["gamma_over"] = None
    if first is not None:
        below = SHARES[first - 1] if first else 0.0
        record["gamma_over"] = (SHARES[first] + below) / 2
    return record | {"cycle": cycle(shaft, condition, min(BEYOND * threshold, GAMMA_MAX), duration)}


def outside(shaft, gamma, kick, speed, duration):
    """Return the motor's errors at the samples."""
    plant = two_masses.elastic(shaft, feed=gamma * float(shaft.estimate[0]))
    return two_masses.run(plant, kick=kick, speed=speed, duration=duration)[1]


def lasts(error, shaft):
    """Tell whether a swing of more than a count either way lasts through the last half."""
    third, fourth = np.array_split(error[error.size // 2 :], 2)
    count = 2 * np.pi / float(shaft.counts[0])
    return bool(np.ptp(fourth) > 2 * count and np.ptp(fourth) >= 0.9 * np.ptp(third))


def steady(shaft):
    """Return the largest error at which the motor stays, over that of the package.

    The cable is wound against the joint's breakaway, to the side to which the load helps.
    """
    band = float(steady_error(shaft)[0])
    plant = two_masses.elastic(shaft, feed=0.0)
    side = np.sign(float(shaft.net_load[0])) or 1.0
    wound = side * NEARLY * plant.behind * plant.friction * plant.stiction / plant.stiffness
    for before, share in pairwise(STAYS):
        kick = -side * share * band
        error = two_masses.run(plant, kick=kick, speed=0.0, duration=STAYS_S, wound=wound)[1]
        if np.abs(error + kick).max() > 2 * np.pi / float(shaft.counts[0]):
            return (before + share) / 2
    return STAYS[-1]


def dragged(shaft):
    """Return the error at which a creeping reference tears the motor off, over the package's.

    With stiction one end breaks away before the other, so that it may be smaller.
    """
    band = float(steady_error(shaft)[0])
    side = np.sign(float(shaft.net_load[0])) or 1.0
    speed = CREEP * float(shaft.friction[0] / shaft.kd[0])
    error = outside(shaft, 0.0, 0.0, side * speed, 1.5 * band / speed)
    return float(np.abs(error).max() / band)


def cycle(shaft, condition, gamma, duration):
    """Return amplitude and frequency over those of the package, where it swings often enough."""
    ours = run(shaft, (condition,), np.array([gamma]))
    speed, kick = float(condition.speed_of(shaft)[0]), float(condition.kick_of(shaft)[0])
    error = outside(shaft, gamma, kick, speed, 2 * duration)
    if not ours.hunts[0] or not lasts(error, shaft):
        return {"hunts": bool(ours.hunts[0]), "hunts_outside": lasts(error, shaft)}
    late = error[error.size // 2 :]
    times = np.arange(late.size) * float(shaft.sample_time[0])
    side = np.sign(late - (late.max() + late.min()) / 2)
    rises = times[1:][(side[:-1] < 0) & (side[1:] >= 0)]
    cycles = rises.size - 1
    if cycles < CYCLES:
        return {"cycles": cycles}
    frequency = cycles / (rises[-1] - rises[0])
    amplitude = np.ptp(error[3 * error.size // 4 :]) / 2
    return {
        "cycles": cycles,
        "amplitude_over": float(amplitude / ours.amplitude[0]),
        "frequency_over": float(frequency / ours.frequency[0]),
    }


def shares(values):
    """Return how many of some ratios are within the tolerance, below and above it, of how many."""
    there = np.array([value for value in values if value is not None])
    within = np.abs(there - 1) <= WITHIN + 1e-9
    return {
        "of": there.size,
        "within": int(within.sum()),
        "below": int((~within & (there < 1)).sum()),
        "above": int((~within & (there > 1)).sum()),
    }


def figures(cases):
    """Return the shares that agree: of all joints, and of those that hunt at rest or in motion.

    Parameters
    ----------
    cases : list of dict
        As of :func:`case`.
    """

    def of(some):
        cycles = [record["cycle"] or {} for record in some]
        return {
            "joints": len(some),
            # who does not hunt at 1.5 times the γ that is reported counts as above
            "gamma": shares([
                record["gamma_over"] if record["gamma_over"] is not None else SHARES[-1]
                for record in some if record["gamma"]
            ]),
            "amplitude": shares([swing.get("amplitude_over") for swing in cycles]),
            "frequency": shares([swing.get("frequency_over") for swing in cycles]),
        }  # fmt: skip

    looked = [record for record in cases if "skipped" not in record]
    return of(looked) | {
        "skipped": len(cases) - len(looked),
        "safe_gain": {
            "of": sum("safe_hunts" in record for record in looked),
            "hunts": sum(record.get("safe_hunts", False) for record in looked),
        },
        "steady_error": shares([record["steady_error"] for record in cases]),
        "dragged_error": shares([record["dragged_error"] for record in cases]),
        "never_hunts": {
            "of": sum("none_outside" in record for record in looked),
            "within": sum(record.get("none_outside", False) for record in looked),
        },
        "at_rest": of([record for record in looked if record["speed_rad_s"] == 0]),
        "in_motion": of([record for record in looked if record["speed_rad_s"] > 0]),
    }


def gather(folder):
    """Run the campaign."""
    return gathered_over_seeds(case, SEEDS, figures, FIXED_SEEDS, folder)


def promises(figures):
    """Return what was promised beside what was found: of every joint, within 10 %."""
    return [
        *(
            rate(
                f"{name.replace('_', ' ')} is within 10 % of the simulation from outside",
                figures[name]["within"],
                figures[name]["of"],
                least=1,
            )
            for name in ("gamma", "amplitude", "frequency", "steady_error")
        ),
        rate(
            "the loop hunts at the gain that is called safe",
            figures["safe_gain"]["hunts"],
            figures["safe_gain"]["of"],
            most=0,
        ),
    ]
