"""What the causes leave: a further smooth force, errors of their laws, or nothing."""

from dataclasses import replace

import numpy as np

from bayesfric.arrays import Array
from bayesfric.diagnosis.forms import AS_IT_IS
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.unknown import Unknown, unknown_force
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.diagnosis_rules import RULES
from bayesfric.probabilities import LN10
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import Remainder

DRAWS = 1000
ALL_LEFT = "no cause is named, so that all of the gap is left"


def remainder_of(
    model: LinearModel,
    search: Search,
    weighed: Weighed,
    gap_share: float,
    left: Array | None = None,
) -> Remainder:
    """Test for a further smooth force together with the causes.

    Parameters
    ----------
    model : LinearModel
        The model in which the hypotheses were compared.
    search : Search
        The hypotheses.
    weighed : Weighed
        The most probable hypothesis without an unknown force; may have no effects.
    gap_share : float
        Rms of the gap over rms friction.
    left : ndarray or None
        Draws of the part of the squared gap that the causes leave; None without causes.
    """
    further = unknown_force(model, weighed, weighed.acting, search.inverse, search.volume)
    if further is None:
        return _remainder(None, None, 0.0)

    def value_of(alone: Weighed) -> float:
        psi, acting, forms = alone.at.psi, alone.acting, alone.forms
        own = model.reweighted(psi, acting, None, forms)
        value = own.evaluate(psi, acting, None, forms).value
        return value + own.weight_volume + search.volume

    before = value_of(weighed)
    gain = (further.log_evidence - before) / LN10
    found_by = [(*_beside(further, gap_share), gain)] if gain > RULES.remainder_log10 else []
    practical = model.analysis.diagnosis.practical_share
    if left is not None and left_matters(left, gap_share, practical):
        # The errors of the causes' laws are so large that something else must act. Its axis is that
        # of a smooth force that replaces these errors.
        plain = replace(weighed, form=AS_IT_IS)
        instead = unknown_force(model, plain, weighed.acting, search.inverse, search.volume)
        assert instead is not None
        asked = (instead.log_evidence - value_of(plain)) / LN10
        # Errors of the laws suffice unless the data favour the smooth force.
        if asked > 0:
            found_by.append((Interval.of_draws(left), instead.best.axis or _widest(instead), asked))
    # Both may be parts of the same force.
    largest = max(found_by, key=lambda candidate: candidate[0].q50, default=(None, None, gain))
    return _remainder(*largest)


def _remainder(share: Interval | None, axis: str | None, factor: float) -> Remainder:
    """Return the remainder with this share of the gap; None if the data favour no force."""
    why = "no further force is asked for"
    return Remainder(
        significant=share is not None,
        log10_bayes_factor=float(factor),
        share_of_gap=share,
        share_of_gap_why=None if share is not None else why,
        axis=axis,
        axis_why=None if axis is not None else why,
    )


def all_left(search: Search, force: Unknown) -> Remainder:
    """Return the remainder where no cause is named and an unknown force makes the gap.

    Parameters
    ----------
    search : Search
        The hypotheses.
    force : Unknown
        The unknown force.
    """
    # A force that effects describe but cannot have made is supported by their evidence.
    best_known = max(force.log_evidence, search.best().log_evidence if search.foreign else -np.inf)
    gain = (best_known - search.none.log_evidence) / LN10
    return Remainder(
        significant=gain > RULES.remainder_log10,
        log10_bayes_factor=float(gain),
        share_of_gap=None,
        share_of_gap_why=ALL_LEFT,
        axis=force.best.axis or _widest(force),
    )


def _beside(further: Unknown, gap_share: float) -> tuple[Interval, str]:
    """Return the part of the gap that a smooth force beside the causes makes, and its axis."""
    shares = np.array([wide.share for wide in further.nodes])
    order = np.argsort(shares)
    ladder = (np.arange(DRAWS) + 0.5) / DRAWS
    place = np.searchsorted(np.cumsum(np.exp(further.log_weights)[order]), ladder)
    drawn = shares[order][place.clip(max=shares.size - 1)] ** 2
    return Interval.of_draws(drawn / (drawn + gap_share**2)), further.best.axis or _widest(further)


def left_matters(left: Array, gap_share: float, practical: float) -> bool:
    """Return whether the causes leave much of the gap, with probability 0.95.

    Parameters
    ----------
    left : ndarray
        Draws of the part of the squared gap that the causes leave.
    gap_share, practical : float
        Rms of the gap, and the rms that matters, over rms friction.
    """
    least = float(np.quantile(left, 0.05))
    return least > RULES.remainder_left or np.sqrt(max(least, 0.0)) * gap_share > practical


def _widest(further: Unknown) -> str:
    """Return the single axis with the largest evidence."""
    rated = [
        (float(weight), node.axis)
        for weight, node in zip(further.log_weights, further.nodes, strict=True)
        if node.axis is not None
    ]
    return str(max(rated)[1])
