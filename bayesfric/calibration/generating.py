"""The generating prior: recordings are drawn from it and fitted with it.

The default priors of a fit are too wide for calibration: most of their draws would not move the
board. Calibration uses a narrower prior for both purposes, stated in ``[calibration]``.
"""

from dataclasses import replace

import numpy as np

from bayesfric.analysis import Analysis, PriorOverrides, Scatter, Uniform
from bayesfric.errors import Fault, InputError
from bayesfric.inference.priors import draw
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.truth import Truth, table1_coefficients

SCATTER_AND_NOISE = (
    "tau",
    "omega",
    "omega_intercept",
    "wander",
    "wander_length",
    "sigma_x",
    "sigma_t",
)


def generating_analysis(analysis: Analysis) -> Analysis:
    """Return an analysis with the generating prior in the place of its own.

    Parameters
    ----------
    analysis : Analysis
        With its ``[calibration]``.

    Raises
    ------
    InputError
        It has a scatter that is not simulated.
    """
    if analysis.scatter != Scatter():
        expected = "the default: recordings are simulated with normal scatter that sizes share"
        raise InputError([Fault("analysis.toml", expected, column="scatter")])
    rules = analysis.calibration

    def around(value: float) -> Uniform:
        return Uniform(low=(1 - rules.spread) * value, high=(1 + rules.spread) * value)

    own = {name: around(getattr(rules, name)) for name in SCATTER_AND_NOISE}
    pulleys = {
        size: PriorOverrides(**{name: around(value) for name, value in law._asdict().items()})
        for size, law in table1_coefficients().items()
    }
    priors = analysis.priors.model_copy(update=own | {"pulleys": pulleys})
    return analysis.model_copy(update={"priors": priors, "sampler": rules.sampler})


def draw_truth(generating: Analysis, rng: np.random.Generator) -> Truth:
    """Draw the true coefficients, scatter and noise of a recording.

    Parameters
    ----------
    generating : Analysis
        Of :func:`generating_analysis`.
    rng : Generator
        Source of randomness.
    """
    priors = generating.priors
    coefficients = {
        size: Coefficients(*(float(draw(getattr(own, c), 1, rng)[0]) for c in Coefficients._fields))
        for size, own in priors.pulleys.items()
    }
    scatter = {name: float(draw(getattr(priors, name), 1, rng)[0]) for name in SCATTER_AND_NOISE}
    return replace(Truth(coefficients), **scatter)  # type: ignore[arg-type]
