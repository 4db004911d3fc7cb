"""The force without what a controller answers to errors of the encoder.

A controller that takes the speed from counts answers the error e of each position with a force
−h ∗ e, with h the response of its loop. That force acts and is in the log: it is no error. But a
row lacks m ∫ φ'' e dt, by which its acceleration is read wrong, and the rate of the force has the
same errors many times larger: least squares explain the one by the other, as a force that acts
some milliseconds later than it was logged, with friction that grows with speed to match. So a
rate, which tells a delay alone, is that of the force without its answer to what a polynomial
through the positions of two windows leaves. A parabola leaves motion too, whose force acts late.

A controller filters the speed, so its answer decays over many samples by a constant factor per
sample. The answer to a slow error is the small difference of large early and late parts. If the
decay is cut off, the rate keeps errors as slow as a window, and inertia is biased: by 0.3 % of a
joint at 500 Hz with counts of 0.4 mrad, whose filter keeps 0.64 of the speed before.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.even_log import EvenLog, local_polynomial

TAPS = 4  # samples over which a controller answers a count, before its answer decays
MOST_KEPT, KEPT_TO = 0.95, 1e-3  # of an answer from sample to sample, and how exactly it is found
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
    wide = WINDOWS * half
    if log.position.size < 2 * wide + 1:
        return log
    errors = log.position - local_polynomial(log.position, wide, DEGREE)
    answer = _answer(log, errors, wide)
    if answer is None:
        return log
    answered = scipy.signal.lfilter(answer.numbers, [1.0, -answer.kept], errors)
    return replace(log, force=log.force - np.where(np.abs(log.force) < limit, answered, 0.0))


def are_sample_errors(differences: Array) -> bool:
    """Return whether positions, differenced :data:`DIFFERENCED` times, are errors of samples."""
    return bool(differences[1:] @ differences[:-1] < -TO_AND_FRO * (differences @ differences))


def shaken_by_counts(log: EvenLog) -> float:
    """Return the correlation of quick forces with errors of positions; 0 where these are motion.

    Of a log that has every few commands of its loop alone it is weaker, for half of the answers
    are to counts that the log has not; a correlation with the motion between rows is nearly lost.
    """
    force, position = (np.diff(values, DIFFERENCED) for values in (log.force, log.position))
    size = float(np.linalg.norm(force) * np.linalg.norm(position))
    return float(force @ position) / size if size > 0 and are_sample_errors(position) else 0.0


class _Answer(NamedTuple):
    """What the force answers to the last positions, (L,), and the share kept a sample later."""

    numbers: Array
    kept: float


def _answer(log: EvenLog, errors: Array, wide: int) -> _Answer | None:
    """Return what the force answers to errors of positions.

    None where quick changes of the force are not made by those of the position, or where these
    are motion: errors of samples, so differenced, go to and fro.

    Quick changes tell little of what is answered slowly. The answer is therefore found in what
    polynomials leave of the force and of the positions.
    """
    if log.sent is not None or log.force.size < 10 * TAPS:
        return None
    force, position = (np.diff(values, DIFFERENCED) for values in (log.force, log.position))
    scale, whole = float(np.abs(position).max()), float(force[TAPS - 1 :] @ force[TAPS - 1 :])
    if scale == 0 or whole == 0 or not are_sample_errors(position):
        return None
    if 1 - _answered_with(0.0, position / scale, force, 0)[1] / whole <= AXIS_RULES.answers:
        return None
    force = log.force - local_polynomial(log.force, wide, DEGREE)
    # Near an end the polynomial is not centred, and nobody knows what was answered before a start.
    ends = min(wide, force.size // 4)

    def left(kept: float) -> float:
        return _answered_with(kept, errors / scale, force, ends)[1]

    nearest = scipy.optimize.minimize_scalar(
        left, bounds=(0.0, MOST_KEPT), method="bounded", options={"xatol": KEPT_TO}
    )
    # A bounded search never ends at its bound, where nothing is kept.
    kept = min((0.0, float(nearest.x)), key=left)
    return _Answer(_answered_with(kept, errors / scale, force, ends)[0] / scale, kept)


def _answered_with(kept: float, position: Array, force: Array, ends: int) -> tuple[Array, float]:
    """Return what a force answers if a share of it is kept, (L,), and the squares that it leaves.

    The share is that of the answer, and not of the force: noise of a logged force is not kept.
    Samples at the ends are left out.
    """
    filtered = scipy.signal.lfilter([1.0], [1.0, -kept], position)
    inside = np.arange(max(ends, TAPS - 1), filtered.size - ends)
    columns = np.stack([filtered[inside - lag] for lag in range(TAPS)], axis=1)
    numbers = np.linalg.lstsq(columns, force[inside], rcond=1e-9)[0]
    rest = force[inside] - columns @ numbers
    return np.asarray(numbers), float(rest @ rest)
