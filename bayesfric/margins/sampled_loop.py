"""A sampled position loop of a motor shaft with friction, for the simulator."""

from dataclasses import dataclass, field, fields
from functools import partial
from typing import Literal, Self

import numpy as np

from bayesfric.arrays import Array, Whole, taken

CompensationSignal = Literal["none", "reference", "measured", "error"]
AtRest = Literal["off", "hold"]
EncoderAt = Literal["motor", "joint"]

NO_NUMBERS = ("compensation_signal", "at_rest", "encoder_at", "cable")
"""Fields that are not arrays of numbers."""


ZERO = partial(np.array, 0.0)
UNIT = partial(np.array, 1.0)
ENDLESS = partial(np.array, np.inf)


@dataclass(frozen=True)
class Cable:
    """The cable between motor and joint, and the joint; each field of shape (draws,).

    Parameters
    ----------
    inertia : tuple of ndarray
        Inertia of the motor, of a shaft between two cables if there is one, and of the joint,
        referred to the motor's shaft [kg·m²].
    rubs : tuple of ndarray
        Share of the friction that acts at each of these [-].
    load_viscous : ndarray
        Part of the loop's viscous friction that acts at the joint [N·m·s/rad].
    stiffness, damping : tuple of ndarray
        Of each cable, from the motor on [N·m/rad, N·m·s/rad].
    hangs : ndarray
        Load on the joint [N·m]; the loop's load torque is the part without feed-forward.
    play : ndarray
        Play between motor and cable, its whole width [rad].
    """

    inertia: tuple[Array, ...]
    rubs: tuple[Array, ...]
    load_viscous: Array
    stiffness: tuple[Array, ...]
    damping: tuple[Array, ...]
    hangs: Array
    play: Array

    @property
    def ringing(self) -> Array:
        """Upper bound of the frequencies at which the ends ring, shape (draws,) [rad/s]."""
        inertia = np.stack(self.inertia)
        both = 1 / inertia[1:] + 1 / inertia[:-1]
        return np.asarray(np.sqrt((np.stack(self.stiffness) * both).sum(axis=0)))


@dataclass(frozen=True, kw_only=True)
class Controlled:
    """Friction of a shaft and the controller that moves it; every array of shape (draws,).

    Parameters
    ----------
    friction : ndarray
        Coulomb torque F while the shaft turns [N·m].
    kp : ndarray
        Torque per position error [N·m/rad].
    kd : ndarray
        Torque per speed error [N·m·s/rad].
    sample_time : ndarray
        T [s].
    ki : ndarray
        Torque per integral of the position error [N·m/(rad·s)].
    delay : ndarray
        Time from reading the encoder to the torque [s]. It does not include the half sample
        that the hold adds on average, which the simulation has itself.
    stiction_ratio : ndarray
        Breakaway torque over friction at the lowest speed, at least 1 [-].
    falling, falling_speed : ndarray
        Friction beyond F at the lowest speed, and the speed at which it has fallen to 1/e of
        that [N·m, rad/s].
    velocity_cutoff : ndarray
        Corner of the low-pass that the derivative's speed goes through; infinite without
        one [rad/s].
    position_cutoff : ndarray
        Corner of the low-pass that the measured position goes through; infinite without one
        [rad/s].
    boundary : ndarray
        Half width of the linear piece of the compensation; 0: a bare sign [rad/s, or rad for
        `error`].
    """

    friction: Array
    kp: Array
    kd: Array
    sample_time: Array
    ki: Array = field(default_factory=ZERO)
    delay: Array = field(default_factory=ZERO)
    stiction_ratio: Array = field(default_factory=UNIT)
    falling: Array = field(default_factory=ZERO)
    falling_speed: Array = field(default_factory=UNIT)
    velocity_cutoff: Array = field(default_factory=ENDLESS)
    position_cutoff: Array = field(default_factory=ENDLESS)
    boundary: Array = field(default_factory=ZERO)

    @property
    def breakaway(self) -> Array:
        """Breakaway torque: friction at the lowest speed times the stiction ratio [N·m]."""
        return (self.friction + self.falling) * self.stiction_ratio

    def taken(self, rows: Whole) -> Self:
        """Return the loop of some draws, in a given order, with repetition if wanted."""
        return taken(self, rows)


@dataclass(frozen=True, kw_only=True)
class SampledLoop(Controlled):
    """A sampled position loop and its friction, at the motor shaft.

    Every number is an array of shape (draws,); scalars are broadcast to it. The other fields are
    those of :class:`Controlled`.

    Parameters
    ----------
    inertia : ndarray
        Inertia J of everything that turns with the shaft [kg·m²].
    viscous : ndarray
        b [N·m·s/rad].
    counts_per_revolution : ndarray
        Encoder counts per revolution of the shaft; 0: an encoder without steps.
    torque_limit : ndarray
        The command is clipped to ± this [N·m]; may be infinite.
    load_torque : ndarray
        Constant torque against the motor, less the feed-forward of the controller [N·m].
    compensation_signal : {"none", "reference", "measured", "error"}
        Signal whose sign the compensator follows: reference speed, measured speed, or
        measured position error.
    compensation_gain : ndarray
        γ, the share of the estimate that is fed forward [-].
    compensation_estimate : ndarray
        F̂, the estimate of the Coulomb torque [N·m].
    at_rest : {"off", "hold"}
        Compensation at exactly zero speed: none, or the last one. Does not apply to `error`.
    encoder_at : {"motor", "joint"}
        The end of the cable that is measured.
    cable : Cable or None
        Cable between motor and joint; None: a stiff cable.
    """

    inertia: Array
    viscous: Array
    counts_per_revolution: Array = field(default_factory=ZERO)
    torque_limit: Array = field(default_factory=ENDLESS)
    load_torque: Array = field(default_factory=ZERO)
    compensation_signal: CompensationSignal = "none"
    compensation_gain: Array = field(default_factory=ZERO)
    compensation_estimate: Array = field(default_factory=ZERO)
    at_rest: AtRest = "off"
    encoder_at: EncoderAt = "motor"
    cable: Cable | None = None

    def __post_init__(self) -> None:
        given = {
            number.name: np.asarray(getattr(self, number.name), dtype=np.float64)
            for number in fields(self)
            if number.name not in NO_NUMBERS
        }
        shape = np.broadcast_shapes((1,), *(value.shape for value in given.values()))
        for name, value in given.items():
            object.__setattr__(self, name, np.broadcast_to(value, shape))

    @property
    def draws(self) -> int:
        """Number of draws."""
        return self.inertia.size
