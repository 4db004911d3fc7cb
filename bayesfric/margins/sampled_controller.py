"""The controller: encoder readings to torque commands, sample by sample, over all draws."""

import numpy as np

from bayesfric.arrays import Array, PerDraw, Whole
from bayesfric.margins.observers import Observer
from bayesfric.margins.reference import Reference
from bayesfric.margins.sampled_loop import SampledLoop

SILENT = 1e-9
"""Share of breakaway below which the rest of the filtered speed counts as zero."""


class Controller(PerDraw):
    """The controller of each draw, with its state.

    The commanded torque is kp e + kd (ω_ref − ω) + ki ∫e dt plus the friction compensation γ F̂ s.
    Here e is the measured position error, and s is the sign of the compensator's signal, or the
    signal over its boundary inside of it. The sum is clipped, and the integral is held while it
    is. Readings pass the position's low-pass, if there is one. ω is their first difference, which
    passes a low-pass of its own, if there is one. A compensator of the speed uses the raw
    difference.

    Parameters
    ----------
    loop : SampledLoop
        The loop with its numbers.
    position : ndarray, shape (draws,)
        Position of the shaft at the first sample [rad].
    reference : Reference
        The reference; the shaft starts with its initial speed.
    observer : Observer or None
        Adds its estimate of friction. Its output at standstill cannot be predicted, so runs with
        an observer advance sample by sample.
    """

    def __init__(
        self,
        loop: SampledLoop,
        position: Array,
        reference: Reference,
        observer: Observer | None = None,
    ) -> None:
        self.observer = observer
        self.signal, self.at_rest = loop.compensation_signal, loop.at_rest
        self.reference = reference
        self.kp, self.kd, self.ki = loop.kp, loop.kd, loop.ki
        self.period = loop.sample_time
        self.limit = loop.torque_limit
        self.load = loop.load_torque
        self.breakaway = loop.breakaway
        self.feed = loop.compensation_gain * loop.compensation_estimate
        self.boundary = loop.boundary
        # weight of a new value in a low-pass
        self.fresh, self.fresh_position = (
            -np.expm1(-cutoff * self.period)
            for cutoff in (loop.velocity_cutoff, loop.position_cutoff)
        )
        counts = loop.counts_per_revolution
        self.stepped = counts > 0.0
        self.step = 2.0 * np.pi / np.where(self.stepped, counts, 1.0)
        self.integrates = bool((self.ki != 0.0).any())
        self.filters = bool((self.fresh < 1.0).any())
        self.smooths = bool((self.fresh_position < 1.0).any())
        speed = reference.speed(np.zeros(loop.draws))
        self.reading = self._read(position - speed * self.period)
        self.smoothed = self.reading.copy()
        self.filtered = speed.copy()
        self.integral = np.zeros(loop.draws)
        self.last_share = np.zeros(loop.draws)
        self.last_torque = np.zeros(loop.draws)

    def _read(self, position: Array) -> Array:
        return np.where(self.stepped, np.rint(position / self.step) * self.step, position)

    def command(self, k: Whole, position: Array) -> tuple[Array, Array]:
        """Return the commanded torque at samples k, and the raw speed reading.

        Parameters
        ----------
        k : ndarray of int, shape (draws,)
            Number of the sample.
        position : ndarray, shape (draws,)
            Position of the shaft [rad].
        """
        reading = self._read(position)
        speed = (reading - self.reading) / self.period
        self.reading = reading
        used, place = speed, reading
        if self.smooths:
            place = self.smoothed + self.fresh_position * (reading - self.smoothed)
            used = (place - self.smoothed) / self.period
            self.smoothed = place
        now = k * self.period
        error, asked = self.reference.position(now) - place, self.reference.speed(now)
        if self.filters:
            self.filtered += self.fresh * (used - self.filtered)
            used = self.filtered
        wanted = self.kp * error + self.kd * (asked - used)
        if self.integrates:
            integral = self.integral + error * self.period
            wanted += self.ki * integral
        if self.signal != "none":
            wanted += self.feed * self._share(asked, error, speed)
        if self.observer is not None:
            wanted += self.observer.torque(used, self.last_torque)
        self.last_torque = torque = np.minimum(np.maximum(wanted, -self.limit), self.limit)
        if self.integrates:  # anti-windup: hold the integral at a limit
            waits = (torque != wanted) & (wanted * error > 0)
            self.integral = np.where(waits, self.integral, integral)
        return torque, speed

    def _share(self, asked: Array, error: Array, speed: Array) -> Array:
        """Return the compensation as a share of its full size, −1 to 1."""
        signals = {"reference": asked, "measured": speed, "error": error}
        signal = signals[self.signal]
        inside = np.abs(signal) < self.boundary
        share = np.divide(signal, self.boundary, out=np.sign(signal), where=inside)
        if self.at_rest == "hold" and self.signal != "error":
            share = np.where(share == 0.0, self.last_share, share)
            self.last_share = share
        return share

    def at_standstill(self, k: Whole) -> tuple[Array, Array, Array]:
        """Return the future commands to a shaft at rest.

        The command at sample k + j is ``constant`` + ``linear`` j + ``square`` j² [N·m], as long
        as the readings do not change, the reference keeps its speed and nothing is clipped; NaN
        if it has no such form.

        Parameters
        ----------
        k : ndarray of int, shape (draws,)
            The next sample, which has no command yet.
        """
        now = k * self.period
        error, asked = self.reference.position(now) - self.reading, self.reference.speed(now)
        ramp = asked * self.period
        by_integral = self.ki * self.period
        square = by_integral * ramp / 2.0
        linear = self.kp * ramp + by_integral * error + square
        constant = self.kp * error + self.kd * asked
        constant += self.ki * self.integral + by_integral * error
        if self.filters:
            left = self.kd * self.filtered
            constant = np.where(np.abs(left) > SILENT * self.breakaway, np.nan, constant)
        if self.smooths:
            left = (self.kp + self.kd / self.period) * (self.reading - self.smoothed)
            constant = np.where(np.abs(left) > SILENT * self.breakaway, np.nan, constant)
        match self.signal:
            case "reference" | "measured":
                moves = asked if self.signal == "reference" else np.zeros_like(error)
                inside = np.abs(moves) < self.boundary
                share = np.divide(moves, self.boundary, out=np.sign(moves), where=inside)
                if self.at_rest == "hold":
                    share = np.where(share == 0.0, self.last_share, share)
                constant += self.feed * share
            case "error":
                changing = (linear != 0.0) | (square != 0.0)
                constant += self.feed * np.clip(error / self.boundary, -1.0, 1.0)
                constant = np.where(changing, np.nan, constant)
        room = self.limit < self.breakaway + np.abs(self.load)
        return np.where(room, np.nan, constant), linear, square

    def wait(self, k: Whole, rows: Whole, samples: Whole) -> None:
        """Advance some draws at rest by a number of samples from k, at constant reference speed."""
        if not self.integrates:
            return
        now = k * self.period
        error = self.reference.position(now) - self.reading
        ramp = self.reference.speed(now) * self.period
        total = samples * error[rows] + ramp[rows] * samples * (samples - 1) / 2.0
        self.integral[rows] += self.period[rows] * total
