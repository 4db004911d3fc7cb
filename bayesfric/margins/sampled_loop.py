"""The sampled position loop of a motor shaft with friction, in time, over all draws at once.

At each sample time t_k = k T the controller reads the encoder, takes the raw first
difference of its readings as speed, and commands a torque, which acts from
t_k + delay until the next command does. Between two changes of torque the motion
is a closed form (:mod:`bayesfric.margins.shaft`), so a run has no step size: any
delay is met exactly, whatever its ratio to the sample time.

The torque commanded is kp e + kd (ω_ref − ω) + ki ∫e dt plus the friction
compensation γ F̂ s, with e the measured position error and s the sign of the
compensator's signal, or that signal over its boundary where it is inside. The sum
is clipped, and the integral waits while it is.
"""

from dataclasses import dataclass, fields
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bayesfric.margins.shaft import Interval, Shaft, turn
from bayesfric.margins.swing import Swing
from bayesfric.margins.traces import Record, Traces

__all__ = ["AtRest", "CompensationSignal", "Motion", "SampledLoop", "simulate"]

Floats = NDArray[np.float64]
CompensationSignal = Literal["none", "reference", "measured", "error"]
AtRest = Literal["off", "hold"]

_POSITIVE = ("inertia", "sample_time", "torque_limit")
_SIGNED = ("kp", "kd", "ki")
_CHOICES = {
    "compensation_signal": ("none", "reference", "measured", "error"),
    "at_rest": ("off", "hold"),
}


@dataclass(frozen=True)
class SampledLoop:
    """A sampled position loop and its friction, at the motor shaft.

    Every number is a scalar or an array of shape (draws,).

    Parameters
    ----------
    inertia : array_like
        J of all that turns with the shaft [kg·m²].
    viscous : array_like
        b [N·m·s/rad].
    friction : array_like
        Coulomb torque F while the shaft turns [N·m].
    kp : array_like
        Torque per position error [N·m/rad].
    kd : array_like
        Torque per speed error [N·m·s/rad].
    sample_time : array_like
        T [s].
    ki : array_like
        Torque per integral of the position error [N·m/(rad·s)].
    delay : array_like
        From reading the encoder to the torque acting [s]. The half sample that the hold
        adds on average is not part of it: it comes from the simulation.
    stiction_ratio : array_like
        Breakaway torque over Coulomb torque, at least 1 [-].
    counts_per_revolution : array_like
        Encoder counts a revolution of the shaft; 0 is an encoder without steps.
    torque_limit : array_like
        The command is clipped to ± this [N·m]; may be infinite.
    compensation_signal : {"none", "reference", "measured", "error"}
        Whose sign the compensator follows: reference speed, measured speed, or measured
        position error.
    compensation_gain : array_like
        γ, the share of the estimate that is fed forward [-].
    compensation_estimate : array_like
        F̂, the estimate of the Coulomb torque [N·m].
    boundary : array_like
        Inside ± this the compensation is proportional to its signal; 0 is a bare sign
        [rad/s, or rad for `error`].
    at_rest : {"off", "hold"}
        What follows a signal of exactly zero speed: no compensation, or the last one.
        `error` has no such choice.

    Raises
    ------
    ValueError
        Where a number is not finite, has a wrong sign, or shapes do not agree; or a word
        is unknown.
    """

    inertia: ArrayLike
    viscous: ArrayLike
    friction: ArrayLike
    kp: ArrayLike
    kd: ArrayLike
    sample_time: ArrayLike
    ki: ArrayLike = 0.0
    delay: ArrayLike = 0.0
    stiction_ratio: ArrayLike = 1.0
    counts_per_revolution: ArrayLike = 0.0
    torque_limit: ArrayLike = np.inf
    compensation_signal: CompensationSignal = "none"
    compensation_gain: ArrayLike = 0.0
    compensation_estimate: ArrayLike = 0.0
    boundary: ArrayLike = 0.0
    at_rest: AtRest = "off"

    def __post_init__(self) -> None:
        for name, known in _CHOICES.items():
            if getattr(self, name) not in known:
                raise ValueError(f"{name}: expected one of {known}, got {getattr(self, name)!r}")
        lengths = set()
        for name in self.numbers():
            value = np.asarray(getattr(self, name), dtype=np.float64)
            if value.ndim > 1:
                raise ValueError(f"{name}: expected a number or one a draw, got {value.shape}")
            lengths |= set(value.shape)
            low = 1.0 if name == "stiction_ratio" else 0.0
            if name in _SIGNED:
                wrong, expected = ~np.isfinite(value), "a finite number"
            elif name in _POSITIVE:
                wrong, expected = ~(value > 0.0), "a positive number"
            else:
                wrong, expected = ~(value >= low), f"at least {low:g}"
            if name != "torque_limit":
                wrong = wrong | np.isinf(value)
            if wrong.any():
                raise ValueError(f"{name}: expected {expected}, got {value[wrong].flat[0]}")
        # One may stand for all.
        if len(lengths - {1}) > 1:
            raise ValueError(f"expected one number of draws, got {sorted(lengths)}")

    @classmethod
    def numbers(cls) -> tuple[str, ...]:
        """Return the names of the fields that hold a number a draw."""
        return tuple(field.name for field in fields(cls) if field.name not in _CHOICES)

    @property
    def draws(self) -> int:
        """Number of draws; 1 where every field is a scalar."""
        return max(np.size(getattr(self, name)) for name in self.numbers())

    def taken(self, index: NDArray[np.intp]) -> "SampledLoop":
        """Return the loop of some draws, in a given order, with repetition if wanted.

        Parameters
        ----------
        index : ndarray of int, shape (m,)
            The draws.

        Returns
        -------
        SampledLoop
            Of m draws.
        """
        numbers = {name: self.array(name)[index] for name in self.numbers()}
        return SampledLoop(
            compensation_signal=self.compensation_signal, at_rest=self.at_rest, **numbers
        )

    def array(self, name: str) -> Floats:
        """Return a field as an array of shape (draws,).

        Parameters
        ----------
        name : str
            One of :meth:`numbers`.

        Returns
        -------
        ndarray, shape (draws,)
            Its values.
        """
        return self.per_draw(name, getattr(self, name))

    def per_draw(self, name: str, value: ArrayLike) -> Floats:
        """Return a value that belongs to the loop as an array of shape (draws,).

        Parameters
        ----------
        name : str
            What it is called, for the error.
        value : array_like
            A scalar, or one a draw.

        Returns
        -------
        ndarray, shape (draws,)
            A copy.

        Raises
        ------
        ValueError
            Where the shape is another.
        """
        array = np.asarray(value, dtype=np.float64)
        if array.shape not in ((), (1,), (self.draws,)):
            raise ValueError(f"{name}: expected a number or {self.draws}, got {array.shape}")
        return np.broadcast_to(array, self.draws).copy()


@dataclass(frozen=True)
class Motion:
    """How the loop answered, a number a draw.

    Parameters
    ----------
    hunts : ndarray of bool, shape (draws,)
        Whether the shaft still swings around the reference in the last quarter of the run: at
        least two reversals against the reference there, an amplitude above one encoder count,
        and not below 0.9 of the quarter before.
    amplitude : ndarray, shape (draws,)
        Half of the range of the error in the last quarter [rad].
    frequency : ndarray, shape (draws,)
        Of the reversals in the last half [Hz]; 0 where there are fewer than three.
    final_error : ndarray, shape (draws,)
        Reference minus true position at the end [rad].
    traces : Traces or None
        The motion itself, where it was asked for.
    """

    hunts: NDArray[np.bool_]
    amplitude: Floats
    frequency: Floats
    final_error: Floats
    traces: Traces | None = None


def simulate(
    loop: SampledLoop,
    *,
    kick: ArrayLike,
    duration: float,
    reference_speed: ArrayLike = 0.0,
    substeps: int = 1,
    traces: bool = False,
) -> Motion:
    """Run the loop for some time after a kick.

    The reference moves at constant speed from 0. The shaft begins with the reference's
    speed, ahead of it by the kick; no torque acts before the first command arrives.

    Parameters
    ----------
    loop : SampledLoop
        The loop.
    kick : array_like
        Position ahead of the reference at the beginning [rad], a scalar or (draws,).
    duration : float
        Length of the run [s], rounded up to whole samples. Whether a loop hunts is judged
        from its last half: let that hold several periods, and the time constant 2J/b be short
        beside it.
    reference_speed : array_like
        Speed of the reference [rad/s], a scalar or (draws,).
    substeps : int
        Parts into which every interval of constant torque is cut. The motion is exact
        with 1; more serve for finer traces.
    traces : bool
        Whether to keep the motion itself.

    Returns
    -------
    Motion
        A number a draw.

    Raises
    ------
    ValueError
        Where kick, duration, speed or substeps cannot be used.
    """
    begin = loop.per_draw("kick", kick)
    reference = loop.per_draw("reference_speed", reference_speed)
    if not (np.isfinite(begin).all() and np.isfinite(reference).all()):
        raise ValueError("kick, reference_speed: expected finite numbers")
    if not (np.isfinite(duration) and duration > 0.0):
        raise ValueError(f"duration: expected a positive time, got {duration}")
    if substeps < 1:
        raise ValueError(f"substeps: expected at least 1, got {substeps}")
    controller = _Controller(loop, begin, reference)
    period = loop.array("sample_time")
    friction = loop.array("friction")
    shaft = Shaft(
        loop.array("inertia"),
        loop.array("viscous"),
        friction,
        friction * loop.array("stiction_ratio"),
    )
    # The command of sample k − whole − 1 acts until `late` after t_k, that of k − whole from there.
    samples_late = loop.array("delay") / period
    whole = np.floor(samples_late + 1e-9)
    late = np.maximum(samples_late - whole, 0.0) * period
    intervals = [
        (whole.astype(np.intp) + older, Interval.of(length / substeps, shaft))
        for older, length in ((1, late), (0, period - late))
        if length.any()
    ]
    depth = int(whole.max()) + 2
    draws = np.arange(loop.draws)
    commands = np.zeros((depth, loop.draws))
    samples = np.ceil(duration / period - 1e-9).astype(np.intp)
    swing = Swing(samples, period, controller.step * controller.stepped)
    position, speed = begin.copy(), reference.copy()
    record = Record(position, speed) if traces else None
    for k in range(int(samples.max())):
        running = k < samples
        commands[k % depth] = controller.command(k, position)
        for age, interval in intervals:
            torque = commands[(k - age) % depth, draws]
            for _ in range(substeps):
                new_position, new_speed = turn(shaft, torque, position, speed, interval)
                position = np.where(running, new_position, position)
                speed = np.where(running, new_speed, speed)
                if record is not None:
                    record.add(np.where(running, interval.length, 0.0), position, speed, torque)
        swing.see(k + 1, reference * (k + 1) * period - position, speed - reference)
    final = reference * samples * period - position
    hunts, amplitude, frequency = swing.judged()
    return Motion(hunts, amplitude, frequency, final, None if record is None else record.traces())


class _Controller:
    """What turns encoder readings into torque commands."""

    def __init__(self, loop: SampledLoop, position: Floats, reference: Floats) -> None:
        self.loop = loop
        self.reference = reference
        self.kp, self.kd, self.ki = (loop.array(name) for name in ("kp", "kd", "ki"))
        self.period = loop.array("sample_time")
        self.limit = loop.array("torque_limit")
        self.feed = loop.array("compensation_gain") * loop.array("compensation_estimate")
        self.boundary = loop.array("boundary")
        counts = loop.array("counts_per_revolution")
        self.stepped = counts > 0.0
        self.step = 2.0 * np.pi / np.where(self.stepped, counts, 1.0)
        self.reading = self._read(position - reference * self.period)
        self.integral = np.zeros(loop.draws)
        self.last_share = np.zeros(loop.draws)

    def _read(self, position: Floats) -> Floats:
        return np.where(self.stepped, np.rint(position / self.step) * self.step, position)

    def command(self, k: int, position: Floats) -> Floats:
        """Return the torque commanded at sample k [N·m]."""
        reading = self._read(position)
        speed = (reading - self.reading) / self.period
        self.reading = reading
        error = self.reference * (k * self.period) - reading
        integral = self.integral + error * self.period
        wanted = self.kp * error + self.kd * (self.reference - speed) + self.ki * integral
        wanted += self.feed * self._share(error, speed)
        torque = np.clip(wanted, -self.limit, self.limit)
        # Wind-up: no further integration into a limit.
        self.integral = np.where((torque != wanted) & (wanted * error > 0), self.integral, integral)
        return torque

    def _share(self, error: Floats, speed: Floats) -> Floats:
        """Return the compensation as a share of its full size, −1 to 1."""
        if self.loop.compensation_signal == "none":
            return np.zeros_like(error)
        signals = {"reference": self.reference, "measured": speed, "error": error}
        signal = signals[self.loop.compensation_signal]
        inside = np.abs(signal) < self.boundary
        share = np.divide(signal, self.boundary, out=np.sign(signal), where=inside)
        if self.loop.at_rest == "hold" and self.loop.compensation_signal != "error":
            share = np.where(share == 0.0, self.last_share, share)
            self.last_share = share
        return share
