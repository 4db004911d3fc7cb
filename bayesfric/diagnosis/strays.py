"""Readings and rows far from all others get less weight, as with a Student-t distribution.

A linear model is normal given the weight of each row. A row that is far from the prediction of the
most probable hypothesis has the weight of a Student-t density; all other rows have weight 1.
Hypotheses are compared with the same weights. The weights are computed again if the most probable
hypothesis has changed.
"""

from collections.abc import Callable, Mapping

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.diagnosis.acting import At
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import Residuals, residuals_of, spread_numbers
from bayesfric.diagnosis_rules import RULES
from bayesfric.hypothesis import UNKNOWN
from bayesfric.inference.symmetric import root_of

TO_SD = 1.4826  # sd of a normal variable over the median of its absolute values
ROUNDS = 8
SETTLED = 0.3  # of the logarithm of a weight
MOST_LEVERAGE = 1 - 1e-6


def stray_weights(
    off: Array, before: Array | None = None, surely: Array | None = None
) -> Array | None:
    """Return the weight of each row, or None if too many rows are far away.

    Parameters
    ----------
    off : ndarray, shape (N,)
        Deviation of each row from its prediction, in any multiple of standard deviations.
    before : ndarray, shape (N,), or None
        Weights with which the prediction was made. Only the farthest row is added to the strays of
        these weights, because it may have changed the prediction of the others. None if a single
        row changes no prediction; all strays are then taken at once.
    surely : ndarray, shape (N,), or None
        Like `off`, but smaller where the prediction is uncertain. It decides which row is the
        farthest.

    Returns
    -------
    ndarray, shape (N,), or None
        1 except for strays.

    References
    ----------
    K. L. Lange, R. J. A. Little, J. M. G. Taylor, "Robust statistical modeling using the t
    distribution", JASA 84 (1989): the weights of a fit by expectation and maximisation.
    """
    weight = np.ones(off.size)
    spread = TO_SD * float(np.median(np.abs(off))) if off.size else 0.0
    if off.size < RULES.stray_least_rows or spread == 0:
        return weight
    z = np.abs(off) / spread
    stray = z > RULES.stray
    if before is not None and stray.any():
        far = np.abs(off if surely is None else surely)
        farthest = np.arange(off.size) == np.argmax(np.where(stray & (before == 1), far, -1.0))
        stray &= farthest | (before < 1)
    if stray.sum() > max(1.0, RULES.most_strays * off.size):
        return None
    weight[stray] = (RULES.stray_freedom + 1) / (RULES.stray_freedom + z[stray] ** 2)
    return weight


def without_strays(
    model: LinearModel,
    search: Search,
    anew: Callable[[Mapping[str, Array]], tuple[LinearModel, Search]],
) -> tuple[LinearModel, Search]:
    """Return a model in which strays have little weight, and the hypotheses in it.

    Parameters
    ----------
    model : LinearModel
        The model in which hypotheses were compared with equal weights.
    search : Search
        The hypotheses.
    anew : callable
        Of the weights of rows, by rig, to a model with them and its hypotheses.
    """
    equal = model, search
    for _ in range(ROUNDS):
        weights = _weights_by(model, search)
        if weights is None:
            return equal
        if _alike(weights, model.full.row_weights):
            break
        model, search = anew(weights)
    return model, search


def far_rows(model: LinearModel) -> tuple[str, ...]:
    """Return a sentence on strays for each rig that has some."""
    said = []
    for rig in model.rigs:
        weight = model.full.row_weights.get(rig.rows.name)
        little = np.flatnonzero(weight < RULES.stray_told) if weight is not None else np.array([])
        if weight is None or not little.size:
            continue
        if weight.size == len(rig.rows.table):
            names = ", ".join(str(rig.rows.table["trial"].iloc[row]) for row in little)
            said.append(f"Trials with little weight, since they are far from all others: {names}")
        else:
            said.append(
                f"{little.size} of {weight.size} windows have little weight, since they are far "
                "from all others"
            )
    return tuple(said)


def _weights_by(model: LinearModel, search: Search) -> dict[str, Array] | None:
    """Return the weights of rows that are far from the likeliest hypothesis, by rig.

    None if too many rows are far away. Rows of the paper's boards have equal weights.
    """
    if all(trials.rig.words.paper for trials in model.data.rigs):
        return {}
    best, own, force = search.best(), model, search.unknown
    at, acting = best.at, best.acting
    if force is not None and search.probabilities()[UNKNOWN] >= RULES.likely:
        own, at, acting = model.full, force.at, force.acting
    plain = own.full
    if plain.row_weights:  # strays are identified at equal weights
        plain = plain.around(plain.laws, plain.candidates, row_weights={})
    windows = residuals_of(plain, at.psi)
    mixing = own.mixing(acting)
    off = windows.left(spread_numbers(own, at.mean, mixing)) / np.sqrt(windows.chance2)
    weights = {}
    for place, rig in enumerate(plain.rigs):
        mine = windows.rig == place
        if not plain.data.rigs[place].rig.words.paper:
            alone, before, surely = off[mine], None, None
            if alone.size == len(rig.rows.table):
                # If an effect follows a reading that no other confirms, this is no agreement.
                kept = 1 - _leverage(windows, mine, own, at, mixing)
                surely, alone = alone / np.sqrt(kept), alone / kept
                before = model.full.row_weights.get(rig.rows.name, np.ones(alone.size))
            weight = stray_weights(alone, before, surely)
            if weight is None:
                return None
            if np.any(weight < 1):
                weights[rig.rows.name] = weight
    return weights


def _leverage(windows: Residuals, rows: Flags, model: LinearModel, at: At, mixing: Array) -> Array:
    """Return the leverage of each reading on its own prediction, below 1."""
    local = spread_numbers(model, root_of(at.covariance).T, mixing)[:, windows.size[rows]]
    moved2 = (np.einsum("prq,rq->pr", local, windows.columns[rows]) ** 2).sum(axis=0)
    return np.asarray(np.minimum(moved2 / windows.chance2[rows], MOST_LEVERAGE))


def _alike(first: Mapping[str, Array], other: Mapping[str, Array]) -> bool:
    if set(first) != set(other):
        return False
    return all(np.abs(np.log(first[name] / other[name])).max() < SETTLED for name in first)
