"""Leave-one-out predictions of trials and assemblies.

Draws are weighted to the posterior without each trial and without each assembly (PSIS). If the
weights are unreliable, the posterior is sampled again without it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, partial
from typing import Literal

import numpy as np
from scipy.special import ndtri

from bayesfric.arrays import Array
from bayesfric.fitting.hypothesis import chart_of
from bayesfric.inference.evidence.bridge import bridge_ratio
from bayesfric.inference.evidence.importance import importance_draws
from bayesfric.inference.evidence.leave_out import (
    ELPD,
    Without,
    elpd,
    loo_pit,
    refit_without,
    without_each,
)
from bayesfric.inference.evidence.record import Evidence
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.model import GivenRest, Model, RigLikelihood

Kind = Literal["trial", "setup"]
DRAWS_A_CALL = 100  # Student-t scatter needs a grid for each draw
AGAIN = 1000  # replicated recordings
GRID = np.arange(1, 50) / 50
BAND = 0.95
LARGEST_ERROR = 0.25  # of a refit's log density [nat]; differences below 4 nat do not matter
BRIDGED_TO = 0.05  # largest error of a bridge [nat], as for an evidence
EDGE = 1e-16  # distance of probabilities from 0 and 1, for finite normal scores


@dataclass(frozen=True)
class LeftOut:
    """Leave-one-out predictions of one rig's N trials and J assemblies.

    Parameters
    ----------
    trial_log_likelihood, setup_log_likelihood : ndarray, shape (S, N) and (S, J)
        Log density of each given all others, draw by draw.
    trials, setups : ELPD or None
        None if a density is not finite for a draw.
    pit : ndarray, shape (N,)
        Leave-one-out CDF value of each trial's friction; empty if `trials` is None.
    again : ndarray, shape (R, N)
        The same for replicated recordings.
    setup_pit : ndarray, shape (J,)
        Leave-one-out CDF value of each assembly's friction; NaN if it has none, empty if
        `setups` is None.
    more : ndarray, shape (S, N)
        Replicated minus measured friction of each trial given all others, draw by draw [N];
        shape (S, 0) without replicates.
    without : mapping of str to ndarray, shape (J,)
        Posterior mean of each coefficient without the assembly; empty if `setups` is None.
    """

    trial_log_likelihood: Array
    setup_log_likelihood: Array
    trials: ELPD | None
    setups: ELPD | None
    pit: Array
    again: Array
    setup_pit: Array
    more: Array
    without: Mapping[str, Array] = field(default_factory=dict)


@dataclass(frozen=True)
class FromUniform:
    """Deviation of leave-one-out CDF values from a uniform distribution.

    Parameters
    ----------
    grid, difference : ndarray, shape (P,)
        Probability, and the share of trials below it minus this probability.
    low, high : ndarray, shape (P,)
        Simultaneous 95 % band of replicated recordings.
    p_value : float
        Share of replicated recordings with a larger maximum deviation, in units of the local
        standard deviation.
    spread : float
        Rms of the normal scores; 1 if trials scatter as the model predicts.
    spread_expected : ndarray, shape (3,)
        5, 50 and 95 % quantiles of `spread` in replicated recordings.
    """

    grid: Array
    difference: Array
    low: Array
    high: Array
    p_value: float
    spread: float
    spread_expected: Array


def leave_out(
    model: Model,
    likelihood: RigLikelihood,
    z: Array,
    start: Array,
    seed: int,
    rng: np.random.Generator | None = None,
) -> LeftOut:
    """Leave out each trial and each assembly of a rig.

    Parameters
    ----------
    model : Model
        Of the posterior.
    likelihood : RigLikelihood
        The rig's likelihood, one of the model's.
    z : ndarray, shape (S, D)
        Posterior draws in the sampling space.
    start : ndarray, shape (D,)
        A point of high density, from which refits start.
    seed : int
        Seed of refits and of replicated recordings.
    rng : Generator or None
        Source of randomness for replicates of each trial; None makes none.

    Returns
    -------
    LeftOut
        Predictions, with exact refits if a Pareto k is above its limit.
    """
    given = _given_rest(model, likelihood, z, rng)
    trial, setup = given.trial, given.setup
    pit, again = np.empty(0), np.empty((0, trial.shape[1]))
    setup_pit = np.empty(0)
    trials = setups = None
    means: dict[str, Array] = {}
    if np.isfinite(setup).all():
        without = without_each(setup)
        setups, refits = _leave_out(model, likelihood, "setup", setup, without, start, seed)
        setup_pit = loo_pit(given.setup_cdf, without)
        means = coefficients_without(model, z, without, refits)
        for place, unseen in refits.items():
            refitted = _given_rest(model, likelihood, unseen)
            setup_pit[place] = refitted.setup_cdf[:, place].mean()
    if np.isfinite(trial).all():
        without = without_each(trial)
        trials, refits = _leave_out(model, likelihood, "trial", trial, without, start, seed)
        pit = loo_pit(given.trial_cdf, without)
        for place, unseen in refits.items():
            pit[place] = _given_rest(model, likelihood, unseen).trial_cdf[:, place].mean()
        some = z[np.linspace(0, len(z) - 1, min(AGAIN, len(z))).astype(int)]
        rng = np.random.default_rng(np.random.SeedSequence([seed, 3]))
        again = by_blocks(model, partial(likelihood.draw_trial_cdf, rng=rng), some)
    return LeftOut(trial, setup, trials, setups, pit, again, setup_pit, given.more, means)


def coefficients_without(
    model: Model, z: Array, without: Without, refits: Mapping[int, Array]
) -> dict[str, Array]:
    """Return the posterior mean of each coefficient without each group.

    Parameters
    ----------
    model : Model
        Of the posterior.
    z : ndarray, shape (S, D)
        Posterior draws in the sampling space.
    without : Without
        Weights of the draws for each of J groups.
    refits : mapping of int to ndarray, shape (S', D)
        Draws of the posterior without a group whose weights are unreliable, by its index.

    Returns
    -------
    dict of str to ndarray, shape (J,)
        By name, in the unit of the parameter.
    """
    means = np.exp(without.log_weights).T @ model.natural(z)
    for place, unseen in refits.items():
        means[place] = model.natural(unseen).mean(axis=0)
    return {
        parameter.name: means[:, place]
        for place, parameter in enumerate(model.parameters)
        if parameter.kind == "coefficient"
    }


def setup_log_densities(model: Model, z: Array) -> list[Array]:
    """Return the log density of each assembly given the others, rig by rig.

    Parameters
    ----------
    model : Model
        Of any boards.
    z : ndarray, shape (S, D)
        Draws in the sampling space.

    Returns
    -------
    list of ndarray, each of shape (S, J)

    Raises
    ------
    ValueError
        A density is not finite for some draw.
    """
    # Draws of an importance sample are repeated by their weights; each point is evaluated once.
    points, place = np.unique(z, axis=0, return_inverse=True)
    parts = [
        by_blocks(model, likelihood.setup_log_likelihood, points)[place.ravel()]
        for likelihood in model.likelihoods
    ]
    if not all(np.isfinite(part).all() for part in parts):
        raise ValueError("the log density of an assembly is not finite")
    return parts


def leave_setups_out(densities: Sequence[Array]) -> ELPD:
    """Leave out each assembly of all rigs of a model, without refits.

    A refit takes seconds for each group. Groups with a Pareto k above its limit stay marked.

    Parameters
    ----------
    densities : sequence of ndarray, each of shape (S, J)
        From :func:`setup_log_densities`.

    Returns
    -------
    ELPD
        Of all boards.
    """
    parts = [elpd(density) for density in densities]
    return ELPD(
        np.concatenate([part.pointwise for part in parts]),
        np.concatenate([part.pareto_k for part in parts]),
        np.concatenate([part.refitted for part in parts]),
        parts[0].limit_k,
    )


def uniformity(pit: Array, again: Array) -> FromUniform:
    """Compare leave-one-out CDF values with those of replicated recordings.

    Trials of an assembly are dependent, so their CDF values do not scatter like independent
    uniform ones. Replicated recordings give their distribution.

    Parameters
    ----------
    pit : ndarray, shape (N,)
        As measured.
    again : ndarray, shape (R, N)
        Of recordings made again.

    Returns
    -------
    FromUniform
        Of the distribution function, and of the spread.

    References
    ----------
    T. Säilynoja, P.-C. Bürkner, A. Vehtari, "Graphical test for discrete uniformity and
    its applications in goodness-of-fit evaluation and multiple sample comparison",
    Statistics and Computing 32 (2022): the difference of distribution functions with a
    simultaneous band.
    """
    difference = _distribution(pit) - GRID
    apart = _distribution(again) - GRID
    sd = np.sqrt((apart**2).mean(axis=0))
    unit = np.where(sd > 0, sd, 1.0)
    farthest = np.abs(apart / unit).max(axis=1)
    limit = float(np.quantile(farthest, BAND)) * sd
    beyond = int((farthest >= np.abs(difference / unit).max()).sum())
    return FromUniform(
        GRID,
        difference,
        -limit,
        limit,
        (1 + beyond) / (1 + len(again)),
        float(_spread(pit)),
        np.quantile(_spread(again), (0.05, 0.5, 0.95)),
    )


def _distribution(pit: Array) -> Array:
    """Return the share of the last axis below each point of the grid, shape (…, P)."""
    return np.stack([(pit <= place).mean(axis=-1) for place in GRID], axis=-1)


def scores(pit: Array) -> Array:
    """Return the normal scores of probabilities, finite."""
    return np.asarray(ndtri(np.clip(pit, EDGE, 1 - EDGE)))


def _spread(pit: Array) -> Array:
    return np.asarray(np.sqrt((scores(pit) ** 2).mean(axis=-1)))


def _leave_out(
    model: Model,
    likelihood: RigLikelihood,
    kind: Kind,
    log_likelihood: Array,
    without: Without,
    start: Array,
    seed: int,
) -> tuple[ELPD, dict[int, Array]]:
    """Return the predictive densities, and the draws of each refit by its group's index."""
    chart = chart_of(model)
    refits: dict[int, Array] = {}

    @cache
    def seen() -> Evidence | None:
        """Return the evidence of all data, which only refits need."""
        laplace = laplace_approximation(model.log_posterior, start, model.scale())
        drawn = importance_draws(model.log_posterior, laplace, seed, chart)
        return None if drawn is None else drawn[0]

    def refit(place: int) -> float | None:
        def conditional(points: Array) -> Array:
            densities: Array = getattr(_given_rest(model, likelihood, points), kind)[:, place]
            return densities

        own = int(np.random.SeedSequence([seed, len(kind), place]).generate_state(1)[0])
        unseen = refit_without(model.log_posterior, conditional, start, model.scale(), own, chart)
        if unseen is None:
            return None
        # The ratio of the evidences with and without the group comes from a bridge between both
        # sets of draws or, if these are too far apart, from importance sampling of both.
        value, error = bridge_ratio(log_likelihood[:, place], conditional(unseen.draws))
        if error > BRIDGED_TO and (whole := seen()) is not None:
            error = float(np.hypot(whole.error, unseen.evidence.error))
            value = whole.log_evidence - unseen.evidence.log_evidence
        if error > LARGEST_ERROR:
            return None
        refits[place] = unseen.draws
        return value

    return elpd(log_likelihood, refit, without), refits


def _given_rest(
    model: Model, likelihood: RigLikelihood, z: Array, rng: np.random.Generator | None = None
) -> GivenRest:
    """Return the density of each trial and assembly given all others, at each point."""
    function = partial(likelihood.given_rest, rng=rng)
    return GivenRest(*_by_blocks(model, function, z))


def by_blocks(model: Model, function: Callable[..., Array], z: Array) -> Array:
    """Return a function of a likelihood at S points, computed in blocks, shape (S, …)."""
    (whole,) = _by_blocks(model, lambda theta: (function(theta),), z)
    return whole


def _by_blocks(
    model: Model, function: Callable[[Mapping[str, Array]], Sequence[Array]], z: Array
) -> list[Array]:
    """Return several functions at S points, each of shape (S, …), without a second copy of them."""
    whole: list[Array] = []
    for start in range(0, len(z), DRAWS_A_CALL):
        block = slice(start, start + DRAWS_A_CALL)
        parts = function(model.by_name(model.natural(z[block])))
        whole = whole or [np.empty((len(z), *part.shape[1:])) for part in parts]
        for values, part in zip(whole, parts, strict=True):
            values[block] = part
    return whole
