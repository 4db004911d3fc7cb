"""A model and an analysis to draws of the posterior."""

from bayesfric.analysis import Analysis
from bayesfric.checkpoint import Checkpoint
from bayesfric.fitting.hypothesis import chart_of
from bayesfric.inference.diagnostics import diagnose_all
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.model import Model
from bayesfric.inference.sampling import Draws, Progress, sample

__all__ = ["draw_posterior"]


def draw_posterior(
    model: Model,
    analysis: Analysis,
    progress: Progress | None = None,
    checkpoint: Checkpoint | None = None,
) -> Draws:
    """Find the mode of a posterior and draw from it.

    Parameters
    ----------
    model : Model
        The posterior.
    analysis : Analysis
        Sampler and seed.
    progress : callable or None
        Called with the sampler's steps done and steps in all.
    checkpoint : Checkpoint or None
        Keeps the draws on the way.
    """
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    return sample(
        model.log_posterior,
        laplace,
        analysis.sampler,
        analysis.seed,
        progress,
        checkpoint,
        converged=lambda z: all(one.converged for one in diagnose_all(model.natural(z))),
        chart=chart_of(model),
    )
