"""All runs reduced, once, to rows that are linear in mass and friction."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.ndimage import uniform_filter1d

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.rigs.single_axis.beside import Mixing, leading, rough_amounts
from bayesfric.rigs.single_axis.even_log import (
    EvenLog,
    given,
    position_noise,
    resolving,
    smooth_motion,
)
from bayesfric.rigs.single_axis.following import DrivePath, Followed
from bayesfric.rigs.single_axis.force_curvature import force_curvature
from bayesfric.rigs.single_axis.late_rates import late_rates
from bayesfric.rigs.single_axis.passes import passes_of, rests_of
from bayesfric.rigs.single_axis.rough import RoughLaw, pull_columns, rough_law
from bayesfric.rigs.single_axis.weak_form import (
    NODES,
    TestFunction,
    node_weights,
    test_function,
)

__all__ = [
    "FEWEST",
    "PIECE",
    "Readings",
    "pass_s",
    "position_sd",
    "readings_of",
    "rough_law_of",
]

QUIET = 0.003  # of the rms drive force, that a row's error from the position may be
NARROWEST = 8  # samples on either side of a window's middle
FEWEST = 4  # the same, where the axis turns too soon for so many
SMOOTHED = 4  # samples on either side that a speed is of, at the least
FOLLOWED = 12  # samples in half a window, of the path along which loads are followed
PASSES = 4  # windows side by side that a pass should have room for
MOST = 3000  # rows of a recording
PIECE = 16  # rows of a stretch whose friction wanders as one
LOCAL = 5  # samples over which jumps of the force are averaged
UNHEARD = 1e-4  # of the force's standard deviation: jumps that are none
LATEST_S = 0.05  # of a force, in which its rate is told exactly
FAR = 10.0  # strokes: travel since a reversal that nobody saw
FORGOTTEN = 0.2  # of the stroke, after which such a reversal no longer counts


@dataclass(frozen=True)
class Readings:
    """W rows: mean forces over windows, in the direction of the motion.

    Parameters
    ----------
    trial : ndarray of int, shape (W,)
        Place of the trial, ascending.
    piece : ndarray of int, shape (W,)
        Number of the stretch of neighbours, at most :data:`PIECE` each, ascending.
    way : ndarray, shape (W,)
        1 or −1.
    force, acceleration : ndarray, shape (W,)
        ∫ φ F dt, without what is known of it, and ∫ φ'' q dt, times the direction.
    force_rate, lagging_rate, force_curvature : ndarray, shape (W,)
        −∫ φ' F dt and ∫ φ'' F dt, times the direction. The first rate is of the force earlier
        by half of what it is late: F(t) − F(t − d) is d F'(t − d/2) up to the third order. The
        other is that of what an actuator gives which lags by as much.
    time_s : ndarray, shape (W,)
        Of the window's middle.
    speed, travel, position, drive : ndarray, shape (W, P)
        At places inside: speed, travel since the last reversal, position and drive force.
    passes : ndarray, shape (W, E)
        Travel of the passes before the present one, the last first.
    dwell_s, since_rest, temperature : ndarray, shape (W,)
        How long it rested before it moved as it does, travel since then, and the temperature;
        nan where none was logged.
    position_lag, force_lag : ndarray, shape (W, L)
        Covariance of a row with the l-th next by an error of position of 1, at every sample
        its own, per mass squared; and by an error of the force, of 1 where it is quiet.
    simulated : ndarray, shape (W, K)
        Means of what a simulator says of the force, times the direction; K is 0 without one.
    beside : ndarray, shape (W, K)
        Means of forces that may be there in amounts N(0, 1), times the direction.
    place : ndarray of int, shape (W,)
        Of the row among all of `followed`.
    followed : Followed
        Loads behind the drive, along the paths of the runs.
    position_sd, half_s, hop : float
        Standard deviation of a position's error, half a window [s], windows' distance over that.
    known_inertia : float
        What the model of a known force moves [kg, or kg·m²].
    mixing : Mixing
        Of what the columns of `beside` are made.
    """

    trial: Whole
    piece: Whole
    way: Array
    force: Array
    acceleration: Array
    force_rate: Array
    lagging_rate: Array
    force_curvature: Array
    time_s: Array
    speed: Array
    travel: Array
    position: Array
    drive: Array
    passes: Array
    dwell_s: Array
    since_rest: Array
    temperature: Array
    position_lag: Array
    force_lag: Array
    simulated: Array
    beside: Array
    place: Whole
    followed: Followed
    position_sd: float
    half_s: float
    hop: float
    known_inertia: float = 0.0
    mixing: Mixing = field(default_factory=Mixing)

    @property
    def count(self) -> int:
        """Number of rows."""
        return self.trial.size

    @property
    def weights(self) -> Array:
        """Of the places inside a window, shape (P,)."""
        return node_weights()[1]

    def of(self, trials: Whole) -> "Readings":
        """Return the rows of some trials, which are numbered anew in that order."""
        place = np.full(int(self.trial.max()) + 1, -1, dtype=np.intp)
        place[trials] = np.arange(trials.size)
        rows = np.flatnonzero(place[self.trial] >= 0)
        rows = rows[np.argsort(place[self.trial[rows]], kind="stable")]
        changed = {
            item.name: getattr(self, item.name)[rows]
            for item in fields(self)
            if isinstance(getattr(self, item.name), np.ndarray)
        }
        trial = place[changed["trial"]]
        piece = np.cumsum(np.diff(changed["piece"], prepend=changed["piece"][:1]) != 0)
        return replace(self, **(changed | {"trial": trial, "piece": piece}))


def readings_of(
    logs: Sequence[EvenLog],
    starts: Sequence[Whole],
    resolution: float | None,
    like: Readings | None = None,
    limit: float = np.inf,
) -> Readings | None:
    """Reduce runs to rows; None where no window runs one way.

    Parameters
    ----------
    logs : sequence of EvenLog
        Runs.
    starts : sequence of ndarray of int
        Of each run, the samples at which its trials begin, 0 first.
    resolution : float or None
        Of the encoder.
    like : Readings or None
        Rows whose windows and noise these have, on time; None looks for them.
    limit : float
        Of the drive: what is commanded beyond it neither acts later nor changes what acts.
    """
    stroke = max(float(np.ptp(one.position)) for one in logs)
    if like is None:
        noise = position_sd(logs, resolution)
        half_s, hop = _width(logs, noise, stroke)
        late_s = _late_by([given(one, limit) for one in logs], half_s, noise, stroke)
    else:
        noise, half_s, hop, late_s = like.position_sd, like.half_s, like.hop, 0.0
    parts: list[dict[str, Any]] = []
    paths = []
    trials = pieces = 0
    for log, begin in zip(logs, starts, strict=True):
        half = _samples(half_s, log)
        step = max(1, round(hop * half))
        test = test_function(half, log.interval_s)
        part = _of_run(log, test, step, noise, stroke, late_s, limit)
        centres = part["centre"].astype(np.intp)
        path = part.pop("path")
        paths.append(_drive_path(path, log.interval_s, test, centres, part["way"]))
        place = np.searchsorted(begin, part.pop("centre"), side="right")
        part["trial"] = np.asarray(trials + place - 1, dtype=np.float64)
        part["piece"] = pieces + _pieces(part.pop("neighbour"), part["trial"])
        trials += begin.size
        pieces = int(part["piece"].max()) + 1 if part["piece"].size else pieces
        parts.append(part)
    widest = max(part["position_lag"].shape[1] for part in parts)
    for part in parts:
        for name in ("position_lag", "force_lag"):
            short = widest - part[name].shape[1]
            nothing = np.zeros((len(part[name]), short))
            part[name] = np.concatenate([part[name], nothing], axis=1)
    joined = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    if not joined["way"].size:
        return None
    whole: dict[str, Any] = {name: joined.pop(name).astype(np.intp) for name in ("trial", "piece")}
    whole["place"] = np.arange(joined["way"].size)
    joined["beside"], mixing = leading(joined["beside"], joined["force"])
    return Readings(
        **whole,
        **joined,
        followed=Followed(paths),
        position_sd=noise,
        half_s=half_s,
        hop=hop,
        known_inertia=float(np.mean([log.known_inertia for log in logs])),
        mixing=mixing,
    )


def _drive_path(
    path: Array, interval_s: float, test: TestFunction, centres: Whole, way: Array
) -> DrivePath:
    """Return the path along which loads are followed, step by step: of no more than it takes.

    Where a window has many samples, every few of them tell the path as well.
    """
    every = test.half // FOLLOWED
    if every < 2:
        return DrivePath(path, interval_s, test, centres, way)
    fewer = test_function(test.half // every, every * interval_s)
    path = path[::every]
    middles = np.clip(np.round(centres / every), fewer.half, path.size - fewer.half - 1)
    return DrivePath(path, every * interval_s, fewer, middles.astype(np.intp), way)


def _width(logs: Sequence[EvenLog], noise: float, stroke: float) -> tuple[float, float]:
    """Return half the width of a window [s], and windows' distance as a share of that."""
    logs = [replace(log, beside=()) for log in logs]
    moved = float(np.mean([log.known_inertia for log in logs]))
    interval = max(one.interval_s for one in logs)
    length = sum(one.time_s.size * one.interval_s for one in logs)
    room_s = pass_s(logs, noise) / (2 * PASSES)
    narrowest = int(np.clip(room_s / interval, FEWEST, NARROWEST))
    longest = max(room_s, narrowest * interval)
    half_s = narrowest * interval
    while half_s < longest:
        rows = []
        for one in logs:
            half = _samples(half_s, one)
            test = test_function(half, one.interval_s)
            rows.append(_of_run(one, test, 2 * half, noise, stroke))
        force, way = _joined(rows, "force"), _joined(rows, "way")
        pull = pull_columns(_joined(rows, "position"), way)
        acceleration, speed = _joined(rows, "acceleration"), _joined(rows, "speed")
        mass = rough_law(force, acceleration, speed, pull).mass + moved
        error = noise * float(np.sqrt(max(row["position_lag"][:1, :1].sum() for row in rows)))
        if force.size and mass * error < QUIET * float(np.sqrt(np.mean(force**2))):
            break
        half_s *= 1.25
    half_s = min(half_s, longest)
    return half_s, max(1.0, length / (MOST * half_s))


def _samples(half_s: float, log: EvenLog) -> int:
    """Return half a window in samples of a run."""
    return max(FEWEST, round(half_s / log.interval_s))


def position_sd(logs: Sequence[EvenLog], resolution: float | None) -> float:
    """Return the standard deviation of a position's error, the median of runs."""
    return float(np.median([position_noise(one, resolution) for one in logs]))


def pass_s(logs: Sequence[EvenLog], noise: float) -> float:
    """Return the median time that the axis runs one way [s]; a quarter of it counts at least."""
    found = []
    for one in logs:
        way = smooth_motion(one, resolving(one, SMOOTHED, noise), noise)[2]
        edges = np.flatnonzero(np.diff(way, prepend=0.0, append=0.0))
        each = np.diff(edges)[way[edges[:-1]] != 0] if edges.size > 1 else np.zeros(0)
        found.append(each * one.interval_s)
    lengths = np.concatenate(found)
    if not lengths.size:
        return 0.0
    # Of the time, not of the passes: at a reversal noise makes many short ones.
    order = np.sort(lengths)
    return float(order[np.searchsorted(np.cumsum(order), 0.5 * order.sum())])


def _joined(rows: Sequence[dict[str, Array]], name: str) -> Array:
    values = [row[name] for row in rows]
    return np.concatenate([one.mean(axis=1) if one.ndim > 1 else one for one in values])


def rough_law_of(rows: Readings, inside: Flags, *, viscous: bool = True) -> RoughLaw:
    """Return mass and friction by some rows; see :func:`.rough.rough_law`.

    Parameters
    ----------
    rows : Readings
        W rows.
    inside : ndarray of bool, shape (W,)
        Those that tell it.
    viscous : bool
        Whether friction may grow with the speed.
    """
    speed = viscous * (rows.speed @ rows.weights)
    pull = pull_columns(rows.position @ rows.weights, rows.way)
    columns = np.column_stack([rows.acceleration, np.ones(rows.count), speed])
    force = rows.force - rough_amounts(columns, rows.beside, rows.force, inside)
    return rough_law(force[inside], rows.acceleration[inside], speed[inside], pull[inside])


def _late_by(logs: Sequence[EvenLog], half_s: float, noise: float, stroke: float) -> float:
    """Return by how much the force acts later than the log has it, roughly [s]."""
    late_s, logs = 0.0, [replace(log, beside=()) for log in logs]
    for _ in range(2):
        rows = []
        for one in logs:
            test = test_function(_samples(half_s, one), one.interval_s)
            rows.append(_of_run(one, test, test.half, noise, stroke, late_s))
        force, rate = _joined(rows, "force"), _joined(rows, "force_rate")
        acceleration, speed = _joined(rows, "acceleration"), _joined(rows, "speed")
        pull = pull_columns(_joined(rows, "position"), _joined(rows, "way"))
        design = np.stack([rate, acceleration, np.ones_like(rate), speed], axis=1)
        if rough_law(force, acceleration, speed, pull).pull:
            design = np.column_stack([design, pull])
        width = np.abs(design).max(axis=0, initial=0.0)
        width[width == 0] = 1.0
        found = np.linalg.lstsq(design / width, force, rcond=1e-6)[0] / width
        late_s = float(np.clip(found[0], -LATEST_S, LATEST_S)) if force.size else 0.0
    return late_s


def _of_run(
    log: EvenLog,
    test: TestFunction,
    step: int,
    noise: float,
    stroke: float,
    late_s: float = 0.0,
    limit: float = np.inf,
) -> dict[str, Array]:
    """Return the rows of one run, fields of :class:`Readings` and where they are."""
    half = test.half
    quick = half < NARROWEST
    position, velocity, way = smooth_motion(log, max(SMOOTHED, half // 2), noise, quick=quick)
    if (other := log.further.get("sim_position")) is not None:
        # Where the simulated axis runs the other way its friction says nothing of this motion.
        there = smooth_motion(replace(log, position=other), max(SMOOTHED, half // 2), noise)[2]
        way = np.where(there == way, way, 0.0)
    travel, before = passes_of(position, way, FAR * stroke)
    dwell, since = rests_of(position, way, log.interval_s)
    warm = log.further.get("temperature", np.full(way.size, np.nan))
    # A log does not say how long ago the axis turned before it, nor by which way it came to where
    # it rests, which friction may remember; where it turns later on, that is better known.
    if (way > 0).any() and (way < 0).any():
        near = np.abs(position - position[0]) < FORGOTTEN * stroke
        way[near & (np.arange(way.size) < max(np.argmax(way > 0), np.argmax(way < 0)))] = 0.0
    centres = np.arange(half, log.time_s.size - half, step)
    # A window counts where all of its samples run the same way.
    runs = np.concatenate([[0.0], np.cumsum(way)])
    one_way = np.abs(runs[centres + half + 1] - runs[centres - half]) == 2 * half + 1
    place = np.flatnonzero(one_way)
    centres = centres[one_way]
    sign = way[centres]
    # The outermost places may lie between a window's last sample and the next, which turned.
    places = np.clip(node_weights()[0] * (half + 1), -half, half)
    at = log.time_s[centres][:, None] + places * log.interval_s

    def inside(values: Array) -> Array:
        return np.asarray(np.interp(at, log.time_s, values))

    simulated = [sign * one.over(test, centres) for one in log.forces]
    beside = [sign * one.over(test, centres) for one in log.beside]
    force = test.over(log.force, test.value, centres)
    if log.known_force is not None:
        force = force - log.known_force.over(test, centres)
    lags = range(0, 2 * half // step + 1)
    acting = given(log, limit)
    curvature = force_curvature(acting, test, centres, runs)
    delayed, lagging = late_rates(acting, test, centres, curvature, late_s)
    return {
        "path": position,
        "centre": centres.astype(np.float64),
        "neighbour": place.astype(np.float64),
        "way": sign,
        "force": sign * force,
        "acceleration": sign * test.over(log.position, test.curvature, centres),
        "force_rate": sign * delayed,
        "lagging_rate": sign * lagging,
        "force_curvature": sign * curvature,
        "time_s": log.time_s[centres],
        "speed": np.abs(inside(velocity)),
        "travel": inside(travel),
        "passes": before[centres],
        "dwell_s": dwell[centres],
        "since_rest": since[centres],
        "temperature": warm[centres],
        "position": inside(position),
        # A drive clips what it is sent: a mean over more than the places' distance has no peaks.
        "drive": inside(uniform_filter1d(log.force, 2 * (half // NODES) + 1)),
        "position_lag": np.tile(_lagged(test.curvature, step, lags), (centres.size, 1)),
        "force_lag": _locally(test.value, step, lags, _loudness(log.force), centres),
        "simulated": np.reshape(simulated, (len(simulated), centres.size)).T,
        "beside": np.reshape(beside, (len(beside), centres.size)).T,
    }


def _lagged(kernel: Array, step: int, lags: range) -> Array:
    return np.array([kernel[lag * step :] @ kernel[: kernel.size - lag * step] for lag in lags])


def _loudness(force: Array) -> Array:
    """Return the variance of the force's error at each sample, over that at a quiet one, (N,).

    What a force does between two samples is not in the log. Where it jumps from sample to
    sample (seen in second differences) that is much, and a smooth course hides nothing.
    """
    jump = np.zeros(force.size)
    jump[1:-1] = np.diff(force, 2) ** 2
    local = uniform_filter1d(jump, LOCAL)
    quiet = max(float(np.median(local)), (UNHEARD * float(np.std(force))) ** 2)
    return np.asarray(1 + local / (quiet or 1.0))


def _locally(kernel: Array, step: int, lags: range, variance: Array, centres: Whole) -> Array:
    """Return covariances of windows by errors whose variance differs along the run, (W, L)."""
    around = sliding_window_view(variance, kernel.size)[centres - kernel.size // 2]
    products = np.zeros((kernel.size, len(lags)))
    for lag in lags:
        products[lag * step :, lag] = kernel[lag * step :] * kernel[: kernel.size - lag * step]
    return np.asarray(around @ products)


def _pieces(place: Array, trial: Array) -> Array:
    """Return the number of each row's piece: neighbours of one trial, at most some."""
    if not place.size:
        return place
    breaks = (np.diff(place, prepend=place[0]) > 1) | (np.diff(trial, prepend=trial[0]) != 0)
    stretch = np.cumsum(breaks)
    first = np.flatnonzero(np.diff(stretch, prepend=-1))
    inside = np.arange(place.size) - first[stretch]
    return np.asarray(np.cumsum(breaks | ((inside > 0) & (inside % PIECE == 0))), dtype=float)
