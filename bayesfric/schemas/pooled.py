"""The part of ``fit.json`` that only a fit of several recordings has."""

from bayesfric.schemas.base import Interval, Number, Record, RecordingId
from bayesfric.schemas.parameter import ParameterSummary


class PooledBoard(Record):
    """One of several recordings, each of which counts as a board.

    Fields
    ------
    recording: The data.
    folder: Folder of its own fit, beside this file.
    converged: Whether its own fit has converged.
    """

    recording: RecordingId
    folder: str
    converged: bool


class BoardCoefficient(Record):
    """A coefficient of one board.

    Fields
    ------
    alone: From its own recording and the prior.
    pooled: From all recordings.
    shrinkage: How far its estimate moves towards the population mean: variance of its own estimate
        over that plus the variance between boards. 0: its own estimate is kept; 1: it equals the
        population mean.
    """

    alone: Interval
    pooled: Interval
    shrinkage: Number


class PooledCoefficient(Record):
    """A coefficient of a pulley size over the boards.

    Fields
    ------
    between: Standard deviation from board to board, over the population's mean [-].
    new_board: Predicted for a board that was not measured.
    boards: Coefficient of each board, by its name.
    """

    between: ParameterSummary
    new_board: Interval
    boards: dict[str, BoardCoefficient]


class Pooled(Record):
    """Several recordings as boards of one population.

    Fields
    ------
    shared: What the boards share.
    own: What each board has of its own.
    boards: The boards, by the name of the recording's folder.
    pulleys: c1, c2, c3 of each pulley size. Their population means are in `pulleys` of the file.
    pareto_k: Pareto tail index of the importance weights that correct the normal approximations of
        the boards' densities. Above 0.7 the draws are unreliable.
    pareto_k_why: Why there is none.
    """

    shared: str
    own: str
    boards: dict[str, PooledBoard]
    pulleys: dict[str, dict[str, PooledCoefficient]]
    pareto_k: Number | None
    pareto_k_why: str | None = None
