"""Proposes runs that the axis could make next, on recorded paths and on others of the same range.

Each recorded run gives four paths, and each path is run at several speeds. A path is a spline, so
its speed and acceleration have closed forms. The drive force of a proposed run is that of the law,
plus the force that depended on position in the recording, as that of a weight does. A proposed run
stays within the positions of its recorded run and does not take longer. Its drive force does not
exceed the largest recorded one, unless it repeats a recorded run.
"""

from collections.abc import Collection, Mapping
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
import scipy

from bayesfric.arrays import Array, evenly
from bayesfric.observation.feasible import numbered
from bayesfric.physics.axis import AxisLaw
from bayesfric.recording.tables import Axis, RigConstants
from bayesfric.rigs.single_axis.carried import Pull
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.readings import Readings, readings_of
from bayesfric.rigs.single_axis.rough import places_of, pull_basis
from bayesfric.rigs.single_axis.simulated import log_of

SETTINGS = ("run", "path", "velocity_m_s", "duration_s", "drive_force_n")
OF_ROTARY = ("run", "path", "velocity_rad_s", "duration_s", "drive_torque_n_m")
"""Columns that describe a proposed run, for linear and for rotary axes."""
ROUND = {"at a steady speed": 0.5, "sine": 50.0}  # roundness ε of a path's reversals
RUNS = 3  # recorded runs of each role that are used: the slowest, the fastest and one between
SPEEDS = 5  # speeds of each path, in addition to that of its recorded run
LEAST = 4.0  # least duration of a run [half-widths of a window]
SLOWEST = 0.25  # least speed that is proposed, relative to the slowest run's top speed


def settings_of(rig: RigConstants) -> tuple[str, ...]:
    """Return the columns that describe a proposed run of a linear or a rotary machine."""
    return OF_ROTARY if rig.rotary else SETTINGS


def lay_out(
    axis: Axis, moved: Collection[str], rig: RigConstants, like: Readings, law: AxisLaw
) -> tuple[pd.DataFrame, Readings] | None:
    """Return feasible runs and their windows; None if none has a window.

    Each run is one trial on an assembly of its own. Top speeds lie within
    ``rig.limits.velocity_m_s``. Without this limit, they do not exceed the highest recorded speed.

    Parameters
    ----------
    axis : Axis
        The tables of the recording.
    moved : collection of str
        Runs in which the axis moves.
    rig : RigConstants
        The constants of the machine.
    like : Readings
        Windows of the recording. Proposed runs have their width and noise.
    law : AxisLaw
        The law that determines the drive force.
    """
    read = {str(run): log_of(samples, rig) for run, samples in axis.samples.groupby("run")}
    logs = {run: log for run, log in read.items() if log is not None and run in moved}
    splines = {run: _spline(log, log.position, like.half_s) for run, log in logs.items()}
    tops = {run: _top(path) for run, path in splines.items()}
    largest_force, pull = float(np.abs(like.drive).max()), _pull(like, law)
    speeds = _speeds(tops, rig)
    proposed, rows = [], []
    for run in _chosen(axis.runs, tops):
        name = str(run["run"])
        paths = _paths(logs[name], splines[name], like.half_s, speeds[-1])
        for (kind, path), speed in product(paths.items(), sorted({*speeds, tops[name]})):
            log = _faster(path, speed / _top(path), logs[name], law, pull)
            length = log.time_s.size * log.interval_s
            peak = float(np.abs(log.force).max())
            again = kind == "as recorded" and speed == tops[name]
            inside = again or (speeds[0] <= speed <= speeds[-1] and peak <= largest_force)
            if inside and length >= LEAST * like.half_s:
                proposed.append(log)
                settings = (name, kind, speed, length, peak)
                rows.append(run | dict(zip(settings_of(rig), settings, strict=True)))
    if not proposed:
        return None
    starts = [np.zeros(1, dtype=np.intp)] * len(proposed)
    readings = readings_of(proposed, starts, None, like)
    if readings is None:
        return None
    moving = np.unique(readings.trial)
    table = pd.DataFrame(rows).drop(columns="order", errors="ignore").iloc[moving]
    return numbered(table), readings.of(moving)


def _pull(rows: Readings, law: AxisLaw) -> Pull:
    """Fit the residuals of windows after the law by functions of position."""
    places = places_of(rows.mean_position)
    residual = rows.way * (rows.force - rows.law_columns @ np.array(law))
    amounts = np.linalg.lstsq(pull_basis(rows.mean_position, *places), residual, rcond=None)[0]
    return Pull(law.mass, np.asarray(amounts, dtype=np.float64), *places)


def _spline(log: EvenLog, position: Array, knot_s: float) -> "scipy.interpolate.BSpline":
    """Return a spline through a path, with its start at time 0 and a knot every `knot_s`."""
    time = log.time_s - log.time_s[0]
    inner = np.linspace(0.0, time[-1], max(2, round(time[-1] / knot_s)))
    return scipy.interpolate.make_lsq_spline(time, position, np.pad(inner, 3, mode="edge"))


def _paths(
    log: EvenLog, own: "scipy.interpolate.BSpline", knot_s: float, fastest: float
) -> "dict[str, scipy.interpolate.BSpline]":
    """Return paths over the range of a run, by name.

    A path to and fro is a triangle wave with round corners, A arcsin(r cos φ). Its speed is
    A sin φ / √(sin² φ + ε²) with r² = 1 / (1 + ε²). A large ε makes it a sine.
    """
    low, high = float(log.position.min()), float(log.position.max())
    paths = {
        "as recorded": own,
        "mirrored": scipy.interpolate.BSpline(own.t, low + high - own.c, own.k),
    }
    # The top speed of these paths is at least `fastest`: a slower run only covers a part of them.
    phase = np.pi * fastest / (high - low) * (log.time_s - log.time_s[0])
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
    high = max(high, slowest)  # a declared limit may be below the recorded speeds
    return [float(speed) for speed in np.geomspace(min(max(low, slowest), high), high, SPEEDS)]


def _chosen(runs: pd.DataFrame, tops: Mapping[str, float]) -> list[dict[str, Any]]:
    """Return recorded runs of every role, at evenly spaced ranks of their top speeds."""
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
    path: "scipy.interpolate.BSpline", faster: float, log: EvenLog, law: AxisLaw, pull: Pull
) -> EvenLog:
    """Return the log of a path that is run faster by a factor; its drive force has no delay.

    A faster run covers the whole path in less time. A slower run takes as long as the recorded one
    and covers only a part of the path.
    """
    time = np.arange(0.0, path.t[-1] / max(faster, 1.0), log.interval_s)
    position, velocity = path(faster * time), faster * path(faster * time, 1)
    force = law.mass * faster**2 * path(faster * time, 2)
    force = force + np.sign(velocity) * law.coulomb + law.viscous * velocity
    force = force + pull.at(position)
    is_free = np.ones(time.size, dtype=np.bool_)
    return EvenLog(time, position, force, is_free, log.interval_s, {})
