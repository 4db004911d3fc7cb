"""A smooth force that nobody named, beyond the discrepancy: how large, and along which axis."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp
from scipy.stats import halfnorm

from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.climbing import climb
from bayesfric.diagnosis.discrepancy import Wide
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.weighing import Weighed

__all__ = ["Unknown", "unknown_force"]

Array = NDArray[np.float64]
QUANTILES = (0.1, 0.3, 0.5, 0.7, 0.9)  # of the rms of an unknown force


@dataclass(frozen=True)
class Unknown:
    """A smooth force that nobody named, weighed.

    Parameters
    ----------
    nodes : tuple of Wide
        How large it may be, and along which axis.
    log_weights : ndarray
        Of each node, normalised.
    log_evidence : float
        As of :class:`~bayesfric.diagnosis.weighing.Weighed`.
    at : At
        With the most probable node.
    acting : Acting
        Effects beside it, which make less of the gap than it does.
    """

    nodes: tuple[Wide, ...]
    log_weights: Array
    log_evidence: float
    at: At
    acting: Acting

    @property
    def best(self) -> Wide:
        """The most probable node."""
        return self.nodes[int(np.argmax(self.log_weights))]


def unknown_force(
    model: LinearModel,
    without: Weighed,
    acting: Acting,
    inverse: Array,
    volume: float,
    starts: Sequence[Array] = (),
) -> Unknown | None:
    """Weigh a smooth force beyond the discrepancy, along all axes or any single one.

    Parameters
    ----------
    model : LinearModel
        All rigs.
    without : Weighed
        The same without the force.
    acting : Acting
        What acts beside it.
    inverse, volume
        Of the noise without effects.
    starts : sequence of ndarray
        Further noises to climb from.
    """
    model = model.full
    axes = model.acting_axes
    if not axes:
        return None
    scale = model.analysis.diagnosis.unknown_scale
    shares = [scale * float(halfnorm.ppf(one)) for one in QUANTILES]
    nodes = tuple(Wide(share, axis) for axis in (None, *axes) for share in shares)
    form = without.forms

    def values(psi: Array) -> Array:
        information = model.evaluate(psi, acting, nodes[0], form).information
        priors = [model.amplitude_prior(law) for law in acting.laws]
        nothing = np.array([], dtype=np.intp)
        log_prior, _ = model.log_prior(psi, acting)
        return log_prior + np.array(
            [
                information.reduced(*model.prior(priors, one, form), nothing).log_evidence
                for one in nodes
            ]
        )

    psi = without.at.psi
    tried = [psi, model.quiet(psi), *(s for s in starts if s.size == psi.size)]
    rated = [values(one) for one in tried]
    best = int(np.argmax([one.max() for one in rated]))
    psi, found = tried[best], rated[best]
    for _ in range(2):
        at = climb(model, psi, acting, nodes[int(np.argmax(found))], form, inverse)
        settled = bool(np.abs(at.psi - psi).max() < 0.05)
        psi = at.psi
        found = values(psi)
        if settled:
            break
    total = float(logsumexp(found) - np.log(len(nodes))) + volume
    # Along all axes is as likely as along any one.
    return Unknown(nodes, found - logsumexp(found), total, at, acting)
