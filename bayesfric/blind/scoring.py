"""The score of a verdict, once the envelope is open."""

from collections.abc import Collection, Mapping, Sequence
from itertools import permutations
from typing import Any

from bayesfric.hypothesis import NONE, UNKNOWN, Hypothesis, parsed
from bayesfric.probabilities import total
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.scorecard import ScoredCase

NO_CLAIM = ("no-gap", "undecided")
"""Verdicts that claim no gap."""
BETS_ON_GAP_FROM = 0.5  # probability of a practical gap above which `undecided` bets on a gap
FLAG_SHARE = 0.1  # share of the gap: an outsider is flagged if a remainder's 5 % quantile is larger
OTHERS = "other-combination"
"""Column of verdicts with several effects that are not the withheld pair."""
LAWS_OF_FORMS = {
    ("air-drag", "drag"): "quadratic",
    ("cable-weight", "off-centre"): "passing",
    ("end-asymmetry", "constant"): "constant-part",
    ("fixed-drag", "applied_n"): "constant",
    ("magnet-spacing", "any-places"): "waves",
    ("pulley-count-curvature", "applied_n"): "power",
    ("pulley-inertia", "armature_kg"): "same",
    ("tension-curvature", "applied_n"): "quadratic",
    ("viscous", "damping"): "constant",
    ("viscous", "with-tension"): "tension",
    ("viscous", "with-wrap"): "wrap",
    ("wear-drift", "applied_n"): "exponential",  # a straight line is its limit
    ("wear-drift", "linear"): "exponential",
    ("wear-drift", "saturating"): "exponential",
    ("wrap-curvature", "applied_n"): "quadratic",
}
"""Law of the diagnosis by effect and form, if an engine has another name for the form."""


def score(
    public: Mapping[str, Any],
    truth: Mapping[str, Any],
    diagnosis: DiagnosisFile,
    *,
    effect_names: Collection[str],
    gap: float | None = None,
    true_shrink: float | None = None,
    oracle_power: float | None = None,
) -> ScoredCase:
    """Compare a verdict with the truth.

    A case counts as ``none`` if nothing is withheld, or if the withheld effects leave less than
    ``practical_share`` after the baseline is refitted. Then ``no-gap`` and ``undecided`` are
    correct if they list no absent cause, and naming the withheld effects is correct too. An effect
    is named if the causes are exactly the withheld effects, or effects that the diagnosis itself
    calls identical to them on this rig. An effect that the diagnosis does not know is flagged by
    ``unknown``, or by a significant remainder on a true axis.

    Parameters
    ----------
    public : mapping
        ``name``, ``seed``, ``engine``, ``design`` and ``envelope_sha256`` of the case.
    truth : mapping
        ``withheld``: a list with ``name`` of each effect and, if known, its ``form``, ``own``,
        ``strength``, ``parameters`` and ``axes``.
    diagnosis : DiagnosisFile
        The verdict.
    effect_names : collection of str
        Effects that the diagnosis examines.
    gap : float or None
        Noise-free gap over rms friction, after the baseline is refitted; None if unknown, as
        for a user's recording.
    true_shrink : float or None
        Share of the squared noise-free gap that the named causes remove; None if unknown.
    oracle_power : float or None
        Power of the best test that knows the withheld effects; None if unknown.
    """
    withheld: Sequence[Mapping[str, Any]] = truth["withheld"]
    names = [str(effect["name"]) for effect in withheld]
    kind = _kind(names, effect_names)
    as_none = not names or (gap is not None and gap < diagnosis.practical_share)
    named = diagnosis.verdict == "named" and kind != "outsider" and _is_named(names, diagnosis)
    flagged = diagnosis.verdict == "unknown" or _remainder_flags(withheld, diagnosis)
    rightly_open = as_none and diagnosis.verdict in NO_CLAIM and _all_act(names, diagnosis)
    return ScoredCase(
        **{key: public[key] for key in ("name", "seed", "engine", "design", "envelope_sha256")},
        **_of_truth(withheld),
        **_of_diagnosis(withheld, diagnosis, true_shrink, named),
        kind=kind,
        noise_free_gap=gap,
        oracle_power=oracle_power,
        counts_as_none=as_none,
        outcome=_outcome(names, kind, named, diagnosis),
        correct=named or rightly_open or (kind == "outsider" and flagged),
        came_true=_came_true(names, kind, as_none, diagnosis),
        truth_probability=_truth_probability(names, kind, as_none, diagnosis),
        flagged=flagged,
    )


def _of_truth(withheld: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the fields on the withheld effects."""
    return {
        "withheld": tuple(str(effect["name"]) for effect in withheld),
        "form": tuple(str(effect.get("form", "")) for effect in withheld),
        "own": all(effect.get("own", False) for effect in withheld) if withheld else None,
        "strength": {str(e["name"]): float(e["strength"]) for e in withheld if "strength" in e},
    }


def _of_diagnosis(
    withheld: Sequence[Mapping[str, Any]],
    diagnosis: DiagnosisFile,
    true_shrink: float | None,
    named: bool,
) -> dict[str, Any]:
    """Return the fields on the diagnosis; `named`: whether it names the withheld effects."""
    shrink, covered = diagnosis.gap.shrink_of_model, None
    if named and shrink is not None and true_shrink is not None:
        covered = shrink.q05 <= true_shrink <= shrink.q95
    return {
        "verdict": diagnosis.verdict,
        "causes": tuple(cause.effect for cause in diagnosis.causes),
        "probability": diagnosis.verdict_probability,
        "falsely_named": diagnosis.verdict == "named" and not named,
        "remainder_significant": diagnosis.remainder.significant,
        "shrink": shrink,
        "shrink_why": None if shrink is not None else diagnosis.gap.shrink_of_model_why,
        "true_shrink": true_shrink,
        "shrink_covered": covered,
        "parameters_covered": _covered(withheld, diagnosis) if named else {},
    }


def _kind(names: Sequence[str], effect_names: Collection[str]) -> str:
    if not names:
        return "none"
    if any(name not in effect_names for name in names):
        return "outsider"
    return "effect" if len(names) == 1 else "pair"


def _twins(diagnosis: DiagnosisFile) -> list[set[str]]:
    return [
        set(inseparable.effects)
        for inseparable in diagnosis.unseparated
        if inseparable.reason == "identical-on-this-rig"
    ]


def _stands_for(name: str, cause: str, twins: Sequence[set[str]]) -> bool:
    """Return whether a cause is this effect, or was reported as identical to it on this rig."""
    return name == cause or any({name, cause} <= alike for alike in twins)


def _all_act(names: Sequence[str], diagnosis: DiagnosisFile) -> bool:
    """Return whether each cause stands for another one of the withheld effects."""
    causes, twins = [cause.effect for cause in diagnosis.causes], _twins(diagnosis)
    return any(
        all(_stands_for(name, cause, twins) for name, cause in zip(chosen, causes, strict=True))
        for chosen in permutations(names, len(causes))
    )


def _is_named(names: Sequence[str], diagnosis: DiagnosisFile) -> bool:
    return len(diagnosis.causes) == len(names) and _all_act(names, diagnosis)


def _came_true(names: Sequence[str], kind: str, as_none: bool, diagnosis: DiagnosisFile) -> bool:
    """Return whether the statement to which the verdict's probability belongs is true.

    ``named``: all its causes act, possibly with others. ``unseparated``: one of its sets acts.
    ``unknown``: a force acts that no effect has. ``no-gap``: the gap is below the practical share.
    ``undecided``: the gap is on the more probable side of the practical share.
    """
    if diagnosis.verdict == "named":
        return _all_act(names, diagnosis)
    if diagnosis.verdict == "unknown":
        return kind == "outsider"
    if diagnosis.verdict == "no-gap":
        return as_none
    if diagnosis.verdict == "undecided":
        return as_none is (diagnosis.gap.probability_above_practical < BETS_ON_GAP_FROM)
    twins = _twins(diagnosis)
    sets = [
        inseparable.effects
        for inseparable in diagnosis.unseparated
        if inseparable.reason == "these-data"
    ]
    return any(
        _stands_for(name, candidate, twins)
        for name in names
        for among in sets
        for candidate in among
    )


def _remainder_flags(withheld: Sequence[Mapping[str, Any]], diagnosis: DiagnosisFile) -> bool:
    axes = {str(axis) for effect in withheld for axis in effect.get("axes", ())}
    left = diagnosis.remainder
    share = left.share_of_gap
    return left.significant and left.axis in axes and share is not None and share.q05 > FLAG_SHARE


def _outcome(names: Sequence[str], kind: str, named: bool, diagnosis: DiagnosisFile) -> str:
    """Return the column of the confusion matrix."""
    if diagnosis.verdict == "no-gap":
        return "none"
    if diagnosis.verdict in ("unknown", "unseparated", "undecided"):
        return diagnosis.verdict
    if named:
        return names[0] if kind == "effect" else "pair"
    causes = [cause.effect for cause in diagnosis.causes]
    return causes[0] if len(causes) == 1 else OTHERS


def _truth_probability(
    names: Sequence[str], kind: str, as_none: bool, diagnosis: DiagnosisFile
) -> float:
    """Return the posterior probability of the hypothesis that is true."""
    chances = parsed(diagnosis.probabilities)
    if as_none:
        return chances.get(NONE, 0.0)
    if kind == "outsider":
        return chances.get(UNKNOWN, 0.0)
    twins = _twins(diagnosis)

    def is_true(hypothesis: Hypothesis) -> bool:
        return len(hypothesis) == len(names) and all(
            any(_stands_for(name, effect, twins) for effect in hypothesis) for name in names
        )

    return total(chance for acting, chance in chances.items() if is_true(acting))


def _covered(withheld: Sequence[Mapping[str, Any]], diagnosis: DiagnosisFile) -> dict[str, bool]:
    """Return whether 90 % intervals of parameters contain the truth, for own forms.

    Two laws of an effect may give the same curve with different numbers, such as the exponent of a
    power and the curvature of a parabola. Only parameters of the withheld law are compared.
    """
    causes = {cause.effect: cause for cause in diagnosis.causes}
    covered = {}
    for withheld_effect in withheld:
        effect, form = str(withheld_effect["name"]), str(withheld_effect.get("form", ""))
        cause = causes.get(effect)
        if cause is None or not withheld_effect.get("own", False):
            continue
        if cause.law != LAWS_OF_FORMS.get((effect, form), form):
            continue
        for name, value in sorted(withheld_effect.get("parameters", {}).items()):
            interval = cause.parameters.get(name)
            if interval is not None and isinstance(value, int | float):
                inside = interval.q05 <= float(value) <= interval.q95
                covered[f"{cause.effect}.{name}"] = inside
    return covered
