"""What a fit predicts of trials and assemblies that it has not seen.

Each trial, and each assembly, is left out in turn: draws are weighted as if they had
not seen it, and where the weights fail the posterior without it is sampled anew.
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
DRAWS_A_CALL = 100  # Student-t scatter needs a grid for each
AGAIN = 1000  # recordings made again
GRID = np.arange(1, 50) / 50
BAND = 0.95
LARGEST_ERROR = 0.25  # of a refit's density [nat]; a difference below 4 nat decides nothing
BRIDGED_TO = 0.05  # of a bridge [nat]: no worse than the error of an evidence
EDGE = 1e-16  # of a probability whose normal score is to be finite


@dataclass(frozen=True)
class LeftOut:
    """What a fit predicts of one board's N trials and J assemblies.

    Parameters
    ----------
    trial_log_likelihood, setup_log_likelihood : ndarray, shape (S, N) and (S, J)
        Log densities of each given all others, draw by draw.
    trials, setups : ELPD or None
        None where a density is not finite for some draw.
    pit : ndarray, shape (N,)
        Probability of less friction of each trial, had it been left out; empty where there
        is no `trials`.
    again : ndarray, shape (R, N)
        Such probabilities of recordings made again.
    setup_pit : ndarray, shape (J,)
        Probability of less friction of each assembly, had all its trials been left out; NaN of
        one that has none, empty where there is no `setups`.
    more : ndarray, shape (S, N)
        By how much more friction each trial would show, made again among all others, draw by
        draw [N]; shape (S, 0) where none was asked for.
    without : mapping of str to ndarray, shape (J,)
        Posterior mean of each coefficient, had the assembly been left out, in its unit; none
        where there is no `setups`.
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
    """How far leave-one-out probabilities are from uniform ones.

    Parameters
    ----------
    grid, difference : ndarray, shape (P,)
        Probability, and the share of trials below it less it.
    low, high : ndarray, shape (P,)
        Band that 95 % of recordings made again stay within everywhere.
    p_value : float
        Share of recordings made again that leave uniformity by more somewhere, in units
        of the standard deviation there.
    spread : float
        Root mean square of the normal scores of the probabilities; 1 where trials scatter
        as much as the model says.
    spread_expected : ndarray, shape (3,)
        5, 50 and 95 % quantile of that of recordings made again.
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
    """Leave each trial and each assembly of a board out.

    Parameters
    ----------
    model : Model
        Of the posterior.
    likelihood : RigLikelihood
        The board's, one of the model's.
    z : ndarray, shape (S, D)
        Posterior draws in the sampling space.
    start : ndarray, shape (D,)
        A point of high density, from which refits climb.
    seed : int
        Of refits and of recordings made again.
    rng : Generator or None
        Makes each trial again among all others; None makes none.

    Returns
    -------
    LeftOut
        With exact refits wherever a Pareto k is above its limit.
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
    """Return the posterior mean of each coefficient, had a group been left out.

    Parameters
    ----------
    model : Model
        Of the posterior.
    z : ndarray, shape (S, D)
        Posterior draws in the sampling space.
    without : Without
        Their weights for each of J groups.
    refits : mapping of int to ndarray, shape (S', D)
        Draws of the posterior without a group whose weights fail, by its place.

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
    """Return the log density of each assembly given the others, a rig at a time.

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
    parts = [
        by_blocks(model, likelihood.setup_log_likelihood, z) for likelihood in model.likelihoods
    ]
    if not all(np.isfinite(part).all() for part in parts):
        raise ValueError("the log density of an assembly is not finite")
    return parts


def leave_setups_out(densities: Sequence[Array]) -> ELPD:
    """Leave each assembly of all of a model's boards out, without refits.

    A refit takes seconds a group. Without, one whose Pareto k is above its limit stays marked.

    Parameters
    ----------
    densities : sequence of ndarray, each of shape (S, J)
        Of :func:`setup_log_densities`.

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
    """Compare leave-one-out probabilities with those of recordings made again.

    Trials of an assembly depend on one another, so their probabilities do not scatter as
    independent uniform ones: recordings made again say how they do.

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
    """Return the share of the last axis below each place of the grid, shape (…, P)."""
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
    """Return the predictive densities, and the draws of each refit by its group's place."""
    chart = chart_of(model)
    refits: dict[int, Array] = {}

    @cache
    def seen() -> Evidence | None:
        """Return the evidence of all data; most boards need no refit and never call this."""
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
        # The evidence of all data over that without the group: by a bridge between the draws
        # of either, or, where these are too far apart, by importance both.
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
    """Return at each point the density of each trial and assembly given all others."""
    parts = [
        likelihood.given_rest(model.by_name(model.natural(block)), rng) for block in _blocks(z)
    ]
    return GivenRest(
        *(np.concatenate(parts_of_field) for parts_of_field in zip(*parts, strict=True))
    )


def by_blocks(model: Model, function: Callable[..., Array], z: Array) -> Array:
    """Return a function of a likelihood at S points, computed in blocks, shape (S, …)."""
    parts = [function(model.by_name(model.natural(block))) for block in _blocks(z)]
    return np.concatenate(parts)


def _blocks(z: Array) -> list[Array]:
    return [z[start : start + DRAWS_A_CALL] for start in range(0, len(z), DRAWS_A_CALL)]
