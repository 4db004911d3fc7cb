"""Rules of a diagnosis: figures that go together, and a verdict that follows from them."""

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from bayesfric.diagnosis_rules import RULES
from bayesfric.hypothesis import UNKNOWN, parsed
from bayesfric.invariants.common import ROUNDING, SHARES, Rule, rule

FAR = 1.5  # times what is measured before, beyond which a systematic gap contradicts it
UNLISTED = 1e-3  # probability of hypotheses too rare to be listed
ROUND = "rotation_angle"
"""The axis of what begins otherwise in each trial: windows of data held out do not show it."""


DIAGNOSIS: dict[str, Rule] = {}
"""Rules of ``diagnosis.json``, by name."""


@rule(DIAGNOSIS, "Probabilities of hypotheses add up to 1.")
def _hypotheses_add_up_to_1(record: Mapping[str, Any]) -> list[str]:
    chances = {"probabilities": record["probabilities"]}
    for prior, by_hypothesis in record["prior_sensitivity"].items():
        if len(by_hypothesis) >= len(record["probabilities"]):
            chances[f"prior_sensitivity.{prior}"] = by_hypothesis
    wrong = []
    for place, by_hypothesis in chances.items():
        whole = math.fsum(by_hypothesis.values())
        if any(not 0 <= chance <= 1 for chance in by_hypothesis.values()):
            wrong.append(f"{place} has a probability outside of 0 to 1")
        if abs(whole - 1) > ROUNDING:
            wrong.append(f"{place} add up to {whole:.12g}")
    return wrong


@rule(
    DIAGNOSIS,
    "Each axis in `where` has a share of the mean square of the systematic force. Each share lies "
    "between 0 and 1. Together with `unexplained` the shares add up to 1.",
)
def _shares_add_up_to_1(record: Mapping[str, Any]) -> list[str]:
    wrong, sums = [], []
    for axis in record["where"]:
        share = axis.get("share")
        if not isinstance(share, Mapping):
            continue
        sums.append(float(share["mean"]))
        if any(not -SHARES <= float(share[key]) <= 1 + SHARES for key in ("mean", "q05", "q95")):
            wrong.append(f"the share of {axis['axis']} is {share['mean']:.4g}")
    if not sums:
        return wrong
    rest = record.get("unexplained")
    whole = math.fsum(sums) + (float(rest["mean"]) if isinstance(rest, Mapping) else 0.0)
    if whole > 1 + SHARES or (isinstance(rest, Mapping) and whole < 1 - SHARES):
        wrong.append(f"shares along axes add up to {whole:.8g}")
    return wrong


@rule(
    DIAGNOSIS,
    "The estimated systematic gap is not much larger than the rms residual that the law without "
    "the causes leaves in held-out data. If the rms of scatter is larger than this residual, the "
    "gap is compared with the scatter.",
)
def _gap_is_measured(record: Mapping[str, Any]) -> list[str]:
    gap = record["gap"]
    systematic, before, floor = gap["systematic"], gap["before"], gap["floor"]
    if systematic["q50"] < RULES.unresolved * (gap.get("friction_rms") or 0.0):
        return []
    # By chance as much may be taken off the squares before as scatter makes.
    most, middle = (max(before[key], floor[key]) for key in ("q95", "q50"))
    shown = math.sqrt(max(1 - _share_along(record, ROUND), 0.0))
    if shown * systematic["q05"] > most and shown * systematic["q50"] > FAR * middle:
        return [
            f"a systematic gap of {systematic['q50']:.3g} {gap['unit']} stands beside "
            f"{before['q50']:.3g} {gap['unit']} on data held out"
        ]
    return []


def _share_along(record: Mapping[str, Any], name: str) -> float:
    """Return which part of the squared gap lies along an axis; 0 where that is not known."""
    shares = (axis["share"] for axis in record["where"] if axis["axis"] == name)
    return sum(float(share["mean"]) for share in shares if share is not None)


@rule(
    DIAGNOSIS,
    "A shrink (the part of the gap that the causes remove) is reported only where the gap is "
    "above the error of a perfect law (the floor) with probability 0.95. The shrink is at most "
    "1.2.",
)
def _shrink_of_a_gap(record: Mapping[str, Any]) -> list[str]:
    gap = record["gap"]
    rows = {f"held_out.{row['name']}": row for row in gap["held_out"]}
    rows["in_sample"] = gap["in_sample"]
    if gap["trajectory"] is not None:
        rows["trajectory"] = gap["trajectory"]
    if gap["held_out"]:
        rows["gap"] = {**gap, "below_floor": gap["held_out"][0]["below_floor"]}
    wrong = []
    for name, row in rows.items():
        shrink = row["shrink"]
        if shrink is None:
            continue
        if 1 - row["below_floor"] < RULES.above_floor - ROUNDING:
            above = 1 - row["below_floor"]
            wrong.append(f"{name} shrinks, and is above its floor with {above:.2f} only")
        if shrink["q50"] > RULES.most_shrink + ROUNDING:
            wrong.append(f"{name} shrinks by {shrink['q50']:.3g} of itself")
    return wrong


@rule(DIAGNOSIS, "The remainder is significant only if its Bayes factor favours a further force.")
def _remainder_by_evidence(record: Mapping[str, Any]) -> list[str]:
    left = record["remainder"]
    if left["significant"] and left["log10_bayes_factor"] <= 0:
        return [f"a remainder is significant at a log10 factor of {left['log10_bayes_factor']:.3g}"]
    return []


@rule(
    DIAGNOSIS,
    "The verdict and its probability follow from the probabilities of the hypotheses and of the "
    "gap.",
)
def _verdict_follows(record: Mapping[str, Any]) -> list[str]:
    kind, chance = record["verdict"], record["verdict_probability"]
    chances, above = parsed(record["probabilities"]), record["gap"]["probability_above_practical"]
    unknown, wrong = chances.get(UNKNOWN, 0.0), []
    causes = {cause["effect"] for cause in record["causes"]}
    rivals = [pair for pair in record["unseparated"] if pair["reason"] == "these-data"]
    no_gap = above <= 1 - RULES.sure + ROUNDING
    if no_gap and kind not in ("no-gap", "undecided"):
        wrong.append(f"it is {kind} where a gap is there with {above:.3g} only")
    if kind == "no-gap" and not no_gap:
        wrong.append(f"it is no-gap where a gap is there with {above:.3g}")
    if kind == "unknown" and unknown < RULES.likely:
        wrong.append(f"it is unknown where an unknown force acts with {unknown:.3g} only")
    if unknown >= RULES.likely and not no_gap and kind not in ("unknown", "undecided"):
        wrong.append(f"it is {kind} where an unknown force acts with {unknown:.3g}")
    if kind in ("named", "unseparated") and above < RULES.sure:
        wrong.append(f"it is {kind} where a gap is there with {above:.3g} only")
    if kind == "named" and not causes:
        wrong.append("it is named and names no cause")
    if kind == "unseparated" and not rivals:
        wrong.append("it is unseparated and tells no rivals")
    stated = {
        "no-gap": 1 - above,
        "unknown": unknown,
        "named": math.fsum(p for acting, p in chances.items() if causes <= acting),
    }.get(kind)
    if stated is not None and abs(stated - chance) > UNLISTED:
        wrong.append(f"it states {chance:.4g} where the probabilities say {stated:.4g}")
    return wrong


@rule(
    DIAGNOSIS,
    "A cause or a present effect acts with a probability of at least 0.9, a possible effect of "
    "at least 0.1.",
)
def _causes_act(record: Mapping[str, Any]) -> list[str]:
    bounds = {
        "causes": (RULES.sure, 1.0),
        "present": (RULES.sure, 1.0),
        "possible": (RULES.possible, RULES.sure),
    }
    wrong = []
    for kind, (least, most) in bounds.items():
        for effect in record[kind]:
            chance = effect["inclusion_probability"]
            if not least - ROUNDING <= chance <= most + ROUNDING:
                wrong.append(f"{effect['effect']} of {kind} acts with {chance:.3g}")
    return wrong


@rule(
    DIAGNOSIS,
    "The probability that an effect acts is the sum over all hypotheses with this effect.",
)
def _inclusion_follows(record: Mapping[str, Any]) -> list[str]:
    wrong, hypotheses = [], parsed(record["probabilities"])
    for effect in record["inclusion"]:
        name, chance = effect["effect"], effect["probability"]
        whole = math.fsum(p for acting, p in hypotheses.items() if name in acting)
        if abs(whole - chance) > UNLISTED:
            wrong.append(f"{name} acts with {chance:.4g}, and its hypotheses have {whole:.4g}")
    return wrong


@rule(DIAGNOSIS, "The force limit of a drive lies above the friction that the drive overcomes.")
def _drive_limit_above_friction(record: Mapping[str, Any]) -> list[str]:
    friction = record["law"].get("coulomb")
    if friction is None:
        return []
    wrong = []
    for effect in _effects(record, ("causes", "present")):
        limit = effect["parameters"].get("limit")
        if limit is not None and limit["q95"] < friction["after"]["q05"]:
            wrong.append(
                f"{effect['effect']} has a limit of {limit['q50']:.3g} {limit['unit']} below "
                f"friction of {friction['after']['q50']:.3g}"
            )
    return wrong


@rule(DIAGNOSIS, "Root mean squares, strengths and scatter are not negative.")
def _sizes_above_0(record: Mapping[str, Any]) -> list[str]:
    gap = record["gap"]
    numbers = {"gap.friction_rms": gap["friction_rms"]}
    numbers |= {f"scatter.{name}": value for name, value in record["scatter"].items()}
    for name in ("before", "after", "floor", "systematic"):
        numbers[f"gap.{name}"] = gap[name]["q05"]
    for effect in _effects(record, ("causes", "present", "possible", "considered")):
        numbers[f"strength of {effect['effect']}"] = effect["strength"]
    return [f"{name} is {value:.3g}" for name, value in numbers.items() if value < 0]


@rule(DIAGNOSIS, "The curve along an axis lies within its band.")
def _curves_within_bands(record: Mapping[str, Any]) -> list[str]:
    wrong = []
    for axis in record["where"]:
        shape = axis.get("shape")
        if shape is None:
            continue
        rows = zip(shape["low_n"], shape["gap_n"], shape["high_n"], strict=True)
        if any(not low <= middle <= high for low, middle, high in rows):
            wrong.append(f"the curve along {axis['axis']} leaves its band")
    return wrong


def _effects(record: Mapping[str, Any], kinds: Iterable[str]) -> Iterator[Mapping[str, Any]]:
    return (effect for kind in kinds for effect in record.get(kind, ()))
