"""Motor and joint on an elastic cable with friction along it, in small equal steps.

If the frequency of the cable is not far above that of the loop, the motor can slip while the joint
is at rest, breakaway is divided between the two ends, and the joint lags behind the motor. The
positions of the pulleys determine which part of their friction acts at the joint. The cable behind
it stores the lost motion.

Steps are semi-implicit (Euler): second order in the oscillation, without loss of its energy.
Friction reduces the speed of an end to zero and then holds it up to its limit.
"""

from dataclasses import dataclass
from functools import reduce

import numpy as np

from bayesfric.arrays import Array, Flags, PerDraw
from bayesfric.margins.sampled_loop import Cable, SampledLoop

LARGEST_PHASE = 0.5
"""Largest phase of the cable's ringing in a step [rad]; its frequency error is (phase)²/24."""
LEAST_STEPS = 2
"""Least number of steps in an interval of constant torque."""


@dataclass(frozen=True)
class Step:
    """A small time step, and its weights on forces and speeds.

    Parameters
    ----------
    length : ndarray, shape (draws,)
        Length [s].
    over_inertia : ndarray, shape (ends, draws)
        Speed gained per torque [rad/(s·N·m)].
    left : ndarray, shape (ends, draws)
        Share of a speed that viscous friction leaves [-].
    rubbed : ndarray, shape (ends, draws)
        Speed that friction removes [rad/s].
    """

    length: Array
    over_inertia: Array
    left: Array
    rubbed: Array


class Ends(PerDraw):
    """The state of motor, joint and a shaft between two cables, shape (ends, draws).

    Parameters
    ----------
    loop : SampledLoop
        The loop with its friction, load and encoder.
    cable : Cable
        The cable between the ends.
    position, speed : ndarray, shape (draws,)
        Of the measured end at the start, with the cable stretched by the load [rad, rad/s].
    """

    def __init__(self, loop: SampledLoop, cable: Cable, position: Array, speed: Array) -> None:
        self.stiffness, self.damping = np.stack(cable.stiffness), np.stack(cable.damping)
        self.ringing = cable.ringing
        self.inertia, rubs = np.stack(cable.inertia), np.stack(cable.rubs)
        self.viscous = np.zeros_like(self.inertia)
        self.viscous[0], self.viscous[-1] = loop.viscous - cable.load_viscous, cable.load_viscous
        self.friction, self.falling = rubs * loop.friction, rubs * loop.falling
        self.falls, self.sticks = bool(loop.falling.any()), bool((loop.stiction_ratio > 1.0).any())
        self.falling_speed = loop.falling_speed
        self.breakaway = (self.friction + self.falling) * loop.stiction_ratio
        self.hangs, self.fed = cable.hangs, cable.hangs - loop.load_torque
        self.half_play, self.plays = cable.play / 2, bool(cable.play.any())
        twist = cable.hangs / self.stiffness
        twist[0] += np.sign(cable.hangs) * self.half_play
        behind = np.concatenate([np.zeros_like(twist[:1]), twist.cumsum(axis=0)])
        self.measured = 0 if loop.encoder_at == "motor" else -1
        self.ends = position + behind[self.measured] - behind
        self.speeds = np.broadcast_to(speed, self.ends.shape).copy()

    @property
    def position(self) -> Array:
        """Position of the measured end, shape (draws,) [rad]."""
        return np.asarray(self.ends[self.measured])

    @property
    def speed(self) -> Array:
        """Speed of the measured end, shape (draws,) [rad/s]."""
        return np.asarray(self.speeds[self.measured])

    @property
    def joint(self) -> Array:
        """Position of the joint's end, shape (draws,) [rad]."""
        return np.asarray(self.ends[-1])

    @property
    def twist(self) -> Array:
        """Motor minus joint, shape (draws,) [rad]."""
        return np.asarray(self.ends[0] - self.ends[-1])

    @property
    def stands(self) -> Flags:
        """Whether all ends stand still, shape (draws,)."""
        return reduce(np.logical_and, self.speeds == 0.0)  # faster than along an axis

    def withstands(self) -> tuple[Array, Array]:
        """Return the torque that acts on a resting motor, and its breakaway torque [N·m]."""
        near = self._stretched(self.ends[0] - self.ends[1])
        return self.stiffness[0] * near - self.fed, self.breakaway[0]

    def _stretched(self, twist: Array) -> Array:
        """Return the part of a twist that stretches the cable: the part beyond the play."""
        return twist - np.clip(twist, -self.half_play, self.half_play) if self.plays else twist

    def cut(self, length: Array, parts: int) -> tuple[int, Step]:
        """Return the number of steps of an interval, at least `parts`, and the step."""
        phase = (self.ringing * length).max()
        if len(self.damping) == 2:  # both cables damp a light shaft
            braked = self.damping.sum(axis=0) * length / self.inertia[1]
            phase = max(phase, braked.max())
        count = int(np.ceil(phase / LARGEST_PHASE))
        count = parts * max(count, LEAST_STEPS)
        step = length / count
        over = step / self.inertia
        return count, Step(step, over, 1.0 - over * self.viscous, over * self.friction)

    def advance(self, command: Array, step: Step, running: Flags | None) -> None:
        """Advance by one step.

        Parameters
        ----------
        command : ndarray, shape (draws,)
            Torque of the motor, without the feed-forward against the load [N·m].
        step : Step
            The step from :meth:`cut`.
        running : ndarray of bool, shape (draws,), or None
            Draws that continue; None: all of them.
        """
        speed = self.speeds
        stretched = self.ends[:-1] - self.ends[1:]
        pull = self.damping * (speed[:-1] - speed[1:])
        if self.plays:
            stretched[0] = self._stretched(stretched[0])
            pull[0, stretched[0] == 0.0] = 0.0
        pull += self.stiffness * stretched
        push = np.empty_like(speed)
        push[0], push[1:] = command + self.fed, pull
        push[:-1] -= pull
        push[-1] -= self.hangs
        rubbed = step.rubbed
        if self.falls:
            more = self.falling * np.exp(-np.abs(speed) / self.falling_speed)
            rubbed = rubbed + step.over_inertia * more
        free = step.over_inertia * push
        free += step.left * speed
        after = np.abs(free)
        after -= rubbed
        np.maximum(after, 0.0, out=after)
        np.copysign(after, free, out=after)
        # an end whose speed changes sign first stops
        stops = after * speed < 0.0
        if self.sticks or self.falls:
            stops |= (speed == 0.0) & (np.abs(push) <= self.breakaway)
        np.copyto(after, 0.0, where=stops)
        travel = step.length * after
        if running is not None:
            travel, after = np.where(running, travel, 0.0), np.where(running, after, speed)
        self.speeds = after
        self.ends = self.ends + travel
