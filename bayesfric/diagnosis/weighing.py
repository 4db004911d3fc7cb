"""The evidence of effects that act together, their laws and shapes averaged."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr, logsumexp

from bayesfric.diagnosis.linear_model import Acting, LinearModel
from bayesfric.effects.candidates import Candidate, is_positive
from bayesfric.inference.information import Reduced

__all__ = ["Weighed", "candidates_by_name", "combine", "single_gains", "weigh"]

Array = NDArray[np.float64]
ROUNDS = 3  # of choosing laws and shapes, and noise, in turn
WORTH = -40.0  # log weight below the best, of a choice of laws and shapes that is kept


@dataclass(frozen=True)
class Weighed:
    """Effects that act together, weighed.

    Parameters
    ----------
    names : tuple of str
        Effects; none for the baseline alone.
    log_evidence : float
        Without the volume of the noise's mode, which hypotheses share unless it is
        computed.
    psi : ndarray
        Logarithms of the noise at the mode.
    choices : tuple of Acting
        Candidates that act, one choice of laws and shapes each.
    log_weights : ndarray
        Of each choice, normalised.
    log_shares : ndarray
        Log evidence by what laws may be wrong by, of each share that was tried.
    """

    names: tuple[str, ...]
    log_evidence: float
    psi: Array
    choices: tuple[Acting, ...]
    log_weights: Array
    log_shares: Array

    @property
    def best(self) -> Acting:
        """The most probable choice of laws and shapes."""
        return self.choices[int(np.argmax(self.log_weights))]


def candidates_by_name(model: LinearModel) -> dict[str, list[int]]:
    """Return the places of each effect's candidates."""
    places: dict[str, list[int]] = {}
    for place, candidate in enumerate(model.candidates):
        places.setdefault(candidate.effect.name, []).append(place)
    return places


def weigh(
    model: LinearModel,
    names: Sequence[str],
    psi: Array,
    *,
    climb: bool = True,
    shares: Sequence[float] = (0.0,),
) -> Weighed:
    """Weigh effects that act together.

    Parameters
    ----------
    model : LinearModel
        The boards.
    names : sequence of str
        Effects.
    psi : ndarray
        Logarithms of the noise, a start.
    climb : bool
        Whether to look for the mode of the noise; else it is taken as `psi`.
    shares : sequence of float
        By which shares of what effects do their laws may be wrong, summed over.
    """
    places = candidates_by_name(model)
    each = [places[name] for name in names]
    for _ in range(ROUNDS if climb else 1):
        choices, values = _choices(model, each, psi, shares)
        if not climb:
            break
        form, place = divmod(int(np.argmax(values)), len(choices))
        moved, _ = model.climb(psi, choices[place], form=shares[form])
        settled = bool(np.abs(moved - psi).max() < 1e-2)
        psi = moved
        if settled:
            break
    if climb:
        choices, values = _choices(model, each, psi, shares)
    log_values = logsumexp(values, axis=0)
    total = float(logsumexp(log_values))
    kept = np.flatnonzero(log_values > log_values.max() + WORTH)
    return Weighed(
        tuple(names),
        total + model.log_prior(psi),
        psi,
        tuple(choices[index] for index in kept),
        log_values[kept] - logsumexp(log_values[kept]),
        logsumexp(values, axis=1),
    )


def _choices(
    model: LinearModel, each: list[list[int]], psi: Array, shares: Sequence[float]
) -> tuple[list[Acting], Array]:
    """Return every choice of a candidate from each effect, with its weighted log evidence.

    The log evidence has a row a share by which laws may be wrong.
    """
    with_phases = [[p for p in places if model.candidates[p].effect.components] for places in each]
    columns = tuple(
        p for places in each for p in places if not model.candidates[p].effect.components
    )
    fixed = [places for places in with_phases if places]
    free = [places for places, phases in zip(each, with_phases, strict=True) if not phases]
    together = list(product(*free))
    places = np.array(together, dtype=np.intp)
    stands = np.zeros(len(model.candidates), dtype=np.intp)
    stands[list(columns)] = np.arange(len(columns))
    own_weight = np.array([candidate.log_weight for candidate in model.candidates])
    choices: list[Acting] = []
    values: list[Array] = []
    for phases in product(*fixed):
        information = model.information(psi, Acting(columns, phases))
        choices += [Acting(chosen, phases) for chosen in together]
        weight = own_weight[list(phases)].sum() + own_weight[places].sum(axis=1)
        rows = []
        for form in shares:
            mean, sd = model.prior(columns, form=form)
            reduced = information.reduced(mean, sd, model.places(columns))
            rows.append(weight + combine(model, reduced, stands[places], places))
        values.append(np.stack(rows))
    return choices, np.concatenate(values, axis=1)


def combine(
    model: LinearModel, reduced: Reduced, inside: NDArray[np.intp], chosen: NDArray[np.intp]
) -> Array:
    """Return the log evidence of candidates that act together, shape (M,).

    Parameters
    ----------
    model : LinearModel
        For the priors.
    reduced : Reduced
        The quadratic form in the amplitudes.
    inside : ndarray of int, shape (M, k)
        Places of k candidates in it, a choice of them a row.
    chosen : ndarray of int, shape (M, k)
        Their places among the model's candidates.
    """
    precision = reduced.precision[inside[:, :, None], inside[:, None, :]] + np.eye(inside.shape[1])
    slope = reduced.slope[inside]
    covariance = np.linalg.inv(precision)
    mean = (covariance @ slope[:, :, None])[:, :, 0]
    value = reduced.log_evidence + 0.5 * (slope * mean).sum(axis=1)
    value += 0.5 * np.linalg.slogdet(covariance)[1]
    # A half-normal is a folded normal: twice the share of it that lies above zero.
    sd = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    share = np.where(_positive(model.candidates)[chosen], np.log(2) + log_ndtr(mean / sd), 0.0)
    return np.asarray(value + share.sum(axis=1))


def single_gains(candidates: Sequence[Candidate], reduced: Reduced) -> Array:
    """Return what each candidate alone adds to the log evidence, shape (E,)."""
    precision = np.diag(reduced.precision) + 1
    gains = 0.5 * reduced.slope**2 / precision - 0.5 * np.log(precision)
    share = np.log(2) + log_ndtr(reduced.slope / np.sqrt(precision))
    return np.asarray(gains + np.where(_positive(candidates), share, 0.0))


def _positive(candidates: Sequence[Candidate]) -> NDArray[np.bool_]:
    """Return whose amplitude is above zero, shape (E,)."""
    return np.array([is_positive(c.effect.amplitude.prior) for c in candidates], dtype=bool)
