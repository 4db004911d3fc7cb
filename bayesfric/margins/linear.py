"""Stability margins of many linear loops at once, from their frequency responses.

The loop is given as a function of frequency, so delays need no approximation. Each crossing is
bracketed on a grid and then refined to rounding. So the grid affects which crossings are found, but
not their places. Stability is tested first, since margins of an unstable loop have no meaning.

References
----------
P. Seiler, A. Packard, P. Gahinet, "An introduction to disk margins", IEEE Control
Systems Magazine 40(5) (2020).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from bayesfric.arrays import Array, Complex, Flags, Whole

Rows = Whole

LARGEST_TURN = 1.5  # rad; a larger step of arg(1 + L) is evaluated on a finer grid
AT_ONCE = 64  # loops that are evaluated at once
MOST_HALVINGS = 12  # largest number of halvings of a step


class Response(Protocol):
    """Open loop L(jω) of some loops."""

    def __call__(self, omega: Array, rows: Rows) -> Complex:
        """Return L(jω) for ω [rad/s] and indices of loops in equal or broadcast shapes."""


@dataclass(frozen=True)
class LinearMargins:
    """Margins, each of shape (loops,).

    Parameters
    ----------
    gain : ndarray
        Smallest factor on the loop's gain, up or down, that destabilises; inf if none does.
    phase : ndarray
        Smallest rotation of the loop, either way, that destabilises [rad]; inf without a
        crossing.
    delay : ndarray
        Smallest additional delay that destabilises [s]; inf without a crossing.
    disk : ndarray
        Diameter α of the disk of complex gains (skew 0) that are all stable, 2 at most.
    phase_frequency : ndarray
        Frequency of the phase margin [rad/s]; NaN without a crossing.
    crossings : ndarray of int
        Number of gain crossings of the loop.
    """

    gain: Array
    phase: Array
    delay: Array
    disk: Array
    phase_frequency: Array
    crossings: Rows


def on_a_grid(response: Response, omega: Array) -> Complex:
    """Return the response of each loop at its frequencies, both of shape (loops, F)."""
    rows = np.arange(len(omega))[:, None]
    values = np.empty(omega.shape, dtype=np.complex128)
    for start in range(0, len(omega), AT_ONCE):  # blocks that fit into the cache are much faster
        some = slice(start, start + AT_ONCE)
        values[some] = response(omega[some], rows[some])
    return values


def is_stable(
    response: Response, omega: Array, on_grid: Complex | None = None, pairs: Whole | int = 0
) -> Flags:
    """Return which closed loops are stable, by the winding of 1 + L around 0.

    Let the open loop be strictly proper, without poles right of the imaginary axis. The argument
    arg(1 + L) is unwrapped from high frequency, where it is 0, down to where |L| is large. The
    closed loop is stable if and only if it then equals arg L between −7π/4 and π/4, as the poles at
    the origin and the delay require. Each pair of unstable poles of the closed loop adds a turn.
    Each pair of unstable poles of the open loop requires a turn.

    Parameters
    ----------
    response : Response
        The open loops, with up to three poles at the origin, with or without delay.
    omega : ndarray, shape (loops, F)
        Increasing frequencies, from where L is large (or constant) to where it is small
        [rad/s].
    on_grid : ndarray of complex, shape (loops, F), or None
        The response at these frequencies, if already computed.
    pairs : ndarray of int, shape (loops,), or int
        Number of pairs of unstable poles of the open loop. A single one beside a pole at the
        origin does not count, since the response starts on its side.

    Returns
    -------
    ndarray of bool, shape (loops,)
    """
    around = 1 + (on_a_grid(response, omega) if on_grid is None else on_grid)
    step = np.angle(around[:, 1:] * around[:, :-1].conj())
    turned = step.sum(axis=1)
    # A large step may hide a whole turn: halve it until every step is small.
    for row, left in zip(*np.nonzero(np.abs(step) > LARGEST_TURN), strict=True):
        turned[row] += _turning(response, omega[row, left], omega[row, left + 1], row)
        turned[row] -= step[row, left]
    start = np.angle(around[:, 0])
    start = np.where(start > np.pi / 4, start - 2 * np.pi, start)
    return np.asarray(np.abs(start + turned - 2 * np.pi * pairs) < np.pi)


def linear_margins(
    response: Response, omega: Array, on_grid: Complex | None = None
) -> LinearMargins:
    """Return the margins of stable loops.

    Parameters
    ----------
    response : Response
        Open loops that are stable when closed.
    omega : ndarray, shape (loops, F)
        Increasing frequencies, close enough that no two crossings lie between neighbours
        [rad/s].
    on_grid : ndarray of complex, shape (loops, F), or None
        The response at these frequencies, if already computed.

    Returns
    -------
    LinearMargins
        With a relative error of about 1e-9.
    """
    value = on_a_grid(response, omega) if on_grid is None else on_grid
    loops = len(omega)
    # gain crossings
    size = value.real**2 + value.imag**2
    where, at = np.nonzero((size[:, :-1] > 1) != (size[:, 1:] > 1))
    crossing = _root(lambda w, r: np.log(np.abs(response(w, r))), omega, where, at)
    lag = np.mod(np.angle(response(crossing, where)) + np.pi, 2 * np.pi)
    phase, phase_frequency = _smallest(np.minimum(lag, 2 * np.pi - lag), crossing, where, loops)
    delay, _ = _smallest(lag / crossing, crossing, where, loops)
    # phase crossings: L real and negative
    negative = (value.real[:, :-1] < 0) | (value.real[:, 1:] < 0)
    change = (value.imag[:, :-1] > 0) != (value.imag[:, 1:] > 0)
    turned, at = np.nonzero(change & negative)
    crossing = _root(lambda w, r: _sine(response(w, r)), omega, turned, at)
    real = response(crossing, turned).real
    kept = real < 0
    distance = np.full(real.shape, np.inf)
    distance[kept] = np.abs(np.log(-real[kept]))
    log_gain, gain_frequency = _smallest(distance, crossing, turned, loops)
    sign = np.ones(loops)
    nearest = crossing == gain_frequency[turned]
    sign[turned[nearest]] = -np.sign(np.log(np.maximum(-real[nearest], 1e-300)))
    disk = 2 * np.sqrt(
        _least(response, omega, value, lambda z: _squared(z) / np.maximum(_squared(-z), 1e-300))
    )
    return LinearMargins(
        np.exp(sign * log_gain),
        phase,
        delay,
        disk,
        phase_frequency,
        np.bincount(where, minlength=loops),
    )


def _sine(value: Complex) -> Array:
    return np.asarray(value.imag / np.abs(value))


def _root(function: Callable[[Array, Rows], Array], omega: Array, rows: Rows, at: Rows) -> Array:
    """Return the frequency of the change of sign in each bracket."""
    if not rows.size:
        return np.empty(0)
    ends = (np.log(omega[rows, at]), np.log(omega[rows, at + 1]))

    def of_log(log_omega: Array, row: Array) -> Array:
        return function(np.exp(log_omega), row.astype(np.intp))

    from scipy.optimize import elementwise  # imported here: commands without margins do not need it

    find: Any = elementwise.find_root
    root = find(of_log, ends, args=(rows.astype(float),))
    return np.asarray(np.exp(root.x))


def _smallest(values: Array, places: Array, rows: Rows, loops: int) -> tuple[Array, Array]:
    """Return the smallest value of each loop and where it is; inf and NaN without one."""
    least = np.full(loops, np.inf)
    np.minimum.at(least, rows, values)
    where = np.full(loops, np.nan)
    hit = np.isfinite(values) & (values == least[rows])
    where[rows[hit]] = places[hit]
    return least, where


def peaks(response: Response, omega: Array, on_grid: Complex | None = None) -> tuple[Array, Array]:
    """Return the largest |S| and |T| of stable loops, Ms and Mt, each of shape (loops,).

    Parameters
    ----------
    response, omega, on_grid
        As for :func:`linear_margins`; S = 1/(1 + L), T = L/(1 + L).
    """
    value = on_a_grid(response, omega) if on_grid is None else on_grid
    apart = _least(response, omega, value, _squared)
    inverse = _least(response, omega, value, lambda z: _squared(z) / _size(z))
    return 1 / np.sqrt(apart), 1 / np.sqrt(inverse)


def _squared(value: Complex) -> Array:
    return np.asarray((1 + value.real) ** 2 + value.imag**2)


def _size(value: Complex) -> Array:
    return np.asarray(np.maximum(value.real**2 + value.imag**2, 1e-300))


def _least(
    response: Response, omega: Array, value: Complex, margin: Callable[[Complex], Array]
) -> Array:
    """Return the minimum of a function of L over ω, of shape (loops,)."""
    on_grid = margin(value)
    # every local minimum that could be the lowest once refined
    inner = on_grid[:, 1:-1]
    low = (inner <= on_grid[:, :-2]) & (inner <= on_grid[:, 2:])
    curve = np.abs(on_grid[:, :-2] - inner) + np.abs(on_grid[:, 2:] - inner)
    low &= inner - curve <= on_grid.min(axis=1, keepdims=True)
    rows, at = np.nonzero(low)
    least = on_grid.min(axis=1)
    if rows.size:
        triple: Any = tuple(np.log(omega[rows, at + shift]) for shift in (0, 1, 2))

        def of_log(log_omega: Array, row: Array) -> Array:
            return margin(response(np.exp(log_omega), row.astype(np.intp)))

        from scipy.optimize import elementwise

        find: Any = elementwise.find_minimum
        minimum = find(of_log, triple, args=(rows.astype(float),))
        np.fmin.at(least, rows, minimum.f_x)
    return np.asarray(least)


def _turning(response: Response, low: float, high: float, row: np.intp) -> float:
    """Return how far arg(1 + L) turns between two frequencies, in ever smaller steps."""
    points = 16
    turned = 0.0
    for _ in range(MOST_HALVINGS):
        omega = np.geomspace(low, high, points + 1)
        around = 1 + response(omega, np.full(points + 1, row))
        step = np.angle(around[1:] * around[:-1].conj())
        turned = float(step.sum())
        if np.abs(step).max() < LARGEST_TURN:
            break
        points *= 2
    return turned
