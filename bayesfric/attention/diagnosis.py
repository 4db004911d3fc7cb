"""The attention list of a diagnosis."""

import math
from collections.abc import Iterator, Mapping

from bayesfric.observation.coefficients import PAPER_SIZES
from bayesfric.probabilities import in_thousands, two_digits
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import IMPLAUSIBLE, INERTIAS, SIGNED, Cause, LawNumber

FAR_FROM_SCATTER = 10.0  # times what scatter makes: a law that misses more is not to be entered
FAR_FROM_FRICTION = 0.5  # of friction, the same
NOT_YET = "Do not enter these numbers yet"
MULTIPLE = 2.0  # times friction, from which on nobody reads a percentage
OF_BIASED_LAW = "Results of fit and claims rest on this biased law"
APART = 2.0  # combined standard deviations, beyond which chance does not make a bias
SHARE_THAT_MATTERS = 0.01  # of a number: the law is biased by less whatever acts


def of_diagnosis(diagnosis: DiagnosisFile) -> tuple[str, ...]:
    """Return a sentence for every check of a diagnosis that failed.

    Sentences that the diagnosis itself wrote, such as settings that it ignores, come first.

    Parameters
    ----------
    diagnosis : DiagnosisFile
        As it is stored.
    """
    untrusted = why_untrusted(diagnosis)
    lines = [
        *diagnosis.attention,
        *([] if untrusted is None else [untrusted]),
        *_bent_by_the_loop(diagnosis),
        *_biased(diagnosis),
        *_held_out(diagnosis),
        *(line for cause in diagnosis.causes for line in _of_cause(cause)),
        *_rest(diagnosis),
    ]
    return tuple(dict.fromkeys(lines))


def _bent_by_the_loop(diagnosis: DiagnosisFile) -> Iterator[str]:
    """Yield that least squares and an instrument are apart, with the numbers of both."""
    instrument = diagnosis.instrument
    if instrument is None or not instrument.alarms:
        return
    shown = {
        name: number
        for name, number in instrument.numbers.items()
        if not set(INERTIAS if name in INERTIAS else (name,)) & set(diagnosis.untold)
    }
    numbers = "; ".join(
        f"{name} {number.instrumental:.3g} ± {number.instrumental_se:.1g} {number.unit}, not "
        f"{number.ordinary:.3g}"
        for name, number in shown.items()
    )
    below = [name for name in shown if name not in SIGNED and shown[name].instrumental <= 0]
    exception = ""
    if below:
        exception = (
            f", except for {' and '.join(below)}: no joint has a value below 0, so the difference "
            "only widens the interval"
        )
    yield (
        "Encoder errors, or disturbances inside the control loop, bias least squares: with the "
        f"{instrument.kind} as instrumental variable, {numbers} (Durbin-Wu-Hausman test: "
        f"p = {instrument.p_value:.1g}). Use the instrumental-variable numbers{exception}"
    )


def why_untrusted(diagnosis: DiagnosisFile) -> str | None:
    """Return why the numbers to enter are not to be relied on; None where they are.

    Parameters
    ----------
    diagnosis : DiagnosisFile
        Of one joint, as it is stored.
    """
    gap = diagnosis.gap
    left, friction, scatter = gap.held_out_excess, gap.friction_rms, gap.floor.q50
    if not diagnosis.enter or not left > 0 or left < diagnosis.practical_share * friction:
        return None
    is_share = gap.no_share is None and friction > 0
    is_far = left > FAR_FROM_SCATTER * scatter or (is_share and left > FAR_FROM_FRICTION * friction)
    force = f"{two_digits(left)} {gap.unit} rms"
    size = f"{force} ({_of_friction(left / friction)})" if is_share else force
    advice = NOT_YET if is_far else "Enter these numbers with care"
    of = "" if diagnosis.joint is None else f" for the joint {diagnosis.joint}"
    whose = "those of least squares" if is_by_instrument(diagnosis) else "these numbers"
    return (
        f"{advice}{of}. On data that the fit has not seen, the law with {whose} is off by {size} "
        f"after scatter is subtracted; scatter alone makes {two_digits(scatter)} {gap.unit} rms. A "
        "force acts that these numbers do not describe"
    )


def is_contradicted(diagnosis: DiagnosisFile) -> bool:
    """Return whether the error on held-out data is too large for the numbers to be entered."""
    return (why_untrusted(diagnosis) or "").startswith(NOT_YET)


def _of_friction(share: float) -> str:
    """Return a share of friction in words; from twice friction on as a multiple."""
    return (
        f"{two_digits(share)} times friction" if share >= MULTIPLE else f"{share:.0%} of friction"
    )


def is_by_instrument(diagnosis: DiagnosisFile) -> bool:
    """Return whether an instrument gave numbers of the law: held-out data are of least squares."""
    return any(number.least_squares is not None for number in diagnosis.law.values())


def biased_numbers(diagnosis: DiagnosisFile) -> Mapping[str, LawNumber]:
    """Return the numbers that the law alone has wrong where causes are named.

    Parameters
    ----------
    diagnosis : DiagnosisFile
        As it is stored.

    Returns
    -------
    mapping of str to LawNumber
        Those whose values without and with the causes are more than :data:`APART` combined
        standard deviations apart, and by more than a hundredth, in their usual order; none
        where no cause is named.
    """
    if not diagnosis.causes:
        return {}
    biased = {name: number for name, number in diagnosis.law.items() if _is_biased(number)}
    return {name: biased[name] for name in sorted(biased, key=_place)}


def _refitted(number: LawNumber) -> Interval:
    """Return a number of the fit with the causes, by least squares as the fit without them is."""
    return number.least_squares or number.after


def _is_biased(number: LawNumber) -> bool:
    after, alone = _refitted(number), number.before
    off = abs(alone.mean - after.mean)
    return off > max(SHARE_THAT_MATTERS * abs(after.mean), APART * math.hypot(alone.sd, after.sd))


def _biased(diagnosis: DiagnosisFile) -> Iterator[str]:
    biased = biased_numbers(diagnosis)
    if not biased:
        return
    causes = " and ".join(cause.effect for cause in diagnosis.causes)
    worst = max(biased, key=lambda name: _relative_bias(biased[name]))
    number = biased[worst]
    unit = "" if number.unit == "1" else f" {number.unit}"
    others = [name for name in biased if name != worst]
    more = f" Also biased: {', '.join(others)}." if others else ""
    yield (
        f"Without {causes} the fit gives {worst} as {in_thousands(number.before.mean)}{unit} "
        f"instead of {in_thousands(_refitted(number).mean)}{unit}.{more} {OF_BIASED_LAW}: use "
        f"the numbers refitted with {causes}"
    )


def _place(name: str) -> tuple[str, int, str]:
    """Return what sorts the numbers of a law: by coefficient, then by pulley size as usual."""
    coefficient, _, size = name.removesuffix("]").partition("[")
    usual = PAPER_SIZES.index(size) if size in PAPER_SIZES else len(PAPER_SIZES)
    return coefficient, usual, size


def _relative_bias(number: LawNumber) -> float:
    """Return how far the number of the law alone is off, as a share of that with the causes."""
    refitted = _refitted(number).mean
    off = abs(number.before.mean - refitted)
    return off / abs(refitted) if refitted else float("inf")


def _held_out(diagnosis: DiagnosisFile) -> Iterator[str]:
    if diagnosis.considered and diagnosis.verdict == "unknown":
        names = ", ".join(effect.effect for effect in diagnosis.considered)
        why = diagnosis.overruled_by
        if why is not None and IMPLAUSIBLE in why:
            yield f"Not named, though consistent with the data of the fit: {names}, since {why}."
        else:
            yield f"Held-out data contradict {names}{'' if why is None else f': {why}'}."
    # What is missed beyond scatter is told once, by `why_untrusted` where there are numbers.
    if diagnosis.gap.floor_disagreement is not None and why_untrusted(diagnosis) is None:
        yield f"Held-out data contradict the assumed scatter: {diagnosis.gap.floor_disagreement}."


def _of_cause(cause: Cause) -> Iterator[str]:
    if not cause.plausible:
        name, number = next(iter(cause.parameters.items()))
        low, high = cause.plausible_range
        yield (
            f"{cause.effect} is {IMPLAUSIBLE}: {name} is "
            f"{number.q50:.3g} {number.unit}, outside of {low:.3g} to {high:.3g} "
            f"({cause.plausible_reference})."
        )
    if cause.log10_bayes_factor_se_why is not None:
        yield f"The Bayes factor of {cause.effect} has no error: {cause.log10_bayes_factor_se_why}"


def _rest(diagnosis: DiagnosisFile) -> Iterator[str]:
    if diagnosis.stray_trials:
        names = ", ".join(diagnosis.stray_trials)
        yield (
            f"Trials left out, since they are far from the others of their own assembly: {names}. "
            "Look at how they were recorded"
        )
    if diagnosis.remainder.significant and diagnosis.verdict == "named":
        axis = (
            ""
            if diagnosis.remainder.axis is None
            else f", most of all along {diagnosis.remainder.axis}"
        )
        yield (
            f"The causes leave a force that no effect explains{axis}: the numbers refitted with "
            "them may be biased"
        )
    leader = _likeliest(diagnosis.probabilities)
    others = {_likeliest(chances) for chances in diagnosis.prior_sensitivity.values()} - {leader}
    if others and diagnosis.verdict in ("named", "no-gap", "unknown"):
        yield (
            "Which hypothesis is the most probable depends on the prior probability of no effect: "
            f"{leader}, or {', '.join(sorted(others))}. Measure more before you rely on it"
        )


def _likeliest(probabilities: Mapping[str, float]) -> str:
    return max(probabilities, key=lambda name: probabilities[name], default="none")
