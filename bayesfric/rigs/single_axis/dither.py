"""Detects dither: encoder counts in the controller's damping make a joint oscillate.

A controller that differentiates encoder counts responds to each count with a force pulse. At low
speed the joint then reverses between two counts. Friction changes its sign within a window, while
the smoothed speed does not, and its mean looks like friction that grows with speed. The pulses are
in the log; divided by the inertia they give the part of the speed that smoothing removes. Windows
with such reversals are excluded and counted.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy

from bayesfric.arrays import Array, Flags
from bayesfric.rigs.single_axis.answered import shaken_by_counts
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.even_log import EvenLog, smooth_motion
from bayesfric.rigs.single_axis.run_rows import SMOOTHED, turns_back
from bayesfric.rigs.single_axis.weak_form import test_function
from bayesfric.rigs.single_axis.windows import half_samples, position_sd


class Dither(NamedTuple):
    """Windows in which a joint reverses between two counts.

    Parameters
    ----------
    windows, of : int
        Their number, and the number of all otherwise valid windows.
    left_out : bool
        Whether they are excluded; they are not if too few windows would remain.
    """

    windows: int = 0
    of: int = 0
    left_out: bool = False


def steady(
    logs: Sequence[EvenLog], mass: float, half_s: float, resolution: float | None
) -> tuple[tuple[EvenLog, ...], Dither]:
    """Return runs with their dithering samples marked, and a summary.

    Parameters
    ----------
    logs : sequence of EvenLog
        Runs.
    mass : float
        Rough mass or inertia [kg or kg·m²].
    half_s : float
        Half the width of a window [s].
    resolution : float or None
        Resolution of the encoder.
    """
    noise = position_sd(logs, resolution)
    marked, dithering, total = [], 0, 0
    for log in logs:
        half = half_samples(half_s, log)
        way, dithers = _turned_back(log, mass, half, noise)
        marked.append(replace(log, dithers=dithers))
        test = test_function(half, log.interval_s)
        centres = np.arange(half, log.time_s.size - half, half)
        runs = np.concatenate([[0.0], np.cumsum(way)])
        one_way = np.abs(runs[centres + half + 1] - runs[centres - half]) == 2 * half + 1
        total += int(one_way.sum())
        dithering += int(turns_back(dithers, test, centres[one_way]).sum())
    if not dithering:
        return tuple(logs), Dither()
    enough = total - dithering >= AXIS_RULES.kept_of_dither * total
    return tuple(marked if enough else logs), Dither(dithering, total, enough)


def _turned_back(log: EvenLog, mass: float, half: int, noise: float) -> tuple[Array, Flags]:
    """Return the apparent direction, and which samples move against it, (N,) each."""
    _, speed, way = smooth_motion(log, max(SMOOTHED, half // 2), noise)
    nothing = np.zeros(way.size, dtype=np.bool_)
    quick, moved = _quick(log.force, half), _quick(np.diff(log.position, prepend=0.0), half)
    moved[: half + 1] = 0.0  # there are no samples before the first one
    size = float(np.linalg.norm(quick) * np.linalg.norm(moved))
    if not mass > 0 or size == 0:
        return way, nothing
    if min(float(quick @ moved) / size, shaken_by_counts(log)) > -AXIS_RULES.answers:
        return way, nothing
    kicked = _quick(np.cumsum(quick), half) * log.interval_s / mass
    within = 0.5 * np.abs(quick) * log.interval_s / mass  # from the middle of a step to its end
    return way, (way != 0) & (way * (speed + kicked) < within)


def _quick(values: Array, half: int) -> Array:
    """Return values minus their mean over a window, shape (N,)."""
    return np.asarray(values - scipy.ndimage.uniform_filter1d(values, 2 * half + 1))
