"""Shapes looked at more closely where an effect is there.

Data that speak for an effect by thousands of nats tell its shape to a hundredth of
what the prior leaves open. Nodes are added around the best one until they are as close.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from bayesfric.diagnosis.forms import SHARES, other_forms
from bayesfric.diagnosis.linear_model import Acting, LinearModel
from bayesfric.diagnosis.reference import amplitudes_of, fitted_laws
from bayesfric.diagnosis.small_amounts import relative_rms
from bayesfric.diagnosis.weighing import Weighed, candidates_by_name, single_gains
from bayesfric.effects.candidates import Candidate, candidates_of

__all__ = ["share_of_form", "sharpened", "sharpened_around", "widened_by"]

Array = NDArray[np.float64]
ROUNDS = 2
NEW = np.array([-3, -2, -1, 1, 2, 3]) / 4  # cells from the best node
GAIN = 10.0  # nat that an effect alone adds, from which on its shape is looked at
FORM = 0.1  # of an effect's force, by which its law may be wrong before the data are asked
LEAST = 0.05  # of it, by which any law is: tension differs from pulley to pulley
NEAR = 0.01  # width of a cell, in normal quantiles: closer, and no more nodes are needed


def sharpened(model: LinearModel, psi: Array) -> tuple[LinearModel, Array]:
    """Add nodes to the shapes of effects that help on their own; start with the best of them.

    With the best one a trial is followed back to its release, which effects of the first
    stretch of travel need to be told from each other.

    Parameters
    ----------
    model : LinearModel
        With the usual nodes.
    psi : ndarray
        Logarithms of the noise under the baseline alone.

    Returns
    -------
    model : LinearModel
        With more candidates, or the same.
    psi : ndarray
        Logarithms of the noise with the best effect alone.
    """
    for _ in range(ROUNDS):
        gains = _gains(model, psi)
        if not np.any(gains > GAIN):
            return model, psi
        best = Acting((int(np.argmax(gains)),))
        psi, _ = model.climb(psi, best)
        gains = _gains(model, psi)
        model = model.around(
            fitted_laws(model, psi, best),
            _with_nodes(model, gains, gains > GAIN),
            released=amplitudes_of(model, psi, best),
        )
    return model, psi


def sharpened_around(model: LinearModel, found: Weighed) -> LinearModel:
    """Linearise around the law fitted with effects that act together; sharpen their shapes.

    No law of an effect is quite right: the discrepancy grows by a tenth of what the effects
    do, and each law may be wrong by more along what it acts over, lest the difference between
    two forms of one effect pass for another effect.
    """
    best = np.full(len(model.candidates), -np.inf)
    for choice, weight in zip(found.choices, found.log_weights, strict=True):
        for place in choice.columns:
            best[place] = max(best[place], weight)
    acting = amplitudes_of(model, found.psi, found.best)
    rows = None if model.gravity is None else model.gravity.rows
    return model.around(
        fitted_laws(model, found.psi, found.best),
        _with_nodes(model, best, np.isfinite(best)),
        scattering=acting,
        widened=widened_by(FORM, model, model, found),
        forms=other_forms(rows, model.motor, acting),
    )


def share_of_form(found: Weighed) -> float:
    """Return by which share of what causes do their laws are wrong, by the data.

    Causes without forms have the same evidence at every share.
    """
    if np.ptp(found.log_shares) == 0:
        return FORM
    weights = np.exp(found.log_shares - logsumexp(found.log_shares))
    return float(np.sqrt(LEAST**2 + weights @ np.square(SHARES)))


def widened_by(share: float, model: LinearModel, around: LinearModel, found: Weighed) -> float:
    """Return how many times as wide the discrepancy is with a share of what causes do.

    Parameters
    ----------
    share : float
        Of it.
    model : LinearModel
        Whose discrepancy is widened.
    around : LinearModel
        In which the causes were found.
    found : Weighed
        The causes.
    """
    rows = None if around.gravity is None else around.gravity.rows
    acting = amplitudes_of(around, found.psi, found.best)
    sizes = [relative_rms(rows, around.motor, one) * amplitude for one, amplitude in acting]
    sizes += [around.candidates[place].amplitude for place in found.best.phases]
    return float(np.hypot(1.0, share * np.linalg.norm(sizes) / model.practical_share))


def _gains(model: LinearModel, psi: Array) -> Array:
    """Return what each candidate alone adds, -inf of those with phases, shape (E,)."""
    columns = tuple(p for p, c in enumerate(model.candidates) if not c.effect.components)
    mean, sd = model.prior(columns)
    reduced = model.information(psi, Acting(columns)).reduced(mean, sd, model.places(columns))
    gains = np.full(len(model.candidates), -np.inf)
    gains[list(columns)] = single_gains([model.candidates[p] for p in columns], reduced)
    return gains


def _with_nodes(model: LinearModel, value: Array, wanted: NDArray[np.bool_]) -> list[Candidate]:
    """Return the candidates with nodes added around the best of each law."""
    candidates: list[Candidate] = []
    for places in candidates_by_name(model).values():
        effect = model.candidates[places[0]].effect
        nodes: dict[str, Array] = {}
        for law in effect.laws:
            own = [place for place in places if model.candidates[place].law == law]
            nodes[law] = np.array([model.candidates[place].node for place in own])
            best = max(own, key=lambda place: value[place])
            cell = model.candidates[best].cell
            if effect.shape is not None and wanted[best] and cell > NEAR:
                more = model.candidates[best].node + cell * NEW
                nodes[law] = np.unique(np.concatenate([nodes[law], more]).round(9))
        candidates += candidates_of(effect, nodes)
    return candidates
