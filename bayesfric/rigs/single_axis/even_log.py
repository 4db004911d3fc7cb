"""A run on an even grid of time, and its smoothed speed and direction."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import scipy

from bayesfric.arrays import Array, Flags
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.even_clock import even_clock
from bayesfric.rigs.single_axis.weak_form import WeakForce

NORMAL = 1.4826  # from the median of absolute deviations to a standard deviation
SLOW = 0.2  # share of the top speed from which the direction of the axis must be resolved
FINE = 0.005  # error of a speed that is small enough, relative to the top speed
QUICK = 3  # least samples on either side of a polynomial of fourth degree


@dataclass(frozen=True)
class EvenLog:
    """A run, evenly sampled.

    Parameters
    ----------
    time_s, position, force : ndarray, shape (N,)
        The log [s], [m or rad], [N or N·m].
    is_known : ndarray of bool, shape (N,)
        False in gaps, and where the force is clipped.
    interval_s : float
        Time between samples [s].
    further : dict of str to ndarray, shape (N,)
        Further columns of the log.
    forces : tuple of WeakForce
        The force that a simulator needs for the measured motion, and then its derivative by each
        parameter of the simulator. Empty without a simulator.
    known_force : WeakForce or None
        The part of the drive force that a model of the machine explains.
    beside : tuple of WeakForce
        Forces with unknown amounts, whose priors are N(0, 1): errors of that model, or forces of
        other joints. Each is given for an amount of 1.
    known_inertia : float
        Inertia in the known force of the model. Errors of the position enter its acceleration
        [kg, or kg·m²].
    known_to_a_share : bool
        Whether the first of `beside` is a relative error of the known force.
    dithers : ndarray of bool, shape (N,), or None
        Samples at which the axis reverses between two encoder counts; None if this was not
        tested.
    sent : WeakForce or None
        For a log of commands: the servo's stiffness times the command. `force` is then its value
        minus the stiffness times the position. None if a force was logged.
    stiffness : float
        Stiffness of that servo, which converts an error of the position to one of the force; 0 if
        a force was logged [N/m or N·m/rad].
    moment : ndarray, shape (N,), or None
        For a force that is held from one sample to the next: its first moment in time about the
        middle of the sampling interval, divided by the interval. None for other forces.
    stamps_sd_s : float
        Rms deviation of the time stamps from the even clock that replaced them; 0 if the stamps
        were used [s].
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
        """The run with the delayed signal as its force: for a servo, that of its command."""
        return self if self.sent is None else replace(self, force=self.sent.value)


def even_grid(
    time_s: Array,
    columns: dict[str, Array],
    *,
    force_time_s: Array | None = None,
    one_clock: bool = False,
    steps: bool = False,
) -> EvenLog | None:
    """Interpolate a log to an even grid of time; None if it is too short.

    Measured values are interpolated linearly. A command is held until the next one. Its value on
    the grid is therefore its mean over the sampling interval around each point, which preserves
    its integral over time.

    Parameters
    ----------
    time_s : ndarray, shape (N,)
        Increasing times [s].
    columns : dict of str to ndarray, shape (N,)
        ``position``, ``force`` and further columns.
    force_time_s : ndarray, or None
        Increasing times of the force readings, if they differ from `time_s`; it has as many
        values as ``force`` [s].
    one_clock : bool
        Whether the same clock gave the times of force readings and positions. What corrects the
        one then corrects the other.
    steps : bool
        Whether each value of ``force`` is held until the next, as a command is.
    """
    if time_s.size < AXIS_RULES.least_samples:
        return None
    stamps = time_s
    time_s, stamps_sd = even_clock(stamps, columns["position"])
    between = np.diff(time_s)
    interval = float(np.median(between))
    is_logged = np.ones(time_s.size, dtype=np.bool_)
    force_clock = time_s if force_time_s is None else force_time_s
    if force_time_s is not None and one_clock:
        force_clock = force_time_s + np.interp(force_time_s, stamps, time_s - stamps)
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
        force, moment = _steps_of(grid, interval, force_clock, force)
    elif force_time_s is not None or grid is not time_s:
        force = np.interp(grid, force_clock, force)
    position = on_grid.pop("position")
    return EvenLog(
        grid, position, force, is_logged, interval, on_grid, moment=moment, stamps_sd_s=stamps_sd
    )


def _steps_of(grid: Array, interval: float, time_s: Array, sent: Array) -> tuple[Array, Array]:
    """Return the mean of a held signal over the interval around each point of a grid, and moment.

    The moment is the first moment in time about the point, divided by the interval. Both results
    have shape (G,).
    """
    edges = np.concatenate([[time_s[0] - interval], time_s, [time_s[-1] + interval]])
    lasts = np.concatenate([sent[:1], sent])
    lengths = np.diff(edges)
    sums = np.concatenate([[0.0], np.cumsum(lasts * lengths)])
    twice = np.concatenate([[0.0], np.cumsum((sums[:-1] + 0.5 * lasts * lengths) * lengths)])

    def until(time: Array) -> tuple[Array, Array]:
        """Return the integral of the signal up to some times, and the integral of this integral."""
        beyond = time.clip(edges[0], edges[-1])
        at = (np.searchsorted(edges, beyond, side="right") - 1).clip(0, lasts.size - 1)
        since = beyond - edges[at]
        once = np.interp(time, edges, sums)
        return once, twice[at] + (sums[at] + 0.5 * lasts[at] * since) * since

    high, high_twice = until(grid + 0.5 * interval)
    low, low_twice = until(grid - 0.5 * interval)
    moment = 0.5 * interval * (high + low) - (high_twice - low_twice)
    return (high - low) / interval, moment / interval


def given(log: EvenLog, limit: float) -> EvenLog:
    """Return a run whose force is clipped at the limit of its drive."""
    return replace(log, force=np.clip(log.force, -limit, limit))


def local_polynomial(values: Array, half: int, degree: int, *, slope: bool = False) -> Array:
    """Smooth values by a local polynomial (a Savitzky-Golay filter), shape (N,).

    At each value, the polynomial is fitted to `half` values on either side. Near an end, the
    polynomial of the 2 `half` + 1 outermost values is used. The result is that of
    :func:`scipy.signal.savgol_filter`, which is slower on short runs because each call repeats
    the fits at the ends.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Values at even steps, at least 2 `half` + 1.
    half, degree : int
        Values on either side of the middle, and degree of the polynomial.
    slope : bool
        Whether to return the slope of the polynomial per step, instead of its value.

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


def slope_weights(half: int, degree: int) -> Array:
    """Return the weights of the slope per step in :func:`local_polynomial`, (2 half + 1,)."""
    return np.asarray(_polynomials(half, degree, slope=True)[half])


@lru_cache(maxsize=64)
def _polynomials(half: int, degree: int, slope: bool) -> Array:
    """Return the matrix from values to a fitted polynomial or its slope, (2 half + 1,) twice."""
    place = np.linspace(-1, 1, 2 * half + 1)
    powers = np.vander(place, degree + 1, increasing=True)
    of_values = np.linalg.pinv(powers)
    if not slope:
        return np.asarray(powers @ of_values)
    of_slope = np.arange(1, degree + 1)[:, None] * of_values[1:]
    return np.asarray(powers[:, :-1] @ of_slope) / half


def sample_noise(values: Array) -> float:
    """Return the standard deviation of the samples' independent errors.

    It is estimated from the residuals of local parabolas over seven samples.
    """
    residual = np.abs(values - local_polynomial(values, 3, 2))[3:-3]
    # A parabola through seven samples removes a third of the error variance at its middle.
    return float(NORMAL * np.median(residual) / np.sqrt(1 - 1 / 3))


def position_noise(log: EvenLog, resolution: float | None) -> float:
    """Return the standard deviation of a position's error [m or rad].

    It is at least that of rounding to the encoder's resolution. If the resolution is not declared,
    it is that of the smallest steps of the log.
    """
    noise = sample_noise(log.position)
    if resolution is None:
        steps = np.abs(np.diff(log.position))
        steps = steps[steps > 0]
        resolution = float(np.quantile(steps, 0.01)) if steps.size else 0.0
    return float(max(noise, resolution / 12**0.5))


def resolving(log: EvenLog, half: int, noise: float) -> int:
    """Return a half-width in samples, at least `half`, over which slow motion is resolved.

    Over a few samples of a coarse encoder, a slow axis seems to stand still.
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
    """Return smoothed position, speed and direction of a run.

    Parabolas are fitted to as few samples as give a precise speed, because wide parabolas smooth
    over a stop or a slip. The direction by a wide parabola counts only if no narrower one
    contradicts it.

    Parameters
    ----------
    log : EvenLog
        A run.
    half : int
        Largest number of samples on either side of a parabola.
    noise : float
        Standard deviation of a position's error [m or rad].
    quick : bool
        Whether the axis reverses within few samples. A parabola would then underestimate the
        speed, and a polynomial of fourth degree is used.

    Returns
    -------
    position, velocity : ndarray, shape (N,)
        [m or rad], [m/s or rad/s].
    way : ndarray, shape (N,)
        Direction: 1 or −1; 0 where the axis may stand still, or where the log is not known.
    """
    widths = [*(2**power for power in range((half - 1).bit_length())), half]
    way = np.zeros(log.position.size)
    for count in range(1, len(widths) + 1):
        way = np.where(way == 0, _surely(log, widths[:count], noise), way)
    tolerance = FINE * np.abs(_speed(log, half)).max()
    narrow = next((width for width in widths if _speed_error(log, width, noise) < tolerance), half)
    if quick:
        narrow = max(narrow, QUICK)
    degree = 4 if quick else 2
    position = local_polynomial(log.position, narrow, degree)
    return position, _speed(log, narrow, degree), np.where(log.is_known, way, 0.0)


def _surely(log: EvenLog, widths: Sequence[int], noise: float) -> Array:
    """Return the direction of the axis by parabolas of the last of some widths, (N,).

    A sample has a direction only if all samples within the parabola's width have it. Otherwise
    samples of a stop would seem to move, although friction at a stop can have any value. If the
    speed of a narrower parabola differs by more than its error, the wider parabola smooths over a
    stop or a reversal, and the sample has no direction.
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
    """Return the speed by local polynomials through `half` samples on either side, (N,)."""
    return local_polynomial(log.position, half, degree, slope=True) / log.interval_s
