"""The result on held-out data in a sentence."""

from collections.abc import Callable, Sequence

from bayesfric.diagnosis.verdict import Verdict
from bayesfric.diagnosis_rules import RULES
from bayesfric.probabilities import ALL_BUT, PAST_ALL, WIDE, stated, two_digits
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import Cause
from bayesfric.schemas.gap import Gap, GapRow

ROUGH = 0.2  # width of a share's interval from which it counts as not determined


def held_out_words(gap: Gap, causes: Sequence[Cause], verdict: Verdict | None = None) -> str:
    """Return a sentence on the held-out data, also if they determine nothing.

    Parameters
    ----------
    gap : Gap
        The gap in the form that is stored.
    causes : sequence of Cause
        Effects that these data test.
    verdict : str or None
        Verdict of the preceding sentence (:func:`sentence_of`). After the share of a named
        cause, the sentence says which of the two shares to rely on.
    """
    if not gap.held_out:
        return "No data could be held out: without them nothing would be left to fit."
    row = gap.held_out[0]
    them = "it" if len(causes) == 1 else "them"
    if causes and verdict == "named" and gap.shrink is not None and gap.shrink_of_model is not None:
        return _beside_the_model(gap.shrink, gap.shrink_of_model, row, gap.unit)
    if causes and gap.shrink is not None:
        past = "; values above 100% come from scatter" if gap.shrink.q95 > PAST_ALL else ""
        which = " and ".join(cause.effect for cause in causes) if verdict == "unknown" else them
        return (
            f"On data that the fit has not seen, adding {which} removes "
            f"{removed_words(gap.shrink)} of the gap (mean square{past})."
        )
    if causes and verdict != "no-gap":  # without a gap nothing is to be removed
        removes = "it removes" if len(causes) == 1 else "they remove"
        return (
            f"How much of the gap {removes} on data that the fit has not seen is unknown: "
            f"{gap.shrink_why}."
        )
    return _error_of_law(gap, row, causes)


def _error_of_law(gap: Gap, row: GapRow, causes: Sequence[Cause]) -> str:
    """Return a sentence on the law's error on held-out data, alone and refitted with causes."""
    names = " and ".join(cause.effect for cause in causes)

    def off(shown: Callable[[Interval], str]) -> str:
        refitted = f" (refitted with {names}: {shown(row.after)} {gap.unit} rms)" if names else ""
        return (
            f"On data that the fit has not seen the law is off by {shown(row.before)} {gap.unit} "
            f"rms{refitted}"
        )

    floor = f"{_middle_of(row.floor)} {gap.unit} on average"
    if row.before.q50 <= row.floor.q50:
        return f"{off(_middle_of)}, no more than scatter alone makes ({floor})."
    if row.below_floor <= 1 - RULES.above_floor:
        return (
            f"{off(_middle_of)}; scatter alone makes {floor}, a difference that chance does not "
            "explain."
        )
    compared = "The law's error and scatter are" if names else "The two are"
    return (
        f"{off(_ends)}; scatter alone makes {_ends(row.floor)} {gap.unit} rms (90% intervals). "
        f"{compared} consistent (p = {stated(row.below_floor)})."
    )


def _middle_of(interval: Interval) -> str:
    return two_digits(interval.q50)


def _ends(interval: Interval) -> str:
    return f"{two_digits(interval.q05)} to {two_digits(interval.q95)}"


def _beside_the_model(measured: Interval, inferred: Interval, row: GapRow, unit: str) -> str:
    """Return a sentence on the held-out share, and which share to rely on."""
    on_unseen = f"On data that the fit has not seen, {removed_words(measured)} is removed"
    if measured.q95 < inferred.q05:
        return (
            f"{on_unseen}. Rely on this lower figure: {_middle(inferred)} is the model's own "
            "estimate, from the data that it was fitted to."
        )
    if measured.q95 - measured.q05 < ROUGH:
        return f"{on_unseen}, which confirms this."
    return (
        f"{on_unseen}: a consistent but rough figure, since scatter alone makes "
        f"{two_digits(row.floor.q50)} {unit} rms there. Rely on the {_middle(inferred)}, which the "
        "model has freed of scatter."
    )


def _middle(share: Interval) -> str:
    return f"{min(share.q50, ALL_BUT):.1%}"


def removed_words(shrink: Interval) -> str:
    """Return the removed share of a gap, with its interval; by chance it may exceed 100 %."""
    if shrink.q05 >= ALL_BUT and shrink.q95 <= PAST_ALL:
        return f"more than {ALL_BUT:.1%}"
    digits = 0 if shrink.q95 - shrink.q05 >= WIDE else 1
    low, middle, high = (f"{end:.{digits}%}" for end in (shrink.q05, shrink.q50, shrink.q95))
    return f"{middle} [{low}, {high}]"
