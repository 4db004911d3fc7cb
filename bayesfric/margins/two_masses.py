"""Motor and joint on an elastic cable that rubs along its way, with the sampled controller.

What the closed forms and the stiff simulator leave out is here: the cable's stiffness and
damping, friction of the pulleys behind it, and the whole of the joint's load with what the
controller feeds forward against it. Of the pulleys' friction a part acts at the joint's end,
by the places of the pulleys, so that the cable stores behind it what the lost motion says.

Time goes in small equal steps, semi-implicit (Euler). Friction takes speed off an end until
none is left, and holds what it can hold.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.sampled_controller import Controller
from bayesfric.margins.swing import Swing

__all__ = ["CableMotion", "simulate_two_masses"]

Array = NDArray[np.float64]

LARGEST_PHASE = 0.25
"""Of the cable's ringing in a step [rad]."""
LEAST_STEPS, MOST_STEPS = 8, 200
"""Steps in a sample."""


@dataclass(frozen=True)
class CableMotion:
    """How motor and joint answered, every array of shape (draws,).

    Parameters
    ----------
    hunts : ndarray of bool
        Whether the motor swings at the end, as :class:`~bayesfric.margins.swing.Swing` judges.
    amplitude, frequency : ndarray
        Of the motor's error [rad, Hz].
    error, twist : ndarray
        Reference minus motor, and motor minus joint, at the end [rad].
    """

    hunts: NDArray[np.bool_]
    amplitude: Array
    frequency: Array
    error: Array
    twist: Array


def simulate_two_masses(
    shaft: LoopAtShaft, *, gamma: Array, kick: Array, reference_speed: Array, duration: float
) -> CableMotion:
    """Run loops on an elastic cable for some time after a kick.

    Motor and joint begin with the reference's speed, ahead of it by the kick, the load hanging
    in its cable.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loops.
    gamma : ndarray, shape (draws,)
        Compensation gains.
    kick, reference_speed : ndarray, shape (draws,)
        As of :func:`bayesfric.margins.simulating.simulate` [rad, rad/s].
    duration : float
        [s].
    """
    controller = Controller(shaft.sampled(gamma), kick, reference_speed)
    period = controller.period
    ringing = np.sqrt(shaft.stiffness * (1 / shaft.load_inertia + 1 / shaft.motor_inertia))
    steps = int(np.clip(np.ceil((ringing * period).max() / LARGEST_PHASE), LEAST_STEPS, MOST_STEPS))
    step = period / steps
    samples = np.ceil(duration / period).astype(np.intp)
    swing = Swing(samples, period, controller.step * controller.stepped)
    late = np.rint(shaft.delay / step).astype(np.intp)
    # command k − age acts in step j of sample k
    ages = np.array([-((j - late) // steps) for j in range(steps)])
    commands = np.zeros((int(ages.max()) + 1, kick.size))
    draws = np.arange(kick.size)
    ends = _Ends(shaft, kick, reference_speed)
    against = shaft.load_torque - shaft.net_load
    for k in range(int(samples.max())):
        commands[1:] = commands[:-1]
        number = np.full(kick.size, k)
        commands[0], _ = controller.command(number, ends.position[0])
        for j in range(steps):
            if j == 0 or (ages[j] != ages[j - 1]).any():
                torque = commands[ages[j], draws] + against
            ends.advance(torque, step)
        error = reference_speed * (k + 1) * period - ends.position[0]
        swing.see(number + 1, error, ends.speed[0] - reference_speed, number < samples)
    seen = swing.judged()
    twist = np.asarray(ends.position[0] - ends.position[1])
    return CableMotion(seen.hunts, seen.amplitude, seen.frequency, error, twist)


class _Ends:
    """Motor and joint, each array of shape (2, draws)."""

    def __init__(self, shaft: LoopAtShaft, kick: Array, speed: Array) -> None:
        self.stiffness, self.damping = shaft.stiffness, shaft.damping
        self.load = shaft.load_torque
        self.inertia = np.stack([shaft.motor_inertia, shaft.load_inertia])
        self.viscous = np.stack([shaft.motor_viscous, shaft.load_viscous])
        behind = np.minimum(shaft.lost_motion * shaft.stiffness, shaft.friction)
        self.friction = np.stack([shaft.friction - behind, behind])
        self.falling = self.friction / shaft.friction * shaft.falling
        self.falls = bool(self.falling.any())
        self.falling_speed = shaft.falling_speed
        self.breakaway = (self.friction + self.falling) * shaft.stiction_ratio
        self.position = np.stack([kick, kick - shaft.load_torque / shaft.stiffness])
        self.speed = np.stack([speed, speed])

    def advance(self, torque: Array, step: Array) -> None:
        """Go on by a step."""
        speed = self.speed
        pull = self.stiffness * (self.position[0] - self.position[1])
        pull += self.damping * (speed[0] - speed[1])
        push = np.stack([torque - pull, pull - self.load])
        rub = self.friction
        if self.falls:
            rub = rub + self.falling * np.exp(-np.abs(speed) / self.falling_speed)
        free = speed + step / self.inertia * (push - self.viscous * speed)
        left = np.abs(free) - step / self.inertia * rub
        after = np.copysign(np.maximum(left, 0.0), free)
        holds = (speed == 0.0) & (np.abs(push) <= self.breakaway)
        # who comes to the other side of no speed stands first
        after[holds | (after * speed < 0.0)] = 0.0
        self.speed = after
        self.position += step * after
