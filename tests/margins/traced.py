"""The motion of a simulated loop, kept interval by interval."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from bayesfric.margins.simulating import simulate


@dataclass(frozen=True)
class Traces:
    """Times, positions and speeds at the beginning and after every interval of constant torque.

    Each of shape (intervals + 1, draws); the torque is that of the interval, (intervals, draws).
    """

    time: np.ndarray
    position: np.ndarray
    speed: np.ndarray
    torque: np.ndarray


def traced(loop, *, kick, reference_speed=0.0, **arguments):
    """Return what `simulate` returns, and its traces beside it."""
    start = [np.broadcast_to(value, loop.draws) for value in (0.0, kick, reference_speed)]
    intervals = []
    motion = simulate(loop, kick=kick, reference_speed=reference_speed, **arguments,
                      record=lambda *interval: intervals.append(interval))  # fmt: skip
    lengths, positions, speeds, torques = map(np.array, zip(*intervals, strict=True))
    along = (np.vstack([first, rest])
             for first, rest in zip(start, (lengths.cumsum(axis=0), positions, speeds),
                                    strict=True))  # fmt: skip
    return SimpleNamespace(**vars(motion), traces=Traces(*along, torques))
