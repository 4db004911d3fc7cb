"""The width of the windows of a recording, and a rough delay of its force."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bayesfric.arrays import Array, Whole
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.even_log import (
    EvenLog,
    given,
    position_noise,
    resolving,
    smooth_motion,
)
from bayesfric.rigs.single_axis.rough import SINGULAR, least_squares, pull_columns, rough_law
from bayesfric.rigs.single_axis.run_rows import SMOOTHED, rows_of_run
from bayesfric.rigs.single_axis.weak_form import node_weights, test_function

MOST = 3000  # most windows of a recording
SPARSE = 24  # with fewer windows they overlap more, and their errors are more correlated
CLOSER = 0.5  # distance of these windows [half-widths]
ROWS_A_COLUMN = 3  # least windows for each column of a regression
LATEST_S = 0.05  # largest delay of a force for which its rate is exact enough


def window_width(logs: Sequence[EvenLog], noise: float, stroke: float) -> tuple[float, float]:
    """Return half the width of a window [s], and the distance of windows relative to that.

    A known force may be proportional to the acceleration, but without the errors of this log's
    positions. If these errors were a large part of its residual acceleration, its relative error
    would explain the inertia. So they must be a small part too.
    """
    logs = [replace(log, beside=log.beside[:1] * (len(log.beside) == 1)) for log in logs]
    moved = float(np.mean([log.known_inertia for log in logs]))
    length = sum(log.time_s.size * log.interval_s for log in logs)
    half_s, longest = _narrowest_and_widest(logs, noise)
    if any(log.sent is not None for log in logs):
        # Only small differences separate a servo's delay from damping, so windows are widest.
        half_s = longest
    # Acceptable half-widths, with the error of the acceleration relative to its independent part.
    tried: list[tuple[float, float]] = []
    while half_s < longest:
        rows = [
            rows_of_run(log, test_function(half, log.interval_s), 2 * half, noise, stroke)
            for log, half in ((log, half_samples(half_s, log)) for log in logs)
        ]
        mass, force, beyond_known, own = _told_by(rows)
        error = noise * float(np.sqrt(max(row["position_lag"][:1, :1].sum() for row in rows)))
        is_quiet = (mass + moved) * error < AXIS_RULES.quiet * force
        if tried or (is_quiet and error < AXIS_RULES.told_apart * beyond_known):
            tried.append((half_s, error / max(own, 1e-300)))
            if is_quiet and error < AXIS_RULES.told_apart * own:
                break
        half_s *= 1.25
    half_s = min(_told_best(tried, longest), longest)
    return half_s, max(1.0, length / (MOST * half_s))


def _told_best(tried: Sequence[tuple[float, float]], widest: float) -> float:
    """Return the width that determines the acceleration best; the narrowest if none does."""
    if not tried:
        return widest
    best, share = min(tried, key=lambda width: width[1])
    return best if share**2 < 1 - AXIS_RULES.acceleration_shows else tried[0][0]


def _told_by(rows: Sequence[dict[str, Array]]) -> tuple[float, float, float, float]:
    """Return the rough mass, the rms force, and two residual accelerations.

    They are the rms residuals after regression on the known force, and on the law with forces of
    the position (in a free swing, the force of a weight is proportional to the acceleration). If
    errors of positions are as large as such a residual, the mass is underestimated, although they
    make little force with that mass.
    """
    force, way = joined(rows, "force"), joined(rows, "way")
    acceleration, speed = joined(rows, "acceleration"), joined(rows, "speed")
    pull = pull_columns(joined(rows, "position"), way)
    law = np.column_stack([np.ones_like(speed), speed, pull])
    own = np.inf
    if force.size >= ROWS_A_COLUMN * law.shape[1]:
        own = _beyond(acceleration, law)
    beyond_known = _beyond(acceleration, np.concatenate([row["beside"] for row in rows]))
    mass = rough_law(force, acceleration, speed, pull).mass
    return mass, float(np.sqrt(np.mean(force**2))) if force.size else 0.0, beyond_known, own


def _beyond(values: Array, columns: Array) -> float:
    """Return the rms residual of values after regression on columns; infinite without columns."""
    if not columns.size:
        return np.inf
    residual = values - columns @ np.linalg.lstsq(columns, values, rcond=None)[0]
    return float(np.sqrt(np.mean(residual**2)))


def _narrowest_and_widest(logs: Sequence[EvenLog], noise: float) -> tuple[float, float]:
    interval = max(log.interval_s for log in logs)
    room_s = pass_s(logs, noise) / (2 * AXIS_RULES.windows_a_pass)
    narrowest = (
        int(np.clip(room_s / interval, AXIS_RULES.narrowest_at_turns, AXIS_RULES.narrowest))
        * interval
    )
    return narrowest, max(room_s, narrowest)


def widest_half_s(logs: Sequence[EvenLog], noise: float) -> float:
    """Return half the width of the widest window for the length of the passes [s]."""
    return _narrowest_and_widest(logs, noise)[1]


def half_samples(half_s: float, log: EvenLog) -> int:
    """Return half the width of a window in samples of a run."""
    return max(AXIS_RULES.narrowest_at_turns, round(half_s / log.interval_s))


def position_sd(logs: Sequence[EvenLog], resolution: float | None) -> float:
    """Return the standard deviation of a position's error, the median over runs [m or rad]."""
    return float(np.median([position_noise(log, resolution) for log in logs]))


def pass_s(logs: Sequence[EvenLog], noise: float) -> float:
    """Return the typical duration of a pass in one direction [s]; 0 if there is no pass.

    Half of the time in motion belongs to passes of at least this duration.
    """
    lengths = np.concatenate([_stretches(log, noise)[0] for log in logs])
    if not lengths.size:
        return 0.0
    # A median over time, not over passes: noise at a reversal makes many short passes.
    order = np.sort(lengths)
    return float(order[np.searchsorted(np.cumsum(order), 0.5 * order.sum())])


def sticking_share(logs: Sequence[EvenLog], noise: float) -> float:
    """Return the share of stops after which the direction is the same; 0 without stops."""
    goes_on = [np.diff(_stretches(log, noise)[1]) == 0 for log in logs]
    return float(np.mean(np.concatenate(goes_on))) if sum(map(len, goes_on)) else 0.0


def _stretches(log: EvenLog, noise: float) -> tuple[Array, Array]:
    """Return the duration [s] and the direction of each pass."""
    way = smooth_motion(log, resolving(log, SMOOTHED, noise), noise)[2]
    samples, ways = stretches_of(way)
    return log.interval_s * samples.astype(np.float64), ways


def stretches_of(way: Array) -> tuple[Whole, Array]:
    """Return the number of samples and the direction of each stretch with one known direction."""
    edges = np.flatnonzero(np.diff(way, prepend=0.0, append=0.0))
    ways = way[edges[:-1]]
    return np.diff(edges)[ways != 0], ways[ways != 0]


def joined(rows: Sequence[dict[str, Array]], name: str) -> Array:
    """Return one field of all runs; values at places inside windows are averaged under φ, (W,)."""
    values, weights = [row[name] for row in rows], node_weights()[1]
    return np.concatenate([part @ weights if part.ndim > 1 else part for part in values])


def late_by(logs: Sequence[EvenLog], half_s: float, noise: float, stroke: float) -> float:
    """Return a rough delay of the force relative to the log [s]."""
    late_s, logs = 0.0, [replace(log, beside=()) for log in logs]
    for _ in range(2):
        rows = []
        for log in logs:
            test = test_function(half_samples(half_s, log), log.interval_s)
            rows.append(rows_of_run(log, test, test.half, noise, stroke, late_s))
        force, rate = joined(rows, "force"), joined(rows, "force_rate")
        acceleration, speed = joined(rows, "acceleration"), joined(rows, "speed")
        pull = pull_columns(joined(rows, "position"), joined(rows, "way"))
        design = np.stack([rate, acceleration, np.ones_like(rate), speed], axis=1)
        if rough_law(force, acceleration, speed, pull).pull:
            design = np.column_stack([design, pull])
        numbers, _ = least_squares(design, force, rcond=SINGULAR)
        late_s = float(np.clip(numbers[0], -LATEST_S, LATEST_S)) if force.size else 0.0
    return late_s


def windows_of(
    logs: Sequence[EvenLog], resolution: float | None, stroke: float, limit: float
) -> tuple[float, float, float, float]:
    """Return the position error, half-width [s] and distance of windows, and force delay [s]."""
    noise = position_sd(logs, resolution)
    half_s, hop = window_width(logs, noise, stroke)
    if _count(logs, half_s, noise, stroke) < SPARSE:
        half = half_samples(half_s, logs[0])
        hop *= max(1, round(CLOSER * half)) / half
    late_s = 0.0
    if all(log.sent is None for log in logs):  # a servo's delay is estimated elsewhere
        late_s = late_by([given(run_log, limit) for run_log in logs], half_s, noise, stroke)
    return noise, half_s, hop, late_s


def _count(logs: Sequence[EvenLog], half_s: float, noise: float, stroke: float) -> int:
    """Return the number of windows with a single direction, at distances of half a window."""
    count = 0
    for log in logs:
        half = half_samples(half_s, log)
        rows = rows_of_run(log, test_function(half, log.interval_s), half, noise, stroke)
        count += rows["way"].size
    return count
