"""The trial that would best distinguish the hypotheses that these data leave open.

Feasible conditions, combined from recorded ones, are simulated as trials without noise. The
expected log Bayes factor of a trial is half the squared difference of the predictions of two
hypotheses. Its unit is their uncertainty: noise, scatter of friction, the posterior of the law, and
the discrepancy of every hypothesis.
"""

from collections.abc import Mapping
from itertools import combinations

import numpy as np

from bayesfric.arrays import Array, Whole
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.diagnosis_rules import RULES
from bayesfric.hypothesis import Hypothesis
from bayesfric.inference.symmetric import eigen_of, root_of
from bayesfric.observation.layout import COEFFICIENTS
from bayesfric.observation.linear import LinearRig
from bayesfric.probabilities import LN10
from bayesfric.rigs.base import RigTrials
from bayesfric.rigs.data import Data
from bayesfric.schemas.diagnosis import NextExperiment

Places = Whole
RIVALS = 3
PULLEYS = ("pulley_size", "n_pulleys", "wrap_angle_deg")


def next_experiment(
    model: LinearModel, search: Search, chances: Mapping[Hypothesis, float]
) -> tuple[tuple[NextExperiment, ...], str | None]:
    """Propose a trial for each pair of hypotheses that remain open.

    Parameters
    ----------
    model : LinearModel
        The model in which the hypotheses were compared.
    search : Search
        The hypotheses.
    chances : mapping of Hypothesis to float
        Posterior probabilities, the largest first.

    Returns
    -------
    proposals : tuple of NextExperiment
        Proposals, the one with the largest expected Bayes factor first.
    why : str or None
        Why there is no proposal.
    """
    open_ = [
        search.weighed[hypothesis]
        for hypothesis, p in chances.items()
        if p >= RULES.rival and hypothesis in search.weighed
    ][:RIVALS]
    if len(open_) < 2:
        return (), "no two plausible hypotheses are left to separate"
    data = feasible_trials(model)
    if not data.rigs:
        return (), "no further trial of such a recording can be predicted"
    proposals = []
    for first, other in combinations(open_, 2):
        best = _most_telling(model, data, first, other)
        if best is not None and best.log10_bayes_factor > np.log10(RULES.next_trial_factor):
            proposals.append(best)
    if not proposals:
        return (
            (),
            "one more trial within what was recorded tells them apart by less than two to one",
        )
    return tuple(sorted(proposals, key=lambda proposal: -proposal.log10_bayes_factor)), None


def _most_telling(
    model: LinearModel, data: Data, first: Weighed, other: Weighed
) -> NextExperiment | None:
    """Return the trial that separates two hypotheses best; None if no trial separates them."""
    laws = (*first.acting.laws, *other.acting.laws)
    shapes = (*first.acting.shapes, *other.acting.shapes)
    candidates = [model.candidate(law, shape) for law, shape in zip(laws, shapes, strict=True)]
    rows = LinearModel(
        data,
        model.laws,
        candidates,
        model.analysis,
        model.fixed,
        scattering=model.scattering,
        small=model.full.discrepancy.amounts,
    )
    noise = model.noise.named(first.at.psi)
    left_open = _left_open(rows)
    best: NextExperiment | None = None
    for trials, rig in zip(data.rigs, rows.rigs, strict=True):
        information = rig.information_by_trial(noise)
        mean = np.zeros((information.shape[0], information.shape[2]))
        spreads = []
        start = 0
        for which, sign in ((first, 1.0), (other, -1.0)):
            for size in range(len(model.layout.sizes)):
                mine = rig.size == size
                place, kept = _shared(model, rows, rig, which, start, size)
                mean[np.ix_(mine, place)] += sign * which.at.mean[kept]
            spreads.append((start, which))
            start += len(which.acting.laws)
        expected = np.array(
            [
                _expected(
                    model, rows, rig, trial, information[trial], mean[trial], spreads, left_open
                )
                for trial in range(len(information))
            ]
        )
        top = int(np.argmax(expected))
        if best is None or expected[top] > best.log10_bayes_factor:
            best = NextExperiment(
                condition={"rig": rig.rows.name, **condition_of(trials, rig, top)},
                separates=(str(first.hypothesis), str(other.hypothesis)),
                log10_bayes_factor=float(expected[top]),
            )
    return best


def feasible_trials(model: LinearModel) -> Data:
    """Return the trials that the rigs of a model could run next, simulated without noise."""
    laid = (trials.next_trials(model.laws) for trials in model.data.rigs)
    return Data(tuple(trials for trials in laid if trials is not None))


def condition_of(trials: RigTrials, rig: LinearRig, trial: int) -> dict[str, float | str]:
    """Return the condition of a trial, by column of its recording.

    Parameters
    ----------
    trials : RigTrials
        Trials of a rig.
    rig : LinearRig
        Linear model of these trials.
    trial : int
        Index of the trial.
    """
    names = (*(PULLEYS if trials.has_pulleys else ()), *rig.rows.loads)
    values = ((name, rig.rows.table[name].iloc[trial]) for name in names)
    return {name: value if isinstance(value, str) else float(value) for name, value in values}


def _left_open(rows: LinearModel) -> Array:
    """Return the prior variance of the discrepancy's local numbers, 0 for others, shape (q,)."""
    layout = rows.layout
    own, shared = rows.discrepancy.rms(None)
    open_numbers = np.zeros(layout.local)
    open_numbers[COEFFICIENTS : COEFFICIENTS + own.size] = own**2
    start = layout.own + layout.candidates
    open_numbers[start : start + shared.size] = shared**2
    return open_numbers


def _shared(
    model: LinearModel, rows: LinearModel, rig: LinearRig, which: Weighed, start: int, size: int
) -> tuple[Places, Places]:
    """Return the positions of the numbers that a new trial and a hypothesis share.

    Parameters
    ----------
    model, rows : LinearModel
        Models of the hypothesis and of the new trials.
    rig : LinearRig
        Rig of the new trials.
    which : Weighed
        The hypothesis.
    start : int
        Position of the hypothesis' first effect among the candidates of the new trials.
    size : int
        Index of the trial's pulley size.

    Returns
    -------
    local, kept : ndarray of int
        Positions of coefficients, effects and the rig's nuisances in both.
    """
    layout, count = model.layout, len(which.acting.laws)
    own = np.arange(COEFFICIENTS)
    first = rows.layout.own + start
    names = [rig_part.rows.name for rig_part in model.rigs]
    mine = layout.nuisance(names.index(rig.rows.name))
    # From local numbers to numbers of all sizes: candidates are combined, sizes follow in turn.
    moved = count - layout.candidates + layout.own * (len(layout.sizes) - 1)
    laid = np.arange(rows.layout.local)[rows.layout.nuisance(rows.rigs.index(rig))]
    local = np.r_[own, first + np.arange(count), laid]
    # A new trial has no nuisances of a sensor that it lacks.
    nuisances = mine.start + moved + np.arange(laid.size)
    return local, np.r_[size * layout.own + own, model.places(count), nuisances]


def _expected(
    model: LinearModel,
    rows: LinearModel,
    rig: LinearRig,
    trial: int,
    information: Array,
    mean: Array,
    spreads: list[tuple[int, Weighed]],
    left_open: Array,
) -> float:
    """Return the expected log10 Bayes factor of one trial.

    Parameters
    ----------
    model, rows, rig
        As of :func:`_shared`.
    trial : int
        Index of the trial.
    information : ndarray, shape (q, q)
        Information of the trial on the local numbers, with scatter marginalised.
    mean : ndarray, shape (q,)
        Difference of the hypotheses' predictions, in local numbers.
    spreads : list of (int, Weighed)
        Position of the first effect of each hypothesis, and the hypothesis.
    left_open : ndarray, shape (q,)
        Prior variance of the discrepancy's local numbers.
    """
    covariance = np.diag(left_open)
    for start, which in spreads:
        place, kept = _shared(model, rows, rig, which, start, int(rig.size[trial]))
        covariance[np.ix_(place, place)] += which.at.covariance[np.ix_(kept, kept)]
    taken = information @ mean
    root = root_of(covariance)
    stiffness, turned = eigen_of(root.T @ information @ root)
    moved = turned.T @ (root.T @ taken)
    square = mean @ taken - (moved**2 / (1 + np.maximum(stiffness, 0.0))).sum()
    return float(square) / 2 / LN10
