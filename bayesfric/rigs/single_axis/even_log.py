"""A run on an even grid, and what is known of its speed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import scipy
from numpy.lib.stride_tricks import sliding_window_view

from bayesfric.arrays import Array, Flags
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.weak_form import WeakForce

NORMAL = 1.4826  # from the median of absolute deviations to a standard deviation
SLOW = 0.2  # of the top speed: speeds from which on it shall be known which way the axis runs
FINE = 0.005  # of the top speed, to which a speed is told well
QUICK = 3  # samples on either side of a polynomial of fourth degree, at the least
MOST_OFF = 2.0  # intervals, by which a stamp of an even clock is off at most
SMOOTHER = 2.0  # times, that positions are over an even clock where stamps jitter about it
AROUND = 3  # samples on either side of a reading that may be a spike
OFTEN_AT_END, STAYS = 10, 5  # readings at the end of a range, and of these in a row
BESIDE_END, PILED_UP = 5, 5  # steps of readings below that end, and times as many at it
SPIKE = (5.0, 4.0)  # times the spread about it, and times that of the run, by which it is off


@dataclass(frozen=True)
class EvenLog:
    """A run, evenly sampled.

    Parameters
    ----------
    time_s, position, force : ndarray, shape (N,)
        The log.
    is_known : ndarray of bool, shape (N,)
        False in gaps.
    interval_s : float
        Between samples.
    further : dict of str to ndarray, shape (N,)
        Further columns of the log.
    forces : tuple of WeakForce
        What a simulator says of the force: what it needs, and more by each parameter.
    known_force : WeakForce or None
        What is known of the drive force, by a model of the machine.
    beside : tuple of WeakForce
        Forces that may be there in unknown amounts, each with a prior N(0, 1): the errors of
        that model, or the pull of other joints.
    known_inertia : float
        What the model moves, whose acceleration an error of the position makes [kg, or kg·m²].
    known_to_a_share : bool
        Whether the first of `beside` is the share by which the known force may be wrong.
    dithers : ndarray of bool, shape (N,), or None
        Where it turns back between two counts; None where nobody looked.
    sent : WeakForce or None
        Of a log of commands, the force that a servo's stiffness makes of them: `force` is its
        value less what the stiffness makes of the position. None where a force was logged.
    stiffness : float
        Of that servo, by which an error of the position is one of the force; 0 where a force was
        logged.
    moment : ndarray, shape (N,), or None
        Of a force that acts as it is until the next: that of an interval about its middle, over
        the interval; None of one that does not.
    stamps_sd_s : float
        By how much stamps were off from the even clock that was taken for them; 0 where they stand.
    """

    time_s: Array
    position: Array
    force: Array
    is_known: Flags
    interval_s: float
    further: dict[str, Array]
    forces: tuple[WeakForce, ...] = ()
    known_force: WeakForce | None = None
    beside: tuple[WeakForce, ...] = ()
    known_inertia: float = 0.0
    known_to_a_share: bool = False
    dithers: Flags | None = None
    sent: WeakForce | None = None
    stiffness: float = 0.0
    moment: Array | None = None
    stamps_sd_s: float = 0.0

    @property
    def delayed(self) -> "EvenLog":
        """The run with what a delay acts on in the place of the force: of a servo, its command."""
        return self if self.sent is None else replace(self, force=self.sent.value)


def even_grid(
    time_s: Array,
    columns: dict[str, Array],
    *,
    force_time_s: Array | None = None,
    steps: bool = False,
) -> EvenLog | None:
    """Put a log on an even grid; None where it is too short.

    What is measured goes on in a straight line from sample to sample. A command acts as it is
    until the next: its mean over the interval about each place of the grid stands there, so that
    an integral over many of them is that of its steps.

    Parameters
    ----------
    time_s : ndarray, shape (N,)
        Increasing [s].
    columns : dict of str to ndarray, shape (N,)
        ``position``, ``force`` and what else there is.
    force_time_s : ndarray, shape (N,), or None
        The force's own clock, increasing, of as many readings as it has; None where it is that
        of the rest [s].
    steps : bool
        Whether ``force`` acts as it is until the next, as a command does.
    """
    if time_s.size < AXIS_RULES.least_samples:
        return None
    time_s, stamps_sd = even_clock(time_s, columns["position"])
    between = np.diff(time_s)
    interval = float(np.median(between))
    is_logged = np.ones(time_s.size, dtype=np.bool_)
    own = time_s if force_time_s is None else force_time_s
    force = columns["force"]
    columns = {name: values for name, values in columns.items() if name != "force"}
    if np.abs(between - interval).max() > AXIS_RULES.uneven * interval:
        count = int((time_s[-1] - time_s[0]) / interval) + 1
        grid = time_s[0] + interval * np.arange(count)
        after = np.searchsorted(time_s, grid, side="right").clip(1, time_s.size - 1)
        is_logged = time_s[after] - time_s[after - 1] <= AXIS_RULES.longest_hole * interval
        on_grid = {name: np.interp(grid, time_s, values) for name, values in columns.items()}
    else:
        grid, on_grid = time_s, dict(columns)
    moment = None
    if steps:
        force, moment = _steps_of(grid, interval, own, force)
    elif force_time_s is not None or grid is not time_s:
        force = np.interp(grid, own, force)
    position = on_grid.pop("position")
    return EvenLog(
        grid, position, force, is_logged, interval, on_grid, moment=moment, stamps_sd_s=stamps_sd
    )


def even_clock(time_s: Array, position: Array) -> tuple[Array, float]:
    """Return an even clock where stamps jitter about it, and their rms from it; else the stamps.

    A host that stamps readings as they arrive is now early, now late; the readings were taken
    evenly. Positions are then smoother over the even clock than over the stamps.

    Parameters
    ----------
    time_s, position : ndarray, shape (N,)
        The stamps, increasing [s], and what was read.
    """
    number = np.arange(time_s.size, dtype=np.float64)
    even = np.polynomial.Polynomial.fit(number, time_s, 1)(number)
    off, interval = time_s - even, float(even[1] - even[0])
    size = float(np.sqrt(np.mean(off**2)))
    jitters = size > AXIS_RULES.uneven * interval and np.abs(off).max() < MOST_OFF * interval
    jitters &= bool(np.ptp(position) > 0)  # what stands still is smooth over any clock
    if not jitters or _roughness(even, position) * SMOOTHER > _roughness(time_s, position):
        return time_s, 0.0
    return np.asarray(even), size


def _roughness(time_s: Array, position: Array) -> float:
    """Return the rms of readings less the cubics through two neighbours on either side."""
    times, values = (sliding_window_view(x, 5) for x in (time_s, position))
    around = [0, 1, 3, 4]
    cubic = np.zeros(len(times))
    for k in around:
        others = [j for j in around if j != k]
        weight = np.prod(
            [(times[:, 2] - times[:, j]) / (times[:, k] - times[:, j]) for j in others], axis=0
        )
        cubic += weight * values[:, k]
    return float(np.sqrt(np.mean((values[:, 2] - cubic) ** 2)))


def _steps_of(grid: Array, interval: float, time_s: Array, sent: Array) -> tuple[Array, Array]:
    """Return the mean of what is held over an interval about each place of a grid, and its moment.

    The moment is that about the place, over the interval; both of shape (G,).
    """
    edges = np.concatenate([[time_s[0] - interval], time_s, [time_s[-1] + interval]])
    lasts = np.concatenate([sent[:1], sent])
    lengths = np.diff(edges)
    sums = np.concatenate([[0.0], np.cumsum(lasts * lengths)])
    twice = np.concatenate([[0.0], np.cumsum((sums[:-1] + 0.5 * lasts * lengths) * lengths)])

    def until(time: Array) -> tuple[Array, Array]:
        """Return the integral until some times, and the integral of that."""
        beyond = time.clip(edges[0], edges[-1])
        at = (np.searchsorted(edges, beyond, side="right") - 1).clip(0, lasts.size - 1)
        since = beyond - edges[at]
        once = np.interp(time, edges, sums)
        return once, twice[at] + (sums[at] + 0.5 * lasts[at] * since) * since

    high, high_twice = until(grid + 0.5 * interval)
    low, low_twice = until(grid - 0.5 * interval)
    moment = 0.5 * interval * (high + low) - (high_twice - low_twice)
    return (high - low) / interval, moment / interval


def spikes(force: Array) -> float:
    """Return the share of a run's readings that are spikes; 0 where they are single ones.

    A spike is far from the median of the few readings about it, by their own spread and by that
    of the whole run: a step, and a force that goes to and fro, are none.

    Parameters
    ----------
    force : ndarray, shape (N,)
        As it was logged.
    """
    if force.size <= 2 * AROUND:
        return 0.0
    about = sliding_window_view(np.pad(force, AROUND, mode="edge"), 2 * AROUND + 1)
    middle = np.median(about, axis=1)
    spread = NORMAL * np.median(np.abs(about - middle[:, None]), axis=1)
    off = np.abs(force - middle)
    usual = NORMAL * float(np.median(off))
    share = float(np.mean((off > SPIKE[0] * spread) & (off > SPIKE[1] * usual)))
    return share if usual > 0 and share > AXIS_RULES.often_spiked else 0.0


def clipped(force: Array) -> Flags:
    """Return which readings lie at an end of what could be read, (N,); none where few do.

    A sensor, or what wrote the log, cuts off what is beyond its range: its largest reading comes
    again and again, and those just below it do not. What acted meanwhile nobody knows.

    Parameters
    ----------
    force : ndarray, shape (N,)
        As it was read.
    """
    at_ends = np.zeros(force.size, dtype=np.bool_)
    steps = np.diff(np.unique(force))
    if not steps.size:
        return at_ends
    for sign in (1.0, -1.0):
        top = float((sign * force).max())
        there = sign * force == top
        below = (sign * force < top) & (sign * force >= top - BESIDE_END * float(steps.min()))
        lengths = np.diff(np.flatnonzero(np.diff(np.pad(there, 1).astype(np.int8))))[::2]
        often = there.sum() > max(OFTEN_AT_END, PILED_UP * below.sum() / BESIDE_END)
        if top > 0 and often and there.mean() > AXIS_RULES.often_spiked and lengths.max() >= STAYS:
            at_ends |= there
    return at_ends


def given(log: EvenLog, limit: float) -> EvenLog:
    """Return a run with the force that a drive gives which clips at a limit."""
    return replace(log, force=np.clip(log.force, -limit, limit))


def local_polynomial(values: Array, half: int, degree: int, *, slope: bool = False) -> Array:
    """Return the polynomial through `half` values on either side of each, at it, (N,).

    Near an end it is that through the values at the end. This is
    :func:`scipy.signal.savgol_filter`, whose fits at the ends are made anew in each call: most
    of its time where runs are short.

    Parameters
    ----------
    values : ndarray, shape (N,)
        At even steps; at least 2 `half` + 1 of them.
    half, degree : int
        Of the polynomial.
    slope : bool
        Whether its slope a step is asked for.

    References
    ----------
    A. Savitzky, M. J. E. Golay, "Smoothing and differentiation of data by simplified least
    squares procedures", Analytical Chemistry 36 (1964).
    """
    at = _polynomials(half, degree, slope)
    smoothed = np.convolve(values, at[half][::-1], "same")
    smoothed[:half] = at[:half] @ values[: 2 * half + 1]
    smoothed[-half:] = at[-half:] @ values[-2 * half - 1 :]
    return smoothed


@lru_cache(maxsize=64)
def _polynomials(half: int, degree: int, slope: bool) -> Array:
    """Return what values tell of a polynomial through them, at each, (2 half + 1,) twice."""
    place = np.linspace(-1, 1, 2 * half + 1)
    powers = np.vander(place, degree + 1, increasing=True)
    of_values = np.linalg.pinv(powers)
    if not slope:
        return np.asarray(powers @ of_values)
    of_slope = np.arange(1, degree + 1)[:, None] * of_values[1:]
    return np.asarray(powers[:, :-1] @ of_slope) / half


def sample_noise(values: Array) -> float:
    """Return the standard deviation of an error that each sample has of its own.

    It is that of what a parabola over seven samples leaves.
    """
    left = np.abs(values - local_polynomial(values, 3, 2))[3:-3]
    # A parabola through seven samples takes up a third of the variance at its middle.
    return float(NORMAL * np.median(left) / np.sqrt(1 - 1 / 3))


def position_noise(log: EvenLog, resolution: float | None) -> float:
    """Return the standard deviation of a position's error.

    At least that of rounding to the encoder's resolution, or to the least step that the log has
    where nobody says.
    """
    noise = sample_noise(log.position)
    if resolution is None:
        steps = np.abs(np.diff(log.position))
        steps = steps[steps > 0]
        resolution = float(np.quantile(steps, 0.01)) if steps.size else 0.0
    return float(max(noise, resolution / 12**0.5))


def resolving(log: EvenLog, half: int, noise: float) -> int:
    """Return samples on either side, `half` at least, over which the axis' speed is resolved.

    Over a few samples of a coarse encoder nothing seems to move.
    """
    while 8 * half < log.time_s.size:
        if (
            AXIS_RULES.sure_of_way * _speed_error(log, half, noise)
            < SLOW * np.abs(_speed(log, half)).max()
        ):
            break
        half += max(1, half // 4)
    return half


def _speed_error(log: EvenLog, half: int, noise: float) -> float:
    # Least squares: the variance of a slope through n samples is 12 σ² / (n³ Δt²).
    return float(noise * np.sqrt(12 / (2 * half + 1) ** 3) / log.interval_s)


def smooth_motion(
    log: EvenLog, half: int, noise: float, *, quick: bool = False
) -> tuple[Array, Array, Array]:
    """Return position, speed, and where it is known which way the axis runs.

    Parabolas go through no more samples than tell the speed well: over many of them a stop, or
    a slip, is none. A wide one counts only where narrower ones do not contradict it.

    Parameters
    ----------
    log : EvenLog
        A run.
    half : int
        Samples on either side that a parabola goes through, at the most.
    noise : float
        Standard deviation of a position's error.
    quick : bool
        Whether the axis turns within few samples, over which a parabola's speed is too low: it
        is then that of a polynomial of fourth degree.

    Returns
    -------
    position, velocity : ndarray, shape (N,)
    way : ndarray, shape (N,)
        1, −1, or 0 where it is not known that the axis runs.
    """
    widths = [*(2**power for power in range((half - 1).bit_length())), half]
    way = np.zeros(log.position.size)
    for count in range(1, len(widths) + 1):
        way = np.where(way == 0, _surely(log, widths[:count], noise), way)
    well = FINE * np.abs(_speed(log, half)).max()
    fine = next((width for width in widths if _speed_error(log, width, noise) < well), half)
    if quick:
        fine = max(fine, QUICK)
    degree = 4 if quick else 2
    position = local_polynomial(log.position, fine, degree)
    return position, _speed(log, fine, degree), np.where(log.is_known, way, 0.0)


def _surely(log: EvenLog, widths: Sequence[int], noise: float) -> Array:
    """Return which way the axis runs, by parabolas of the last of some widths, (N,).

    It runs at a sample where it does at all through which the parabola goes: one that goes over
    a stop moves for as many samples as it reaches, while friction is anything. If a narrower
    parabola has another speed by more than its error, the wider one went over a stop or a turn.
    """
    half = widths[-1]
    velocity, error = _speed(log, half), _speed_error(log, half, noise)
    way = np.where(np.abs(velocity) > AXIS_RULES.sure_of_way * error, np.sign(velocity), 0.0)
    for narrow in widths[:-1]:
        surely = AXIS_RULES.sure_of_way * _speed_error(log, narrow, noise)
        way[np.abs(_speed(log, narrow) - velocity) > surely] = 0.0
    least = scipy.ndimage.minimum_filter1d(way, 2 * half + 1)
    return np.where(least == scipy.ndimage.maximum_filter1d(way, 2 * half + 1), least, 0.0)


def _speed(log: EvenLog, half: int, degree: int = 2) -> Array:
    """Return the slope at the middle of a polynomial through `half` samples either side, (N,)."""
    return local_polynomial(log.position, half, degree, slope=True) / log.interval_s
