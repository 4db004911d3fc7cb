"""The gravity board with any friction force, by the 4th-order Runge-Kutta method.

Eq. (4) of the paper, ``(m1 + m2) a = (m1 − m2) g − F(x, v, a)``, where F is any
force against the motion. The closed forms of :mod:`bayesfric.physics.gravity` are faster where they
hold; this holds for every force.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array

NEWTON_STEPS = 6


@dataclass(frozen=True)
class SteppedMotion:
    """Motion of N trials at P times, cubic in between.

    Parameters
    ----------
    step_s : ndarray, shape (N, 1)
        Between two times [s].
    position_m, speed_m_s : ndarray, shape (N, P)
        Since the start; the speed stays 0 once it is.
    """

    step_s: Array
    position_m: Array
    speed_m_s: Array

    def time_at(self, position_m: Array) -> Array:
        """Return when distances are reached; inf where the cable stops before [s].

        Parameters
        ----------
        position_m : ndarray, shape (N, …)
            Distances from the start, above 0 [m].

        Returns
        -------
        ndarray, shape (N, …)
            Time since the start [s].
        """
        times = np.empty(position_m.shape)
        for trial, wanted in enumerate(position_m):
            times[trial] = self._time_at(trial, wanted.ravel()).reshape(wanted.shape)
        return times

    def speed(self, time_s: Array) -> Array:
        """Return the speed at a time ≥ 0 since the start [m/s]."""
        speeds = np.empty(time_s.shape)
        grid = np.arange(self.speed_m_s.shape[1])
        for trial, wanted in enumerate(time_s):
            step = float(self.step_s[trial, 0])
            speeds[trial] = np.interp(wanted / step, grid, self.speed_m_s[trial])
        return speeds

    def _time_at(self, trial: int, wanted: Array) -> Array:
        position, speed = self.position_m[trial], self.speed_m_s[trial]
        step = float(self.step_s[trial, 0])
        left = np.clip(np.searchsorted(position, wanted) - 1, 0, position.size - 2)
        start, rise = position[left], position[left + 1] - position[left]
        slope0, slope1 = step * speed[left], step * speed[left + 1]
        share = np.clip((wanted - start) / np.where(rise > 0, rise, 1.0), 0, 1)
        # Newton's method on the cubic that has the positions and speeds of both ends.
        for _ in range(NEWTON_STEPS):
            curved = 3 * rise - 2 * slope0 - slope1
            cubic = slope0 + slope1 - 2 * rise
            rise_so_far = share * (slope0 + share * (curved + share * cubic))
            gradient = slope0 + share * (2 * curved + share * 3 * cubic)
            safe = np.where(gradient > 0, gradient, np.inf)
            share = np.clip(share - (rise_so_far - (wanted - start)) / safe, 0, 1)
        return np.where(wanted <= position[-1], step * (left + share), np.inf)


def step_board(
    acceleration: Callable[[Array, Array], Array],
    duration_s: Array,
    steps: int,
    distance_m: float = np.inf,
    start_speed_m_s: Array | float = 0.0,
) -> SteppedMotion:
    """Integrate trials from their release.

    Parameters
    ----------
    acceleration : callable
        Travels and speeds, shape (N,), to accelerations while the cable moves, shape (N,).
    duration_s : ndarray, shape (N,)
        How long each trial is followed, at most [s].
    steps : int
        Number of steps in that time.
    distance_m : float
        The integration ends once every trial has travelled this far, or rests [m].
    start_speed_m_s : ndarray, shape (N,), or float
        Speed at the release [m/s].

    Returns
    -------
    SteppedMotion
        A trial that does not start, or stops, stays: friction at rest is set-valued.
    """
    step = duration_s / steps
    still = np.zeros_like(duration_s)
    start = still + start_speed_m_s
    positions, speeds = [still], [start]
    moving = (start > 0) | (acceleration(still, still) > 0)
    for _ in range(steps):
        x, v = positions[-1], speeds[-1]
        a1 = acceleration(x, v)
        v2 = np.maximum(v + step / 2 * a1, 0)
        a2 = acceleration(x + step / 2 * v, v2)
        v3 = np.maximum(v + step / 2 * a2, 0)
        a3 = acceleration(x + step / 2 * v2, v3)
        v4 = np.maximum(v + step * a3, 0)
        a4 = acceleration(x + step * v3, v4)
        faster = v + step / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        moving &= faster > 0
        speeds.append(np.where(moving, faster, 0.0))
        advance = step / 6 * (v + 2 * v2 + 2 * v3 + v4)
        positions.append(x + np.where(moving, advance, 0.0))
        if not (moving & (positions[-1] < distance_m)).any():
            break
    return SteppedMotion(step[:, None], np.stack(positions, axis=1), np.stack(speeds, axis=1))
