"""Inertias in a row on springs, each with friction of its own, in small steps; none of the package.

Semi-implicit Euler; friction takes speed off until none is left, and holds what it can hold.
"""

import math

import numpy as np


def run(
    inertia,
    friction,
    viscous,
    springs,
    dampers,
    *,
    kp,
    kd,
    period,
    delay,
    counts,
    kick,
    feed=0.0,
    speed=0.0,
    load=0.0,
    duration=2.0,
    steps=40,
    at_end=False,
    play=0.0,
    ki=0.0,
    stiction=1.0,
):
    """Return the errors of motor and joint at the samples, after a kick.

    The load hangs in the springs from the beginning; of the first, `play` is the whole width.
    The compensator feeds forward `feed` by the sign of the measured speed; `stiction` is what each
    of them withstands at rest over its friction.
    """  # fmt: skip
    ends, half = len(inertia), [play / 2] + [0.0] * (len(springs) - 1)
    dt, late = period / steps, round(delay / period * steps)
    x, v = [kick], [speed] * ends
    for spring, width in zip(springs, half, strict=True):
        x.append(x[-1] - load / spring - (math.copysign(width, load) if load else 0.0))
    if at_end:
        x = [position + kick - x[-1] for position in x]
    end, count = (-1 if at_end else 0), 2 * math.pi / counts
    seen = round((kick - speed * period) / count) * count
    waiting, torque, integral, errors = [], 0.0, 0.0, []
    for i in range(round(duration / dt)):
        if i % steps == 0:
            wanted = speed * i * dt
            errors.append((wanted - x[0], wanted - x[-1]))
            reading = round(x[end] / count) * count
            rate, seen = (reading - seen) / period, reading
            integral += (wanted - reading) * period
            command = kp * (wanted - reading) + kd * (speed - rate) + ki * integral
            waiting.append((i + late, command + feed * ((rate > 0) - (rate < 0))))
        while waiting and waiting[0][0] <= i:
            torque = waiting.pop(0)[1]
        pushes, before = [], torque
        for place, spring in enumerate(springs):
            gap = x[place] - x[place + 1]
            stretch = gap - min(max(gap, -half[place]), half[place])
            pull = spring * stretch
            if stretch:
                pull += dampers[place] * (v[place] - v[place + 1])
            pushes.append(before - pull)
            before = pull
        pushes.append(before - load)
        for place, push in enumerate(pushes):
            if v[place] == 0.0 and abs(push) <= stiction * friction[place]:
                continue
            free = v[place] + dt * (push - viscous[place] * v[place]) / inertia[place]
            after = max(abs(free) - dt * friction[place] / inertia[place], 0.0)
            after = math.copysign(after, free)
            v[place] = 0.0 if after * v[place] < 0 else after
            x[place] += dt * v[place]
    return np.array(errors).T
