"""Reduces one run to windows: their mean forces, motion and covariances.

Friction may depend on the passes of an axis from one reversal to the next, and on its rests.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import scipy
from numpy.lib.stride_tricks import sliding_window_view

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.rigs.single_axis.answered import without_answers
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.even_log import EvenLog, given, smooth_motion
from bayesfric.rigs.single_axis.force_rates import force_curvature, late_rates
from bayesfric.rigs.single_axis.instruments import instruments_of
from bayesfric.rigs.single_axis.weak_form import NODES, TestFunction, WeakForce, node_weights

SMOOTHED = 4  # least samples on either side in the estimate of a speed
LOCAL = 5  # samples over which squared jumps of the force are averaged
NEGLIGIBLE = 1e-4  # largest jump that is ignored, relative to the force's standard deviation
OFTEN = 0.2  # share of samples with a jump from which the force is not a few steps
FAR = 10.0  # travel since a reversal before the log [strokes]
A_MOMENT = 0.01  # share of a window during which motion in the other direction is tolerated
A_STOP = 4  # a stop of half a window over this number changes the mean friction


def rows_of_run(
    log: EvenLog,
    test: TestFunction,
    step: int,
    noise: float,
    stroke: float,
    late_s: float = 0.0,
    limit: float = np.inf,
) -> dict[str, Array]:
    """Return the windows of one run: fields of :class:`Readings`, and where each window is."""
    half = test.half
    position, velocity, way = _motion(log, half, noise)
    travel, before = passes_of(position, way, FAR * stroke)
    dwell, since = rests_of(position, way, log.interval_s)
    _forget_start(position, way, stroke)
    centres = np.arange(half, log.time_s.size - half, step)
    # All samples of a window must have the same direction.
    runs = np.concatenate([[0.0], np.cumsum(way)])
    one_way = np.abs(runs[centres + half + 1] - runs[centres - half]) == 2 * half + 1
    if log.dithers is not None:
        one_way &= ~turns_back(log.dithers, test, centres)
    if log.sent is not None:
        rests = _may_rest(log.position, max(1, half // A_STOP), noise)
        one_way &= ~turns_back(rests, test, centres)
    place = np.flatnonzero(one_way)
    centres = centres[one_way]
    sign = way[centres]
    # The outermost places may lie beyond a window's last sample, after a reversal.
    places = np.clip(node_weights()[0] * (half + 1), -half, half)
    at = log.time_s[centres][:, None] + places * log.interval_s

    def inside(values: Array) -> Array:
        return np.asarray(np.interp(at, log.time_s, values))

    known_held, known_moved = _known_load(log)
    return {
        "path": position,
        "centre": centres.astype(np.float64),
        "neighbour": place.astype(np.float64),
        "way": sign,
        "acceleration": sign * test.over(log.position, test.curvature, centres),
        "time_s": log.time_s[centres],
        "speed": _speed_inside(log, test, centres, np.abs(inside(velocity))),
        "travel": inside(travel),
        "passes": before[centres],
        "dwell_s": dwell[centres],
        "since_rest": since[centres],
        "temperature": log.further.get("temperature", np.full(way.size, np.nan))[centres],
        "position": inside(position),
        "known_held": inside(known_held),
        "known_moved": inside(known_moved),
        # A drive clips peaks: a mean over more than the distance of the places would hide them.
        "drive": inside(scipy.ndimage.uniform_filter1d(log.force, 2 * (half // NODES) + 1)),
        "instruments": sign[:, None] * instruments_of(log, test, centres),
        "simulated": _means_of(log.forces, test, centres, sign),
        "beside": _means_of(log.beside, test, centres, sign),
        "known_rate": _known_rate(log, test, centres, sign),
        **_forces(log, test, centres, sign, runs, late_s, limit),
        **_errors(log, test, centres, step),
    }


def _speed_inside(log: EvenLog, test: TestFunction, centres: Whole, speed: Array) -> Array:
    """Return speeds at places inside windows; for a servo, scaled to the mean by its positions.

    An error of a servo's damping is estimated together with its delay, and only small differences
    of the speed separate the two. A polynomial through many samples is too inexact for this.
    """
    if log.sent is None:
        return speed
    mean = speed @ node_weights()[1]
    exact = np.abs(test.over(log.position, test.slope, centres))
    return np.asarray(speed * (exact / np.where(mean > 0, mean, 1.0))[:, None])


def _may_rest(position: Array, span: int, noise: float) -> Flags:
    """Return the samples at which a servo may stand still for at least `span` samples, (N,).

    A command is held until the next one. A joint that has nearly reached it stops, and later
    continues in the same direction. In a short window, a parabola does not show such a stop. The
    friction of a joint at rest can have any value between its limits.
    """
    moved = np.abs(position[span:] - position[:-span]) > AXIS_RULES.sure_of_way * noise
    may_rest = np.zeros(position.size, dtype=np.bool_)
    for shift in range(span + 1):
        may_rest[shift : shift + moved.size] |= ~moved
    return may_rest


def _motion(log: EvenLog, half: int, noise: float) -> tuple[Array, Array, Array]:
    """Return position, speed and direction of a run.

    The direction is 0 where a simulated path has another one.
    """
    over, quick = max(SMOOTHED, half // 2), half < AXIS_RULES.narrowest
    position, velocity, way = smooth_motion(log, over, noise, quick=quick)
    if (other := log.further.get("sim_position")) is not None:
        # Friction of a simulated axis that moves in the other direction has the wrong sign.
        simulated_way = smooth_motion(replace(log, position=other), over, noise)[2]
        way = np.where(simulated_way == way, way, 0.0)
    return position, velocity, way


def _forget_start(position: Array, way: Array, stroke: float) -> None:
    """Set the direction to 0 in the first samples, near the position where the log begins.

    Friction may depend on the last reversal, or on the direction in which the axis arrived at a
    rest. At the start of a log both are unknown. Samples are removed only if the axis reverses
    later in the log.
    """
    if (way > 0).any() and (way < 0).any():
        near = np.abs(position - position[0]) < AXIS_RULES.forgotten * stroke
        way[near & (np.arange(way.size) < max(np.argmax(way > 0), np.argmax(way < 0)))] = 0.0


def _means_of(
    forces: Sequence[WeakForce], test: TestFunction, centres: Whole, sign: Array
) -> Array:
    """Return the mean of each force in each window, along the motion, (W, K)."""
    means = [sign * force.over(test, centres) for force in forces]
    return np.reshape(means, (len(means), centres.size)).T


def _forces(
    log: EvenLog,
    test: TestFunction,
    centres: Whole,
    sign: Array,
    runs: Array,
    late_s: float,
    limit: float,
) -> dict[str, Array]:
    """Return the force of each window and its derivatives in time, along the motion."""
    force = test.over(log.force, test.value, centres)
    if log.sent is not None:
        force += replace(log.sent, value=np.zeros(log.force.size)).over(test, centres)
    if log.known_force is not None:
        force = force - log.known_force.over(test, centres)
    acting = given(log, limit)
    curvature = force_curvature(acting, test, centres, runs)
    quiet = without_answers(acting, test.half, limit)
    delayed, lagging = late_rates(quiet.delayed, test, centres, curvature, late_s)
    return {
        "force": sign * force,
        "force_rate": sign * delayed,
        "lagging_rate": sign * lagging,
        "force_curvature": sign * curvature,
    }


def _known_rate(log: EvenLog, test: TestFunction, centres: Whole, sign: Array) -> Array:
    """Return the rate of a logged known force along the motion, (W,); 0 if there is none.

    Responses of a controller to encoder errors are removed, as in :mod:`.answered`.
    """
    if log.known_force is None or not log.known_to_a_share:
        return np.zeros(centres.size)
    quiet = without_answers(replace(log, force=log.known_force.value), test.half, np.inf)
    return -sign * test.over(quiet.force, test.slope, centres)


def _errors(log: EvenLog, test: TestFunction, centres: Whole, step: int) -> dict[str, Array]:
    """Return the covariances of neighbouring windows due to errors of positions and forces."""
    lags = range(0, 2 * test.half // step + 1)
    held = np.zeros((len(lags), 3))
    if log.stiffness:
        held[:, 0] = _lag_products(test.value, test.value, step, lags)
        held[:, 1] = _lag_products(test.slope, test.slope, step, lags)
        held[:, 2] = 2 * _lag_products(test.value, test.curvature, step, lags)
    position = _lag_products(test.curvature, test.curvature, step, lags)
    return {
        "position_lag": np.tile(position, (centres.size, 1)),
        "held_lag": np.tile(held, (centres.size, 1, 1)),
        "force_lag": _varying_products(
            test.value, step, lags, _relative_variance(log.force), centres
        ),
    }


def _known_load(log: EvenLog) -> tuple[Array, Array]:
    """Return the static and the inertial part of a known force at each sample, (N,) twice.

    A known force that was logged counts as static.
    """
    known_force, nothing = log.known_force, np.zeros(log.time_s.size)
    if known_force is None:
        return nothing, nothing
    moved = (
        nothing
        if known_force.momentum is None
        else np.gradient(known_force.momentum, log.interval_s)
    )
    return known_force.value, moved


def turns_back(dithers: Flags, test: TestFunction, centres: Whole) -> Flags:
    """Return the windows with more than a small share of marked samples, (W,).

    Parameters
    ----------
    dithers : ndarray of bool, shape (N,)
        Marked samples, at which a joint does not move in the direction of its mean speed.
    test : TestFunction
        Test function of the windows.
    centres : ndarray of int, shape (W,)
        Middle sample of each window.
    """
    return test.over(dithers.astype(np.float64), test.value, centres) > A_MOMENT


def _lag_products(kernel: Array, other: Array, step: int, lags: range) -> Array:
    return np.array([kernel[lag * step :] @ other[: other.size - lag * step] for lag in lags])


def _relative_variance(force: Array) -> Array:
    """Return the error variance of the force at each sample, relative to a smooth force, (N,).

    The log does not contain changes of the force between samples. They are large where the force
    jumps from sample to sample (large second differences), and negligible where it is smooth. A
    constant force of a drive that is off, or at its limit, is no measure of the usual error.
    """
    jump = np.zeros(force.size)
    jump[1:-1] = np.diff(force, 2) ** 2
    local = scipy.ndimage.uniform_filter1d(jump, LOCAL)
    jumps = local > np.finfo(np.float64).eps * local.max(initial=0.0)  # a running sum has rounding
    jumping = local[jumps] if jumps.mean() > OFTEN else local
    quiet = max(float(np.median(jumping)), (NEGLIGIBLE * float(np.std(force))) ** 2)
    return np.asarray(1 + local / (quiet or 1.0))


def _varying_products(
    kernel: Array, step: int, lags: range, variance: Array, centres: Whole
) -> Array:
    """Return covariances of windows by errors whose variance changes along the run, (W, L)."""
    around = sliding_window_view(variance, kernel.size)[centres - kernel.size // 2]
    products = np.zeros((kernel.size, len(lags)))
    for lag in lags:
        products[lag * step :, lag] = kernel[lag * step :] * kernel[: kernel.size - lag * step]
    return np.asarray(around @ products)


REMEMBERED = 4  # earlier passes that friction may depend on


def passes_of(position: Array, way: Array, unseen: float) -> tuple[Array, Array]:
    """Return the travel since the last reversal, and the travel of earlier passes.

    Parameters
    ----------
    position, way : ndarray, shape (N,)
        Position [m or rad], and direction: 1, −1, or 0 if unknown.
    unseen : float
        Travel of a pass that began before the log [m or rad].

    Returns
    -------
    travel : ndarray, shape (N,)
        Travel since the last reversal. Before the first reversal it is `unseen`, or the travel
        from the start of the log if the log begins at rest.
    before : ndarray, shape (N, REMEMBERED)
        Travel of the earlier passes, the latest first.
    """
    moving = np.flatnonzero(way)
    travel = np.full(position.size, unseen)
    before = np.full((position.size, REMEMBERED), unseen)
    if not moving.size:
        return travel, before
    turned = np.flatnonzero(np.diff(way[moving]))
    turns = moving[turned + 1]
    last = np.searchsorted(turns, np.arange(position.size), side="right") - 1
    # A reversal is at the extreme position between two samples of known, opposite directions.
    extremes = np.array(
        [_extreme(position, int(moving[place]), int(moving[place + 1])) for place in turned]
    )
    if way[0] == 0:
        travel = np.abs(position - position[0])
    if extremes.size:
        after_reversal = last >= 0
        travel[after_reversal] = np.abs(position[after_reversal] - extremes[last[after_reversal]])
        strokes = np.concatenate([np.full(REMEMBERED, unseen), np.abs(np.diff(extremes))])
        ago = last[after_reversal, None] - 1 - np.arange(REMEMBERED)
        before[after_reversal] = strokes[np.maximum(ago + REMEMBERED, 0)]
    return travel, before


def rests_of(position: Array, way: Array, interval_s: float) -> tuple[Array, Array]:
    """Return the duration of the last rest before the present motion, and the travel since.

    Parameters
    ----------
    position, way : ndarray, shape (N,)
        Position [m or rad], and direction: 1, −1, or 0 where the axis is not known to move.
    interval_s : float
        Time between samples [s].

    Returns
    -------
    dwell_s, since : ndarray, shape (N,)
        Duration of the last rest before the present motion [s], and the distance from it [m]; 0
        before the first start, and the values of the motion before it during a rest.
    """
    moving = way != 0
    starts = np.flatnonzero(moving[1:] & ~moving[:-1]) + 1
    dwell, since = np.zeros((2, position.size))
    stops = np.flatnonzero(~moving[1:] & moving[:-1]) + 1
    rested_from = np.concatenate([[0], stops])[np.searchsorted(stops, starts)]
    for rested, (begin, end) in zip(rested_from, pairwise([*starts, position.size]), strict=True):
        dwell[begin:end] = (begin - rested) * interval_s
        since[begin:end] = np.abs(position[begin:end] - position[begin])
    return dwell, since


def _extreme(position: Array, before: int, after: int) -> float:
    between = position[before : after + 1]
    middle = 0.5 * (between[0] + between[-1])
    return float(between[np.argmax(np.abs(between - middle))])
