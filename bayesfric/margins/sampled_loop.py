"""A sampled position loop of a motor shaft with friction, as the simulator takes it."""

from dataclasses import dataclass, fields, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.arrays import Array, Whole, taken
from bayesfric.margins.elastic_cable import Cable, EncoderAt

CompensationSignal = Literal["none", "reference", "measured", "error"]
AtRest = Literal["off", "hold"]

_CUTOFFS = ("velocity_cutoff", "position_cutoff")
_POSITIVE = ("inertia", "sample_time", "torque_limit", *_CUTOFFS, "falling_speed")
_SIGNED = ("kp", "kd", "ki", "load_torque")
_MAY_BE_INFINITE = ("torque_limit", *_CUTOFFS)
_CHOICES = {
    "compensation_signal": ("none", "reference", "measured", "error"),
    "at_rest": ("off", "hold"),
    "encoder_at": ("motor", "joint"),
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
        Breakaway torque over that of friction at the lowest speed, at least 1 [-].
    falling, falling_speed : array_like
        Friction beyond F at the lowest speed, and the speed at which it has fallen to 1/e of
        that [N·m, rad/s].
    counts_per_revolution : array_like
        Encoder counts a revolution of the shaft; 0 is an encoder without steps.
    torque_limit : array_like
        The command is clipped to ± this [N·m]; may be infinite.
    velocity_cutoff : array_like
        Corner of the low-pass that the derivative's speed goes through; infinite without
        one [rad/s].
    position_cutoff : array_like
        Corner of the low-pass that the measured position goes through; infinite without one
        [rad/s].
    load_torque : array_like
        Constant torque against the motor, less what the controller is told to hold [N·m].
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
    encoder_at : {"motor", "joint"}
        Which end of the cable is measured.
    cable : Cable or None
        Between motor and joint; None is a stiff one.

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
    falling: ArrayLike = 0.0
    falling_speed: ArrayLike = 1.0
    counts_per_revolution: ArrayLike = 0.0
    torque_limit: ArrayLike = np.inf
    velocity_cutoff: ArrayLike = np.inf
    position_cutoff: ArrayLike = np.inf
    load_torque: ArrayLike = 0.0
    compensation_signal: CompensationSignal = "none"
    compensation_gain: ArrayLike = 0.0
    compensation_estimate: ArrayLike = 0.0
    boundary: ArrayLike = 0.0
    at_rest: AtRest = "off"
    encoder_at: EncoderAt = "motor"
    cable: Cable | None = None

    def __post_init__(self) -> None:
        for name, choices in _CHOICES.items():
            if getattr(self, name) not in choices:
                raise ValueError(f"{name}: expected one of {choices}, got {getattr(self, name)!r}")
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
            if name not in _MAY_BE_INFINITE:
                wrong = wrong | np.isinf(value)
            if wrong.any():
                raise ValueError(f"{name}: expected {expected}, got {value[wrong].flat[0]}")
        # One may stand for all.
        if len(lengths - {1}) > 1:
            raise ValueError(f"expected one number of draws, got {sorted(lengths)}")

    @classmethod
    def numbers(cls) -> tuple[str, ...]:
        """Return the names of the fields that hold a number a draw."""
        others = (*_CHOICES, "cable")
        return tuple(field.name for field in fields(cls) if field.name not in others)

    @property
    def breakaway(self) -> Array:
        """Torque that a shaft at rest withstands, shape (draws,) [N·m]."""
        return (self.array("friction") + self.array("falling")) * self.array("stiction_ratio")

    @property
    def draws(self) -> int:
        """Number of draws; 1 where every field is a scalar."""
        return max(np.size(getattr(self, name)) for name in self.numbers())

    def taken(self, index: Whole) -> "SampledLoop":
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
        numbers: dict[str, Any] = {name: self.array(name)[index] for name in self.numbers()}
        return replace(self, cable=taken(self.cable, index), **numbers)

    def array(self, name: str) -> Array:
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

    def per_draw(self, name: str, value: ArrayLike) -> Array:
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
