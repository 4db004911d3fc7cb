"""Diagnoses of simulated `quick` recordings whose effects are known.

The simulator is the project's own: this proves consistency, not more.
"""

from itertools import count

from bayesfric.diagnosis import diagnose
from bayesfric.effects import all_effects
from bayesfric.simulate import simulate_recording

RIGS = ("gravity_board", "motor_board")
NULL_SEEDS = range(200)
STRENGTHS = (1.0, 0.3)
PAIRS = (
    ("viscous", "fixed-drag"),
    ("viscous", "tension-curvature"),
    ("stribeck", "wrap-curvature"),
    ("stribeck", "torque-constant"),
    ("air-drag", "wear-drift"),
    ("presliding", "tension-curvature"),
    ("cable-weight", "pulley-count-curvature"),
    ("length-scale", "viscous"),
    ("mass-error", "wear-drift"),
    ("runout", "viscous"),
)
FIRST_SEED = 1000


def cases():
    """Return the effects and the seed of every case, by name."""
    seeds = count(FIRST_SEED)
    found = {
        f"{name}-{strength:g}": ({name: strength}, next(seeds))
        for strength in STRENGTHS
        for name in all_effects()
    }
    found |= {"+".join(pair): (dict.fromkeys(pair, 1.0), next(seeds)) for pair in PAIRS}
    return found


def null_case(seed):
    """Diagnose a recording of the paper's law."""
    found = diagnose(simulate_recording("quick", seed=seed)).summary
    return {"seed": seed, "verdict": found.verdict, "probability": found.verdict_probability}


def case(given):
    """Diagnose a recording with effects; say what was found, and whether it is right."""
    effects, seed = given
    recording = simulate_recording("quick", seed=seed, effects=effects)
    found = diagnose(recording).summary
    twins = [set(one.effects) for one in found.unseparated if one.reason.startswith("identical")]
    named = [cause.effect for cause in found.causes]

    def stands_for(name, cause):
        return name == cause or any({name, cause} <= alike for alike in twins)

    right = found.verdict == "named" and len(named) == len(effects)
    right = right and all(any(stands_for(name, cause) for cause in named) for name in effects)
    acted = recording.metadata["simulation"]["truth"]["effects"]
    truth = {one["name"]: one["parameters"] for one in acted}
    covered = {
        f"{cause.effect}.{name}": bool(five.q05 <= truth[cause.effect][name] <= five.q95)
        for cause in found.causes
        if cause.effect in truth
        for name, five in cause.parameters.items()
    }
    return {
        "effects": effects,
        "seed": seed,
        "verdict": found.verdict,
        "causes": sorted(named),
        "probability": found.verdict_probability,
        "right": bool(right),
        "covered": covered,
        "shrink": None if found.gap.shrink is None else found.gap.shrink.q50,
    }
