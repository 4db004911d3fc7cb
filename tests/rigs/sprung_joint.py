"""A load on a spring behind a joint in its controller's loop: a script of its own, two masses."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from rigs.joints import recording_of

STEPS = 16  # of the physics for each step of the controller


@dataclass
class SprungJoint:
    """Motor and load, each with mass and friction of its own; the motor's place is logged."""

    motor_inertia: float = 0.03
    load_inertia: float = 0.033
    motor_coulomb: float = 0.1
    load_coulomb: float = 0.1
    viscous: float = 0.047
    stiffness: float = 12.0
    damping_ratio: float = 0.05
    sampled_hz: float = 500.0
    count: float = 1e-4
    seconds: float = 15.0

    def samples(self, run="a", seed=1):
        """Return what is logged of a run."""
        rng = np.random.default_rng(seed)
        step = 1 / self.sampled_hz / STEPS
        rates = 2 * np.pi * np.array([0.23, 0.61, 1.17]) * rng.uniform(0.85, 1.2, 3)
        sizes, phases = np.array([0.8, 0.35, 0.1]), rng.uniform(0, 2 * np.pi, 3)
        times = np.arange(round(self.seconds * self.sampled_hz)) / self.sampled_hz
        angles = np.multiply.outer(times, rates) + phases
        goals, goal_speeds = np.sin(angles) @ sizes, np.cos(angles) @ (sizes * rates)
        place = behind = goals[0]
        speed = behind_speed = goal_speeds[0]
        damping = 2 * self.damping_ratio * np.sqrt(self.stiffness * self.load_inertia)
        before = round(place / self.count) * self.count
        counted, sent = np.empty((2, times.size))
        for sample, (goal, goal_speed) in enumerate(
            zip(goals.tolist(), goal_speeds.tolist(), strict=True)
        ):
            now = round(place / self.count) * self.count
            command = 40 * (goal - now) + 1.5 * (goal_speed - (now - before) * self.sampled_hz)
            before = now
            counted[sample], sent[sample] = now, command
            for _ in range(STEPS):
                pull = self.stiffness * (place - behind) + damping * (speed - behind_speed)
                push = command - pull - self.viscous * speed
                speed = rubbed(speed + step * push / self.motor_inertia, self._loss(step))
                behind_speed = rubbed(
                    behind_speed + step * pull / self.load_inertia,
                    step * self.load_coulomb / self.load_inertia,
                )
                place, behind = place + step * speed, behind + step * behind_speed
        return pd.DataFrame({"run": run, "time_s": times, "position_m": counted, "force_n": sent})

    def _loss(self, step):
        return step * self.motor_coulomb / self.motor_inertia

    def recording(self, runs=2):
        """Return a recording of some runs."""
        tables = [self.samples(f"r{run}", 1 + run) for run in range(runs)]
        return recording_of(pd.concat(tables, ignore_index=True), force_is="commanded")


def rubbed(speed, loss):
    """Return a speed that friction has lessened, to nothing at the most."""
    return 0.0 if abs(speed) <= loss else speed - np.sign(speed) * loss
