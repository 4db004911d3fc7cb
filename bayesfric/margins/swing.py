"""Detection of a sustained oscillation at the end of a run, sample by sample over all draws."""

from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array, Flags, PerDraw, Whole
from bayesfric.margins.margin_rules import MARGIN_RULES


@dataclass(frozen=True)
class LoopMotion:
    """The motion of a loop after a kick, one value for each draw.

    Parameters
    ----------
    hunts : ndarray of bool, shape (draws,)
        Whether the measured end still oscillates around the reference in the last quarter of
        the run: at least two reversals relative to the reference, a distance of more than one
        encoder count between two of them, in both directions, and no decay since the previous
        quarter.
    amplitude : ndarray, shape (draws,)
        Half of the range of the error in the last quarter [rad].
    frequency : ndarray, shape (draws,)
        Frequency in the last half, from its reversals [Hz]; 0 with fewer than three.
    cycles : ndarray, shape (draws,)
        Number of cycles in the last half, from its reversals.
    rms_error : ndarray, shape (draws,)
        Rms error of the last half [rad].
    final_error : ndarray, shape (draws,)
        Reference minus true position of the measured end, at the end of the run [rad].
    twist : ndarray, shape (draws,)
        Twist of the cable at the end of the run, motor minus joint [rad].
    """

    hunts: Flags
    amplitude: Array
    frequency: Array
    cycles: Array
    rms_error: Array
    final_error: Array
    twist: Array


class Swing(PerDraw):
    """Ranges and reversals in the third and fourth quarter of each draw's run.

    Parameters
    ----------
    samples : ndarray of int, shape (draws,)
        Length of each run.
    period : ndarray, shape (draws,)
        Sample time [s].
    least : ndarray, shape (draws,)
        Amplitude up to which a motion is no oscillation, such as one encoder count [rad].
    lasts : ndarray, shape (draws,)
        Share of its amplitude that a lasting oscillation keeps from one quarter to the next.
    """

    def __init__(self, samples: Whole, period: Array, least: Array, lasts: Array) -> None:
        self._period, self._least, self._lasts = period, least, lasts
        self.begin, self.middle, self.end = (samples + 1) // 2, (3 * samples + 3) // 4, samples
        count = samples.size
        self._low, self._high = np.full(count, np.inf), np.full(count, -np.inf)
        self._before = np.zeros(count)
        self._reversals, self._early_reversals = np.zeros((2, count), dtype=np.intp)
        self._first, self._last = np.zeros(count), np.zeros(count)
        self._side, self._squares = np.zeros(count), np.zeros(count)
        # range between two reversals: jitter of a drifting error is no oscillation
        self._turned_at, self._widest = np.full(count, np.nan), np.zeros(count)
        # nor is an error that moves in one direction only, as when a shaft starts to follow
        self._rise, self._fall = np.zeros((2, count))

    def judge_from(self, rows: Whole, begin: Whole, half: Whole) -> None:
        """Judge some draws by two stretches of their own, instead of the last two quarters.

        Parameters
        ----------
        rows : ndarray of int, shape (m,)
            The draws.
        begin : ndarray of int, shape (m,)
            First sample of the first stretch, which must not be recorded yet.
        half : ndarray of int, shape (m,)
            Length of each of the two stretches; the run ends with the second.
        """
        self.begin[rows], self.middle[rows] = begin, begin + half
        self.end[rows] = begin + 2 * half
        self._low[rows], self._high[rows] = np.inf, -np.inf
        self._reversals[rows] = self._early_reversals[rows] = 0
        self._squares[rows] = self._widest[rows] = 0.0
        self._turned_at[rows] = np.nan

    def next_look(self, k: Whole) -> Whole:
        """Return, for each k, the last sample of the quarter that is being judged."""
        return np.select(
            [k < self.begin, k < self.middle], [self.begin - 1, self.middle - 1], self.end
        )

    def see(self, k: Whole, error: Array, speed: Array, running: Flags) -> None:
        """Record the errors at samples k.

        Parameters
        ----------
        k : ndarray of int, shape (draws,)
            Index of the sample, from 1 to the end of each run.
        error, speed : ndarray, shape (draws,)
            Position error [rad], and speed against the reference [rad/s].
        running : ndarray of bool, shape (draws,)
            Draws that have a new sample.
        """
        side = np.sign(speed)
        turned = side * self._side < 0.0
        np.copyto(self._side, side, where=side != 0.0)
        looked = running & (k >= self.begin)
        if not looked.any():
            return
        half = (running & (k == self.middle)).nonzero()[0]
        if half.size:
            self._before[half] = (self._high[half] - self._low[half]) / 2.0
            self._low[half], self._high[half] = np.inf, -np.inf
            self._early_reversals[half] = self._reversals[half]
            self._reversals[half] = 0
            self._widest[half] = self._rise[half] = self._fall[half] = 0.0
        np.add(self._squares, error * error, out=self._squares, where=looked)
        np.minimum(self._low, error, out=self._low, where=looked)
        np.maximum(self._high, error, out=self._high, where=looked)
        rows = (turned & looked).nonzero()[0]
        if rows.size:
            fresh = rows[self._reversals[rows] + self._early_reversals[rows] == 0]
            self._first[fresh] = k[fresh] * self._period[fresh]
            self._last[rows] = k[rows] * self._period[rows]
            self._reversals[rows] += 1
            error_now, there = error[rows], self._turned_at[rows]
            low, high = np.fmin(self._low[rows], there), np.fmax(self._high[rows], there)
            self._rise[rows] = np.maximum(self._rise[rows], error_now - low)
            self._fall[rows] = np.maximum(self._fall[rows], high - error_now)
            way = np.abs(error_now - there)
            self._widest[rows] = np.fmax(self._widest[rows], way)
            self._turned_at[rows] = error_now

    def pass_over(self, rows: Whole, samples: Whole, k: Whole, before: Array, after: Array) -> None:
        """Record shafts that stood still while the error went from one value to another.

        Parameters
        ----------
        rows : ndarray of int, shape (m,)
            The draws that stood still.
        samples : ndarray of int, shape (m,)
            Number of samples for which they stood still.
        k : ndarray of int, shape (draws,)
            The sample at which each draw is now.
        before, after : ndarray, shape (m,)
            Position error at the start and at the end [rad].
        """
        # a shaft at rest falls behind a moving reference
        self._side[rows] = np.where(after != before, np.sign(before - after), self._side[rows])
        seen = k[rows] >= self.begin[rows]
        rows, samples = rows[seen], samples[seen]
        before, after = before[seen], after[seen]
        self._low[rows] = np.minimum(self._low[rows], after)
        self._high[rows] = np.maximum(self._high[rows], after)
        # sum over samples of the squared error, which changes linearly from `before` to `after`
        step = (after - before) / samples
        self._squares[rows] += (
            samples * before**2
            + before * step * samples * (samples + 1)
            + step**2 * samples * (samples + 1) * (2 * samples + 1) / 6.0
        )

    def judged(self, final_error: Array, twist: Array) -> LoopMotion:
        """Return the result for the recorded samples, with the last error and twist."""
        after = np.maximum(self._high - self._low, 0.0) / 2.0
        least_way = np.min([self._widest, self._rise, self._fall], axis=0)
        reverses = self._reversals >= MARGIN_RULES.swing_least_reversals
        swings = reverses & (least_way / 2.0 > self._least)
        hunts = swings & (after >= self._lasts * self._before)
        turns = self._reversals + self._early_reversals
        span = np.where(turns >= 3, self._last - self._first, 1.0)
        frequency = np.where(turns >= 3, (turns - 1) / (2.0 * span), 0.0)
        rms = np.sqrt(self._squares / np.maximum(self.end - self.begin + 1, 1))
        return LoopMotion(hunts, after, frequency, turns / 2.0, rms, final_error, twist)
