"""A motor shaft with set-valued Coulomb friction under constant torque, in closed form.

J dv/dt = u − F sign(v) − b v while the shaft turns. At rest it stays while |u| ≤ Fs. Under constant
torque the shaft turns in one direction, may stop, and may then break away in the direction of the
torque. It never stops twice. So an interval of constant torque has at most two arcs, each an
exponential in time, and needs no numerical integration. Only friction that falls with speed is
approximated, by its value at the speed at the start of an interval.
"""

from dataclasses import dataclass, replace

import numpy as np

from bayesfric.arrays import Array, Flags, PerDraw, taken
from bayesfric.margins.sampled_loop import SampledLoop

SERIES_BELOW = 0.1
SERIES_TERMS = 9  # the next term is 0.1⁹/11! ≈ 3e-17 of the sum


@dataclass(frozen=True)
class Shaft:
    """Inertia and friction of a shaft, each of shape (draws,).

    Parameters
    ----------
    inertia : ndarray
        Inertia J at the motor shaft [kg·m²].
    viscous : ndarray
        Viscous friction b [N·m·s/rad].
    friction : ndarray
        Coulomb torque F while the shaft turns [N·m].
    breakaway : ndarray
        Breakaway torque Fs of a shaft at rest, at least F [N·m].
    """

    inertia: Array
    viscous: Array
    friction: Array
    breakaway: Array


@dataclass(frozen=True)
class Interval:
    """A time step and its weights, which are constant over a run.

    Parameters
    ----------
    length : ndarray, shape (draws,)
        Duration h [s].
    decay : ndarray, shape (draws,)
        exp(−b h/J), the share of a speed that remains after it [-].
    by_speed : ndarray, shape (draws,)
        Travel per initial speed, ∫ exp(−b t/J) dt [s].
    by_acceleration : ndarray, shape (draws,)
        Travel per acceleration from rest [s²].
    """

    length: Array
    decay: Array
    by_speed: Array
    by_acceleration: Array

    @classmethod
    def of(cls, length: Array, shaft: Shaft) -> "Interval":
        """Return the weights of steps of these lengths.

        Parameters
        ----------
        length : ndarray, shape (draws,)
            Durations [s], none negative.
        shaft : Shaft
            The shafts.

        Returns
        -------
        Interval
            Of shape (draws,).
        """
        return cls(length, *_weights(length, shaft.viscous / shaft.inertia))


def turn(
    shaft: Shaft, torque: Array, position: Array, speed: Array, interval: Interval
) -> tuple[Array, Array]:
    """Return position and speed after an interval of constant torque.

    Exact up to rounding: v(t) = v₀ e^{−βt} + a (1 − e^{−βt})/β with β = b/J and
    a = (u − F s)/J, where s is the direction of motion, or of the torque where the
    shaft breaks away; it stops at t = ln(1 − β v₀/a)/β where a opposes v₀.

    Parameters
    ----------
    shaft : Shaft
        The shafts, of shape (draws,).
    torque : ndarray, shape (draws,)
        Applied torque u [N·m].
    position, speed : ndarray, shape (draws,)
        At the start [rad, rad/s]. A speed of exactly zero is rest.
    interval : Interval
        The step.

    Returns
    -------
    position, speed : ndarray, shape (draws,)
        At the end; the speed of a shaft at rest is exactly zero.
    """
    rests = speed == 0.0
    direction = np.sign(np.where(rests, torque, speed))
    free = ~(rests & (np.abs(torque) <= shaft.breakaway))
    acceleration = np.where(free, (torque - direction * shaft.friction) / shaft.inertia, 0.0)
    end_speed = speed * interval.decay + acceleration * interval.by_speed
    travel = speed * interval.by_speed + acceleration * interval.by_acceleration
    # Speed is monotone under constant torque: a change of its sign is a stop.
    slows = direction * acceleration < 0.0
    stops = np.flatnonzero((direction * end_speed <= 0.0) & slows & ~rests)
    if stops.size:
        travel[stops], end_speed[stops] = _after_a_stop(
            taken(shaft, stops),
            torque[stops],
            speed[stops],
            acceleration[stops],
            interval.length[stops],
        )
    return position + travel, end_speed


def _after_a_stop(
    shaft: Shaft, torque: Array, speed: Array, acceleration: Array, length: Array
) -> tuple[Array, Array]:
    """Return travel and final speed of shafts that stop within the interval."""
    rate = shaft.viscous / shaft.inertia
    ratio = -speed / acceleration
    slowed = rate * ratio
    factor = np.divide(np.log1p(slowed), slowed, out=np.ones_like(slowed), where=slowed > 0.0)
    until = np.minimum(ratio * factor, length)
    _, by_speed, by_acceleration = _weights(until, rate)
    travel = speed * by_speed + acceleration * by_acceleration
    left = length - until
    _, by_speed, by_acceleration = _weights(left, rate)
    breaks = np.abs(torque) > shaft.breakaway
    net = np.where(breaks, torque - np.sign(torque) * shaft.friction, 0.0) / shaft.inertia
    return travel + net * by_acceleration, net * by_speed


def _weights(time: Array, rate: Array) -> tuple[Array, Array, Array]:
    """Return e^{−z}, t (1 − e^{−z})/z and t² (z − 1 + e^{−z})/z² with z = rate × time."""
    z = rate * time
    near = z < SERIES_BELOW  # there the closed form of the last weight suffers cancellation
    away = np.where(near, 1.0, z)
    series = np.ones_like(z)
    for term in range(SERIES_TERMS + 2, 2, -1):  # Σ 2 (−z)^k/(k + 2)! by Horner
        series = 1.0 - z * series / term
    second = np.where(near, 0.5 * series, (away + np.expm1(-away)) / away**2)
    first = 1.0 - z * second
    return np.exp(-z), time * first, time**2 * second


class StiffShaft(PerDraw):
    """The state of motor and joint as one shaft, with the interface of `Ends`.

    Parameters
    ----------
    loop : SampledLoop
        The loop, with inertia and friction.
    position, speed : ndarray, shape (draws,)
        At the start [rad, rad/s].
    """

    def __init__(self, loop: SampledLoop, position: Array, speed: Array) -> None:
        self.shaft = Shaft(loop.inertia, loop.viscous, loop.friction, loop.breakaway)
        self.load, self.falling, self.falling_speed = (
            loop.load_torque,
            loop.falling,
            loop.falling_speed,
        )
        self.position, self.speed = position, speed

    @property
    def joint(self) -> Array:
        """Position of the joint, equal to that of the shaft, shape (draws,) [rad]."""
        return self.position

    @property
    def twist(self) -> Array:
        """Motor minus joint: zero, shape (draws,) [rad]."""
        return np.zeros_like(self.position)

    @property
    def stands(self) -> Flags:
        """Whether the shaft stands still, shape (draws,)."""
        return np.asarray(self.speed == 0.0)

    def withstands(self) -> tuple[Array, Array]:
        """Return the torque that acts on a resting shaft, and its breakaway torque [N·m]."""
        return self.load, self.shaft.breakaway

    def cut(self, length: Array, parts: int) -> tuple[int, Interval]:
        """Return the number of steps of an interval, and the step."""
        return parts, Interval.of(length / parts, self.shaft)

    def advance(self, command: Array, step: Interval, running: Flags | None) -> None:
        """Advance the draws of `running` by one step; None: all of them."""
        shaft = self.shaft
        if self.falling.any():
            more = self.falling * np.exp(-np.abs(self.speed) / self.falling_speed)
            shaft = replace(shaft, friction=shaft.friction + more)
        position, speed = turn(shaft, command - self.load, self.position, self.speed, step)
        if running is not None:
            position = np.where(running, position, self.position)
            speed = np.where(running, speed, self.speed)
        self.position, self.speed = position, speed
