"""Finds the limit of the drive force from the response of the motion.

In a regression of the commanded force, a loss beyond a limit explains part of its own response:
a limit below all commands, with no mass, explains everything. Therefore acceleration is regressed
on the command: it is a line with a kink at the limit.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bayesfric.arrays import Flags, Whole
from bayesfric.recording.held import SENSED
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.beside import rough_amounts
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.readings import Readings, readings_of
from bayesfric.rigs.single_axis.rough import least_squares, pull_columns

LIMITS = 60
"""Limits that are tried, at as many quantiles of the command."""
LOW, HIGH = 0.05, 0.998  # range of these quantiles
STATED = 0.02  # relative error of a declared limit
MOST = 1.2  # largest plausible loss beyond a limit, relative to the command beyond it
FINER = 9  # limits that are tried between two of these quantiles
LINE = 4  # coefficients of the line: of force, a constant, force rate and speed


class Limit(NamedTuple):
    """A kink, estimated from rows that were computed without a limit.

    Parameters
    ----------
    force : float
        Force at the kink [N]; above all commands if there is none.
    explained : float
        Part of the squared residual of a line without a kink that the kink explains.
    tried : int
        Number of limits that were tried.
    error : float
        Relative standard error.
    """

    force: float
    explained: float
    tried: int = LIMITS
    error: float = 0.1

    @property
    def there(self) -> bool:
        """Whether the drive has a limit: the kink explains enough of the residual."""
        return self.explained > AXIS_RULES.limit_explained

    def within(self, readings: Readings) -> Flags:
        """Return whether all commands of a window lie within the limit, (W,).

        All windows count as within it if there is no limit, or if too few windows would remain.
        """
        inside = np.abs(readings.drive).max(axis=1) < self.force
        return np.asarray(inside | (not self.there or inside.sum() < AXIS_RULES.limit_least_rows))


def within_limit(
    logs: Sequence[EvenLog], starts: Sequence[Whole], constants: RigConstants
) -> tuple[Readings, Limit] | None:
    """Reduce runs to windows, with the force clipped at the limit of the drive.

    The limit is estimated from windows with the unclipped force, because clipped windows contain
    a part of its effect. A declared limit is used instead, if any command exceeds it. A measured
    force is not clipped. The limit is returned together with the windows.

    Parameters
    ----------
    logs : sequence of EvenLog
        The runs.
    starts : sequence of ndarray of int
        For each run, the samples at which its trials begin.
    constants : RigConstants
        Resolution of the encoder, declared limit, and whether the force was measured.

    Returns
    -------
    tuple of (Readings, Limit), or None
        None if no window has a single direction.
    """
    resolution, declared = constants.encoder_resolution, constants.force_limit_n
    rows = readings_of(logs, starts, resolution)
    if rows is None:
        return None
    most = float(np.abs(rows.drive).max())
    if constants.force_is in SENSED or (declared is not None and declared >= most):
        limit = Limit(most, 0.0)
    else:
        limit = drive_limit(rows) if declared is None else Limit(declared, 1.0, 1, STATED)
    if not limit.there:
        return rows, limit
    within = readings_of(logs, starts, resolution, limit=limit.force)
    return None if within is None else (within, limit)


def drive_limit(readings: Readings) -> Limit:
    """Return the limit whose loss of force explains the acceleration best.

    Parameters
    ----------
    readings : Readings
        Windows with the unclipped force.
    """
    size = np.abs(readings.drive)
    toward = np.sign(readings.drive) * readings.way[:, None]
    force = readings.force - rough_amounts(readings.law_columns, readings.beside, readings.force)
    pull = pull_columns(readings.mean_position, readings.way)
    pull = pull[:, : max(0, readings.count // AXIS_RULES.rows_a_number - LINE)]
    line = np.column_stack(
        [force, np.ones(readings.count), readings.force_rate, readings.mean_speed, pull]
    )
    width = np.maximum(np.abs(line).max(axis=0), 1e-300)

    def left(limit: float) -> float:
        """Return the sum of squared residuals with a loss; infinite if it is not feasible."""
        lost = (toward * np.maximum(size - limit, 0.0)) @ readings.weights
        most = float(np.abs(lost).max()) or 1.0
        design = np.column_stack([line / width, lost / most])
        coefficients, squares, _, _ = np.linalg.lstsq(design, readings.acceleration, rcond=1e-9)
        if squares.size == 0:  # too few windows, or collinear columns
            return np.inf
        by_force, rest, by_lost = (coefficients / np.append(width, most))[[0, 1, -1]]
        if by_force <= 0:
            return np.inf
        share, friction = -by_lost / by_force, -rest / by_force
        # The axis moved, so the limit of its drive exceeds friction.
        return float(squares[0]) if 0 < share < MOST and limit > friction else np.inf

    places = np.quantile(size, np.linspace(LOW, HIGH, LIMITS))
    best = int(np.argmin([left(limit) for limit in places]))
    places = np.linspace(places[max(best - 1, 0)], places[min(best + 1, LIMITS - 1)], 2 * FINER)
    squares = [left(limit) for limit in places]
    best = int(np.argmin(squares))
    straight = least_squares(line, readings.acceleration, rcond=1e-9)[1]
    if not squares[best] < straight:
        return Limit(float(size.max()), 0.0)
    return Limit(float(places[best]), 1 - squares[best] / straight)
