"""Removes a controller's response to encoder errors from the force.

A controller that computes the speed from encoder counts responds to the error e of each position
with a force −h ∗ e, where h is the response of its loop. That force acts, so it is no error of the
force. But the acceleration of a window has the error ∫ φ'' e dt, and the rate of the force contains
the same errors, many times larger. Least squares explain one by the other: as a force that acts
some milliseconds later than it was logged, together with too much viscous friction. The rate of
the force is needed only to determine a delay. It is therefore computed from the force without its
response to position errors. These are the residuals of polynomials of fourth degree over two
windows. Residuals of parabolas would also contain motion, whose force does act late.

A controller filters the speed, so its response decays over many samples by a constant factor per
sample. The response to a slow error is the small difference of large early and late parts. If the
decay is cut off, the rate keeps errors as slow as a window, and inertia is biased: by 0.3 % for a
joint at 500 Hz with counts of 0.4 mrad, whose filter gives the previous speed a weight of 0.64.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.decay import decaying
from bayesfric.rigs.single_axis.even_log import EvenLog, local_polynomial

TAPS = 4  # samples of a controller's response to a position before it decays geometrically
MOST_KEPT, KEPT_TO = 0.95, 1e-3  # largest factor of this decay per sample, and its tolerance
DIFFERENCED = 3  # order of the differences that remove motion and leave errors of samples
ALTERNATE = 0.5  # least negative correlation of neighbouring differences; of errors it is 0.75
WINDOWS, DEGREE = 2, 4  # windows that a polynomial spans, and its degree


def without_answers(log: EvenLog, half: int, limit: float) -> EvenLog:
    """Return a run without the force's response to errors of its positions.

    Parameters
    ----------
    log : EvenLog
        A run.
    half : int
        Half the width of a window [samples].
    limit : float
        Force limit of the drive, at which the force does not respond [N or N·m].
    """
    wide = WINDOWS * half
    if log.position.size < 2 * wide + 1:
        return log
    errors = log.position - local_polynomial(log.position, wide, DEGREE)
    answer = _answer(log, errors, wide)
    if answer is None:
        return log
    at_once = np.convolve(errors, answer.numbers)[: errors.size]
    answered = decaying(at_once, answer.kept)
    return replace(log, force=log.force - np.where(np.abs(log.force) < limit, answered, 0.0))


def are_sample_errors(differences: Array) -> bool:
    """Return whether differences of order :data:`DIFFERENCED` are errors of samples, not motion.

    Those of independent errors alternate in sign.
    """
    return bool(differences[1:] @ differences[:-1] < -ALTERNATE * (differences @ differences))


def shaken_by_counts(log: EvenLog) -> float:
    """Return the correlation of fast changes of the force with errors of positions.

    It is 0 if fast changes of the positions are motion. It is weaker in a log that contains only
    every second (or later) command of the loop, because the other commands respond to positions
    that are not in the log.
    """
    force, position = (np.diff(values, DIFFERENCED) for values in (log.force, log.position))
    size = float(np.linalg.norm(force) * np.linalg.norm(position))
    return float(force @ position) / size if size > 0 and are_sample_errors(position) else 0.0


class _Answer(NamedTuple):
    """A controller's response to position errors.

    Parameters
    ----------
    numbers : ndarray, shape (L,)
        Force per error of the present and of the previous positions, before the decay.
    kept : float
        Factor by which the response decays per sample.
    """

    numbers: Array
    kept: float


def _answer(log: EvenLog, errors: Array, wide: int) -> _Answer | None:
    """Return the force's response to errors of positions.

    None if fast changes of the force are not a response to those of the position, or if the latter
    are motion.

    Fast changes do not determine the slow part of a response. It is therefore fitted to the
    residuals of force and positions after local polynomials.
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
    # At the ends, polynomials are not centred, and the response to earlier errors is unknown.
    ends = min(wide, force.size // 4)

    def residual_square(kept: float) -> float:
        return _answered_with(kept, errors / scale, force, ends)[1]

    nearest = scipy.optimize.minimize_scalar(
        residual_square, bounds=(0.0, MOST_KEPT), method="bounded", options={"xatol": KEPT_TO}
    )
    # A bounded search never returns its bound 0, so that value is compared too.
    kept = min((0.0, float(nearest.x)), key=residual_square)
    return _Answer(_answered_with(kept, errors / scale, force, ends)[0] / scale, kept)


def _answered_with(kept: float, position: Array, force: Array, ends: int) -> tuple[Array, float]:
    """Fit the force's response to positions at a given decay.

    The response decays, not the force, so noise of a logged force does not persist.

    Parameters
    ----------
    kept : float
        Factor by which the response decays per sample.
    position, force : ndarray, shape (N,)
        Errors of positions, and the force.
    ends : int
        Number of samples at either end that are not used.

    Returns
    -------
    numbers : ndarray, shape (L,)
        The response before its decay.
    squares : float
        Residual sum of squares of the force.
    """
    filtered = decaying(position, kept)
    inside = np.arange(max(ends, TAPS - 1), filtered.size - ends)
    columns = np.stack([filtered[inside - lag] for lag in range(TAPS)], axis=1)
    numbers = np.linalg.lstsq(columns, force[inside], rcond=1e-9)[0]
    residual = force[inside] - columns @ numbers
    return np.asarray(numbers), float(residual @ residual)
