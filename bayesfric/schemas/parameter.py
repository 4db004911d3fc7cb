"""A parameter in ``fit.json``."""

from typing import Annotated

from pydantic import BeforeValidator, Field

from bayesfric.schemas.base import Because, Interval, Number, Record, Why

NO_COEFFICIENT = Because("it is asked of coefficients alone")
LARGEST = 1000.0  # JSON has no infinity


def _finite(r_hat: float) -> float:
    return min(r_hat, LARGEST)


class StoredDraws(Record):
    """What ArviZ says of the draws of a parameter that are kept in ``draws.nc``."""

    r_hat: Number = Field(description="Rank-normalised split R-hat.")
    ess_bulk: Number = Field(description="Effective draws for the mean.")


class ParameterSummary(Interval):
    """The posterior of a parameter and how well it is known."""

    unit: str = Field(description="Unit; 1 for a ratio.")
    prior: str = Field(description="Prior density, as in half-normal(scale=0.05).")
    mcse_mean: Number = Field(description="Monte Carlo standard error of the mean.")
    ess_bulk: Number = Field(description="Effective draws for the mean.")
    ess_tail: Number = Field(description="Effective draws for the 5 and 95 % quantiles.")
    r_hat: Number = Field(description="Rank-normalised split R-hat, walkers pooled by ensemble.")
    r_hat_walkers: Annotated[Number, BeforeValidator(_finite)] = Field(
        description="The same of walkers, each a chain, with little of what chance adds for few "
        f"draws; {LARGEST:g} where they do not leave their places."
    )
    stored: StoredDraws | None = Field(
        None, description="Of the draws in draws.nc; all else is of every draw."
    )
    stored_why: Annotated[Why, Because("the file is of an earlier version")] = None
    contraction: Number | None = Field(description="1 - posterior sd / prior sd.")
    contraction_why: Why = None
    informed: bool = Field(description="Whether the data say more than the prior.")
    prior_sensitivity: Number | None = Field(
        None,
        description="Of a coefficient: how far its cumulative distribution moves for a doubling "
        "of the power to which all priors are raised; above 0.05 they matter.",
    )
    prior_sensitivity_why: Annotated[Why, NO_COEFFICIENT] = None
    likelihood_sensitivity: Number | None = Field(
        None, description="The same for the power of the likelihood."
    )
    likelihood_sensitivity_why: Annotated[Why, NO_COEFFICIENT] = None
