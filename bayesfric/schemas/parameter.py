"""A parameter in ``fit.json``."""

from typing import Annotated

from pydantic import BeforeValidator, Field

from bayesfric.schemas.base import Because, Interval, Number, Record, Why

NO_COEFFICIENT = Because("it is asked of coefficients alone")
LARGEST = 1000.0  # JSON has no infinity


def _finite(r_hat: float) -> float:
    return min(r_hat, LARGEST)


class StoredDraws(Record):
    """ArviZ diagnostics of the draws of a parameter that are kept in ``draws.nc``.

    Fields
    ------
    r_hat: Rank-normalised split R-hat.
    ess_bulk: Effective draws for the mean.
    """

    r_hat: Number
    ess_bulk: Number


class ParameterSummary(Interval):
    """The posterior of a parameter, with its diagnostics.

    Fields
    ------
    unit: Unit; 1 for a ratio.
    prior: Prior density, as in half-normal(scale=0.05).
    mcse_mean: Monte Carlo standard error of the mean.
    ess_bulk: Effective draws for the mean.
    ess_tail: Effective draws for the 5 and 95 % quantiles.
    r_hat: Rank-normalised split R-hat, walkers pooled by ensemble.
    stored: Diagnostics of the draws in draws.nc; all else is computed from every draw.
    contraction: 1 - posterior sd / prior sd.
    informed: Whether the data are informative beyond the prior.
    prior_sensitivity: For a coefficient: how far its cumulative distribution moves if all priors
        are raised to a power, per doubling of the power. Above 0.05 the priors matter.
    likelihood_sensitivity: The same for a power of the likelihood.
    """

    unit: str
    prior: str
    mcse_mean: Number
    ess_bulk: Number
    ess_tail: Number
    r_hat: Number
    r_hat_walkers: Annotated[Number, BeforeValidator(_finite)] = Field(
        description="The same of walkers, each a chain, with little of what chance adds for few "
        f"draws; {LARGEST:g} where they do not leave their places."
    )
    stored: StoredDraws | None = None
    stored_why: Annotated[Why, Because("the file is of an earlier version")] = None
    contraction: Number | None
    contraction_why: Why = None
    informed: bool
    prior_sensitivity: Number | None = None
    prior_sensitivity_why: Annotated[Why, NO_COEFFICIENT] = None
    likelihood_sensitivity: Number | None = None
    likelihood_sensitivity_why: Annotated[Why, NO_COEFFICIENT] = None
