"""What a loop is told to follow: position and speed at the sample times, over all draws."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from bayesfric.arrays import Array


class Reference(Protocol):
    """A trajectory, a draw each; times and what it returns are of shape (draws,)."""

    def position(self, time: Array) -> Array:
        """Return where it is at some times [rad]."""
        ...

    def speed(self, time: Array) -> Array:
        """Return how fast it moves there [rad/s]."""
        ...


@dataclass(frozen=True)
class ConstantSpeed:
    """From 0 on at one speed.

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
        When it sets off [s].
    step : ndarray, shape (draws,)
        By which it is ahead from then on [rad].
    ramp : ndarray, shape (draws,)
        Its speed [rad/s], and back at the same after the turn.
    turn : ndarray, shape (draws,)
        How long after setting off that is [s]; infinite without one.
    amplitude, omega : ndarray, shape (draws,)
        Of a sine [rad, rad/s].
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
        """Return how fast it moves there, a step apart [rad/s]."""
        since = time - self.begin
        way = np.where(since < self.turn, self.ramp, -self.ramp)
        way = way + self.amplitude * self.omega * np.cos(self.omega * since)
        return np.where(since >= 0.0, way, 0.0)
