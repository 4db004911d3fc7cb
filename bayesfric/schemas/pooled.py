"""The part of ``fit.json`` that only a fit of several recordings has."""

from pydantic import Field

from bayesfric.schemas.base import Interval, Number, Record, RecordingId
from bayesfric.schemas.parameter import ParameterSummary


class PooledBoard(Record):
    """One of several recordings, each of which counts as a board."""

    recording: RecordingId = Field(description="The data.")
    folder: str = Field(description="Of its own fit, beside this file.")
    converged: bool = Field(description="Whether its own fit is.")


class BoardCoefficient(Record):
    """A coefficient of one board."""

    alone: Interval = Field(description="By its own recording and the prior.")
    pooled: Interval = Field(description="By all recordings.")
    shrinkage: Number = Field(
        description="How far the population draws it: variance of its own estimate over that plus "
        "the variance between boards; 0 where it speaks for itself, 1 where it is as the others."
    )


class PooledCoefficient(Record):
    """A coefficient of a pulley size over the boards."""

    between: ParameterSummary = Field(
        description="Standard deviation from board to board, over the population's mean [-]."
    )
    new_board: Interval = Field(description="Of a board that was not measured.")
    boards: dict[str, BoardCoefficient] = Field(description="By the name of the board.")


class Pooled(Record):
    """Several recordings as boards of one population."""

    shared: str = Field(description="What the boards share.")
    own: str = Field(description="What each has for itself.")
    boards: dict[str, PooledBoard] = Field(description="By name: that of the recording's folder.")
    pulleys: dict[str, dict[str, PooledCoefficient]] = Field(
        description="c1, c2, c3 of each pulley size; their means stand in `pulleys` of the file."
    )
    pareto_k: Number | None = Field(
        description="Tail of the weights by which the boards' own densities correct their normal "
        "approximations; above 0.7 the draws are not to be relied on."
    )
    pareto_k_why: str | None = Field(None, description="Why there is none.")
