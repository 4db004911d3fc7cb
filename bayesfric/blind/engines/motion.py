"""Motion of the gravity board: DOP853 on all trials at once, and events located on it.

The drive mass falls, m1 (g − a) is the tension at its end, m2 (g + a) at the other, and
friction adds up from pulley to pulley between them: an equation for a. It is a straight
line in a where effects are straight lines in tension, and is iterated where not.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from bayesfric.blind.engines.design import TRAVEL_M
from bayesfric.blind.engines.state import Array, BoardState, ImposedEffect

GRID = 240  # points of the dense output in each stage
STAGES = 12
TOLERANCE = 1e-9
LARGEST_STEP = 0.1  # of the time that a trial takes
FORCE_TOLERANCE_N = 1e-11  # N, at which the iteration for the acceleration stops
MOST_SECANTS = 20
SHARE_AT_DRIVE = {"ends": 0.5, "air": 0.5, "drive": 1.0, "load": 0.0}
NONE_AND_ONE = np.array([0.0, 1.0])[:, None, None]  # N: tensions that show a straight line


@dataclass(frozen=True)
class Board:
    """The trials as the equations of motion see them; columns (trials, 1).

    Parameters
    ----------
    state : BoardState
        At rest before the release.
    drive_kg, load_kg : ndarray
        Masses.
    factor : ndarray
        Scatter of friction: 1 + setup + trial.
    wander : callable or None
        Of the travel (trials, anything), by which share friction then differs.
    push_m_s : ndarray or float
        Speed at the release.
    """

    state: BoardState
    drive_kg: Array
    load_kg: Array
    factor: Array
    wander: Callable[[Array], Array] | None = None
    push_m_s: Array | float = 0.0

    def factor_at(self, travel_m: Array) -> Array:
        """Return the scatter of friction where the cable is."""
        if self.wander is None:
            return self.factor
        return np.asarray(self.factor * (1 + self.wander(travel_m)))


@dataclass(frozen=True)
class Motion:
    """Dense motion of each trial; arrays (trials, points).

    Parameters
    ----------
    time_s, travel_m, speed_m_s, acceleration_m_s2 : ndarray
        Since the release. Behind a stall the cable stands still.
    stall_m : ndarray, shape (trials,)
        Travel at which the cable stopped; infinite where it did not.
    """

    time_s: Array
    travel_m: Array
    speed_m_s: Array
    acceleration_m_s2: Array
    stall_m: Array


def friction_along(
    state: BoardState, effects: Sequence[ImposedEffect], factor: Array, entering: Array
) -> Array:
    """Add up the pulleys from the end where the cable runs on.

    Parameters
    ----------
    state : BoardState
        Where the board is.
    effects : sequence of ImposedEffect
        Those on friction, on the drive and on inertia act.
    factor : ndarray
        Multiplies all friction, and leaves the drive and inertia alone.
    entering : ndarray
        Pull of what hangs at the load end, by the masses that are written down [N].

    Returns
    -------
    ndarray
        Pull that what hangs at the drive end must have [N].
    """
    slope, constant, mass, (at_load, at_drive) = _straight(state, effects, factor)
    entering = entering + at_load
    bent = [e for e in effects if e.form.acts == "pulley" and not e.form.affine]
    n = state.n_pulleys
    if not bent:
        growth, total = _powers(slope, n)
        inertia = mass * state.acceleration_m_s2
        return np.asarray(growth * entering + (constant + inertia) * total + at_drive)
    shape = np.broadcast_shapes(np.shape(entering), slope.shape, state.speed_m_s.shape)
    tension = np.broadcast_to(entering, shape)
    for pulley in range(int(n.max())):
        more = sum(effect(state, tension) for effect in bent)
        step = slope * tension + constant + mass * state.acceleration_m_s2 + factor * more
        tension = np.where(pulley < n, tension + step, tension)
    return np.asarray(tension + at_drive)


def _straight(
    state: BoardState, effects: Sequence[ImposedEffect], factor: Array
) -> tuple[Array, Array, Array, tuple[Array, Array]]:
    """Return a pulley's slope and constant, the mass it moves along, and forces at the ends."""
    slope, constant = state.slope, state.constant_n
    mass = np.zeros(1)
    at_load, at_drive = np.zeros(1), np.zeros(1)
    for effect in effects:
        acts = effect.form.acts
        if acts == "pulley" and effect.form.affine:
            at_none, at_one = effect(state, NONE_AND_ONE)
            slope = slope + at_one - at_none
            constant = constant + at_none
        elif acts == "inertia":
            mass = mass + effect(state) * (not state.steady)
        elif acts in SHARE_AT_DRIVE:
            force = effect(state) * (factor if acts == "ends" else 1.0)
            at_drive = at_drive + SHARE_AT_DRIVE[acts] * force
            at_load = at_load + (1 - SHARE_AT_DRIVE[acts]) * force
    return factor * slope, factor * constant, mass, (at_load, at_drive)


def _powers(slope: Array, n: Array) -> tuple[Array, Array]:
    """Return (1 + slope)^n, and the sum of its powers below n."""
    log = n * np.log1p(slope)
    flat = np.abs(slope) < 1e-14
    safe = np.where(flat, 1.0, slope)
    return np.exp(log), np.where(flat, n, np.expm1(log) / safe)


def acceleration_of(
    board: Board, effects: Sequence[ImposedEffect], travel: Array, speed: Array
) -> Array:
    """Return the acceleration that balances the two masses and the pulleys [m/s²].

    Parameters
    ----------
    board : Board
        The trials.
    effects : sequence of ImposedEffect
        What acts.
    travel, speed : ndarray
        Of the cable, (trials, anything).
    """
    g = board.state.gravity_m_s2
    state = replace(board.state, travel_m=travel, speed_m_s=np.maximum(speed, 0.0))
    factor = board.factor_at(travel)
    slope, constant, _, _ = _straight(state, (), factor)
    growth, total = _powers(slope, state.n_pulleys)
    drive = board.drive_kg * g - growth * board.load_kg * g - constant * total
    moving = board.drive_kg + growth * board.load_kg
    acceleration = np.broadcast_to(drive / moving, travel.shape)
    if not effects:
        return np.asarray(acceleration)

    def missing(a: Array) -> Array:
        at = replace(state, acceleration_m_s2=a)
        pull = friction_along(at, effects, factor, board.load_kg * (g + a))
        return np.asarray(board.drive_kg * (g - a) - pull)

    # Secants: two steps are exact where effects are straight lines, as nearly all are.
    before, force_before = acceleration, missing(acceleration)
    acceleration = before + force_before / moving
    for _ in range(MOST_SECANTS):
        force = missing(acceleration)
        if np.abs(force).max() < FORCE_TOLERANCE_N:
            break
        change = force_before - force
        steep = np.abs(change) > 1e-3 * moving * np.abs(acceleration - before)
        rate = np.where(steep, (acceleration - before) / np.where(steep, change, 1.0), 1 / moving)
        before, force_before, acceleration = acceleration, force, acceleration + force * rate
    return np.asarray(acceleration)


def move(board: Board, effects: Sequence[ImposedEffect], travel_m: float = TRAVEL_M) -> Motion:
    """Integrate all trials from their release until each has run its travel, or stands.

    A stage is a piece of time, of another length for each trial: trials that have
    arrived stand still in the next one. DOP853 (Hairer, Nørsett and Wanner, Solving
    Ordinary Differential Equations I, 1993) then solves for all of them at once.
    """
    trials = len(board.drive_kg)
    travel, elapsed = np.zeros((trials, 1)), np.zeros((trials, 1))
    speed = np.broadcast_to(board.push_m_s, (trials, 1)).astype(np.float64)
    pieces: list[tuple[Array, Array, Array]] = []
    running = np.ones((trials, 1), dtype=bool)
    starts = (acceleration_of(board, effects, travel, speed) > 0) | (speed > 0)
    running &= starts
    for _ in range(STAGES):
        length = np.where(running, _time_left(board, effects, travel, speed, travel_m), 0.0)
        piece = _stage(board, effects, travel, speed, length)
        pieces.append((elapsed + length * np.linspace(0, 1, GRID), *piece))
        elapsed, travel, speed = elapsed + length, piece[0][:, -1:], piece[1][:, -1:]
        running &= (travel < travel_m) & (piece[1][:, 1:].min(axis=1, keepdims=True) > 0)
        if not running.any():
            break
    time, x, v = (np.concatenate([piece[i] for piece in pieces], axis=1) for i in range(3))
    moving = np.ones_like(x, dtype=bool)
    moving[:, 1:] = np.logical_and.accumulate(v[:, 1:] > 0, axis=1)
    stopped = ~moving.all(axis=1) | ~starts[:, 0]
    stall = np.where(stopped, np.where(moving, x, 0.0).max(axis=1), np.inf)
    x = np.where(moving, x, stall[:, None])
    a = np.where(moving, acceleration_of(board, effects, x, v), 0.0)
    return Motion(time, x, np.where(moving, v, 0.0), a, stall)


def _time_left(
    board: Board, effects: Sequence[ImposedEffect], travel: Array, speed: Array, goal: float
) -> Array:
    """Guess the time to the goal, or a little more than the time to a stall."""
    left = np.maximum(goal - travel, 1e-6)
    ahead = travel + left / 2
    fast = np.sqrt(speed**2 + 0.5 * left)
    a = acceleration_of(board, effects, ahead, fast)
    reached = speed**2 + 2 * a * left
    arrives = 2 * left / (speed + np.sqrt(np.maximum(reached, 1e-4 * left)))
    return 1.03 * np.minimum(arrives, 4.0) + 1e-3


def _stage(
    board: Board, effects: Sequence[ImposedEffect], travel: Array, speed: Array, length: Array
) -> tuple[Array, Array]:
    trials = len(travel)

    def derivative(_: float, y: Array) -> Array:
        v = y[trials:, None]
        a = acceleration_of(board, effects, y[:trials, None], v)
        return np.concatenate([(length * v)[:, 0], (length * a)[:, 0]])

    start = np.concatenate([travel[:, 0], speed[:, 0]])
    solved = scipy.integrate.solve_ivp(
        derivative,
        (0.0, 1.0),
        start,
        method="DOP853",
        t_eval=np.linspace(0, 1, GRID),
        rtol=TOLERANCE,
        atol=TOLERANCE,
        max_step=LARGEST_STEP,
    )
    return solved.y[:trials], solved.y[trials:]


def times_at(motion: Motion, place_m: Array) -> tuple[Array, Array]:
    """Locate events: when the cable has travelled this far, and how fast it then is.

    Between two points of the dense motion the travel is the quintic that shares place,
    speed and acceleration with it at both; its root is found by safeguarded Newton steps.

    Parameters
    ----------
    motion : Motion
        Dense motion.
    place_m : ndarray, shape (trials, events)
        Travel since the release [m]; NaN where there is no event.

    Returns
    -------
    time_s, speed_m_s : ndarray, shape (trials, events)
        NaN where the cable does not get there.
    """
    time, speed = np.full(place_m.shape, np.nan), np.full(place_m.shape, np.nan)
    for trial, places in enumerate(place_m):
        x = motion.travel_m[trial]
        there = np.flatnonzero((places >= 0) & (places < x.max()))
        if there.size == 0:
            continue
        # Where two points coincide (between stages), the later one starts the cell.
        cell = np.searchsorted(x, places[there], side="right") - 1
        time[trial, there], speed[trial, there] = _roots(motion, trial, cell, places[there])
    return time, speed


def _roots(motion: Motion, trial: int, cell: Array, places: Array) -> tuple[Array, Array]:
    t, x = motion.time_s[trial], motion.travel_m[trial]
    v, a = motion.speed_m_s[trial], motion.acceleration_m_s2[trial]
    h = t[cell + 1] - t[cell]
    p0, p1, p2 = x[cell], h * v[cell], h**2 * a[cell] / 2
    rise = x[cell + 1] - p0 - p1 - p2
    turn = h * v[cell + 1] - p1 - 2 * p2
    bend = h**2 * a[cell + 1] - 2 * p2
    p3 = 10 * rise - 4 * turn + bend / 2
    p4 = -15 * rise + 7 * turn - bend
    p5 = 6 * rise - 3 * turn + bend / 2
    low, high = np.zeros_like(p0), np.ones_like(p0)
    u = (places - p0) / (x[cell + 1] - p0)
    for _ in range(50):
        at = p0 + u * (p1 + u * (p2 + u * (p3 + u * (p4 + u * p5)))) - places
        rate = p1 + u * (2 * p2 + u * (3 * p3 + u * (4 * p4 + u * 5 * p5)))
        low, high = np.where(at <= 0, u, low), np.where(at >= 0, u, high)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = u - at / rate
        inside = (newton >= low) & (newton <= high)
        following = np.where(inside, newton, (low + high) / 2)
        if np.abs(following - u).max() < 1e-14:
            break
        u = following
    rate = p1 + u * (2 * p2 + u * (3 * p3 + u * (4 * p4 + u * 5 * p5)))
    return t[cell] + u * h, rate / h
