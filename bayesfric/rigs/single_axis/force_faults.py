"""Faults of a logged force: spikes, and readings clipped at an end of the sensor's range."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from bayesfric.arrays import Array, Flags
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.even_log import NORMAL

AROUND = 3  # samples on either side with which a possible spike is compared
OFTEN_AT_END, STAYS = 10, 5  # least readings at the end of a range, and least run of them
BESIDE_END = 5  # quantisation steps next to the end of a range, whose readings are counted
PILED_UP = 5  # factor by which readings at the end exceed those in one of these steps
SPIKE = (5.0, 4.0)  # least deviation of a spike: in local spreads, and in spreads of the run


def spikes(force: Array) -> float:
    """Return the share of a run's readings that are spikes; 0 if spikes are rare.

    A spike is far from the median of the readings around it, compared with their own spread and
    with that of the whole run. Steps and oscillating forces are therefore not spikes.

    Parameters
    ----------
    force : ndarray, shape (N,)
        The logged force [N or N·m].
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
    """Return which readings lie at an end of the sensor's range; none if few do.

    A sensor, or the program that writes the log, clips a force beyond its range. The largest
    reading then occurs much more often than readings just below it. The force that acted at these
    samples is unknown.

    Parameters
    ----------
    force : ndarray, shape (N,)
        The logged force [N or N·m].

    Returns
    -------
    ndarray of bool, shape (N,)
    """
    at_ends = np.zeros(force.size, dtype=np.bool_)
    steps = np.diff(np.unique(force))
    if not steps.size:
        return at_ends
    for sign in (1.0, -1.0):
        top = float((sign * force).max())
        at_top = sign * force == top
        below = (sign * force < top) & (sign * force >= top - BESIDE_END * float(steps.min()))
        lengths = np.diff(np.flatnonzero(np.diff(np.pad(at_top, 1).astype(np.int8))))[::2]
        often = at_top.sum() > max(OFTEN_AT_END, PILED_UP * below.sum() / BESIDE_END)
        if top > 0 and often and at_top.mean() > AXIS_RULES.often_spiked and lengths.max() >= STAYS:
            at_ends |= at_top
    return at_ends
