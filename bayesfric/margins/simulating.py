"""The sampled position loop of a motor shaft with friction, in time, over all draws at once.

At each sample time t_k = k T the controller reads the encoder and commands a torque, which
acts from t_k + delay until the next command acts. Between two changes of torque the motion of a
stiff shaft has a closed form (:mod:`bayesfric.margins.shaft`), and that of motor and joint on an
elastic cable is integrated in small steps (:mod:`bayesfric.margins.elastic_cable`). Any delay is
represented exactly, whatever its ratio to the sample time. A shaft at rest is advanced in closed
form to the sample before its torque reaches breakaway, so that slow hunting, with the shaft mostly
at rest, needs little computation. If a shaft moves for a whole settling time of its linear loop,
with at most brief rests, the part of the run after this time decides.
"""

from collections.abc import Callable
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bayesfric.arrays import Array, Flags, PerDraw
from bayesfric.margins.elastic_cable import Ends
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.margins.observers import Observer
from bayesfric.margins.reference import ConstantSpeed, Reference
from bayesfric.margins.sampled_controller import Controller
from bayesfric.margins.sampled_loop import SampledLoop
from bayesfric.margins.shaft import StiffShaft
from bayesfric.margins.swing import LoopMotion, Swing

Recorder = Callable[[Array, Array, Array, Array], None]

EARLY_TWICE = 2
"""Number of times that a run may be judged early, if the shaft stands still again afterwards."""
STANDS_IN_SETTLING = 4
"""A shaft that stands for less than the settling time over this number counts as moving."""
LOOKED_AT_EVERY = 8
"""Samples between checks of which shafts stand still and which runs are over."""


def simulate(
    loop: SampledLoop,
    *,
    kick: ArrayLike,
    duration: ArrayLike,
    reference_speed: ArrayLike = 0.0,
    settling: ArrayLike = np.inf,
    lasts: ArrayLike = MARGIN_RULES.swing_lasts,
    substeps: int = 1,
    record: Recorder | None = None,
) -> LoopMotion:
    """Run the loop for some time after a kick.

    The reference moves at constant speed from 0. The shaft starts with the reference's speed, ahead
    of it by the kick. Only the load's torque acts before the first command arrives.

    Parameters
    ----------
    loop : SampledLoop
        The loop.
    kick : array_like
        Initial position of the measured end ahead of the reference [rad], a scalar or (draws,).
    duration : array_like
        Length of the run [s], rounded up to whole samples, a scalar or (draws,). Its last half
        decides whether a loop hunts. It should contain several periods, and be long compared
        with the time constant 2J/b.
    reference_speed : array_like
        Speed of the reference [rad/s], a scalar or (draws,).
    settling : array_like
        Settling time [s], a scalar or (draws,). If a shaft has not stood still for more than a
        quarter of it at once, it is judged by the next stretch of the same length, and its run
        ends there if the shaft has not stood still in that stretch either.
    lasts : array_like
        Share of its amplitude that a lasting oscillation keeps from one quarter to the next, a
        scalar or (draws,).
    substeps : int
        Parts into which every interval of constant torque is divided, or each step on an elastic
        cable. The motion of a stiff shaft is exact with 1; more parts give finer traces.
    record : callable or None
        Called for each interval of constant torque with its length [s], position and speed at
        its end [rad, rad/s], and the torque [N·m], each of shape (draws,).

    Returns
    -------
    LoopMotion
        One value for each draw.
    """
    begin, reference, length, settled, kept = (
        np.broadcast_to(np.asarray(values, dtype=np.float64), loop.draws)
        for values in (kick, reference_speed, duration, settling, lasts)
    )
    run = _Run(loop, begin, ConstantSpeed(reference), length, settled, kept, substeps)
    _run_down(run, record)
    return LoopMotion(**run.results)


def _run_down(run: "_Run", record: Recorder | None) -> None:
    """Advance a run until all draws are over; finished draws are removed in groups."""
    looks = 0
    while run.rows.size:
        run.advance(record)
        looks += 1
        if record is not None:
            if (run.k >= run.swing.end).all():
                run.retire(np.ones(run.rows.size, dtype=bool))
        elif looks % LOOKED_AT_EVERY == 0:
            run.stand_still()
            run.judge_early()
            over = run.k >= run.swing.end
            if over.sum() > 0.1 * over.size or over.all():
                run.retire(over)


def follow(
    loop: SampledLoop,
    reference: Reference,
    duration: float,
    observer: Observer | None = None,
) -> Array:
    """Return the tracking error of the joint at each sample.

    Motor and joint start at 0 with the speed of the reference, and the load stretches the cable.

    Parameters
    ----------
    loop : SampledLoop
        The loop.
    reference : Reference
        The reference, with as many draws; it starts at 0.
    duration : float
        Length of the run [s], rounded up to whole samples.
    observer : Observer or None
        Adds its estimate of friction to the command.

    Returns
    -------
    ndarray, shape (samples + 1, draws)
        Reference minus joint, at the motor's shaft [rad]. The last value is repeated if other
        draws take more samples.
    """
    whole, never = np.zeros(loop.draws), np.full(loop.draws, np.inf)
    length = np.full(loop.draws, duration)
    run = _Run(loop, whole, reference, length, never, whole, 1, observer)
    errors = [run.joint_error()]
    while (run.k < run.swing.end).any():
        run.advance(None)
        errors.append(run.joint_error())
    return np.array(errors)


class _Run(PerDraw):
    """The state of a running simulation; draws may be at different samples."""

    def __init__(
        self,
        loop: SampledLoop,
        begin: Array,
        reference: Reference,
        duration: Array,
        settling: Array,
        lasts: Array,
        substeps: int,
        observer: Observer | None = None,
    ) -> None:
        self.controller = Controller(loop, begin, reference, observer)
        period = self.controller.period
        at = begin.copy(), reference.speed(np.zeros(loop.draws)).copy()
        self.plant: StiffShaft | Ends = (
            StiffShaft(loop, *at) if loop.cable is None else Ends(loop, loop.cable, *at)
        )
        # Command k − whole − 1 acts until `late` after t_k; from then on command k − whole does.
        samples_late = loop.delay / period
        self.whole = np.floor(samples_late + 1e-9).astype(np.intp)
        self.alike = bool((self.whole == self.whole[0]).all())
        late = np.maximum(samples_late - self.whole, 0.0) * period
        self.intervals = tuple(
            (older, *self.plant.cut(length, substeps))
            for older, length in ((1, late), (0, period - late))
            if length.any()
        )
        # before the first command: no torque
        self.commands = (np.zeros(loop.draws),) * (int(self.whole.max()) + 2)
        self.k = np.zeros(loop.draws, dtype=np.intp)
        self.quiet = np.zeros(loop.draws, dtype=np.intp)  # samples since the last reading of motion
        samples = np.ceil(duration / period - 1e-9).astype(np.intp)
        least = self.controller.step * self.controller.stepped
        self.swing = Swing(samples, period, least, lasts)
        self.stretch = np.maximum(samples // 4, 1)  # quarters, by which the whole run is judged
        settling = np.minimum(settling, duration)
        self.settling = np.ceil(settling / period - 1e-9).astype(np.intp)
        self.early = np.zeros(loop.draws, dtype=bool)
        self.times = np.zeros(loop.draws, dtype=np.intp)  # number of early judgements
        self.moving = np.zeros(loop.draws, dtype=np.intp)  # samples since the shaft stood for long
        self.rows = np.arange(loop.draws)
        self.results: dict[str, NDArray[Any]] = {
            field.name: np.zeros(loop.draws, dtype=bool if field.name == "hunts" else float)
            for field in fields(LoopMotion)
        }

    def advance(self, record: Recorder | None) -> None:
        """Advance all running draws by one sample."""
        running = self.k < self.swing.end
        plant = self.plant
        torque, reading = self.controller.command(self.k, plant.position)
        self.commands = (torque, *self.commands[:-1])
        self.quiet = np.where((reading == 0.0) & plant.stands, self.quiet + 1, 0)
        some = None if running.all() else running
        for older, count, step in self.intervals:
            acting = self._acting(older)
            for _ in range(count):
                plant.advance(acting, step, some)
                if record is not None:
                    length = np.where(running, step.length, 0.0)
                    record(length, plant.position, plant.speed, acting)
        self.k = self.k + running
        self.moving = np.where(STANDS_IN_SETTLING * self.quiet > self.settling, 0, self.moving + 1)
        error = self._error()
        asked = self.controller.reference.speed(self.k * self.controller.period)
        self.swing.see(self.k, error, plant.speed - asked, running)

    def _error(self) -> Array:
        controller = self.controller
        return controller.reference.position(self.k * controller.period) - self.plant.position

    def joint_error(self) -> Array:
        """Return the reference minus the joint, of shape (draws,) [rad]."""
        asked = self.controller.reference.position(self.k * self.controller.period)
        return np.asarray(asked - self.plant.joint)

    def _acting(self, older: int) -> Array:
        """Return the command that is `older` samples older than the newest that acts."""
        if self.alike:
            return self.commands[int(self.whole[0]) + older]
        age = self.whole + older
        return np.stack(self.commands)[age, np.arange(age.size)]

    def stand_still(self) -> None:
        """Advance each resting shaft to the sample before its torque reaches breakaway."""
        depth = len(self.commands)
        ready = np.flatnonzero((self.quiet > depth) & (self.k < self.swing.end))
        if not ready.size:
            return
        constant, linear, square = (part[ready] for part in self.controller.at_standstill(self.k))
        load, most = (part[ready] for part in self.plant.withstands())
        until = np.minimum(
            *(_reached(sign * (constant - load) - most, sign * linear, sign * square)
              for sign in (1.0, -1.0))
        )  # fmt: skip
        left = self.swing.next_look(self.k)[ready] - self.k[ready]
        samples = np.minimum(np.nan_to_num(until, nan=0.0, posinf=np.inf) - 2.0, left)
        some = samples > depth + 1
        if not some.any():
            return
        rows, samples = ready[some], samples[some].astype(np.intp)
        constant, linear, square = constant[some], linear[some], square[some]
        before = self._error()[rows]
        self.controller.wait(self.k, rows, samples)
        past = np.stack(self.commands)
        j = samples - 1 - np.arange(depth)[:, None]
        past[:, rows] = constant + linear * j + square * j**2
        self.commands = tuple(past)
        self.k[rows] += samples
        self.quiet[rows] += samples
        self.swing.pass_over(rows, samples, self.k, before, self._error()[rows])

    def judge_early(self) -> None:
        """Judge early the draws that have moved for long; undo this if they stand still again."""
        swing = self.swing
        going = self.k < swing.end  # finished draws stay finished
        stands = np.flatnonzero(going & self.early & (self.moving < self.settling))
        if stands.size:
            self.early[stands] = False
            swing.judge_from(stands, self.k[stands] + 1, self.stretch[stands])
        left = swing.end - self.k
        steady = (self.moving >= self.settling) & (left > self.settling)
        ready = np.flatnonzero(~self.early & steady & (self.times < EARLY_TWICE))
        if ready.size:
            self.early[ready] = True
            self.times[ready] += 1
            half = np.maximum(self.settling[ready] // 2, 1)
            swing.judge_from(ready, self.k[ready] + 1, half)

    def retire(self, over: Flags) -> None:
        """Store the results of some draws, and continue with the others."""
        motion = self.swing.judged(self._error(), self.plant.twist)
        for name, value in vars(motion).items():
            self.results[name][self.rows[over]] = value[over]
        kept = np.flatnonzero(~over)
        for part in (self, self.controller, self.swing, self.plant):
            part.keep(kept)


def _reached(constant: Array, linear: Array, square: Array) -> Array:
    """Return the first j at which constant + linear j + square j² reaches 0; inf if never."""
    root = np.sqrt(np.maximum(linear**2 - 4.0 * square * constant, 0.0))
    real = linear**2 >= 4.0 * square * constant
    below = linear + root
    rises = real & (below > 0.0)
    first = np.divide(-2.0 * constant, below, out=np.full_like(root, np.inf), where=rises)
    return np.where(np.isnan(constant) | (constant > 0.0), np.nan, first)
