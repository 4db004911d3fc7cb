"""What the named causes leave: a further smooth force, or nothing."""

import numpy as np
from numpy.typing import NDArray

from bayesfric.diagnosis.linear_model import LinearModel
from bayesfric.diagnosis.shrink import interval
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.diagnosis.which import Unknown, unknown_evidence
from bayesfric.rigs.layout import COEFFICIENTS
from bayesfric.schemas import Remainder

__all__ = ["remainder_of"]

Array = NDArray[np.float64]
LN10 = float(np.log(10))
SIGNIFICANT = 1.0  # log10 Bayes factor
DRAWS = 1000


def remainder_of(model: LinearModel, found: Weighed, taken_share: float) -> Remainder:
    """Weigh a further smooth force beside the causes.

    Parameters
    ----------
    model : LinearModel
        Around the law that was fitted with the causes.
    found : Weighed
        The causes; may be none.
    taken_share : float
        Rms of what the causes take away over rms friction; the rest of the gap is the
        further force.
    """
    further = unknown_evidence(model, found.psi, found.best)
    gain = (further.log_evidence - model.log_joint(found.psi, found.best)) / LN10
    significant = gain > SIGNIFICANT
    axis, share, why = None, None, "no further force is asked for"
    if significant:
        axis = _axis(model, found, further)
        # Beyond the discrepancy that every hypothesis has.
        rms2 = np.array([wide.share**2 for wide in further.nodes]) - model.practical_share**2
        weights = np.exp(further.log_weights)
        order = np.argsort(rms2)
        ladder = (np.arange(DRAWS) + 0.5) / DRAWS
        place = np.searchsorted(np.cumsum(weights[order]), ladder).clip(max=rms2.size - 1)
        drawn = rms2[order][place]
        share = interval(drawn / (drawn + taken_share**2))
    return Remainder(
        significant=bool(significant),
        log10_bayes_factor=float(gain),
        share_of_gap=share,
        share_of_gap_why=None if share is not None else why,
        axis=axis,
        axis_why=None if axis is not None else why,
    )


def _axis(model: LinearModel, found: Weighed, further: Unknown) -> str:
    """Return the covariate along which the further force is largest."""
    wide = further.nodes[int(np.argmax(further.log_weights))]
    mean, sd = model.prior(found.best.columns, wide)
    centre, _ = model.information(further.psi, found.best).posterior(mean, sd)
    own, sizes = model.layout.own, len(model.layout.sizes)
    numbers = centre[: own * sizes].reshape(sizes, own)[:, COEFFICIENTS:]
    power: dict[str, float] = {}
    start = 0
    for smooth in model.smooths:
        square = float((numbers[:, start : start + smooth.count] ** 2).sum())
        power[smooth.axis] = power.get(smooth.axis, 0.0) + square
        start += smooth.count
    return max(power, key=lambda name: power[name])
