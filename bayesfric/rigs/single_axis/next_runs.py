"""Runs that the axis could make next: recorded paths again, and others over the same range.

Each run gives four paths, and each path is run at several speeds. A path is a spline, so that
its speed and acceleration are known in closed form. The drive force is what the law takes for
it, with what pulled at each place of what was recorded, as a weight does. No run leaves the
positions of the run that it is made of or takes longer, and none but a recorded run again asks
for a larger drive force than was seen.
"""

from collections.abc import Collection, Mapping
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import scipy

from bayesfric.arrays import Array, evenly
from bayesfric.observation.feasible import numbered
from bayesfric.physics.axis import AxisLaw
from bayesfric.recording.tables import Axis, RigConstants
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.readings import Readings, readings_of
from bayesfric.rigs.single_axis.rough import places_of, pull_basis
from bayesfric.rigs.single_axis.simulated import log_of

SETTINGS = ("run", "path", "velocity_m_s", "duration_s", "drive_force_n")
OF_ROTARY = ("run", "path", "velocity_rad_s", "duration_s", "drive_torque_n_m")
"""What is said of a run, in units of an axis that slides and of a joint that turns."""
ROUND = {"at a steady speed": 0.5, "sine": 50.0}  # by how a path there and back turns
RUNS = 3  # of each role: the slowest, the fastest and one between them
SPEEDS = 5  # beside that of the run itself
LEAST = 4.0  # half windows that a run has at the least
SLOWEST = 0.25  # of the slowest run's top speed, which every axis can do


def settings_of(rig: RigConstants) -> tuple[str, ...]:
    """Return the columns of a run that is laid out, by whether the machine turns."""
    return OF_ROTARY if rig.rotary else SETTINGS


def lay_out(
    axis: Axis, moved: Collection[str], rig: RigConstants, like: Readings, law: AxisLaw
) -> tuple[pd.DataFrame, Readings] | None:
    """Return feasible runs, one a trial and assembly, and their rows; None where none has any.

    Top speeds lie within ``rig.limits.velocity_m_s``, without it at most at the highest that
    was recorded.

    Parameters
    ----------
    axis : Axis
        What was recorded.
    moved : collection of str
        Runs in which the axis moves.
    rig : RigConstants
        The machine.
    like : Readings
        Rows of what was recorded, whose windows and noise those of the runs have.
    law : AxisLaw
        That says what drive force a path takes.
    """
    read = {str(run): log_of(samples, rig) for run, samples in axis.samples.groupby("run")}
    logs = {run: log for run, log in read.items() if log is not None and run in moved}
    own = {run: _spline(log, log.position, like.half_s) for run, log in logs.items()}
    tops = {run: _top(path) for run, path in own.items()}
    most, pull = float(np.abs(like.drive).max()), _Pull.of(like, law)
    speeds = _speeds(tops, rig)
    made, rows = [], []
    for run in _chosen(axis.runs, tops):
        name = str(run["run"])
        paths = _paths(logs[name], own[name], like.half_s, speeds[-1])
        for (kind, path), speed in product(paths.items(), sorted({*speeds, tops[name]})):
            log = _faster(path, speed / _top(path), logs[name], law, pull)
            length = log.time_s.size * log.interval_s
            peak = float(np.abs(log.force).max())
            again = kind == "as recorded" and speed == tops[name]
            inside = again or (speeds[0] <= speed <= speeds[-1] and peak <= most)
            if inside and length >= LEAST * like.half_s:
                made.append(log)
                settings = (name, kind, speed, length, peak)
                rows.append(run | dict(zip(settings_of(rig), settings, strict=True)))
    if not made:
        return None
    starts = [np.zeros(1, dtype=np.intp)] * len(made)
    readings = readings_of(made, starts, None, like)
    if readings is None:
        return None
    moving = np.unique(readings.trial)
    table = pd.DataFrame(rows).drop(columns="order", errors="ignore").iloc[moving]
    return numbered(table), readings.of(moving)


class _Pull(NamedTuple):
    """The force that a place takes beside the law, as against a weight or a spring.

    Parameters
    ----------
    middle, half : float
        Of the positions that were recorded [m or rad].
    amounts : ndarray, shape (m,)
        Of functions of the place; see :func:`.rough.pull_basis` [N or N·m].
    """

    middle: float
    half: float
    amounts: Array

    @classmethod
    def of(cls, rows: Readings, law: AxisLaw) -> "_Pull":
        """Return what rows leave of the law, as a function of the place."""
        position, speed = rows.position @ rows.weights, rows.speed @ rows.weights
        left = rows.force - law.mass * rows.acceleration - law.coulomb - law.viscous * speed
        basis = pull_basis(position, *places_of(position))
        amounts = np.linalg.lstsq(basis, rows.way * left, rcond=None)[0]
        return cls(*places_of(position), np.asarray(amounts, dtype=np.float64))

    def at(self, position: Array) -> Array:
        """Return the force at places, shape (N,) [N or N·m]."""
        return np.asarray(pull_basis(position, self.middle, self.half) @ self.amounts)


def _spline(log: EvenLog, position: Array, knot_s: float) -> "scipy.interpolate.BSpline":
    """Return a path that a window resolves, from time 0 on."""
    time = log.time_s - log.time_s[0]
    inner = np.linspace(0.0, time[-1], max(2, round(time[-1] / knot_s)))
    return scipy.interpolate.make_lsq_spline(time, position, np.pad(inner, 3, mode="edge"))


def _paths(
    log: EvenLog, own: "scipy.interpolate.BSpline", knot_s: float, fastest: float
) -> "dict[str, scipy.interpolate.BSpline]":
    """Return paths over the range of a run, by what they are called.

    A path there and back is a triangle wave whose corners are round: A arcsin(r cos φ), whose
    speed is A sin φ / √(sin² φ + ε²) with r² = 1 / (1 + ε²); a large ε makes a sine of it.
    """
    low, high = float(log.position.min()), float(log.position.max())
    paths = {
        "as recorded": own,
        "mirrored": scipy.interpolate.BSpline(own.t, low + high - own.c, own.k),
    }
    phase = np.pi * fastest / (high - low) * (log.time_s - log.time_s[0])  # fast enough for all
    for name, corner in ROUND.items():
        r = 1 / np.hypot(1.0, corner)
        wave = -np.arcsin(r * np.cos(phase)) / np.arcsin(r)
        paths[name] = _spline(log, 0.5 * (low + high) + 0.5 * (high - low) * wave, knot_s)
    return paths


def _top(path: "scipy.interpolate.BSpline") -> float:
    return float(np.abs(path.derivative()(path.t)).max())


def _speeds(tops: Mapping[str, float], rig: RigConstants) -> list[float]:
    slowest, fastest = SLOWEST * min(tops.values()), max(tops.values())
    low, high = rig.limits.get("velocity_m_s", (slowest, fastest))
    high = max(high, slowest)  # what is said to stand still was seen to move
    return [float(speed) for speed in np.geomspace(min(max(low, slowest), high), high, SPEEDS)]


def _chosen(runs: pd.DataFrame, tops: Mapping[str, float]) -> list[dict[str, Any]]:
    """Return runs of every role, evenly by their top speeds."""
    runs = runs[runs["run"].isin(list(tops))]
    runs = runs.iloc[np.argsort(runs["run"].map(tops).to_numpy(), kind="stable")]
    roles = runs["role"].fillna("") if "role" in runs else pd.Series("", runs.index)
    conditions = []
    for role in dict.fromkeys(roles):
        own = runs[roles == role]
        conditions += [
            {str(k): v for k, v in condition.items()}
            for condition in own.iloc[evenly(len(own), RUNS)].to_dict("records")
        ]
    return conditions


def _faster(
    path: "scipy.interpolate.BSpline", faster: float, log: EvenLog, law: AxisLaw, pull: _Pull
) -> EvenLog:
    """Return a path run so much faster, and the drive force that it takes, on time."""
    time = np.arange(0.0, path.t[-1] / max(faster, 1.0), log.interval_s)
    position, velocity = path(faster * time), faster * path(faster * time, 1)
    force = law.mass * faster**2 * path(faster * time, 2)
    force = force + np.sign(velocity) * law.coulomb + law.viscous * velocity
    force = force + pull.at(position)
    is_free = np.ones(time.size, dtype=np.bool_)
    return EvenLog(time, position, force, is_free, log.interval_s, {})
