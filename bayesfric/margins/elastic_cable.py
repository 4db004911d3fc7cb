"""Motor and joint on an elastic cable that rubs along its way, in small equal steps.

A cable that rings not far above the loop's own frequency lets the motor slip while the joint
stands, splits breakaway between the two ends, and leads the joint behind the motor. Of the
pulleys' friction a part acts at the joint's end, by the places of the pulleys, so that the cable
stores behind it what the lost motion says.

Steps are semi-implicit (Euler): second order in the ringing, and none of its energy is lost.
Friction takes speed off an end until none is left, and holds what it can hold.
"""

from dataclasses import dataclass, fields
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Cable", "EncoderAt", "Ends"]

EncoderAt = Literal["motor", "joint"]
Floats = NDArray[np.float64]
Whole = NDArray[np.intp]

LARGEST_PHASE = 0.5
"""Of the cable's ringing in a step [rad]: its frequency is within (phase)²/24."""
LEAST_STEPS = 2
"""In an interval of constant torque."""


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
    """

    motor_inertia: Floats
    load_inertia: Floats
    load_viscous: Floats
    stiffness: Floats
    damping: Floats
    behind: Floats
    hangs: Floats
    play: Floats

    @property
    def ringing(self) -> Floats:
        """The frequency at which both ends ring, shape (draws,) [rad/s]."""
        return np.sqrt(self.stiffness * (1 / self.load_inertia + 1 / self.motor_inertia))

    def taken(self, rows: Whole) -> "Cable":
        """Return the cable of some draws."""
        return Cable(*(getattr(self, field.name)[rows] for field in fields(self)))


class Step(NamedTuple):
    """A small step, and what it does to the speeds.

    Parameters
    ----------
    length : ndarray, shape (draws,)
        [s].
    over_inertia : ndarray, shape (2, draws)
        Speed gained per torque [rad/(s·N·m)].
    left : ndarray, shape (2, draws)
        Share of a speed that viscous friction leaves [-].
    rubbed : ndarray, shape (2, draws)
        Speed that friction takes off [rad/s].
    """

    length: Floats
    over_inertia: Floats
    left: Floats
    rubbed: Floats


class Ends:
    """The motor's and the joint's end, each array of shape (2, draws).

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
        friction: Floats,
        falling: Floats,
        falling_speed: Floats,
        stiction_ratio: Floats,
        viscous: Floats,
        load: Floats,
        encoder_at: EncoderAt,
        position: Floats,
        speed: Floats,
    ) -> None:
        parts = np.stack([1.0 - cable.behind, cable.behind])
        self.stiffness, self.damping, self.ringing = cable.stiffness, cable.damping, cable.ringing
        self.inertia = np.stack([cable.motor_inertia, cable.load_inertia])
        self.viscous = np.stack([viscous - cable.load_viscous, cable.load_viscous])
        self.friction, self.falling = parts * friction, parts * falling
        self.falls, self.sticks = bool(falling.any()), bool((stiction_ratio > 1.0).any())
        self.falling_speed = falling_speed
        self.breakaway = (self.friction + self.falling) * stiction_ratio
        self.hangs, self.fed = cable.hangs, cable.hangs - load
        self.half_play, self.plays = cable.play / 2, bool(cable.play.any())
        twist = cable.hangs / cable.stiffness + np.sign(cable.hangs) * self.half_play
        self.measured = 0 if encoder_at == "motor" else 1
        motor = position if encoder_at == "motor" else position + twist
        self.ends = np.stack([motor, motor - twist])
        self.speeds = np.stack([speed, speed])

    @property
    def position(self) -> Floats:
        """Of the measured end, shape (draws,) [rad]."""
        return np.asarray(self.ends[self.measured])

    @property
    def speed(self) -> Floats:
        """Of the measured end, shape (draws,) [rad/s]."""
        return np.asarray(self.speeds[self.measured])

    @property
    def joint(self) -> Floats:
        """Position of the joint's end, shape (draws,) [rad]."""
        return np.asarray(self.ends[1])

    @property
    def twist(self) -> Floats:
        """Motor minus joint, shape (draws,) [rad]."""
        return np.asarray(self.ends[0] - self.ends[1])

    @property
    def stands(self) -> NDArray[np.bool_]:
        """Where both ends stand still, shape (draws,)."""
        first, *others = self.speeds == 0.0
        return np.logical_and(first, others[0])

    def withstands(self) -> tuple[Floats, Floats]:
        """Return what pulls at a motor that stands, and what more it withstands [N·m]."""
        return self.stiffness * self._stretched(self.twist) - self.fed, self.breakaway[0]

    def _stretched(self, twist: Floats) -> Floats:
        """Return what of a twist stretches the cable, beyond the play."""
        return twist - np.clip(twist, -self.half_play, self.half_play) if self.plays else twist

    def cut(self, length: Floats, parts: int) -> tuple[int, Step]:
        """Return into how many steps an interval is cut, at least some parts, and the step."""
        count = int(np.ceil((self.ringing * length).max() / LARGEST_PHASE))
        count = parts * max(count, LEAST_STEPS)
        step = length / count
        over = step / self.inertia
        return count, Step(step, over, 1.0 - over * self.viscous, over * self.friction)

    def keep(self, rows: Whole) -> None:
        """Go on with some of the draws alone."""
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                setattr(self, name, value[..., rows])

    def advance(self, command: Floats, step: Step, running: NDArray[np.bool_] | None) -> None:
        """Go on by a step.

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
        np.subtract(pull, self.hangs, out=push[1])
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
        # who comes to the other side of no speed stands first
        stops = after * speed < 0.0
        if self.sticks or self.falls:
            stops |= (speed == 0.0) & (np.abs(push) <= self.breakaway)
        np.copyto(after, 0.0, where=stops)
        travel = step.length * after
        if running is not None:
            travel, after = np.where(running, travel, 0.0), np.where(running, after, speed)
        self.speeds = after
        self.ends = self.ends + travel
