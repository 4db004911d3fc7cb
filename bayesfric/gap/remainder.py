"""What the named causes leave: a further smooth force, or nothing."""

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from bayesfric.gap.layout import COEFFICIENTS
from bayesfric.gap.linear_model import LinearModel
from bayesfric.gap.shrink import interval
from bayesfric.gap.weighing import Weighed
from bayesfric.gap.which import unknown_evidence
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
    nodes, evidence, _ = unknown_evidence(model, found.psi, found.best)
    gain = (evidence - model.log_joint(found.psi, found.best)) / LN10
    significant = gain > SIGNIFICANT
    axis, share, why = None, None, "no further force is asked for"
    if significant:
        axis = _axis(model, found, nodes)
        # Beyond the discrepancy that every hypothesis has.
        rms2 = np.array([share**2 - model.practical_share**2 for share, _ in nodes])
        weights = np.exp([weight - logsumexp([w for _, w in nodes]) for _, weight in nodes])
        order = np.argsort(rms2)
        ladder = (np.arange(DRAWS) + 0.5) / DRAWS
        place = np.searchsorted(np.cumsum(weights[order]), ladder).clip(max=len(nodes) - 1)
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


def _axis(model: LinearModel, found: Weighed, nodes: tuple[tuple[float, float], ...]) -> str:
    """Return the covariate along which the further force is largest."""
    share = max(nodes, key=lambda node: node[1])[0]
    mean, sd = model.prior(found.best.columns, share)
    centre, _ = model.information(found.psi, found.best).posterior(mean, sd)
    own, sizes = model.layout.own, len(model.layout.sizes)
    numbers = centre[: own * sizes].reshape(sizes, own)[:, COEFFICIENTS:]
    power: dict[str, float] = {}
    start = 0
    for smooth in model.smooths:
        square = float((numbers[:, start : start + smooth.count] ** 2).sum())
        name = "rig" if smooth.rig == "motor" else smooth.axes[0]
        power[name] = power.get(name, 0.0) + square
        start += smooth.count
    return max(power, key=lambda name: power[name])
