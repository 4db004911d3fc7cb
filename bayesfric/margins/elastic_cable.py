"""Motor and joint on an elastic cable that rubs along its way, in small equal steps.

A cable that rings not far above the loop's own frequency lets the motor slip while the joint
stands, splits breakaway between the two ends, and leads the joint behind the motor. Of the
pulleys' friction a part acts at the joint's end, by the places of the pulleys, so that the cable
stores behind it what the lost motion says.

Steps are semi-implicit (Euler): second order in the ringing, and none of its energy is lost.
Friction takes speed off an end until none is left, and holds what it can hold.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from bayesfric.arrays import Array, Flags, Whole

EncoderAt = Literal["motor", "joint"]

LARGEST_PHASE = 0.5
"""Of the cable's ringing in a step [rad]: its frequency is within (phase)²/24."""
LEAST_STEPS = 2
"""In an interval of constant torque."""


@dataclass(frozen=True)
class Beyond:
    """A shaft behind the cable, and the cable from there to the joint, each of shape (draws,).

    Parameters
    ----------
    inertia : ndarray
        Of the shaft, seen from the motor's [kg·m²].
    share : ndarray
        Of the friction that acts at the shaft [-].
    stiffness, damping : ndarray
        Of the second cable [N·m/rad, N·m·s/rad].
    """

    inertia: Array
    share: Array
    stiffness: Array
    damping: Array


@dataclass(frozen=True)
class Cable:
    """What lies between a motor and its joint, and behind it, each of shape (draws,).

    Parameters
    ----------
    motor_inertia, load_inertia : ndarray
        At either end, seen from the motor's shaft [kg·m²].
    load_viscous : ndarray
        At the joint's end, of the loop's viscous friction [N·m·s/rad].
    stiffness, damping : ndarray
        [N·m/rad, N·m·s/rad].
    behind : ndarray
        Share of the friction that acts at the joint's end [-].
    hangs : ndarray
        Load on the joint, of which the loop's load torque is what nothing is fed forward
        against [N·m].
    play : ndarray
        Of motor against cable, its whole width [rad].
    beyond : Beyond or None
        Where the cable ends at a shaft with a second one; None is at the joint.
    """

    motor_inertia: Array
    load_inertia: Array
    load_viscous: Array
    stiffness: Array
    damping: Array
    behind: Array
    hangs: Array
    play: Array
    beyond: Beyond | None = None

    @property
    def ringing(self) -> Array:
        """The highest frequency at which the ends ring, shape (draws,) [rad/s]."""
        if self.beyond is None:
            return np.sqrt(self.stiffness * (1 / self.load_inertia + 1 / self.motor_inertia))
        near, far = self.stiffness, self.beyond.stiffness
        return np.sqrt(
            near / self.motor_inertia + (near + far) / self.beyond.inertia + far / self.load_inertia
        )


class Step(NamedTuple):
    """A small time step, and its weights on forces and speeds.

    Parameters
    ----------
    length : ndarray, shape (draws,)
        [s].
    over_inertia : ndarray, shape (ends, draws)
        Speed gained per torque [rad/(s·N·m)].
    left : ndarray, shape (ends, draws)
        Share of a speed that viscous friction leaves [-].
    rubbed : ndarray, shape (ends, draws)
        Speed that friction takes off [rad/s].
    """

    length: Array
    over_inertia: Array
    left: Array
    rubbed: Array


class Ends:
    """The motor's and the joint's end, and a shaft between two cables, of shape (ends, draws).

    Parameters
    ----------
    cable : Cable
        Between them.
    friction, falling : ndarray, shape (draws,)
        Coulomb torque of both ends together, and beyond it at the lowest speed [N·m].
    falling_speed, stiction_ratio, viscous, load : ndarray, shape (draws,)
        As of :class:`~bayesfric.margins.sampled_loop.SampledLoop`.
    encoder_at : {"motor", "joint"}
        Which end is measured.
    position, speed : ndarray, shape (draws,)
        Of the measured end at the beginning, the load hanging in its cable [rad, rad/s].
    """

    def __init__(
        self,
        cable: Cable,
        *,
        friction: Array,
        falling: Array,
        falling_speed: Array,
        stiction_ratio: Array,
        viscous: Array,
        load: Array,
        encoder_at: EncoderAt,
        position: Array,
        speed: Array,
    ) -> None:
        beyond = cable.beyond
        self.stiffness, self.damping, self.ringing = cable.stiffness, cable.damping, cable.ringing
        of_motor = viscous - cable.load_viscous
        if beyond is None:
            parts = np.stack([1.0 - cable.behind, cable.behind])
            self.inertia = np.stack([cable.motor_inertia, cable.load_inertia])
            self.viscous = np.stack([of_motor, cable.load_viscous])
            self.far_stiffness, self.far_damping = np.zeros((2, 0, viscous.size))
        else:
            parts = np.stack([1.0 - cable.behind - beyond.share, beyond.share, cable.behind])
            self.inertia = np.stack([cable.motor_inertia, beyond.inertia, cable.load_inertia])
            self.viscous = np.stack([of_motor, np.zeros_like(viscous), cable.load_viscous])
            self.far_stiffness, self.far_damping = beyond.stiffness[None], beyond.damping[None]
        self.friction, self.falling = parts * friction, parts * falling
        self.falls, self.sticks = bool(falling.any()), bool((stiction_ratio > 1.0).any())
        self.falling_speed = falling_speed
        self.breakaway = (self.friction + self.falling) * stiction_ratio
        self.hangs, self.fed = cable.hangs, cable.hangs - load
        self.half_play, self.plays = cable.play / 2, bool(cable.play.any())
        twist = cable.hangs / cable.stiffness + np.sign(cable.hangs) * self.half_play
        further = (cable.hangs / self.far_stiffness).sum(axis=0)
        self.measured = 0 if encoder_at == "motor" else -1
        motor = position if encoder_at == "motor" else position + twist + further
        self.ends = np.stack([motor, motor - twist])
        if beyond is not None:
            self.ends = np.stack([motor, motor - twist, motor - twist - further])
        self.speeds = np.broadcast_to(speed, self.ends.shape).copy()

    @property
    def position(self) -> Array:
        """Of the measured end, shape (draws,) [rad]."""
        return np.asarray(self.ends[self.measured])

    @property
    def speed(self) -> Array:
        """Of the measured end, shape (draws,) [rad/s]."""
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
        """Where all ends stand still, shape (draws,)."""
        stand, *others = self.speeds == 0.0
        for part in others:
            stand = stand & part
        return np.asarray(stand)

    def withstands(self) -> tuple[Array, Array]:
        """Return the torque that pulls at a resting motor, and its breakaway torque [N·m]."""
        near = self.ends[0] - self.ends[1]
        return self.stiffness * self._stretched(near) - self.fed, self.breakaway[0]

    def _stretched(self, twist: Array) -> Array:
        """Return the part of a twist that stretches the cable: all beyond the play."""
        return twist - np.clip(twist, -self.half_play, self.half_play) if self.plays else twist

    def cut(self, length: Array, parts: int) -> tuple[int, Step]:
        """Return the number of steps of an interval, at least `parts`, and the step."""
        phase = (self.ringing * length).max()
        if self.far_stiffness.size:  # both cables damp a light shaft
            braked = (self.damping + self.far_damping[0]) * length / self.inertia[1]
            phase = max(phase, braked.max())
        count = int(np.ceil(phase / LARGEST_PHASE))
        count = parts * max(count, LEAST_STEPS)
        step = length / count
        over = step / self.inertia
        return count, Step(step, over, 1.0 - over * self.viscous, over * self.friction)

    def keep(self, rows: Whole) -> None:
        """Keep some of the draws and drop the others."""
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                setattr(self, name, value[..., rows])

    def advance(self, command: Array, step: Step, running: Flags | None) -> None:
        """Advance by one step.

        Parameters
        ----------
        command : ndarray, shape (draws,)
            Torque of the motor, besides what is fed forward against the load [N·m].
        step : Step
            Of :meth:`cut`.
        running : ndarray of bool, shape (draws,), or None
            Which draws go on; None is all of them.
        """
        speed = self.speeds
        stretched = self._stretched(self.ends[0] - self.ends[1])
        pull = self.stiffness * stretched
        rate = self.damping * (speed[0] - speed[1])
        pull += np.where(stretched == 0.0, 0.0, rate) if self.plays else rate
        push = np.empty_like(speed)
        np.subtract(command + self.fed, pull, out=push[0])
        for place, stiffness in enumerate(self.far_stiffness, start=1):
            before, pull = pull, stiffness * (self.ends[place] - self.ends[place + 1])
            pull += self.far_damping[place - 1] * (speed[place] - speed[place + 1])
            np.subtract(before, pull, out=push[place])
        np.subtract(pull, self.hangs, out=push[-1])
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
        # an end whose speed changes sign stands first
        stops = after * speed < 0.0
        if self.sticks or self.falls:
            stops |= (speed == 0.0) & (np.abs(push) <= self.breakaway)
        np.copyto(after, 0.0, where=stops)
        travel = step.length * after
        if running is not None:
            travel, after = np.where(running, travel, 0.0), np.where(running, after, speed)
        self.speeds = after
        self.ends = self.ends + travel
