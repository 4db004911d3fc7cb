"""Draws from the posterior of a model."""

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.checkpoint import Checkpoint
from bayesfric.errors import Fault, InputError
from bayesfric.fitting.hypothesis import chart_of
from bayesfric.inference.diagnostics import diagnose_all
from bayesfric.inference.laplace import Laplace, NoModeError, laplace_approximation
from bayesfric.inference.model import Model
from bayesfric.inference.priors import quantile
from bayesfric.inference.sampling import Draws, Progress, sample

VANISHED = 1e-9  # relative to the median of a noise prior; smaller values are rounding
SCATTER = (
    "readings that scatter about the law, or their standard errors; these fit it exactly, so "
    "that no error of theirs can be told"
)


def draw_posterior(
    model: Model,
    analysis: Analysis,
    progress: Progress | None = None,
    checkpoint: Checkpoint | None = None,
    *,
    recording: str = "recording",
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
        Stores the draws during the run.
    recording : str
        Name of the recording, for error messages.

    Raises
    ------
    InputError
        The data fit exactly and their noise is unknown, so the density is unbounded.
    """
    try:
        laplace = bounded_mode(model, model.start())
    except NoModeError as error:
        raise InputError([Fault(recording, str(error))]) from error
    return sample(
        model.log_posterior,
        laplace,
        analysis.sampler,
        analysis.seed,
        progress,
        checkpoint,
        converged=lambda z: all(
            diagnostics.converged for diagnostics in diagnose_all(model.natural(z))
        ),
        chart=chart_of(model),
    )


def bounded_mode(model: Model, start: Array) -> Laplace:
    """Return the mode of a posterior whose density is bounded.

    Raises
    ------
    NoModeError
        The data fit exactly and their noise is unknown; the message says what was expected.
    """
    try:
        laplace = laplace_approximation(model.log_posterior, start, model.scale())
    except NoModeError as error:
        raise NoModeError(SCATTER) from error
    refuse_vanished(model, laplace.mode)
    return laplace


def refuse_vanished(model: Model, mode: Array) -> None:
    """Raise NoModeError if a noise is 0 at the mode of a posterior, shape (D,)."""
    vanished = [
        parameter.name
        for parameter, value in zip(model.parameters, model.natural(mode), strict=True)
        # A parameter of either sign, such as a clock offset, is not a scale that can vanish.
        if parameter.kind == "noise"
        and abs(value) < VANISHED * float(quantile(parameter.prior, 0.5))
    ]
    if vanished:
        raise NoModeError(f"{SCATTER} ({', '.join(vanished)} vanishes)")
