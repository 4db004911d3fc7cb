"""The motion of a simulated loop, kept interval by interval."""

from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array


@dataclass(frozen=True)
class Traces:
    """Positions, speeds and torques at the beginning and after every interval of constant torque.

    Parameters
    ----------
    time : ndarray, shape (intervals + 1, draws)
        Since the kick [s].
    position, speed : ndarray, shape (intervals + 1, draws)
        Of the shaft [rad, rad/s].
    torque : ndarray, shape (intervals, draws)
        What the motor applied in each interval [N·m].
    """

    time: Array
    position: Array
    speed: Array
    torque: Array


class Record:
    """A recorder of traces.

    Parameters
    ----------
    position, speed : ndarray, shape (draws,)
        At the beginning [rad, rad/s].
    """

    def __init__(self, position: Array, speed: Array) -> None:
        self._lengths: list[Array] = []
        self._torques: list[Array] = []
        self._positions, self._speeds = [position], [speed]

    def add(self, length: Array, position: Array, speed: Array, torque: Array) -> None:
        """Record the end of an interval of constant torque.

        Parameters
        ----------
        length : ndarray, shape (draws,)
            Its duration [s].
        position, speed : ndarray, shape (draws,)
            At its end [rad, rad/s].
        torque : ndarray, shape (draws,)
            What the motor applied [N·m].
        """
        self._lengths.append(length)
        self._positions.append(position)
        self._speeds.append(speed)
        self._torques.append(torque)

    def traces(self) -> Traces:
        """Return the recorded traces.

        Returns
        -------
        Traces
            Of all intervals.
        """
        lengths = np.array(self._lengths)
        time = np.concatenate([np.zeros((1, lengths.shape[1])), lengths.cumsum(axis=0)])
        return Traces(
            time, np.array(self._positions), np.array(self._speeds), np.array(self._torques)
        )
