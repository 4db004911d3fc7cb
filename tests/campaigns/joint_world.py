"""Diagnoses of joints that MuJoCo moves, with something withheld; see ``joint_worlds``.

The campaign that plays them is ``joint_rounds``.

A cause is right where it acts, or where the diagnosis itself says that it cannot tell the two
apart. What the law takes up all but a fiftieth of friction of, once it is fitted again, may go
unnamed. Half of the names of the catalogue, drawn by a hash, are sealed: nobody looks at them
before the figures of the other half stand.
"""

import hashlib
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations, count, islice

import numpy as np
from joint_worlds import simulator
from joint_worlds.arm import Machine

from bayesfric.blind.engines.reference import Withheld
from bayesfric.diagnosis import diagnose

FULL, WEAK = 1.0, 0.3
FIRST_SEED = 1
ALIKE = ({"hysteresis", "presliding"}, {"delay", "actuator-lag"})
CERTAIN = 0.9
GRAVITY = 9.81  # m/s²
PRACTICAL = 0.02  # of friction: a gap below it is none
CONTRADICTS = 0.1  # below the model's shrink, of a held-out one's whole interval
MOVES = {
    "direction-asymmetry": {"offset"},
    "gravity-torque": {"offset", "gravity"},
    "spring": {"offset", "gravity"},
    "thermal": {"coulomb", "viscous"},
}
"""Numbers of the law that an effect is a part of: their truth is not what was drawn for them.

Of warmth they are those at half of the way to the warmest, and of a law at the mean of a log."""


def is_sealed(name):
    """Tell whether an effect is of the half that nobody looks at."""
    return hashlib.sha256(f"joint {name}".encode()).digest()[0] % 2 == 1


def names(sealed):
    """Return the effects of one half of the catalogue."""
    return tuple(name for name in simulator.effect_names() if is_sealed(name) == sealed)


def _kinds(sealed) -> Iterator[tuple[str, tuple]]:
    """Yield what is withheld, without end: kinds take turns."""
    effects, outsiders = names(sealed), simulator.outsider_names()
    pairs = [pair for pair in combinations(effects, 2) if not any(set(pair) <= a for a in ALIKE)]
    for turn in count():
        for place, name in enumerate(effects):
            yield "effect", ((name, FULL),)
            if place % 2 == 0:
                yield "none", ()
            if place % 3 == 0:
                weak = effects[(place // 3 + turn * 4) % len(effects)]
                yield "effect", ((weak, WEAK),)
            if place % 6 == 1:
                yield "outsider", ((outsiders[(turn * 2 + place // 6) % len(outsiders)], FULL),)
            if place % 6 == 4:
                pair = pairs[(turn * 7 + place * 5) % len(pairs)]
                yield "pair", tuple((effect, FULL) for effect in pair)


def cases(number, design="perfect", sealed=False, first_seed=FIRST_SEED):
    """Return what is withheld in each case, and its seed, by name."""
    withheld_of = {}
    for place, (kind, effects) in enumerate(islice(_kinds(sealed), number)):
        seed = first_seed + place
        name = "+".join(effect for effect, _ in effects) or "none"
        weak = "-weak" if any(strength < FULL for _, strength in effects) else ""
        withheld_of[f"{name}{weak}-{seed}"] = (kind, effects, seed, design)
    return withheld_of


def made(given):
    """Return the recording of a case, and the truth about it."""
    kind, effects, seed, design = given
    return simulator.make(Withheld(kind, tuple(effects), "own"), seed, design=design)


def case(given):
    """Diagnose one case, and say what was named beside what acts."""
    case_made = made(given)
    truth = case_made.truth
    world = simulator.drawn_world(given[2], needs_of(given[1]), given[3])
    summary = diagnose(case_made.recording).summary
    joints = {diagnosed.joint or truth["joint"]: diagnosed for diagnosed in summary.joints} or {
        truth["joint"]: summary
    }
    acts = {withheld["name"] for withheld in truth["withheld"]} | set(truth["beside"])
    judged = {
        joint: judge(diagnosed, acts if joint == truth["joint"] else set(), given[0])
        for joint, diagnosed in joints.items()
    }
    own = judged.pop(truth["joint"])
    if truth["noise_free_gap"] < PRACTICAL and set(own["missing"]) <= {n for n, _ in given[1]}:
        own["exact"] = not own["wrong"]
    return own | {
        "kind": given[0],
        "withheld": [name for name, _ in given[1]],
        "strength": [strength for _, strength in given[1]],
        "seed": given[2],
        "knows": world.knows,
        "gap": truth["noise_free_gap"],
        "others_wrong": {
            joint: other["named"] for joint, other in judged.items() if other["wrong"]
        },
        "contradicts": [contradicts(diagnosed) for diagnosed in joints.values()],
        "numbers": numbers_of(joints[truth["joint"]], truths_of(world, truth, given[1])),
    }


def needs_of(effects):
    """Return what a world must have in which some effects act."""
    return frozenset().union(*(simulator.BY_NAME[name].needs for name, _ in effects))


def truths_of(world, truth, effects):
    """Return numbers of the joint looked at that are what was drawn for them, by name.

    Of a joint whose rigid bodies nobody knows the inertia is that of link and rotor.
    """
    arm, moved = world.arm, set().union(*(MOVES.get(name, set()) for name, _ in effects))
    truths = {name: truth["law"][name] for name in ("coulomb", "viscous", "offset")}
    if world.knows == "known-force":
        truths["inertia"] = truth["law"]["armature"]
    if world.knows == "model":
        truths["armature"] = truth["law"]["armature"]
    if world.knows == "nothing":
        bare = replace(arm, armature=(0.0,) * arm.joints)
        machine = Machine(bare, world.control, (), world.target, 0.0, 0.0)
        truths["inertia"] = float(machine.inertia()[0]) + arm.armature[0]
        if not arm.upright:
            truths["gravity"] = float(GRAVITY * arm.masses[0] * arm.lengths[0] / 2)
    return {name: value for name, value in truths.items() if name not in moved}


def numbers_of(summary, truths):
    """Return truth, ends of the 90 % interval and the median of each number that is told."""
    intervals = {name: number.after for name, number in summary.law.items()}
    for cause in summary.causes:
        if cause.effect == "gravity-torque" and "torque" in cause.parameters:
            intervals["gravity"] = cause.parameters["torque"]
    numbers = {}
    for name, truth in truths.items():
        if name in intervals:
            ends = intervals[name]
            sign = np.sign(ends.q50) if name == "gravity" else 1.0
            low, middle, high = sorted(
                float(sign * value) for value in (ends.q05, ends.q50, ends.q95)
            )
            numbers[name] = [truth, low, middle, high]
    return numbers


def contradicts(summary):
    """Return whether held-out data contradict what is named; None where nobody can say."""
    of_held_out, of_model = summary.gap.shrink, summary.gap.shrink_of_model
    if summary.verdict != "named" or of_held_out is None or of_model is None:
        return None
    return bool(of_held_out.q95 < of_model.q50 - CONTRADICTS)


def judge(summary, acts, kind):
    """Return what a diagnosis of one joint says beside what acts in it."""
    named = {cause.effect: cause.inclusion_probability for cause in summary.causes}
    twins = [
        set(group.effects) for group in summary.unseparated if group.reason.startswith("identical")
    ]
    classes = [*ALIKE, *twins]

    def stands_for(effect, other):
        return effect == other or any({effect, other} <= alike for alike in classes)

    wrong = [
        name
        for name, chance in named.items()
        if not any(stands_for(name, effect) for effect in acts) and chance >= CERTAIN
    ]
    missing = [effect for effect in acts if not any(stands_for(name, effect) for name in named)]
    left_open = {cause.effect for cause in (*summary.possible, *summary.considered)}
    left_open |= {name for group in summary.unseparated for name in group.effects}
    possible = all(any(stands_for(name, effect) for name in left_open) for effect in missing)
    exact = not missing and len(named) == len(acts) and not wrong
    if kind == "outsider":
        exact = not wrong and summary.verdict == "unknown"
    return {
        "verdict": summary.verdict,
        "named": named,
        "wrong": wrong,
        "exact": exact,
        "missing": missing,
        "possible": bool(missing) and possible,
        "sentence": summary.sentence,
    }
