"""Draws from the posterior of a hypothesis: an importance sample or, if need be, chains."""

from bayesfric.analysis import Sampler
from bayesfric.arrays import Array
from bayesfric.fitting.drawing import bounded_mode
from bayesfric.fitting.hypothesis import chart_of
from bayesfric.inference.evidence.bridge import in_one_place
from bayesfric.inference.evidence.importance import LEAST_FOR_A_MEAN, importance_draws
from bayesfric.inference.evidence.record import Evidence
from bayesfric.inference.laplace import Laplace
from bayesfric.inference.model import Model
from bayesfric.inference.proposals import POINTS as FITTED_TO
from bayesfric.inference.sampling import sample

SHORT_RUN = Sampler(burn=20, steps=60, thin=3, extensions=5)  # extended if it is too short
WALKERS = 60  # at least: many walkers and few steps are quicker than the other way round
POINTS_APART = 4000  # for two rigs that differ: 2000 are too few for 26 parameters


def weighed(
    model: Model, laplace: Laplace, seed: int, size: int, points: int = FITTED_TO
) -> tuple[Evidence, Array] | None:
    """Draw by importance sampling; None if the weights have heavy tails."""
    return importance_draws(
        model.log_posterior,
        laplace,
        seed,
        chart_of(model),
        size=size,
        least_effective=LEAST_FOR_A_MEAN,
        points=points,
    )


def sampled(model: Model, laplace: Laplace, seed: int) -> Array:
    """Draw with ensembles of walkers, shape (ensembles, draws, walkers, D)."""
    walkers = max(WALKERS, 2 * laplace.mode.size)
    settings = SHORT_RUN.model_copy(update={"walkers": walkers})
    return sample(
        model.log_posterior, laplace, settings, seed, converged=in_one_place, chart=chart_of(model)
    ).z


def drawn_anew(model: Model, seed: int, proposals: int) -> Array | None:
    """Draw from the posterior of two rigs, shape (S, D); None if no draws are reliable."""
    laplace = bounded_mode(model, model.start())
    by_importance = weighed(model, laplace, proposals, POINTS_APART, POINTS_APART)
    if by_importance is not None:
        return by_importance[1]
    draws = sampled(model, laplace, seed)
    return draws.reshape(-1, draws.shape[-1]) if in_one_place(draws) else None
