"""Joints that lift a weight through a gear: their force follows from a chosen path.

Nothing is integrated, and nothing is shared with the package: the path is a sum of sines, and the
force is what inertia, gravity, friction of every kind and noise make of it.
"""

from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from bayesfric.recording import Axis, Recording, RigConstants


@dataclass
class LoadedJoint:
    """A joint with friction of the ladder M1 to M6, and how it is logged."""

    inertia: float = 0.06
    coulomb: float = 0.18
    viscous: float = 0.05
    offset: float = 0.0
    gravity: float = 1.0
    load: float = 0.0  # of |ℓ|
    driving: float = 0.0  # of |ℓ| where the joint drives its load
    load_at_rest: tuple = (0.0, 0.5)  # of |ℓ| at standstill, and the Stribeck speed
    load_square: float = 0.0
    stribeck: tuple = (0.0, 0.5)  # share of Coulomb friction, speed
    viscous_more: float = 0.0  # in the positive direction beyond the mean
    cubic: float = 0.0
    warm: float = 0.0  # share of friction from the coldest to the warmest
    stroke_rad: float = 1.2
    runs: int = 3
    seconds: float = 16.0
    sampled_hz: float = 200.0
    resolution: float = 1e-5
    noise: float = 0.004
    payloads: tuple = ()  # gravity of each run, over that of the first
    lifts_alone: bool = False  # moves to where the weight is lifted, at each pose
    seed: int = 1
    constants: dict = field(default_factory=lambda: {"force_is": "motor"})

    def run(self, number):
        """Return time, position, speed, acceleration of a run."""
        rng = np.random.default_rng([self.seed, number])
        time = np.arange(round(self.seconds * self.sampled_hz)) / self.sampled_hz
        if self.lifts_alone:
            return time, *self._lifted(time, rng), rng
        position, speed, acceleration = np.zeros((3, time.size))
        for rate, share in zip((0.17, 0.41, 0.9), (0.72, 0.22, 0.06), strict=True):
            rate = 2 * np.pi * rate * rng.uniform(0.85, 1.2)
            stroke = self.stroke_rad * share * rng.uniform(0.8, 1.2)
            phase = rate * time + rng.uniform(0, 2 * np.pi)
            position += stroke * np.sin(phase)
            speed += stroke * rate * np.cos(phase)
            acceleration -= stroke * rate**2 * np.sin(phase)
        return time, position, speed, acceleration, rng

    def _lifted(self, time, rng):
        """Return position, speed and acceleration of one way up, now quicker and now slower."""
        rate = 2 * np.pi * rng.uniform(0.3, 0.6)
        mean = 0.9 * self.stroke_rad / self.seconds
        size, phase = 0.8 * mean / rate, rate * time + rng.uniform(0, 2 * np.pi)
        position = 0.1 * self.stroke_rad + mean * time + size * (np.sin(phase) + 1)
        speed = mean + size * rate * np.cos(phase)
        return position, speed, -size * rate**2 * np.sin(phase)

    def samples(self, number, temperature):
        """Return the log of a run; `temperature` goes from 0 to 1 over the recording."""
        time, position, speed, acceleration, rng = self.run(number)
        heavy = self.payloads[number] if self.payloads else 1.0
        load = self.inertia * acceleration + heavy * self.gravity * np.sin(position)
        size, way = np.abs(speed), np.sign(speed)
        friction = self.coulomb + self.viscous * size + self.load * np.abs(load)
        friction += self.driving * np.maximum(load * way, 0.0)
        friction += self.load_at_rest[0] * np.abs(load) * np.exp(-size / self.load_at_rest[1])
        friction += self.load_square * load**2
        friction += self.coulomb * self.stribeck[0] * np.exp(-size / self.stribeck[1])
        friction += self.viscous_more * speed + self.cubic * size**3
        friction *= 1 + self.warm * (temperature - 0.5)
        force = load + way * friction + self.offset + self.noise * rng.standard_normal(time.size)
        table = pd.DataFrame(
            {
                "run": f"r{number}",
                "time_s": time,
                "position_m": self.resolution * np.round(position / self.resolution),
                "force_n": force,
            }
        )
        return table.assign(temperature_c=25 + 20 * temperature) if self.warm else table

    def recording(self):
        """Return a recording of all runs."""
        warming = np.linspace(0, 1, self.runs + 1)
        count = round(self.seconds * self.sampled_hz)
        samples_of_runs = [
            self.samples(
                number,
                4 * (share := np.linspace(*warming[number : number + 2], count)) * (1 - share),
            )
            for number in range(self.runs)
        ]
        runs = pd.DataFrame({"run": [f"r{number}" for number in range(self.runs)]})
        runs["order"] = np.arange(1, self.runs + 1)
        if self.payloads:
            runs["payload_kg"] = [heavy - 1.0 for heavy in self.payloads]
        rig = RigConstants(rotary=True, **self.constants)
        samples = pd.concat(samples_of_runs, ignore_index=True)
        return Recording(name="joint", title="A joint", rig=rig, axis=Axis(runs, samples))
