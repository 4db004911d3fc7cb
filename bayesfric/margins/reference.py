"""References of a loop: position and speed at the sample times, over all draws."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from bayesfric.arrays import Array


@dataclass(frozen=True)
class ConstantSpeed:
    """Motion from 0 at constant speed.

    Parameters
    ----------
    value : ndarray, shape (draws,)
        The speed [rad/s].
    """

    value: Array

    def position(self, time: Array) -> Array:
        """Return where it is at some times [rad]."""
        return self.value * time

    def speed(self, time: Array) -> Array:
        """Return the speed [rad/s]."""
        return self.value


@dataclass(frozen=True)
class Stroke:
    """At rest at 0, then a step, a ramp that turns back, a sine, or their sum.

    Parameters
    ----------
    begin : ndarray, shape (draws,)
        Start of the motion [s].
    step : ndarray, shape (draws,)
        Height of the step [rad].
    ramp : ndarray, shape (draws,)
        Speed of the ramp [rad/s]; after the turn it is reversed.
    turn : ndarray, shape (draws,)
        Time of the turn after the start [s]; infinite without one.
    amplitude, omega : ndarray, shape (draws,)
        Amplitude and angular frequency of the sine [rad, rad/s].
    """

    begin: Array
    step: Array
    ramp: Array
    turn: Array
    amplitude: Array
    omega: Array

    def position(self, time: Array) -> Array:
        """Return where it is at some times [rad]."""
        since = np.maximum(time - self.begin, 0.0)
        there = np.minimum(since, self.turn)
        way = self.ramp * (2.0 * there - since) + self.amplitude * np.sin(self.omega * since)
        return np.asarray(way + np.where(time >= self.begin, self.step, 0.0))

    def speed(self, time: Array) -> Array:
        """Return the speed at the given times, without the step [rad/s]."""
        since = time - self.begin
        way = np.where(since < self.turn, self.ramp, -self.ramp)
        way = way + self.amplitude * self.omega * np.cos(self.omega * since)
        return np.where(since >= 0.0, way, 0.0)


Reference: TypeAlias = ConstantSpeed | Stroke
"""A trajectory for each draw; its times and results have the shape (draws,)."""
