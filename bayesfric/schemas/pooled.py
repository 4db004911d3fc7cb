"""The part of ``fit.json`` that only a fit of several recordings has."""

from bayesfric.schemas.base import Interval, Number, Record, RecordingId
from bayesfric.schemas.parameter import ParameterSummary


class PooledBoard(Record):
    """One of several recordings, each of which counts as a board.

    Fields
    ------
    recording: The data.
    folder: Of its own fit, beside this file.
    converged: Whether its own fit is.
    """

    recording: RecordingId
    folder: str
    converged: bool


class BoardCoefficient(Record):
    """A coefficient of one board.

    Fields
    ------
    alone: By its own recording and the prior.
    pooled: By all recordings.
    shrinkage: How far the population draws it: variance of its own estimate over that plus the
        variance between boards; 0 where it speaks for itself, 1 where it is as the others.
    """

    alone: Interval
    pooled: Interval
    shrinkage: Number


class PooledCoefficient(Record):
    """A coefficient of a pulley size over the boards.

    Fields
    ------
    between: Standard deviation from board to board, over the population's mean [-].
    new_board: Of a board that was not measured.
    boards: By the name of the board.
    """

    between: ParameterSummary
    new_board: Interval
    boards: dict[str, BoardCoefficient]


class Pooled(Record):
    """Several recordings as boards of one population.

    Fields
    ------
    shared: What the boards share.
    own: What each has for itself.
    boards: By name: that of the recording's folder.
    pulleys: c1, c2, c3 of each pulley size; their means stand in `pulleys` of the file.
    pareto_k: Tail of the weights by which the boards' own densities correct their normal
        approximations; above 0.7 the draws are not to be relied on.
    pareto_k_why: Why there is none.
    """

    shared: str
    own: str
    boards: dict[str, PooledBoard]
    pulleys: dict[str, dict[str, PooledCoefficient]]
    pareto_k: Number | None
    pareto_k_why: str | None = None
