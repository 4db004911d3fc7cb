"""The force without what a controller answers to errors of the encoder.

A controller that takes the speed from counts answers the error e of each position with a force
−h ∗ e, with h the response of its loop. That force acts and is in the log: it is no error. But a
row lacks m ∫ φ'' e dt, by which its acceleration is read wrong, and the rate of the force has the
same errors many times larger: least squares explain the one by the other, as a force that acts
some milliseconds later than it was logged, with friction that grows with speed to match. So a
rate, which tells a delay alone, is that of the force without its answer to what a polynomial
through the positions of two windows leaves. A parabola leaves motion too, whose force acts late.
"""

from dataclasses import replace

import numpy as np

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.even_log import EvenLog, local_polynomial

TAPS = 4  # samples over which a controller answers a count
DIFFERENCED = 3  # times, which leaves errors of samples and no motion
TO_AND_FRO = 0.5  # correlation of neighbours, at the least; of errors it is 0.75
WINDOWS, DEGREE = 2, 4  # whose positions a polynomial goes through, and its degree


def without_answers(log: EvenLog, half: int, limit: float) -> EvenLog:
    """Return a run whose force does not answer errors of its positions.

    Parameters
    ----------
    log : EvenLog
        A run.
    half : int
        Of a window, in samples.
    limit : float
        Of the drive, at which it answers nothing.
    """
    wide, answer = WINDOWS * half, _answer(log)
    if answer is None or log.position.size < 2 * wide + 1:
        return log
    errors = log.position - local_polynomial(log.position, wide, DEGREE)
    answered = np.convolve(errors, answer)[: errors.size]
    return replace(log, force=log.force - np.where(np.abs(log.force) < limit, answered, 0.0))


def goes_to_and_fro(differences: Array) -> bool:
    """Return whether positions, differenced :data:`DIFFERENCED` times, are errors of samples."""
    return bool(differences[1:] @ differences[:-1] < -TO_AND_FRO * (differences @ differences))


def shaken_by_counts(log: EvenLog) -> float:
    """Return the correlation of quick forces with errors of positions; 0 where these are motion.

    Of a log that has every few commands of its loop alone it is weaker, for half of the answers
    are to counts that the log has not; a correlation with the motion between rows is nearly lost.
    """
    force, position = (np.diff(values, DIFFERENCED) for values in (log.force, log.position))
    size = float(np.linalg.norm(force) * np.linalg.norm(position))
    return float(force @ position) / size if size > 0 and goes_to_and_fro(position) else 0.0


def _answer(log: EvenLog) -> Array | None:
    """Return what the force answers to a position of this sample and of each of the last, (L,).

    None where quick changes of the force are not made by those of the position, or where these
    are motion: errors of samples, so differenced, go to and fro.
    """
    if log.sent is not None or log.force.size < 10 * TAPS:
        return None
    force, position = (np.diff(values, DIFFERENCED) for values in (log.force, log.position))
    size, scale = position.size, float(np.abs(position).max())
    force, whole = force[TAPS - 1 :], float(force @ force)
    if scale == 0 or whole == 0 or not goes_to_and_fro(position):
        return None
    lagged = [position[TAPS - 1 - lag : size - lag] / scale for lag in range(TAPS)]
    columns = np.stack(lagged, axis=1)
    numbers = np.linalg.lstsq(columns, force, rcond=1e-9)[0]
    rest = force - columns @ numbers
    made = 1 - float(rest @ rest) / whole
    return np.asarray(numbers / scale) if made > AXIS_RULES.answers else None
