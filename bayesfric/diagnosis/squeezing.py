"""Removes combinations of the discrepancy's coefficients that the data do not inform."""

from copy import copy
from dataclasses import replace

import numpy as np
from scipy.linalg import block_diag

from bayesfric.arrays import Array
from bayesfric.diagnosis.discrepancy import Wide
from bayesfric.diagnosis.information_cache import InformationCache
from bayesfric.diagnosis.model import LinearModel
from bayesfric.inference.symmetric import eigen_of
from bayesfric.observation.layout import COEFFICIENTS

SEEN = 0.02  # information relative to the prior's; numbers with less are removed


def squeezed(model: LinearModel, psi: Array, wide: Wide | None = None) -> LinearModel:
    """Return the model with fewer numbers of the discrepancy.

    Combinations of smooth forces and small amounts are removed if the data do not inform them
    even with the scatter of a good rig: their information, relative to that of the prior, is
    below :data:`SEEN`. ``full`` of the result is this model.

    Parameters
    ----------
    model : LinearModel
        All rigs.
    psi : ndarray
        Logarithms of the noise parameters.
    wide : Wide or None
        Smooth forces with a larger rms than in the discrepancy; the result has this rms.
    """
    layout, sizes = model.layout, len(model.layout.sizes)
    information = model.information_on(model.noise.quiet(psi[: len(model.noise)]), ())
    _, sd = model.prior((), wide)
    whole = sd[:, None] * information.precision * sd
    forms = len(model.forms)
    smooths = np.arange(COEFFICIENTS, layout.own)
    blocks = [np.ix_(smooths + layout.own * s, smooths + layout.own * s) for s in range(sizes)]
    start = layout.own * sizes
    taken = np.arange(start, start + layout.shared - forms)
    of_own = _seen(np.sum([whole[block] for block in blocks], axis=0))
    of_shared = _seen(whole[np.ix_(taken, taken)])
    squeezed = replace(layout, smooths=of_own.shape[1], shared=of_shared.shape[1] + forms)
    first = layout.own + layout.candidates
    squeeze = block_diag(
        np.eye(COEFFICIENTS),
        sd[COEFFICIENTS : layout.own, None] * of_own,
        np.eye(layout.candidates),
        sd[taken, None] * of_shared,
        np.eye(layout.local - first - taken.size),
    )
    squeezed_model = copy(model)
    squeezed_model.squeezed_from, squeezed_model.squeeze, squeezed_model.layout = (
        model,
        squeeze,
        squeezed,
    )
    squeezed_model.information_cache = InformationCache()
    squeezed_model.rigs = tuple(rig.squeezed(squeeze, squeezed) for rig in model.rigs)
    squeezed_model.scales = np.ones(squeezed.local)
    squeezed_model.scales[:COEFFICIENTS] = model.scales[:COEFFICIENTS]
    mine = slice(squeezed.own, squeezed.own + squeezed.candidates)
    squeezed_model.scales[mine] = model.scales[layout.own : first]
    return squeezed_model


def _seen(information: Array) -> Array:
    """Return combinations of numbers (with unit prior) that the data inform, (n, k)."""
    values, vectors = eigen_of(0.5 * (information + information.T))
    return np.asarray(vectors[:, values > SEEN])
