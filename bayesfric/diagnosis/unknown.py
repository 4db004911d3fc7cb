"""A smooth force that nobody named, beyond the discrepancy: how large, and along which axis."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp, ndtri

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.climbing import climb, curvature_at
from bayesfric.diagnosis.discrepancy import Wide
from bayesfric.diagnosis.forms import AS_IT_IS, FormShare
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.squeezing import squeezed
from bayesfric.diagnosis.weighing import Weighed, log_volume, over_amplitudes
from bayesfric.inference.information import Information

LIKELY = 50.0  # nat from the best, of an unknown force that is looked at again
QUANTILES = (0.1, 0.3, 0.5, 0.7, 0.9)  # of the rms of an unknown force


@dataclass(frozen=True)
class Unknown:
    """A smooth force that nobody named, weighed.

    Parameters
    ----------
    nodes : tuple of Wide
        How large it may be, along which axis, and whether alike at all sizes, loads and rigs.
    log_weights : ndarray
        Of each node, normalised.
    log_evidence : float
        As of :class:`~bayesfric.diagnosis.weighing.Weighed`.
    at : At
        With the most probable node.
    acting : Acting
        Effects beside it, which make less of the gap than it does.
    form : FormShare
        The share by which their laws are wrong.
    """

    nodes: tuple[Wide, ...]
    log_weights: Array
    log_evidence: float
    at: At
    acting: Acting
    form: FormShare = AS_IT_IS

    @property
    def best(self) -> Wide:
        """The most probable node."""
        return self.nodes[int(np.argmax(self.log_weights))]

    @property
    def forms(self) -> dict[str, FormShare]:
        """The share of each effect beside it."""
        return dict.fromkeys(self.acting.names, self.form)


def unknown_force(
    model: LinearModel,
    without: Weighed,
    acting: Acting,
    inverse: Array,
    volume: float,
    starts: Sequence[Array] = (),
    near: float | None = None,
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
    near : float or None
        Log evidence from which on the force's own noise is integrated over.
    """
    model = model.full
    axes = model.acting_axes
    if not axes:
        return None
    nodes, idle = _nodes(model, axes)
    form = without.forms
    places = [place for law in acting.laws for place in law.places]

    def information_at(psi: Array) -> Information:
        return model.mixed(model.said_of(psi, places, acting.phases), places, acting)

    def values(psi: Array, of: Whole) -> Array:
        information = information_at(psi)
        priors = [model.amplitude_prior(law) for law in acting.laws]
        nothing = np.array([], dtype=np.intp)
        log_prior, _ = model.log_prior(psi, acting)
        log_densities = [
            information.reduced(*model.prior(priors, nodes[n], form), nothing).log_evidence
            for n in of
        ]
        return np.where(idle[of], -np.inf, log_prior + np.array(log_densities))

    psi = without.at.psi
    tried = [psi, model.noise.quiet(psi), *(s for s in starts if s.size == psi.size)]
    middling = np.arange(len(QUANTILES) // 2, len(nodes), len(QUANTILES))
    psi = tried[int(np.argmax([values(node, middling).max() for node in tried]))]
    log_evidences = values(psi, np.arange(len(nodes)))
    for _ in range(2):
        # The climb needs few of the numbers; the evidence has all of them.
        small = squeezed(model, psi, nodes[int(np.argmax(log_evidences))])
        there = climb(small, psi, acting, None, form, inverse)
        settled = bool(np.abs(there.psi - psi).max() < 0.05)
        psi = there.psi
        small = small.reweighted(psi, acting, None, form)
        model = small.full
        likely = np.flatnonzero(log_evidences > log_evidences.max() - LIKELY)
        log_evidences[likely] = values(psi, likely)
        if settled:
            break
    likeliest = nodes[int(np.argmax(log_evidences))]
    at = model.integrated(psi, acting, information_at(psi), likeliest, form)
    total = float(logsumexp(log_evidences) - np.log(len(nodes))) + volume
    total += over_amplitudes(small, there, acting, form) + small.weight_volume
    if near is not None and total > near:
        noise = slice(len(model.noise))
        total += log_volume(curvature_at(small, there, acting, form)[noise, noise]) - volume
    # Along all axes is as likely as along any one.
    return Unknown(nodes, log_evidences - logsumexp(log_evidences), total, at, acting, without.form)


def _nodes(model: LinearModel, axes: Sequence[str]) -> tuple[tuple[Wide, ...], Flags]:
    """Return how large a force may be and where, and which of these are scatter anyhow."""
    scale = model.analysis.diagnosis.unknown_scale
    shares = [scale * float(ndtri((1 + node) / 2)) for node in QUANTILES]  # half-normal
    # Where in speed a law is off events tell at hundreds of places, and forces that differ with
    # size, load and rig as well are too many to be likely; along other axes few values are met.
    where: list[tuple[str | None, bool]] = [(None, False), *((axis, False) for axis in axes)]
    where += [(axis, True) for axis in axes if axis == "velocity"]
    nodes = tuple(Wide(share, *node) for node in where for share in shares)
    # Along these, what is smaller than matters is scatter.
    practical = model.analysis.diagnosis.practical_share
    scattering = {axis for rig in model.rigs for axis in rig.rows.scattering_axes}
    return nodes, np.array([node.axis in scattering and node.share < practical for node in nodes])
