"""Whether a run ends in a sustained swing, followed sample by sample over all draws."""

import numpy as np
from numpy.typing import NDArray

__all__ = ["LEAST_REVERSALS", "STEADY_SHARE", "Swing"]

Floats = NDArray[np.float64]

STEADY_SHARE = 0.9
"""A swing whose amplitude falls below this share from one quarter of a run to the next dies
out. Below 1, since a limit cycle of a stepped encoder jitters and is approached from above."""

LEAST_REVERSALS = 2
"""Reversals in the last quarter of a run without which nothing swings."""


class Swing:
    """Ranges and reversals in the third and fourth quarter of each draw's run.

    Parameters
    ----------
    samples : ndarray of int, shape (draws,)
        Length of each run.
    period : ndarray, shape (draws,)
        Sample time [s].
    least : ndarray, shape (draws,)
        Amplitude up to which nothing swings, say one encoder count [rad].
    """

    def __init__(self, samples: NDArray[np.intp], period: Floats, least: Floats) -> None:
        self._period, self._least = period, least
        begin, middle = (samples + 1) // 2, (3 * samples + 3) // 4
        self._quarters = ((begin, middle), (middle, samples + 1))
        self._starts = int(begin.min())
        self._low = np.full((2, samples.size), np.inf)
        self._high = np.full((2, samples.size), -np.inf)
        self._reversals = np.zeros((2, samples.size), dtype=np.intp)
        self._first, self._last = np.zeros(samples.size), np.zeros(samples.size)
        self._side = np.zeros(samples.size)

    def see(self, k: int, error: Floats, speed: Floats) -> None:
        """Take note of the k-th sample.

        Parameters
        ----------
        k : int
            From 1 to the longest run.
        error, speed : ndarray, shape (draws,)
            Position error [rad], and speed against the reference [rad/s].
        """
        if k < self._starts:
            return
        side = np.sign(speed)
        turned = side * self._side < 0.0
        self._side = np.where(side == 0.0, self._side, side)
        for quarter, (begin, end) in enumerate(self._quarters):
            now = (k >= begin) & (k < end)
            np.minimum(self._low[quarter], error, out=self._low[quarter], where=now)
            np.maximum(self._high[quarter], error, out=self._high[quarter], where=now)
            reversal = now & turned
            fresh = reversal & (self._reversals.sum(axis=0) == 0)
            np.copyto(self._first, k * self._period, where=fresh)
            np.copyto(self._last, k * self._period, where=reversal)
            self._reversals[quarter] += reversal

    def judged(self) -> tuple[NDArray[np.bool_], Floats, Floats]:
        """Return what was seen.

        Returns
        -------
        hunts : ndarray of bool, shape (draws,)
            Enough reversals and amplitude in the last quarter, and no decay from the third.
        amplitude : ndarray, shape (draws,)
            Half of the range of the error in the last quarter [rad].
        frequency : ndarray, shape (draws,)
            Of the reversals in the last half [Hz]; 0 where there are fewer than three.
        """
        before, after = np.maximum(self._high - self._low, 0.0) / 2.0
        lasts = self._reversals[1] >= LEAST_REVERSALS
        hunts = lasts & (after > self._least) & (after >= STEADY_SHARE * before)
        turns = self._reversals.sum(axis=0)
        span = np.where(turns >= 3, self._last - self._first, 1.0)
        frequency = np.where(turns >= 3, (turns - 1) / (2.0 * span), 0.0)
        return hunts, after, frequency
