"""An unknown smooth force beyond the discrepancy: how large it is, and along which axis."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

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

LIKELY = 50.0  # an unknown force within this of the best is evaluated again [nat]
QUANTILES = (0.1, 0.3, 0.5, 0.7, 0.9)  # of the rms of an unknown force
BEYOND = (2.0, 4.0, 8.0)  # times the largest of them, where the force is even larger
RARE = 0.01  # prior probability of each of these, over that of a quantile


@dataclass(frozen=True)
class Unknown:
    """An unknown smooth force with its evidence.

    Parameters
    ----------
    nodes : tuple of Wide
        Its possible rms values and axes, and whether it is the same fraction of friction for all
        sizes, loads and rigs.
    log_weights : ndarray
        Posterior weight of each node, normalised.
    log_evidence : float
        As in :class:`~bayesfric.diagnosis.weighing.Weighed`.
    at : At
        Posterior with the most probable node.
    acting : Acting
        Effects that act together with it; they make less of the gap than it does.
    form : FormShare
        The relative error of their laws.
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
        """The relative error of each effect that acts together with it."""
        return dict.fromkeys(self.acting.names, self.form)


@dataclass(frozen=True)
class _Grid:
    """Possible sizes and axes of a force, over which its evidence is integrated."""

    model: LinearModel
    acting: Acting
    forms: Mapping[str, FormShare]
    nodes: tuple[Wide, ...]
    idle: Flags
    log_prior: Array

    def information(self, psi: Array) -> Information:
        """Return the information of coefficients, at noise parameters."""
        places = [place for law in self.acting.laws for place in law.places]
        said = self.model.information_on(psi, places, self.acting.phases)
        return self.model.mixed(said, places, self.acting)

    def log_evidences(self, psi: Array, of: Whole) -> Array:
        """Return the log evidence of some nodes at noise parameters, times their prior weights.

        It is -inf where a node is idle.
        """
        information = self.information(psi)
        priors = [self.model.amplitude_prior(law) for law in self.acting.laws]
        nothing = np.array([], dtype=np.intp)
        log_prior, _ = self.model.log_prior(psi, self.acting)
        log_densities = [
            information.reduced(
                *self.model.prior(priors, self.nodes[n], self.forms), nothing
            ).log_evidence
            for n in of
        ]
        log_evidences = log_prior + np.array(log_densities) + self.log_prior[of]
        return np.where(self.idle[of], -np.inf, log_evidences)

    def beyond(self, node: Wide) -> "_Grid | None":
        """Return the grid with forces larger than a node; None if it is not the largest quantile.

        A force may be many times larger than the prior's quantiles, as that of another joint that
        moves. Elsewhere these nodes would add nothing to the evidence.
        """
        top = self.nodes[len(QUANTILES) - 1].share
        larger = tuple(replace(node, share=factor * top) for factor in BEYOND)
        if node.share != top or larger[0] in self.nodes:
            return None
        rare = np.full(len(larger), self.log_prior[0] + np.log(RARE))
        return replace(
            self,
            nodes=(*self.nodes, *larger),
            idle=np.append(self.idle, np.zeros(len(larger), dtype=np.bool_)),
            log_prior=np.append(self.log_prior, rare),
        )

    def likeliest(self, starts: Sequence[Array]) -> Array:
        """Return the noise parameters at which a force of middling size is likeliest."""
        middling = np.arange(len(QUANTILES) // 2, len(self.nodes), len(QUANTILES))
        return starts[int(np.argmax([self.log_evidences(psi, middling).max() for psi in starts]))]


def unknown_force(
    model: LinearModel,
    without: Weighed,
    acting: Acting,
    inverse: Array,
    volume: float,
    starts: Sequence[Array] = (),
    near: float | None = None,
) -> Unknown | None:
    """Return the evidence of a smooth force beyond the discrepancy, along all axes or one.

    Parameters
    ----------
    model : LinearModel
        All rigs.
    without : Weighed
        The hypothesis without the force.
    acting : Acting
        Effects that act together with it.
    inverse, volume
        Inverse curvature and log volume of the noise without effects.
    starts : sequence of ndarray
        Further noise parameters to start from.
    near : float or None
        With a log evidence above this, the volume of the noise is computed for this force.
    """
    axes = model.full.acting_axes
    if not axes:
        return None
    forms = without.forms
    grid = _Grid(model.full, acting, forms, *_nodes(model.full, axes))
    psi = without.at.psi
    alike = (start for start in starts if start.size == psi.size)
    psi = grid.likeliest([psi, grid.model.noise.quiet(psi), *alike])
    log_evidences = grid.log_evidences(psi, np.arange(len(grid.nodes)))
    for _ in range(2):
        grid, log_evidences = _with_larger(grid, psi, log_evidences)
        # The search for the mode needs few coefficients; the evidence contains all of them.
        small = squeezed(grid.model, psi, grid.nodes[int(np.argmax(log_evidences))])
        there = climb(small, psi, acting, None, forms, inverse)
        settled = bool(np.abs(there.psi - psi).max() < 0.05)
        psi = there.psi
        small = small.reweighted(psi, acting, None, forms)
        grid = replace(grid, model=small.full)
        likely = np.flatnonzero(log_evidences > log_evidences.max() - LIKELY)
        log_evidences[likely] = grid.log_evidences(psi, likely)
        if settled:
            break
    likeliest = grid.nodes[int(np.argmax(log_evidences))]
    at = grid.model.integrated(psi, acting, grid.information(psi), likeliest, forms)
    total = float(logsumexp(log_evidences)) + volume
    total += over_amplitudes(small, there, acting, forms) + small.weight_volume
    if near is not None and total > near:
        noise = slice(len(grid.model.noise))
        total += log_volume(curvature_at(small, there, acting, forms)[noise, noise]) - volume
    # All axes together and each single axis have the same prior probability.
    densities = log_evidences - logsumexp(log_evidences)
    return Unknown(grid.nodes, densities, total, at, acting, without.form)


def _with_larger(grid: _Grid, psi: Array, log_evidences: Array) -> tuple[_Grid, Array]:
    """Return a grid and its log evidences, with larger forces where the largest is the best."""
    extended = grid.beyond(grid.nodes[int(np.argmax(log_evidences))])
    if extended is None:
        return grid, log_evidences
    added = extended.log_evidences(psi, np.arange(len(grid.nodes), len(extended.nodes)))
    return extended, np.append(log_evidences, added)


def _nodes(model: LinearModel, axes: Sequence[str]) -> tuple[tuple[Wide, ...], Flags, Array]:
    """Return possible rms values and axes of a force, which are scatter, and log prior weights."""
    scale = model.analysis.diagnosis.unknown_scale
    shares = [scale * float(ndtri((1 + node) / 2)) for node in QUANTILES]  # half-normal
    # Events resolve an error along speed at hundreds of positions. Forces that also differ by size,
    # load and rig need many coefficients there, and their evidence is low. Other axes have few
    # values.
    where: list[tuple[str | None, bool]] = [(None, False), *((axis, False) for axis in axes)]
    where += [(axis, True) for axis in axes if axis == "velocity"]
    nodes = tuple(Wide(share, *node) for node in where for share in shares)
    # Along these axes a force below the practical share is scatter.
    practical = model.analysis.diagnosis.practical_share
    scattering = {axis for rig in model.rigs for axis in rig.rows.scattering_axes}
    idle = np.array([node.axis in scattering and node.share < practical for node in nodes])
    return nodes, idle, np.full(len(nodes), -np.log(len(nodes)))
