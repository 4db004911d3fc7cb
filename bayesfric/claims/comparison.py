"""A claim against its rivals: Bayes factor, size of the effect, prediction, verdict."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.special import logsumexp

from bayesfric.analysis import ClaimRules
from bayesfric.arrays import Array
from bayesfric.claims.base import Case, Claim, Finding, Verdict
from bayesfric.claims.effect_sizes import suited_effects
from bayesfric.claims.odds import odds, share
from bayesfric.claims.studies import WIDTHS, Studied, Task, prior_ratios
from bayesfric.fitting.hypothesis import LawWithEffects
from bayesfric.inference.evidence.leave_out import Difference, difference
from bayesfric.inference.power import amplitude_error, smallest_found
from bayesfric.probabilities import LN10

FOUND_WITH = 0.9  # power at which the smallest detectable effect is reported
LEAST_AMPLITUDE = 1e-12
STABLE_OVER = (10**-0.5, 10**0.5)  # a tenfold change of the width


def compare(claim: Claim, case: Case) -> Finding:
    """Judge a claim by its Bayes factor against the best of its rivals.

    Parameters
    ----------
    claim : Claim
        A claim with rivals.
    case : Case
        Of a recording.

    Returns
    -------
    Finding
        ``not-testable`` if the recording lacks the rig, or if the condition in which the
        rivals differ does not vary.
    """
    if lack := claim.untestable(case.entered):
        return Finding("not-testable", lack)
    name = claim.subject(case.entered)
    own = case.studied[Task(name, case.entered.claimed)]
    rivals = {rival: case.studied[Task(name, rival)] for rival in claim.against(case.entered)}
    lacking = [
        f"{rival.label}: {studied.why}" for rival, studied in rivals.items() if not studied.evidence
    ]
    weighed = {rival: studied for rival, studied in rivals.items() if studied.evidence is not None}
    if own.evidence is None or not weighed:
        why = own.why or "; ".join(lacking)
        return Finding("undecided", f"The evidence cannot be computed: {why}.", why=why)
    case = replace(case, effects=suited_effects(case.entered.data[name], case.effects))
    return _against_rivals(claim, case, name, weighed, lacking)


def _against_rivals(
    claim: Claim,
    case: Case,
    name: str,
    weighed: Mapping[LawWithEffects, Studied],
    lacking: Sequence[str],
) -> Finding:
    """Judge a claim against rivals with an evidence; `lacking` explains missing evidences."""
    rules = case.analysis.claims
    own = case.studied[Task(name, case.entered.claimed)]
    factors = {rival.label: bayes_factor(own, [studied]) for rival, studied in weighed.items()}
    studies = list(weighed.values())
    log10, error = bayes_factor(own, studies)
    curve = np.array([bayes_factor(own, studies, place)[0] for place in range(len(WIDTHS))])
    best = max(weighed, key=lambda rival: log_evidence(weighed[rival]))
    bounds = _upper_bounds(weighed)
    bound = max(bounds.values(), default=0.0)
    best_size = weighed[best].size
    beyond = float((best_size > rules.region_of_equivalence).mean()) if best_size.size else 1.0
    predicted = _difference_of_prediction(own, weighed[best])
    elpd_errors = predicted.elpd / predicted.se if predicted.se > 0 else 0.0
    stable = _over_width(curve)
    verdict, reason = decide(rules, log10, stable, bound, beyond, elpd_errors, best.label)
    reason += _doubted(verdict, predicted)
    verdicts = verdicts_over_widths(case, weighed, curve, elpd_errors)
    if lacking:
        verdicts = ["undecided" if of_width == "supported" else of_width for of_width in verdicts]
        if verdict == "supported":
            verdict, reason = "undecided", f"A rival has no evidence: {'; '.join(lacking)}."
    narrowest, widest = same_around(verdicts, verdict)
    figures: dict[str, Any] = {
        "best_rival": best.label,
        "log10_bayes_factor_against": {label: value for label, (value, _) in factors.items()},
        "log10_bayes_factor_against_se": {label: error for label, (_, error) in factors.items()},
        "effect_upper_bound_95": bound,
        "effect_upper_bound_95_of": bounds,
        "probability_effect_matters": beyond,
        "lowest_over_prior_width": stable[0],
        "highest_over_prior_width": stable[1],
        "same_verdict_from_prior_width": narrowest,
        "same_verdict_to_prior_width": widest,
        "elpd_reliable": predicted.reliable,
        "elpd_unreliable_for": "; ".join(predicted.unreliable),
    }
    return Finding(
        verdict,
        reason,
        figures | could_be_found(case, weighed),
        log10,
        error,
        predicted.elpd,
        predicted.se,
        by_pulley=_by_pulleys(claim, case, name),
        curve={
            "width": np.array(WIDTHS),
            "log10_bayes_factor": curve,
            "verdict": np.array(verdicts),
        },
    )


def _difference_of_prediction(own: Studied, best: Studied) -> Difference:
    """Return the ELPD of new assemblies under the claim minus that under its best rival."""
    assert own.prediction is not None
    assert best.prediction is not None  # both exist in studies of all sizes together
    return difference(own.prediction, best.prediction)


def _upper_bounds(rivals: Mapping[LawWithEffects, Studied]) -> dict[str, float]:
    """Return the 95 % upper bound of each rival's effect, relative to friction."""
    return {
        rival.label: float(np.quantile(studied.size, 0.95))
        for rival, studied in rivals.items()
        if studied.size.size
    }


def _over_width(curve: Array) -> tuple[float, float]:
    """Return the least and largest log10 Bayes factor over :data:`STABLE_OVER`.

    Parameters
    ----------
    curve : ndarray, shape (len(WIDTHS),)
        Log10 Bayes factor at each width.
    """
    widths = np.array(WIDTHS)
    stable = curve[(widths > 0.999 * STABLE_OVER[0]) & (widths < 1.001 * STABLE_OVER[1])]
    return float(stable.min()), float(stable.max())


def verdicts_over_widths(
    case: Case, rivals: Mapping[LawWithEffects, Studied], log10: Array, elpd_errors: float
) -> list[Verdict]:
    """Return the verdict at each width of the rivals' priors.

    Draws are weighted by the ratio of the priors, so that the effect's size depends on the width
    as the Bayes factor does. The difference of prediction is not changed.

    Parameters
    ----------
    case : Case
        For rules and priors.
    rivals : mapping of LawWithEffects to Studied
        All with an evidence.
    log10 : ndarray, shape (len(WIDTHS),)
        Log10 Bayes factor at each width.
    elpd_errors : float
        As for :func:`decide`.
    """
    rules = case.analysis.claims
    sized = {rival: studied for rival, studied in rivals.items() if studied.size.size}
    ratios = {
        rival: prior_ratios(studied.theta, rival, case.effects) for rival, studied in sized.items()
    }
    verdicts = []
    for place in range(len(WIDTHS)):
        weights = {rival: np.exp(r[place] - logsumexp(r[place])) for rival, r in ratios.items()}
        bound = max((_quantile(sized[rival].size, w) for rival, w in weights.items()), default=0.0)
        best = max(rivals, key=lambda rival: log_evidence(rivals[rival], place))
        beyond = 1.0
        if best in weights:
            beyond = float(weights[best] @ (sized[best].size > rules.region_of_equivalence))
        log10_here = float(log10[place])
        verdict, _ = decide(
            rules, log10_here, (log10_here, log10_here), bound, beyond, elpd_errors, best.label
        )
        verdicts.append(verdict)
    return verdicts


def could_be_found(case: Case, rivals: Mapping[LawWithEffects, Studied]) -> dict[str, Any]:
    """Return the smallest effect that these data could have detected, by rival.

    It is relative to friction, at the conditions where the effect is largest. In recordings like
    this one, the odds would refute the claim with a probability of 0.9.

    Parameters
    ----------
    case : Case
        For rules and priors.
    rivals : mapping of LawWithEffects to Studied
        All with an evidence.
    """
    threshold = -case.analysis.claims.refute_log10_bayes_factor * LN10
    shares: dict[str, float] = {}
    open_to_prior = []
    for rival, studied in rivals.items():
        if not studied.size.size:
            continue
        effect = case.effects[rival.effects[0][0]]
        draws = studied.theta[f"{effect.name}.{effect.amplitude.name}"]
        prior = effect.amplitude.prior
        error = amplitude_error(draws, prior)
        if error is None:
            open_to_prior.append(rival.label)
            continue
        per_unit = float(np.median(studied.size / np.maximum(np.abs(draws), LEAST_AMPLITUDE)))
        smallest = smallest_found(error, prior, threshold, FOUND_WITH)
        shares[rival.label] = per_unit * smallest
    figures: dict[str, Any] = {"smallest_found": shares, "smallest_found_with": FOUND_WITH}
    if open_to_prior:
        why = "these data leave the amplitude to its prior"
        figures["smallest_found_open_for"] = f"{', '.join(open_to_prior)}: {why}"
    return figures


def same_around(verdicts: Sequence[Verdict], verdict: Verdict) -> tuple[float, float]:
    """Return the narrowest and widest prior, around the analysis's, with the same verdict."""
    middle = len(WIDTHS) // 2
    other = np.flatnonzero(np.array(verdicts) != verdict)
    if middle in other:  # this verdict depends on several widths, so no single width has it
        return WIDTHS[middle], WIDTHS[middle]
    low = other[other < middle].max(initial=-1) + 1
    high = other[other > middle].min(initial=len(WIDTHS)) - 1
    return WIDTHS[low], WIDTHS[high]


def _quantile(values: Array, weights: Array) -> float:
    """Return the 95 % quantile of weighted draws; the weights add up to 1."""
    order = np.argsort(values)
    place = int(np.searchsorted(np.cumsum(weights[order]), 0.95))
    return float(values[order][min(place, len(order) - 1)])


def _doubted(verdict: str, predicted: Difference) -> str:
    """Return words, added to a reason to refute, on an unreliable error of the prediction."""
    if verdict != "refuted" or predicted.reliable:
        return ""
    return (
        f" The error of that prediction is itself not reliable: {'; '.join(predicted.unreliable)}."
    )


def decide(
    rules: ClaimRules,
    log10: float,
    over_width: tuple[float, float],
    upper_bound: float,
    beyond: float,
    elpd_errors: float,
    best: str,
) -> tuple[Verdict, str]:
    """Return the verdict of the rules and the reason.

    Parameters
    ----------
    rules : ClaimRules
        Thresholds.
    log10 : float
        Log10 Bayes factor in favour of the claim.
    over_width : (float, float)
        Its lowest and highest value over a tenfold change of the rivals' prior width.
    upper_bound : float
        95 % upper bound of the effect, as a share of friction.
    beyond : float
        Probability, under the best rival, that the effect matters.
    elpd_errors : float
        Difference of prediction over its standard error, positive for the claim.
    best : str
        Label of the best rival.

    Returns
    -------
    verdict, reason : str
    """
    if log10 >= rules.support_log10_bayes_factor:
        return _favoured(rules, log10, over_width[0], upper_bound)
    if log10 <= rules.refute_log10_bayes_factor:
        return _disfavoured(rules, log10, over_width[1], beyond, elpd_errors, best)
    return "undecided", (
        f"The odds for the claim are {odds(log10)}; support needs "
        f"{odds(rules.support_log10_bayes_factor)}."
    )


def _favoured(
    rules: ClaimRules, log10: float, lowest: float, upper_bound: float
) -> tuple[Verdict, str]:
    """Decide if the odds favour the claim; `lowest` is their minimum over a tenfold width."""
    small = upper_bound < rules.region_of_equivalence
    if not small:
        return "undecided", (
            f"The odds for the claim are {odds(log10)}, yet an effect of up to "
            f"{share(upper_bound)} of friction could go unnoticed."
        )
    if lowest >= rules.support_over_width_log10_bayes_factor:
        return "supported", (
            f"The data favour the claim {odds(log10)}. The rival's effect is at most "
            f"{share(upper_bound)} of friction (95 %)."
        )
    return "undecided", (
        f"The odds for the claim, {odds(log10)}, fall to {odds(lowest)} as the width "
        "of the rivals' priors changes tenfold."
    )


def _disfavoured(
    rules: ClaimRules, log10: float, highest: float, beyond: float, elpd_errors: float, best: str
) -> tuple[Verdict, str]:
    """Decide if the odds are against the claim."""
    matters = beyond >= rules.refute_effect_probability
    if not matters:
        return "undecided", (
            f"{best} is favoured {odds(-log10)}, but may be too small to matter: it exceeds "
            f"{share(rules.region_of_equivalence)} of friction with probability {beyond:.2f}."
        )
    if highest > rules.refute_log10_bayes_factor:
        return "undecided", (
            f"The odds for {best}, {odds(-log10)}, fall to {odds(-highest)} as the width "
            "of the rivals' priors changes tenfold."
        )
    if elpd_errors < -rules.refute_elpd_errors:
        return "refuted", (
            f"{best} is favoured {odds(-log10)}, makes more than "
            f"{share(rules.region_of_equivalence)} of friction, and predicts new assemblies "
            "better."
        )
    return "undecided", f"{best} is favoured, and does not predict new assemblies better."


def log_evidence(studied: Studied, width: int | None = None) -> float:
    """Return the log evidence of a hypothesis at a width of its amplitude's prior [nat].

    Parameters
    ----------
    studied : Studied
        A study with an evidence.
    width : int or None
        Place in :data:`bayesfric.claims.studies.WIDTHS` of the width of its amplitude's
        prior, if it has one; None is as it is.
    """
    assert studied.evidence is not None
    change = studied.widths[width] if width is not None and studied.widths.size else 0.0
    return float(studied.evidence.log_evidence + change)


def bayes_factor(
    own: Studied, rivals: list[Studied], width: int | None = None
) -> tuple[float, float]:
    """Return the log10 Bayes factor against the best rival, and its error.

    Rivals are not averaged: an excluded rival would lower the average and favour the claim.

    Parameters
    ----------
    own : Studied
        The claim's hypothesis.
    rivals : list of Studied
        All with an evidence.
    width : int or None
        Place in :data:`bayesfric.claims.studies.WIDTHS` of the width of the rivals'
        priors; None is as they are. Which rival is best depends on it.

    Returns
    -------
    value, error : float
    """
    assert own.evidence is not None
    values = [log_evidence(rival, width) for rival in rivals]
    best = int(np.argmax(values))
    rival = rivals[best].evidence
    assert rival is not None
    error = float(np.hypot(own.evidence.error, rival.error))
    return float(own.evidence.log_evidence - values[best]) / LN10, error / LN10


def _by_pulleys(
    claim: Claim, case: Case, name: str
) -> dict[str, tuple[float | None, float | None, str]]:
    """Return the log10 Bayes factor of each pulley size alone, its error, and why there is none."""
    sizes = case.entered.data[name].sizes
    return {size: _by_pulley(claim, case, f"{name}/{size}") for size in sizes}


def _by_pulley(claim: Claim, case: Case, name: str) -> tuple[float | None, float | None, str]:
    own = case.studied[Task(name, case.entered.claimed)]
    rivals = [case.studied[Task(name, rival)] for rival in claim.against(case.entered)]
    lacking = [hypothesis.why for hypothesis in (own, *rivals) if hypothesis.evidence is None]
    if lacking:
        return None, None, "; ".join(lacking)
    return (*bayes_factor(own, rivals), "")
