"""A hobby servo as LeRobot logs it: the position that it was told, and where it is.

The joint is integrated in small steps under what its own controller gives; friction is an impulse
that brings it to rest or slows it. It shares no code with the package.
"""

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayesfric.recording import Axis, Recording, RigConstants

STEP_S = 2e-4
COUNT = 2 * np.pi / 4096
G = 9.80665


@dataclass(frozen=True)
class Servo:
    """A servo with an arm; see the fields.

    `stiffness` is the controller's gain [N·m/rad], `damping` all that goes with the speed: its
    own, viscous friction and back-EMF [N·m s/rad]. `gravity` is the weight of the arm times its
    length [N·m], at rest at `hangs` [rad]. A payload is held at `arm` [m]. `late_s` passes from a
    command in the log to what is made of it. Friction differs along the path, by `uneven` rms.
    """

    stiffness: float = 18.0
    inertia: float = 0.03
    coulomb: float = 0.3
    damping: float = 0.6
    gravity: float = 0.0
    hangs: float = 0.2
    arm: float = 0.25
    late_s: float = 0.015
    rate_hz: float = 60.0
    seconds: float = 30.0
    band_hz: float = 0.8
    amplitude: float = 0.7
    uneven: float = 0.02

    def run(self, seed, payload_kg=0.0):
        """Return times, commands as they were held, and counted positions, (N,) each."""
        rng = np.random.default_rng(seed)
        times = np.arange(round(self.seconds * self.rate_hz)) / self.rate_hz
        rates = 2 * np.pi * self.band_hz * np.array([0.25, 0.6, 1.0]) * rng.uniform(0.85, 1.15, 3)
        sizes = self.amplitude * np.array([0.75, 0.35, 0.12])
        angles = np.multiply.outer(times, rates) + rng.uniform(0, 2 * np.pi, 3)
        commands = np.round(np.sin(angles) @ sizes / COUNT) * COUNT
        step = 1 / self.rate_hz / (steps := max(1, round(1 / self.rate_hz / STEP_S)))
        inertia = self.inertia + payload_kg * self.arm**2
        weight = self.gravity + payload_kg * G * self.arm
        fine = (np.arange(times.size * steps) + 0.5) * step
        held = commands[np.clip(np.floor((fine - self.late_s) * self.rate_hz), 0, None).astype(int)]
        place, speed = float(commands[0]), 0.0
        rub, read = step * self.coulomb / inertia, np.empty(times.size)
        waves = rng.uniform((6, 0.2, 0), (50, 1, 2 * np.pi), (5, 3)).tolist()
        high = self.uneven * math.sqrt(2 / sum(size**2 for _, size, _ in waves))
        kept = 1 / (1 + step * self.damping / inertia)
        held = held.reshape(times.size, steps).tolist()
        for sample, of_sample in enumerate(held):
            read[sample] = place
            for goal in of_sample:
                force = self.stiffness * (goal - place) - weight * math.sin(place - self.hangs)
                uneven = sum(size * math.sin(rate * place + start) for rate, size, start in waves)
                rubbed = rub * (1 + high * uneven)
                pushed = speed + step * force / inertia
                if abs(pushed) <= rubbed:
                    speed = 0.0
                else:
                    speed = (pushed - math.copysign(rubbed, pushed)) * kept
                place += step * speed
        return times, commands, np.round(read / COUNT) * COUNT

    def recording(self, seed=1, payloads=(0.0, 0.0), **rig):
        """Return a log of commands, a run a payload; what is told of the rig goes with it."""
        tables, runs = [], []
        for number, payload in enumerate(payloads):
            times, commands, read = self.run(1000 * seed + number, payload)
            name = f"r{number}"
            log = {"run": name, "time_s": times, "position_m": read, "command_m": commands}
            tables.append(pd.DataFrame(log).round(9))
            runs.append({"run": name, "order": number + 1, "payload_kg": payload})
        table = pd.DataFrame(runs)
        if not any(payloads):
            table = table.drop(columns="payload_kg")
        constants = RigConstants(**{"rotary": True, "encoder_resolution": COUNT, **rig})
        axis = Axis(table, pd.concat(tables, ignore_index=True))
        return Recording("servo", "A servo", constants, axis=axis)
