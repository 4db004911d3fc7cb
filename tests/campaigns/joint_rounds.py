"""Joints as their logs are, diagnosed: drawn joints, arms, servos and the ladder of friction.

``joints`` are moved by MuJoCo, with counts, ripple, jitter, holds and a loop: a third has nothing
beside its law, the others an effect at 10 % or 3 % of friction, a pair, or an outsider. ``perfect``
are such joints too, logged without counts, ripple, jitter or holds. ``arms`` have joints that move
and are not in the log. Of ``servos`` commands alone are logged. ``ladder`` are joints with friction
of M1 to M6; every fifth lifts one load one way, so that nobody can tell.

``python -m campaigns.joint_rounds PART FIRST LAST`` plays places FIRST to LAST − 1 of one part,
and writes the evidence of all that is done; ``python -m campaigns.release joint_rounds`` plays all
that is left. With ``--base SEED`` other joints are played, and nothing is written.
"""

import argparse
import hashlib
import json
import sys
import tempfile
from dataclasses import replace
from itertools import count, islice
from pathlib import Path

import numpy as np
from campaigns import evidence, joint_world, servos
from campaigns.evidence import Gathered
from campaigns.promises import Outcome, rate
from joint_worlds import simulator
from rigs import ladder
from scipy.stats import binomtest

from bayesfric.blind.engines.reference import Withheld
from bayesfric.campaign import run_on_processes
from bayesfric.diagnosis import diagnose
from bayesfric.effects import all_effects
from bayesfric.errors import InputError

FINGERPRINT = ("effects", "likelihood.axis", "diagnosis.axis", "whole.axis")
BASES = {"joints": 25000, "arms": 26000, "servos": 27000, "ladder": 28000, "perfect": 29000}
NUMBER = 60  # of each part
REAL, PERFECT = "real", "perfect"
ACTING = 20  # joints with something beside the law, of which these are other than one effect:
WEAK, OUTSIDE, PAIRS, APART = (3, 9, 14, 18), (6, 16), (11,), 7
NUMBERS = ("coulomb", "viscous", "inertia", "armature", "gravity", "offset")
HOLD = (0.85, 0.95)  # share of truths in 90 % intervals
ONE_LOAD = {"runs": 3, "seconds": 8.0, "lifts_alone": True}
CANNOT_TELL = "one way at each pose"


def shuffled(base):
    """Return all effects in an order of a base's own."""
    return sorted(
        simulator.effect_names(),
        key=lambda name: hashlib.sha256(f"{base}{name}".encode()).digest(),
    )


def withheld_of(place, base):
    """Return the kind of a joint, and its effects with their strengths."""
    if place % 3 == 0:
        return "none", ()
    effects, outsiders = shuffled(base), simulator.outsider_names()
    number = place - place // 3 - 1
    turn, effect = number % ACTING, effects[number % len(effects)]
    if turn in OUTSIDE:
        return "outsider", ((outsiders[(turn + base) % len(outsiders)], joint_world.FULL),)
    if turn in WEAK:
        return "effect", ((effect, joint_world.WEAK),)
    other = effects[(turn + APART) % len(effects)]
    if turn in PAIRS and not any({effect, other} <= alike for alike in joint_world.ALIKE):
        return "pair", ((effect, joint_world.FULL), (other, joint_world.FULL))
    return "effect", ((effect, joint_world.FULL),)


def joint(place, base, design=REAL):
    """Diagnose a joint that MuJoCo moves."""
    kind, effects = withheld_of(place, base)
    return joint_world.case((kind, effects, base + place, design))


def perfect(place, base):
    """Diagnose a joint that MuJoCo moves, of which signals are logged as they are."""
    return joint(place, base, PERFECT)


def arm(place, base):
    """Diagnose one joint of an arm whose other joints move and are not in the log."""
    seeds = (seed for seed in count(base) if _is_an_arm(seed))
    seed = next(islice(seeds, place, None))
    free = [name for name in shuffled(base) if not simulator.BY_NAME[name].needs]
    effects = () if place % 3 == 0 else ((free[place % len(free)], joint_world.FULL),)
    kind = "effect" if effects else "none"
    made = simulator.make(Withheld(kind, effects, "own"), seed, design=REAL)
    recording, joint_name = made.recording, made.truth["joint"]
    samples = recording.axis.samples
    alone = samples[samples["joint"] == joint_name].reset_index(drop=True)
    others = "moving" if place % 2 else "unknown"
    summary = diagnose(
        replace(
            recording,
            rig=replace(recording.rig, robot=None, other_joints=others),
            axis=replace(recording.axis, samples=alone),
        )
    ).summary
    # What a link weighs acts on any of them.
    acts = {withheld["name"] for withheld in made.truth["withheld"]} | {"gravity-torque"}
    judged = joint_world.judge(summary, acts, kind)
    return judged | {
        "seed": seed,
        "withheld": [name for name, _ in effects],
        "other_joints": others,
        "contradicts": [joint_world.contradicts(summary)],
    }


def _is_an_arm(seed):
    world = simulator.drawn_world(seed, frozenset(), REAL)
    return world.knows in ("others", "model") and world.arm.joints > 1


def servo(place, base):
    """Diagnose a servo of which commands alone are logged."""
    return servos.case(base + place)


def rung(place, base):
    """Diagnose a joint with friction of a rung of the ladder."""
    name, one_way = list(ladder.RUNGS)[place % len(ladder.RUNGS)], place % 5 == 4
    logged = ONE_LOAD if one_way else {}
    summary = diagnose(ladder.drawn(name, base + place, **logged).recording()).summary
    named = {cause.effect for cause in summary.causes}
    left_open = {cause.effect for cause in (*summary.possible, *summary.considered)}
    left_open |= {effect for group in summary.unseparated for effect in group.effects}
    by_load = {name for name, effect in all_effects(None).items() if effect.ladder}
    is_told = bool(ladder.RUNGS[name] & (named | left_open))
    if not ladder.RUNGS[name]:
        is_told = named <= {"gravity-torque"}
    return {
        "seed": base + place,
        "rung": name,
        "one_way": one_way,
        "verdict": summary.verdict,
        "named": sorted(named),
        "left_open": sorted(left_open),
        "told": is_told,
        "cannot_tell": not named & by_load and any(CANNOT_TELL in x for x in summary.attention),
        "sentence": summary.sentence,
    }


PARTS = {"joints": joint, "perfect": perfect, "arms": arm, "servos": servo, "ladder": rung}


def case(given):
    """Play one case: of a part, at a place, from a seed on."""
    part, place, base = given
    row = {"part": part, "place": place}
    try:
        return row | PARTS[part](place, base)
    except InputError as error:  # a machine that ran away: no joint moves by thousands of turns
        return row | {"refused": str(error)}


def cases(part, first=0, last=NUMBER, base=None):
    """Return the cases of a part, from a place to before another, by name."""
    seed = BASES[part] if base is None else base
    return {f"{part}-{seed}-{place:03d}": (part, place, seed) for place in range(first, last)}


def everything():
    """Return all cases, by name."""
    return {name: given for part in PARTS for name, given in cases(part).items()}


def share(hits):
    """Return how many of some are so, of how many, and the interval of Wilson."""
    hits = [bool(hit) for hit in hits]
    if not hits:
        return {"hits": 0, "of": 0, "wilson": None}
    interval = binomtest(sum(hits), len(hits)).proportion_ci(0.95, method="wilson")
    return {
        "hits": sum(hits),
        "of": len(hits),
        "wilson": [float(interval.low), float(interval.high)],
    }


def of_joints(done):
    """Return the figures of joints."""
    acting = [row for row in done if row["kind"] in ("effect", "pair")]
    full = [row for row in acting if min(row["strength"]) == joint_world.FULL]
    weak = [row for row in acting if min(row["strength"]) < joint_world.FULL]
    by_kind = {kind: [row for row in done if row["kind"] == kind] for kind in ("none", "outsider")}
    numbers = {}
    for name in NUMBERS:
        intervals = [row["numbers"][name] for row in done if name in row["numbers"]]
        off = [abs(middle / truth - 1) for truth, _, middle, _ in intervals if truth]
        numbers[name] = share(low <= truth <= high for truth, low, _, high in intervals)
        numbers[name]["median_off"] = float(np.median(off)) if off else None
        numbers[name]["outside"] = [
            row["seed"]
            for row in done
            if name in row["numbers"] and not _holds(*row["numbers"][name])
        ]
    return {
        "exact": share(row["exact"] and not row["others_wrong"] for row in full),
        "exact_or_possible": share(
            (row["exact"] or row["possible"]) and not row["wrong"] for row in full
        ),
        "weak_named_or_possible": share(
            (row["exact"] or row["possible"]) and not row["wrong"] for row in weak
        ),
        "wrongly_named": share(is_wrong(row) for row in acting),
        "empty_named": share(is_wrong(row) for row in by_kind["none"]),
        "outsiders_named": share(is_wrong(row) for row in by_kind["outsider"]),
        "contradicted": of_the_gate(done),
        "numbers": numbers,
        "wrong": {str(row["seed"]): row["named"] for row in done if is_wrong(row)},
    }


def _holds(truth, low, _, high):
    return low <= truth <= high


def is_wrong(row):
    """Return whether anything was named that does not act, in any joint of a log."""
    return bool(row["wrong"] or row.get("others_wrong"))


def of_the_gate(done):
    """Return how many named verdicts held-out data contradict, of those that they can judge."""
    return share(value for row in done for value in row["contradicts"] if value is not None)


def of_arms(done):
    """Return the figures of arms."""
    return {
        "wrongly_named": share(is_wrong(row) for row in done),
        "contradicted": of_the_gate(done),
        "wrong": {str(row["seed"]): row["named"] for row in done if is_wrong(row)},
    }


def of_servos(done):
    """Return the figures of servos."""
    numbers = {name: share(servos.inside(done, name)) for name in servos.NAMES}
    return {
        "numbers": numbers,
        "relative": share(row["relative"] for row in done if not row["loaded"]),
        "absolute": share(row["absolute"] for row in done if row["loaded"]),
        "false": share(bool(row["false"]) for row in done),
    }


def of_ladder(done):
    """Return the figures of joints of the ladder."""
    both = [row for row in done if not row["one_way"]]
    return {
        "named_or_possible": share(row["told"] for row in both),
        "cannot_tell": share(row["cannot_tell"] for row in done if row["one_way"]),
        "missed": {
            str(row["seed"]): [row["rung"], row["named"]] for row in both if not row["told"]
        },
    }


FIGURES = {
    "joints": of_joints,
    "perfect": of_joints,
    "arms": of_arms,
    "servos": of_servos,
    "ladder": of_ladder,
}


def figures(done):
    """Return the figures of each part of which there is a case."""
    played = [row for row in done if "refused" not in row]
    of_part = {part: [row for row in played if row["part"] == part] for part in PARTS}
    refused = {f"{row['part']} {row['place']}": row["refused"] for row in done if "refused" in row}
    return {part: FIGURES[part](rows) for part, rows in of_part.items() if rows} | {
        "refused": refused
    }


def gathered(done):
    """Return what is done as evidence."""
    return Gathered(
        seeds=[min(BASES.values()), max(BASES.values()) + NUMBER - 1],
        figures=figures(list(done.values())),
        cases=done,
        complete=done.keys() == everything().keys(),
    )


def gather(folder):
    """Run the campaign: all that is left of every part."""
    return gathered(run_on_processes(case, everything(), folder, workers=2))


def promises(figures):
    """Return what was promised beside what was found, of the parts that were played."""
    asked = {
        ("joints", "exact"): ("an effect at 10 % is named, and nothing else", 0.95, None),
        ("joints", "weak_named_or_possible"): ("at 3 % it is named or possible", 0.85, None),
        ("joints", "empty_named"): ("an empty joint has something named", None, 0),
        ("joints", "outsiders_named"): ("an outsider is named as an effect", None, 0),
        ("joints", "contradicted"): ("held-out data contradict what is named", None, 0.02),
        ("perfect", "exact"): ("perfect: at 10 % it is named, and nothing else", 0.95, None),
        ("perfect", "weak_named_or_possible"): ("at 3 % it is named or possible", 0.85, None),
        ("perfect", "empty_named"): ("an empty joint has something named", None, 0),
        ("perfect", "outsiders_named"): ("an outsider is named as an effect", None, 0),
        ("arms", "wrongly_named"): ("beside joints that nobody logged: a wrong cause", None, 0),
        ("servos", "relative"): ("without a payload all is over K", 1, None),
        ("servos", "absolute"): ("with one all is in newton metres", 1, None),
        ("servos", "false"): ("a servo has a false name", None, 0),
        ("ladder", "named_or_possible"): ("the rung is named or possible", 0.9, None),
        ("ladder", "cannot_tell"): ("one load, one way: it cannot tell", 1, None),
    }
    outcomes: list[Outcome] = []
    for (part, name), (words, least, most) in asked.items():
        of_part = figures.get(part, {}).get(name, {"of": 0})
        if of_part["of"]:
            outcomes.append(rate(words, of_part["hits"], of_part["of"], least=least, most=most))
    for part in ("joints", "perfect", "servos"):
        for name, of_part in figures.get(part, {}).get("numbers", {}).items():
            if of_part["of"]:
                words = f"{part}: truths of {name} in 90 % intervals"
                held = rate(words, of_part["hits"], of_part["of"], least=HOLD[0], most=HOLD[1])
                outcomes.append(held)
    return outcomes


def main():
    """Play some places of one part; write the evidence of all that is done, or print figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=PARTS)
    parser.add_argument("first", type=int, help="place, from 0 on")
    parser.add_argument("last", type=int, help="place before which it ends")
    parser.add_argument("--base", type=int, help="seed of other joints, of which none is written")
    parser.add_argument("--workers", type=int, default=2)
    asked = parser.parse_args()
    some = cases(asked.part, asked.first, asked.last, asked.base)
    if asked.base is not None:
        with tempfile.TemporaryDirectory() as folder:
            done = run_on_processes(case, some, Path(folder), asked.workers)
        sys.stdout.write(json.dumps(figures(list(done.values())), indent=1) + "\n")
        return
    module = evidence.campaign_of("joint_rounds")
    folder = evidence.work("joint_rounds", module)
    run_on_processes(case, some, folder, asked.workers)
    there = {name: given for name, given in everything().items() if _is_done(folder, name)}
    done = run_on_processes(case, there, folder, asked.workers)
    evidence.write("joint_rounds", module, module.gathered(done))


def _is_done(folder, name):
    return (folder / f"{name}.json").is_file()


if __name__ == "__main__":
    main()
