"""The trial that would tell apart what these data leave open.

Conditions that a rig can have, by what was recorded, are laid out as trials without noise; the
expected log Bayes factor of one trial is half the squared distance of what two hypotheses
predict, in units of the noise, friction's scatter and what is not known of the law.
"""

from collections.abc import Mapping
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.search import UNKNOWN, Search
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.rigs.data import Data
from bayesfric.rigs.layout import COEFFICIENTS
from bayesfric.schemas import NextExperiment

__all__ = ["next_experiment"]

Array = NDArray[np.float64]
RIVAL = 0.05  # probability of a hypothesis that is still in question
RIVALS = 3
PULLEYS = ("pulley_size", "n_pulleys", "wrap_angle_deg")
TWO = float(np.log10(2))  # expected log10 Bayes factor below which a trial is not worth it
LN10 = float(np.log(10))


def next_experiment(
    model: LinearModel, search: Search, chances: Mapping[str, float]
) -> tuple[tuple[NextExperiment, ...], str | None]:
    """Propose a trial for each two hypotheses that are still in question.

    Parameters
    ----------
    model : LinearModel
        In which hypotheses were compared.
    search : Search
        The hypotheses.
    chances : mapping of str to float
        Posterior probabilities, the largest first.

    Returns
    -------
    proposals : tuple of NextExperiment
        The most telling first.
    why : str or None
        Why there is none.
    """
    open_ = [
        search.weighed[name]
        for name, p in chances.items()
        if p >= RIVAL and name != UNKNOWN and name in search.weighed
    ][:RIVALS]
    if len(open_) < 2:
        return (), "no two hypotheses are left to separate"
    laid = [one.next_trials(model.laws) for one in model.data.rigs]
    rigs = tuple(one for one in laid if one is not None)
    if not rigs:
        return (), "no rig could run another trial within what was recorded"
    found = []
    for one, other in combinations(open_, 2):
        best = _most_telling(model, Data(rigs), one, other)
        if best is not None and best.log10_bayes_factor > TWO:
            found.append(best)
    if not found:
        return (
            (),
            "one more trial within what was recorded tells them apart by less than two to one",
        )
    return tuple(sorted(found, key=lambda one: -one.log10_bayes_factor)), None


def _most_telling(
    model: LinearModel, data: Data, one: Weighed, other: Weighed
) -> NextExperiment | None:
    """Return the trial that separates two hypotheses best; None where none says anything."""
    laws = (*one.acting.laws, *other.acting.laws)
    shapes = (*one.acting.shapes, *other.acting.shapes)
    candidates = [model.candidate(law, shape) for law, shape in zip(laws, shapes, strict=True)]
    rows = LinearModel(
        data,
        model.laws,
        candidates,
        model.analysis,
        model.fixed,
        discrepancy=False,
        scattering=model.scattering,
    )
    noise = model.named(one.at.psi)
    best: NextExperiment | None = None
    for trials, rig in zip(data.rigs, rows.rigs, strict=True):
        told = rig.told(noise)
        mean = np.zeros((told.shape[0], told.shape[2]))
        spreads = []
        start = 0
        for which, sign in ((one, 1.0), (other, -1.0)):
            count = len(which.acting.laws)
            for size in range(len(model.layout.sizes)):
                mine = rig.size == size
                own = size * model.layout.own + np.arange(COEFFICIENTS)
                kept = np.concatenate([own, model.places(count)])
                place = np.concatenate(
                    [
                        np.arange(COEFFICIENTS),
                        COEFFICIENTS + start + np.arange(count),
                    ]
                )
                mean[np.ix_(mine, place)] += sign * which.at.mean[kept]
            spreads.append((start, count, which))
            start += count
        found = np.array(
            [
                _expected(model, told[trial], mean[trial], spreads, int(rig.size[trial]))
                for trial in range(len(told))
            ]
        )
        top = int(np.argmax(found))
        if best is None or found[top] > best.log10_bayes_factor:
            row = rig.rows.table.iloc[top]
            names = (*(PULLEYS if trials.has_pulleys else ()), *rig.rows.loads)
            condition: dict[str, float | str] = {"rig": rig.rows.name}
            for name in names:
                value = row[name]
                condition[name] = value if isinstance(value, str) else float(value)
            best = NextExperiment(
                condition=condition,
                separates=(one.label, other.label),
                log10_bayes_factor=float(found[top]),
            )
    return best


def _expected(
    model: LinearModel,
    told: Array,
    mean: Array,
    spreads: list[tuple[int, int, Weighed]],
    size: int,
) -> float:
    """Return the expected log10 Bayes factor of one trial.

    Parameters
    ----------
    model : LinearModel
        For what is known of the numbers.
    told : ndarray, shape (q, q)
        Information of the trial on the local numbers, scatter taken up.
    mean : ndarray, shape (q,)
        Difference of what the hypotheses predict, in local numbers.
    spreads : list of (int, int, Weighed)
        Where each one's effects begin, how many, and the hypothesis.
    size : int
        Of the trial's pulleys.
    """
    covariance = np.zeros_like(told)
    for start, count, which in spreads:
        own = size * model.layout.own + np.arange(COEFFICIENTS)
        kept = np.concatenate([own, model.places(count)])
        place = np.concatenate([np.arange(COEFFICIENTS), COEFFICIENTS + start + np.arange(count)])
        covariance[np.ix_(place, place)] += which.at.covariance[np.ix_(kept, kept)]
    taken = told @ mean
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    stiffness, turned = np.linalg.eigh(root.T @ told @ root)
    moved = turned.T @ (root.T @ taken)
    square = mean @ taken - (moved**2 / (1 + np.maximum(stiffness, 0.0))).sum()
    return float(square) / 2 / LN10
