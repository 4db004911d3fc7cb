"""Corrects a time offset between force and position in a log.

If position and force are read by different channels, or two logs were joined, the force can be late
or early by up to a second. No drive has such a delay, so this is no property of the machine. The
force is shifted before any analysis, and the shift is reported. Smaller delays, which a drive can
have, are left to effects.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.beside import leading
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.force_rates import following
from bayesfric.rigs.single_axis.rough import pull_columns
from bayesfric.rigs.single_axis.run_rows import rows_of_run
from bayesfric.rigs.single_axis.weak_form import node_weights, test_function
from bayesfric.rigs.single_axis.windows import (
    LATEST_S,
    half_samples,
    joined,
    position_sd,
    widest_half_s,
)

MARGIN_S = 1e-3  # least standard deviation of the offset between two clocks
WITHIN = 12**-0.5  # rms offset of two readings at random times within an interval [interval]
REACH_S = 1.1  # largest shift that is tried, in either direction
OF_A_RUN = 0.15  # largest shift that is tried, relative to the shortest run
STEPS = 40  # shifts that are tried in either direction
LAGS = 12  # time constants that are tried
ROWS = 1500  # most windows that are used
STAYS = 0.5  # least mean square force that a shift leaves in the windows, relative to no shift


def margin_s(interval_s: float) -> float:
    """Return the prior standard deviation of the offset between the clocks [s].

    Parameters
    ----------
    interval_s : float
        Time between samples; two columns of a row may be read at any time within it [s].
    """
    return float(np.hypot(MARGIN_S, WITHIN * interval_s))


class OnTime(NamedTuple):
    """Runs whose force has been shifted to the time at which it acted.

    Parameters
    ----------
    logs : tuple of EvenLog
        The runs.
    late_s : float
        Shift of the force [s]: positive if it acts later than logged, negative if earlier, 0
        without a shift.
    why_refused : str or None
        Why no law can be estimated from these runs; None if one can.
    """

    logs: tuple[EvenLog, ...]
    late_s: float = 0.0
    why_refused: str | None = None


def on_time(logs: Sequence[EvenLog], resolution: float | None, margin_s: float) -> OnTime:
    """Return runs with their force shifted, if it is clearly late or early.

    Parameters
    ----------
    logs : sequence of EvenLog
        Runs.
    resolution : float or None
        Resolution of the encoder.
    margin_s : float
        Time by which a force may be early without a shift [s].
    """
    squares = _Squares.of(logs, resolution)
    if squares is None:
        return OnTime(tuple(logs))
    reach_s = squares.reach_s  # a larger shift would move windows of the force out of their run
    step = reach_s / STEPS
    delays = step * np.arange(-STEPS, STEPS + 1)
    squares_of_delays = np.array([squares.delayed(late) for late in delays])
    best = float(delays[np.argmin(squares_of_delays)])
    nearest = scipy.optimize.minimize_scalar(
        squares.delayed,
        bounds=(max(best - step, -reach_s), min(best + step, reach_s)),
        method="bounded",
    )
    late_s = float(nearest.x)
    if -margin_s <= late_s <= LATEST_S:
        return OnTime(tuple(logs))
    near = np.linspace(max(-margin_s, -reach_s), min(LATEST_S, reach_s), STEPS)
    lags = np.geomspace(0.1 * LATEST_S, reach_s, LAGS)
    otherwise = min(*map(squares.delayed, near), *map(squares.lagging, lags))
    if not float(nearest.fun) < AXIS_RULES.late_explained * otherwise:
        return OnTime(tuple(logs))
    if abs(best) > reach_s - 0.5 * step:
        acts = "later" if best > 0 else "earlier"
        why = (
            f"the force fits best where it acts {reach_s:.2g} s {acts} than it was logged, "
            "and larger shifts are not tried: correct the clocks of force and positions"
        )
        return OnTime(tuple(logs), why_refused=why)
    return OnTime(tuple(_moved(log, late_s) for log in logs), late_s)


def _moved(log: EvenLog, late_s: float) -> EvenLog:
    """Return a run with its force shifted; samples without a force become unknown."""
    place = np.arange(log.force.size) - late_s / log.interval_s
    force = np.interp(place, np.arange(log.force.size), log.force)
    inside = (place >= 0) & (place <= log.force.size - 1)
    return replace(log, force=force, is_known=log.is_known & inside)


class _Squares(NamedTuple):
    """Residual squares of a rough law as a function of the force's time shift.

    Parameters
    ----------
    means : tuple of (EvenLog, ndarray, ndarray, ndarray, ndarray)
        For each run: the log, φ, and for its windows the middles, directions and known forces.
    basis : ndarray, shape (W, k)
        Orthonormal basis of the law's columns.
    reach_s : float
        Largest shift that is tried, in either direction [s].
    square : float
        Square of the force of all windows without a shift [N²].
    """

    means: tuple[tuple[EvenLog, Array, Array, Array, Array], ...]
    basis: Array
    reach_s: float
    square: float

    @classmethod
    def of(cls, logs: Sequence[EvenLog], resolution: float | None) -> "_Squares | None":
        """Return the squares of windows that stay inside their runs for every shift."""
        noise = position_sd(logs, resolution)
        half_s = widest_half_s(logs, noise)
        stroke = max(float(np.ptp(log.position)) for log in logs)
        shortest = min(log.time_s.size * log.interval_s for log in logs)
        reach_s = min(REACH_S, OF_A_RUN * shortest)
        total = sum(log.time_s.size * log.interval_s for log in logs)
        hop_s = max(0.5 * half_s, total / ROWS)
        parts, means = [], []
        for log in logs:
            test = test_function(half_samples(half_s, log), log.interval_s)
            step = max(1, round(hop_s / log.interval_s))
            part = rows_of_run(log, test, step, noise, stroke)
            out = test.half + int(np.ceil(reach_s / log.interval_s)) + 1
            centre = part["centre"]
            inside = (centre >= out) & (centre < log.time_s.size - out)
            part = {name: part[name][inside] for name in LAW}
            parts.append(part)
            whole = test.over(log.force, test.value, part["centre"].astype(np.intp))
            modelled = whole - part["way"] * part["force"]
            means.append((log, test.value, part["centre"], part["way"], modelled))
        if not any(part["centre"].size for part in parts):
            return None  # every run is too short
        columns = _columns(parts)
        if len(columns) < AXIS_RULES.rows_a_number * columns.shape[1]:
            return None
        width = np.maximum(np.abs(columns).max(axis=0), 1e-300)
        unshifted = [_mean_at(log.force, value, centre) for log, value, centre, _, _ in means]
        square = _square(unshifted, means)
        return cls(tuple(means), np.linalg.qr(columns / width)[0], reach_s, square)

    def delayed(self, late_s: float) -> float:
        """Return the residual squares if the force acts later than logged by `late_s`.

        Between pulses the force is 0. A shift by a pause would leave nothing to be explained, so
        the squares are infinite if a shift moves most of the force out of the windows.
        """
        forces = [
            _mean_at(log.force, value, centre - late_s / log.interval_s)
            for log, value, centre, _, _ in self.means
        ]
        if _square(forces, self.means) < STAYS * self.square:
            return np.inf
        return self._left(forces)

    def lagging(self, time_s: float) -> float:
        """Return the residual squares if the drive follows with a time constant."""
        return self._left(
            _mean_at(following(log.force, max(time_s / log.interval_s, 1.0)), value, centre)
            for log, value, centre, _, _ in self.means
        )

    def _left(self, forces: Iterable[Array]) -> float:
        force = np.concatenate(
            [
                way * (mean - modelled)
                for mean, (*_, way, modelled) in zip(forces, self.means, strict=True)
            ]
        )
        residual = force - self.basis @ (self.basis.T @ force)
        return float(residual @ residual)


def _square(
    forces: Iterable[Array], means: Iterable[tuple[EvenLog, Array, Array, Array, Array]]
) -> float:
    """Return the square of the force that is to be explained in all windows [N²]."""
    parts = zip(forces, means, strict=True)
    return sum(float(np.sum((mean - modelled) ** 2)) for mean, (*_, modelled) in parts)


LAW = ("centre", "way", "force", "acceleration", "speed", "position", "beside")


def _columns(parts: Sequence[dict[str, Array]]) -> Array:
    """Return the columns of a rough law with forces of the position, shape (W, k)."""
    acceleration, way = joined(parts, "acceleration"), joined(parts, "way")
    position = np.concatenate([part["position"] for part in parts])
    weights = node_weights()[1]
    speed = np.concatenate([part["speed"] for part in parts]) @ weights
    columns = [acceleration, np.ones_like(acceleration), speed]
    # In a wide window, the mean force of a weight differs from that at the mean position.
    inside = np.repeat(way, weights.size)
    pull = pull_columns(position.ravel(), inside).reshape(*position.shape, -1)
    pull = np.einsum("wpk,p->wk", pull, weights)
    beside = np.concatenate([part["beside"] for part in parts])
    others = leading(beside, joined(parts, "force"))[0]
    return np.column_stack([*columns, pull, others])


def _mean_at(force: Array, value: Array, middles: Array) -> Array:
    """Return ∫ φ F dt around times between samples, shape (W,)."""
    whole = np.floor(middles).astype(np.intp)
    part = (middles - whole)[:, None]
    at = whole[:, None] + np.arange(value.size) - value.size // 2
    windows = (1 - part) * force[at] + part * force[at + 1]
    return np.asarray(windows @ value)
