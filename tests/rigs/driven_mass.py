"""A driven mass, simulated by a script that shares no code with the package.

A digital controller follows a reference with the position that a quantised encoder showed two
milliseconds ago. Friction is an impulse that brings the mass to rest or slows it, step by step.
All runs are simulated side by side, a column each.
"""

import json
from collections import deque
from dataclasses import dataclass, field
from functools import cache

import numpy as np
import pandas as pd

STEPS = 4  # of the physics for each step of the controller


@dataclass
class Machine:
    """Numbers of a machine; what it has beside mass and friction is 0 or None."""

    mass: float = 2.0
    coulomb: float = 1.5
    resolution: float = 5e-6
    noise: float = 2e-6
    bandwidth_hz: float = 6.0
    control_hz: float = 1000.0
    loop_delay_s: float = 2e-3
    wander: float = 0.01
    wander_length: float = 0.03
    one_path: bool = False  # friction wanders alike in all runs
    run_scatter: float = 0.01
    stroke: float = 0.15
    top_speed: float = 0.6
    viscous: float = 0.0
    air_drag: float = 0.0
    stribeck: tuple = (0.0, 0.05)
    slowly: bool = False  # the Stribeck term dies out as 1 / (1 + v²), not as exp(−v²)
    worn: tuple = (0.0, 0.02, 0.01)  # more friction at a place: share, place, width
    presliding: tuple = (0.0, 0.002)
    bias: float = 0.0
    payload: float = 0.0
    spring: float = 0.0
    gravity: tuple = (0.0, 0.0)
    cogging: tuple = (0.0, 0.02, 0.0)
    backlash: float = 0.0
    compliance: tuple = None  # stiffness, damping ratio, share of the mass at the motor
    delay_s: float = 0.0
    lag_s: float = 0.0
    limit: float = np.inf
    drift: float = 0.0
    asymmetry: float = 0.0
    test_runs: tuple = field(default=())
    in_time: object = None  # more friction, a share by time [s]
    in_speed: object = None  # more friction, a share by speed [m/s]


def reference(machine, time, runs, rng):
    """Return smooth references, (samples, runs), and their speeds and accelerations."""
    q = np.zeros((time.size, runs))
    v, a = np.zeros_like(q), np.zeros_like(q)
    for run in range(runs):
        rates = 2 * np.pi * np.array([0.23, 0.57, 1.3]) * rng.uniform(0.8, 1.25, 3)
        share = np.array([0.7, 0.25, 0.05]) * rng.uniform(0.7, 1.3, 3)
        size = share * machine.stroke
        phase = rng.uniform(0, 2 * np.pi, 3)
        speed = np.abs(size * rates).sum()
        size *= min(1.0, machine.top_speed * rng.uniform(0.5, 1.0) / speed)
        angle = np.multiply.outer(time, rates) + phase
        q[:, run] = (np.sin(angle) * size).sum(axis=1)
        v[:, run] = (np.cos(angle) * size * rates).sum(axis=1)
        a[:, run] = -(np.sin(angle) * size * rates**2).sum(axis=1)
    return q, v, a


@cache
def root_along(stroke, length):
    """Return places, and a root of the covariance of what wanders along them."""
    at = np.linspace(-3 * stroke, 3 * stroke, 2001)
    shape = np.exp(-0.5 * ((at[:, None] - at) / length) ** 2)
    values, vectors = np.linalg.eigh(shape)
    kept = values > 1e-6 * values[-1]
    return at, vectors[:, kept] * np.sqrt(values[kept])


def wandering(machine, runs, rng):
    """Return for each run a smooth random function of position."""
    at, root = root_along(machine.stroke, machine.wander_length)
    drawn = rng.standard_normal((root.shape[1], 1 if machine.one_path else runs))
    return at, np.broadcast_to(root @ drawn, (at.size, runs))


def simulate(machine, *, runs=6, seconds=12.0, log_hz=None, seed=0):
    """Return runs and samples of a recording, as tables."""
    rng = np.random.default_rng(seed)
    control = 1 / machine.control_hz
    step = control / STEPS
    count = int(seconds / control)
    time = control * np.arange(count)
    goal, goal_v, goal_a = reference(machine, time, runs, rng)
    at, wander = wandering(machine, runs, rng)
    spacing = at[1] - at[0]
    scatter = 1 + machine.run_scatter * rng.standard_normal(runs)
    scatter = scatter * (1 + machine.drift * (np.linspace(0, 1, runs) - 0.5))
    mass = np.full(runs, machine.mass)
    for run in machine.test_runs:
        mass[run] += machine.payload
    omega = 2 * np.pi * machine.bandwidth_hz
    kp, kd = machine.mass * omega**2, 1.4 * machine.mass * omega
    q, v = goal[0].copy(), goal_v[0].copy()
    turned, way = q.copy(), np.sign(v)  # where the motion last turned, and which way it goes
    load_q, load_v = q.copy(), v.copy()
    lagged = np.zeros(runs)
    ago = round(machine.loop_delay_s / control)
    late = round(machine.delay_s / step)
    seen = deque([q.copy()] * (ago + 2), maxlen=ago + 2)
    sent = deque([np.zeros(runs)] * (late + 1), maxlen=late + 1)
    logged_q, logged_f = np.empty((count, runs)), np.empty((count, runs))
    columns = np.arange(runs)
    smooth_v = goal_v[0].copy()

    # What a machine lacks is left out: it would multiply by one, or add nothing, in every step.
    low_at, last_at = at[0], at.size - 1.001

    def friction_at(q, v, way, turned, now):
        place = np.minimum(np.maximum((q - low_at) / spacing, 0), last_at)
        low = place.astype(int)
        part = place - low
        varied = wander[low, columns] * (1 - part) + wander[low + 1, columns] * part
        size = machine.coulomb
        if machine.asymmetry:
            size = size * (1 + machine.asymmetry * way)
        rise, speed = machine.stribeck
        if rise:
            dying = 1 / (1 + (v / speed) ** 2) if machine.slowly else np.exp(-((v / speed) ** 2))
            size = size * (1 + rise * dying)
        more, place, width = machine.worn
        if more:
            size = size * (1 + more * np.exp(-0.5 * ((q - place) / width) ** 2))
        if machine.in_time is not None:
            size = size * (1 + machine.in_time(now))
        if machine.in_speed is not None:
            size = size * (1 + machine.in_speed(np.abs(v)))
        missing, length = machine.presliding
        if missing:
            size = size * (1 - missing * np.exp(-np.abs(q - turned) / length))
        friction = scatter * size * (1 + machine.wander * varied)
        if machine.viscous:
            friction = friction + machine.viscous * np.abs(v) * (1 + machine.asymmetry * way)
        return friction

    def external(q):
        torque, phase = machine.gravity
        amount, period, offset = machine.cogging
        force = machine.bias
        if machine.spring:
            force = force + machine.spring * q
        if torque:
            force = force + torque * np.sin(q + phase)
        if amount:
            force = force + amount * np.sin(2 * np.pi * q / period + offset)
        return force

    for k in range(count):
        read = q + machine.noise * rng.standard_normal(runs)
        read = machine.resolution * np.round(read / machine.resolution)
        seen.append(read)
        past, before = seen[1], seen[0]
        smooth_v += 0.3 * ((past - before) / control - smooth_v)
        force = (
            machine.mass * goal_a[k]
            + kp * (goal[k] - past)
            + kd * (goal_v[k] - smooth_v)
            + 0.7 * machine.coulomb * np.tanh(goal_v[k] / 0.02)
        )
        logged_q[k], logged_f[k] = read, force
        for _ in range(STEPS):
            sent.append(force)
            acting = np.minimum(np.maximum(sent[0], -machine.limit), machine.limit)
            if machine.lag_s:
                lagged += step / machine.lag_s * (acting - lagged)
                acting = lagged
            if machine.compliance is None and not machine.backlash:
                push = acting - external(q) - machine.air_drag * v * np.abs(v)
                free = v + step * push / mass
                lost = step * friction_at(q, v, way, turned, time[k]) / mass
                v = np.sign(free) * np.maximum(np.abs(free) - lost, 0.0)
                q = q + step * v
            else:
                stiffness, damping, at_motor = machine.compliance or (4e5, 0.05, 0.3)
                motor, load = at_motor * mass, (1 - at_motor) * mass
                stretch = q - load_q
                half = machine.backlash / 2
                stretch = np.sign(stretch) * np.maximum(np.abs(stretch) - half, 0.0)
                touch = stretch != 0 if machine.backlash else True
                rate = 2 * damping * np.sqrt(stiffness * load) * (v - load_v) * touch
                link = stiffness * stretch + rate
                v = v + step * (acting - link) / motor
                free = load_v + step * (link - external(load_q)) / load
                lost = step * friction_at(load_q, load_v, way, turned, time[k]) / load
                load_v = np.sign(free) * np.maximum(np.abs(free) - lost, 0.0)
                q, load_q = q + step * v, load_q + step * load_v
            sense = np.sign(v)
            turns = (sense != way) & (v != 0)
            if turns.any():
                turned = np.where(turns, q, turned)
                way = np.where(turns, sense, way)
    every = 1 if log_hz is None else round(machine.control_hz / log_hz)
    names = [f"r{run:02d}" for run in range(runs)]
    samples = pd.DataFrame(
        {
            "run": np.repeat(names, time[::every].size),
            "time_s": np.tile(time[::every], runs).round(6),
            "position_m": logged_q[::every].T.ravel().round(9),
            "force_n": logged_f[::every].T.ravel().round(6),
        }
    )
    table = pd.DataFrame({"run": names, "order": np.arange(1, runs + 1)})
    if machine.test_runs:
        table["role"] = ["test" if run in machine.test_runs else "calibrate" for run in range(runs)]
    return table, samples


def write(folder, machine, table, samples, **rig):
    """Write a recording as a person would, with a script of one's own."""
    folder.mkdir(parents=True)
    table.to_csv(folder / "axis_runs.csv", index=False)
    samples.to_csv(folder / "axis_samples.csv", index=False)
    package = {
        "name": folder.name,
        "title": "A simulated axis",
        "resources": [
            {"name": "axis-runs", "path": "axis_runs.csv"},
            {"name": "axis-samples", "path": "axis_samples.csv"},
        ],
        "rig": {"encoder_resolution": machine.resolution, "force_is": "commanded", **rig},
    }
    (folder / "datapackage.json").write_text(json.dumps(package))
    return folder
