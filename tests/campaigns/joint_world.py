"""Diagnoses of joints that MuJoCo moves, with something withheld; see ``joint_worlds``.

A cause is right where it acts, or where the diagnosis itself says that it cannot tell the two
apart. What the law takes up all but a fiftieth of friction of, once it is fitted again, may go
unnamed. Half of the names of the catalogue, drawn by a hash, are sealed: nobody looks at them
before the figures of the other half stand.
"""

import hashlib
from collections.abc import Iterator
from itertools import combinations, count, islice

from campaigns.evidence import Gathered
from campaigns.promises import rate
from joint_worlds import simulator
from scipy.stats import binomtest

from bayesfric.blind.engines.reference import Withheld
from bayesfric.campaign import run_on_processes
from bayesfric.diagnosis import diagnose

FINGERPRINT = ("effects", "likelihood.axis", "diagnosis.axis", "whole.axis")
FULL, WEAK = 1.0, 0.3
FIRST_SEED = 1
ALIKE = ({"hysteresis", "presliding"}, {"delay", "actuator-lag"})
CERTAIN = 0.9
PRACTICAL = 0.02  # of friction: a gap below it is none
NUMBER = {"perfect": 60, "real": 60}
FIXED = ("none-2", "spring-10", "delay-17")


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
    law = joints[truth["joint"]].law
    return own | {
        "kind": given[0],
        "withheld": [name for name, _ in given[1]],
        "strength": [strength for _, strength in given[1]],
        "seed": given[2],
        "knows": truth["world"]["knows"],
        "gap": truth["noise_free_gap"],
        "others_wrong": {
            joint: other["named"] for joint, other in judged.items() if other["wrong"]
        },
        "law": {
            name: [truth["law"][name], value.after.mean, value.after.q05, value.after.q95]
            for name, value in law.items()
            if name in truth["law"]
        },
    }


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


def figures(judged):
    """Return how many cases are right, of those that are there.

    Parameters
    ----------
    judged : list of dict
        As of :func:`case`.
    """
    acting = [row for row in judged if row["kind"] in ("effect", "pair")]
    full = [row for row in acting if min(row["strength"]) == FULL]
    weak = [row for row in acting if row["kind"] == "effect" and min(row["strength"]) < FULL]
    empty = [row for row in judged if row["kind"] == "none"]
    outsiders = [row for row in judged if row["kind"] == "outsider"]
    exact = sum(row["exact"] and not row["others_wrong"] for row in full)
    interval = binomtest(exact, max(len(full), 1)).proportion_ci(0.95)
    return {
        "exact": exact,
        "of": len(full),
        "interval": [interval.low, interval.high],
        "possible": sum(not row["exact"] and row["possible"] for row in full),
        "wrongly_named": sum(bool(row["wrong"] or row["others_wrong"]) for row in full),
        "weak_named_or_possible": sum(
            (row["exact"] or row["possible"]) and not row["wrong"] for row in weak
        ),
        "of_weak": len(weak),
        "empty_named": sum(bool(row["wrong"] or row["others_wrong"]) for row in empty),
        "of_empty": len(empty),
        "outsiders_named": sum(bool(row["wrong"]) for row in outsiders),
        "outsiders_unknown": sum(row["exact"] for row in outsiders),
        "of_outsiders": len(outsiders),
    }


def gather(folder):
    """Run the campaign: both halves of the catalogue, perfect signals and real ones."""
    whole = {
        f"{design}-{half}-{name}": given
        for design, number in NUMBER.items()
        for half, sealed in (("open", False), ("sealed", True))
        for name, given in cases(number, design, sealed).items()
    }
    done = run_on_processes(case, whole, folder, workers=2)

    def of(start):
        return figures([row for name, row in done.items() if name.startswith(start)])

    starts = [f"{design}-{half}-" for design in NUMBER for half in ("open", "sealed")]
    return Gathered(
        seeds=[FIRST_SEED, FIRST_SEED + max(NUMBER.values()) - 1],
        figures={start.rstrip("-"): of(start) for start in starts},
        cases=list(done.values()),
        fixed={name: done[f"perfect-open-{name}"] for name in FIXED},
    )


def promises(figures):
    """Return what was promised beside what was found."""
    promised = []
    for which, counts in figures.items():
        promised += [
            rate(
                f"{which}: an effect is named, and nothing else",
                counts["exact"],
                counts["of"],
                least=0.95,
            ),
            rate(
                f"{which}: an empty joint has something named",
                counts["empty_named"],
                counts["of_empty"],
                most=0,
            ),
            rate(
                f"{which}: an outsider is named as an effect",
                counts["outsiders_named"],
                counts["of_outsiders"],
                most=0,
            ),
            rate(
                f"{which}: at 3 % it is named or possible",
                counts["weak_named_or_possible"],
                counts["of_weak"],
                least=0.85,
            ),
        ]
    return promised
