"""A joint inside its digital controller, as it is logged: counts, holds, jitter, delays.

The joint is integrated in small steps; friction is an impulse that brings it to rest or slows it.
It shares no code with the package.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from rigs.joints import recording_of

STEP_S = 2.5e-4  # of the physics


@dataclass
class LoopedJoint:
    """A weight on a joint, its controller and its telemetry; see the fields.

    `stiffness` and `damping` are the gains [N·m/rad, N·m s/rad] on what the encoder counted; with
    `closed` False the drive follows no position at all. `count` is the encoder's [rad]. `late_s`
    is how long after its logged time a force acts, `held` the samples for which telemetry
    repeats both readings, `force_held` those for which it repeats the force alone.
    """

    inertia: float = 0.063
    coulomb: float = 0.18
    viscous: float = 0.047
    gravity: float = 1.0
    limit: float = np.inf
    sampled_hz: float = 500.0
    count: float = 1e-4
    closed: bool = True
    stiffness: float = 40.0
    damping: float = 1.5
    amplitude: float = 1.0
    pushed: float = 0.0  # rms of a slow torque that nobody logged [N·m]
    waits: int = 0  # samples from a reading to the command that it makes
    seconds: float = 15.0
    noise: float = 0.0  # of the logged force [N·m]
    jitter: float = 0.0  # of the interval
    late_s: float = 0.0
    held: int = 1
    force_held: int = 1

    def motion(self, seed):
        """Return times, counted positions and commands, each of shape (N,)."""
        rng = np.random.default_rng(seed)
        steps = max(1, round(1 / self.sampled_hz / STEP_S))
        step = 1 / self.sampled_hz / steps
        rates = 2 * np.pi * np.array([0.23, 0.61, 1.17]) * rng.uniform(0.85, 1.2, 3)
        sizes = self.amplitude * np.array([0.8, 0.35, 0.1])
        phases = rng.uniform(0, 2 * np.pi, 3)
        times = np.arange(round(self.seconds * self.sampled_hz)) / self.sampled_hz
        angles = np.multiply.outer(times, rates) + phases
        goals, goal_speeds = np.sin(angles) @ sizes, np.cos(angles) @ (sizes * rates)
        pushes = self._pushes(times.size, rng)
        place, speed = (goals[0], goal_speeds[0]) if self.closed else (0.0, 0.0)
        before = round(place / self.count) * self.count
        waiting = [0.0] * self.waits
        counted, sent = np.empty((2, times.size))
        for sample, (goal, goal_speed, push) in enumerate(
            zip(goals.tolist(), goal_speeds.tolist(), pushes.tolist(), strict=True)
        ):
            now = round(place / self.count) * self.count
            command = 1.1 * goal
            if self.closed:
                seen_speed = (now - before) * self.sampled_hz
                command = self.stiffness * (goal - now) + self.damping * (goal_speed - seen_speed)
            before = now
            counted[sample], sent[sample] = now, command
            waiting.append(command)
            acting = min(max(waiting.pop(0), -self.limit), self.limit) + push
            for _ in range(steps):
                force = acting - self.gravity * np.sin(place) - self.viscous * speed
                speed += step * force / self.inertia
                rubbed = step * self.coulomb / self.inertia
                speed = 0.0 if abs(speed) <= rubbed else speed - np.sign(speed) * rubbed
                place += step * speed
        return times, counted, sent

    def _pushes(self, count, rng):
        """Return a torque that goes with a time constant of 0.1 s, shape (N,)."""
        kept = np.exp(-1 / (0.1 * self.sampled_hz))
        pushes, value = np.zeros(count), 0.0
        if self.pushed:
            for sample, drawn in enumerate(rng.standard_normal(count)):
                value = kept * value + self.pushed * np.sqrt(1 - kept**2) * drawn
                pushes[sample] = value
        return pushes

    def samples(self, run="a", seed=1):
        """Return what is logged of a run."""
        times, counted, sent = self.motion(seed)
        rng = np.random.default_rng(seed + 1000)
        force = np.interp(times + self.late_s, times, sent) if self.late_s else sent
        force = force + self.noise * rng.standard_normal(times.size)
        held, every = np.arange(times.size) // self.held * self.held, self.held * self.force_held
        stamps = times + self.jitter / self.sampled_hz * rng.uniform(-0.5, 0.5, times.size)
        return pd.DataFrame(
            {
                "run": run,
                "time_s": np.sort(stamps),
                "position_m": counted[held],
                "force_n": force[np.arange(times.size) // every * every],
            }
        )

    def recording(self, runs=2, first_seed=1, **rig):
        """Return a recording of some runs; what is told of the rig goes with it."""
        tables = [self.samples(f"r{run}", first_seed + run) for run in range(runs)]
        return recording_of(
            pd.concat(tables, ignore_index=True), **{"force_is": "commanded", **rig}
        )
