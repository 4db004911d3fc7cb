"""A motor and a joint on a cable, with friction at both ends, in small steps; none of the package.

Semi-implicit Euler; friction takes speed off until none is left, and holds what it can hold.
"""

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Plant:
    """Everything at the motor's shaft, SI; `stiffness` None is one stiff shaft."""

    motor_inertia: float
    load_inertia: float
    friction: float
    kp: float
    kd: float
    ki: float = 0.0
    viscous: float = 0.0
    joint_viscous: float = 0.0  # of it what acts at the joint's end
    stiction: float = 1.0
    falling: float = 0.0  # friction beyond it at rest, and the speed where 1/e of that is left
    falling_speed: float = 1.0
    stiffness: float | None = None
    damping: float = 0.0
    behind: float = 0.0  # share of the friction at the joint's end of the cable
    load: float = 0.0
    fed: float = 0.0  # what the controller feeds forward against it
    counts: float = 4000.0
    sample_time: float = 1e-3
    delay: float = 1e-3
    clip: float = math.inf
    signal: str = "none"
    feed: float = 0.0  # γ F̂
    play: float = 0.0  # between motor and cable, the whole width
    at_joint: bool = False  # where the encoder sits
    smooths: float = math.inf  # corner of a low-pass of the reading, rad/s


def run(plant, *, kick, speed, duration, steps=10, wound=0.0):
    """Return times and position errors of motor and joint at the samples, after a kick.

    `wound` is what the cable is twisted by at the beginning, besides what the load asks.
    """
    dt = plant.sample_time / steps
    late = round(plant.delay / dt)
    stiff = plant.stiffness is None
    inertia = [plant.motor_inertia + plant.load_inertia] if stiff else [
        plant.motor_inertia, plant.load_inertia]  # fmt: skip
    rub = [plant.friction] if stiff else [
        plant.friction * (1 - plant.behind), plant.friction * plant.behind]  # fmt: skip
    drag = [plant.viscous] if stiff else [
        plant.viscous - plant.joint_viscous, plant.joint_viscous]  # fmt: skip
    x, v = [kick] * len(inertia), [speed] * len(inertia)
    if not stiff:  # hangs in its cable from the beginning
        wound += plant.load / plant.stiffness + math.copysign(plant.play / 2, plant.load)
        wound -= 0.0 if plant.load else plant.play / 2
        x = [kick + wound, kick] if plant.at_joint else [kick, kick - wound]
    seen_end = -1 if plant.at_joint else 0
    fresh = 1.0 - math.exp(-plant.smooths * plant.sample_time)
    count = 2 * math.pi / plant.counts
    seen = round((kick - speed * plant.sample_time) / count) * count
    smooth = seen
    waiting, torque, integral, errors = [], plant.fed, 0.0, []
    for i in range(round(duration / dt)):
        if i % steps == 0:
            wanted = speed * i * dt
            errors.append((wanted - x[0], wanted - x[-1]))
            reading = round(x[seen_end] / count) * count
            rate, seen = (reading - seen) / plant.sample_time, reading
            before, smooth = smooth, smooth + fresh * (reading - smooth)
            error, used = wanted - smooth, (smooth - before) / plant.sample_time
            integral += error * plant.sample_time
            follows = {"none": 0.0, "reference": speed, "measured": rate}[plant.signal]
            command = plant.kp * error + plant.kd * (speed - used) + plant.ki * integral
            command += plant.feed * ((follows > 0) - (follows < 0))
            waiting.append((i + late, min(max(command, -plant.clip), plant.clip)))
        while waiting and waiting[0][0] <= i:
            torque = waiting.pop(0)[1] + plant.fed
        pull = 0.0
        if not stiff:
            gap = x[0] - x[1]
            if abs(gap) > plant.play / 2:
                pull = plant.stiffness * (gap - math.copysign(plant.play / 2, gap))
                pull += plant.damping * (v[0] - v[1])
        ends = [torque - plant.load] if stiff else [torque - pull, pull - plant.load]
        for end, push in enumerate(ends):
            more = 1 + plant.falling / plant.friction * math.exp(-abs(v[end]) / plant.falling_speed)
            if v[end] == 0 and abs(push) <= rub[end] * more * plant.stiction:
                continue
            free = v[end] + dt * (push - drag[end] * v[end]) / inertia[end]
            after = math.copysign(max(abs(free) - dt * rub[end] * more / inertia[end], 0.0), free)
            v[end] = 0.0 if after * v[end] < 0 else after
            x[end] += dt * v[end]
    times = np.arange(len(errors)) * plant.sample_time
    return times, *np.array(errors).T


def sticks_and_slips(times, error):
    """Tell whether the second half swings by over a count either way, and how often."""
    late = error[times.size // 2 :]
    crossings = np.flatnonzero(np.diff(np.sign(late - late.mean())) != 0)
    frequency = (crossings.size - 1) / 2 / (times[-1] / 2) if crossings.size > 2 else 0.0
    return np.ptp(late) > 2 * 2 * np.pi / 4000, frequency


def of(shaft, **changes):
    """Return the plant of the first draw of a loop at its shaft."""
    usual = {
        "motor_inertia": shaft.motor_inertia[0],
        "load_inertia": shaft.load_inertia[0],
        "friction": shaft.friction[0],
        "kp": shaft.kp[0],
        "kd": shaft.kd[0],
        "ki": shaft.ki[0],
        "viscous": shaft.viscous[0],
        "stiction": shaft.stiction_ratio[0],
        "falling": shaft.falling[0],
        "falling_speed": shaft.falling_speed[0],
        "clip": shaft.clip[0],
        "signal": shaft.loop.compensation.signal,
        "feed": shaft.gamma[0] * shaft.estimate[0],
    }
    return Plant(**{name: value if isinstance(value, str) else float(value)
                    for name, value in (usual | changes).items()})  # fmt: skip


def elastic(shaft, **changes):
    """Return the plant of the first draw with its cable, the friction behind it and its load."""
    load = float(shaft.load_torque[0])
    behind = shaft.lost_motion * shaft.stiffness
    if shaft.backlash[0] > 0:
        behind = shaft.friction - shaft.drive_friction
    usual = {
        "stiffness": float(shaft.stiffness[0]),
        "damping": float(shaft.damping[0]),
        "behind": float((behind / shaft.friction)[0]),
        "play": float(shaft.backlash[0]),
        "at_joint": shaft.loop.controller.encoder_at == "joint",
        "smooths": float(shaft.position_cutoff[0]),
        "joint_viscous": float(shaft.load_viscous[0]),
        "load": load,
        "fed": load - float(shaft.net_load[0]),
        "delay": float(shaft.delay[0]),
    }
    return of(shaft, **(usual | changes))
