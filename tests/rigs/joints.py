"""Joints whose force follows from a chosen path: inertia, gravity, friction and noise.

Nothing is integrated: the path is a sum of sines, and the force what the motion takes.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayesfric.recording import Axis, Recording, RigConstants


@dataclass
class Joint:
    """A joint, its path and how it is logged."""

    inertia: float = 0.06
    coulomb: float = 0.18
    viscous: float = 0.05
    gravity: float = 1.0
    drag: float = 0.0  # with the square of the speed [N·m s²/rad²]
    rates_hz: tuple = (0.31, 0.83)
    strokes_rad: tuple = (1.0, 0.35)
    seconds: float = 20.0
    sampled_hz: float = 200.0
    resolution: float = 1e-5
    noise: float = 0.005
    held: int = 1
    force_is: str = "measured"
    seed: int = 1

    def samples(self, run="a"):
        """Return what is logged of a run."""
        rng = np.random.default_rng(self.seed)
        time = np.arange(round(self.seconds * self.sampled_hz)) / self.sampled_hz
        position, speed, acceleration = np.zeros((3, time.size))
        for rate, stroke in zip(self.rates_hz, self.strokes_rad, strict=True):
            phase = 2 * np.pi * rate * time + rng.uniform(0, 2 * np.pi)
            position += stroke * np.sin(phase)
            speed += stroke * 2 * np.pi * rate * np.cos(phase)
            acceleration -= stroke * (2 * np.pi * rate) ** 2 * np.sin(phase)
        force = self.inertia * acceleration + self.gravity * np.sin(position)
        force += np.sign(speed) * self.coulomb + self.viscous * speed
        force += self.drag * speed * np.abs(speed)
        force += self.noise * rng.standard_normal(time.size)
        last = np.arange(time.size) // self.held * self.held
        table = pd.DataFrame(
            {
                "run": run,
                "time_s": time,
                "position_m": self.resolution * np.round(position / self.resolution),
                "force_n": force,
            }
        )
        held = ["position_m", "force_n"]
        return table.assign(**{name: table[name].to_numpy()[last] for name in held})

    def recording(self):
        """Return a recording of one run."""
        return recording_of(self.samples(), force_is=self.force_is)


def recording_of(samples, runs=None, **constants):
    """Return a recording of a rotary axis."""
    if runs is None:
        runs = pd.DataFrame({"run": samples["run"].unique()})
        runs["order"] = np.arange(1, len(runs) + 1)
    rig = RigConstants(rotary=True, **constants)
    return Recording(name="joint", title="A joint", rig=rig, axis=Axis(runs, samples))
