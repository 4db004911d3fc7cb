"""Reduces all runs to windows, whose forces are linear in mass and friction."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.beside import Mixing, leading, rough_amounts
from bayesfric.rigs.single_axis.even_log import EvenLog, sample_noise
from bayesfric.rigs.single_axis.following import DrivePath, LoadMotions
from bayesfric.rigs.single_axis.on_time import margin_s
from bayesfric.rigs.single_axis.rough import SINGULAR, RoughLaw, pull_columns, rough_law
from bayesfric.rigs.single_axis.run_rows import rows_of_run
from bayesfric.rigs.single_axis.weak_form import TestFunction, node_weights, test_function
from bayesfric.rigs.single_axis.windows import half_samples, windows_of

SAMPLES_PER_HALF = 12  # least samples in half a window for which loads are simulated
PIECE = 16  # most windows of a stretch within which the wander is correlated
FEW_ROWS = 3  # least windows for each coefficient of a curve over position
LEVER = ("gravity_sine", "gravity_cosine")
"""Forces of a weight on a lever, if they belong to the law: the last columns of `beside`."""


@dataclass(frozen=True)
class Readings:
    """W windows, with their mean forces in the direction of the motion.

    Parameters
    ----------
    trial : ndarray of int, shape (W,)
        Index of the trial, ascending.
    piece : ndarray of int, shape (W,)
        Number of the stretch of neighbouring windows, at most :data:`PIECE` each, ascending.
    way : ndarray, shape (W,)
        Direction of the motion, 1 or −1.
    force, acceleration : ndarray, shape (W,)
        ∫ φ F dt minus the known force, and ∫ φ'' q dt, times the direction.
    force_rate, lagging_rate, force_curvature : ndarray, shape (W,)
        Derivatives of the force in time, times the direction: −∫ φ' F dt, the same rate of an
        actuator that follows the force with a lag, and ∫ φ'' F dt. If the force is late by d, the
        first rate is taken d/2 earlier, because F(t) − F(t − d) = d F'(t − d/2) up to third order.
    time_s : ndarray, shape (W,)
        Time of the window's middle [s].
    speed, travel, position, drive : ndarray, shape (W, P)
        At P places inside each window: speed, travel since the last reversal, position and drive
        force.
    passes : ndarray, shape (W, E)
        Travel of the passes before the present one, the latest first.
    dwell_s, since_rest, temperature : ndarray, shape (W,)
        Duration of the last rest before the present motion [s], travel since then, and
        temperature; nan if none was logged [°C].
    known_held, known_moved : ndarray, shape (W, P)
        The known load, which is not in `force`, positive along the position: its part held
        against gravity or springs, and its inertial part.
    position_lag, force_lag : ndarray, shape (W, L)
        Covariance of a window with the l-th next one. `position_lag` is that of independent
        errors of positions with standard deviation 1, per mass squared; `force_lag` that of
        errors of the force, whose standard deviation is 1 where the force is smooth.
    held_lag : ndarray, shape (W, L, 3)
        For a servo, further covariances by errors of positions: by stiffness, per stiffness
        squared; by damping, per damping squared; by stiffness and mass together, per their
        product. 0 for other joints.
    instruments : ndarray, shape (W, m)
        Instruments for the motion, free of the window's own errors; see :mod:`.instruments`.
    simulated : ndarray, shape (W, K)
        Means of a simulator's forces, times the direction; K is 0 without a simulator.
    beside : ndarray, shape (W, K)
        Means of forces whose unknown amounts have priors N(0, 1), times the direction.
    place : ndarray of int, shape (W,)
        Index of the window among all windows of `load_motions`.
    load_motions : LoadMotions
        Motions of loads behind the drive, along the paths of the runs.
    position_sd, force_sd, half_s, hop : float
        Standard deviations of the independent errors of a position and of a force, half the width
        of a window [s], and the distance of windows relative to that.
    known_inertia : float
        Inertia in the model of a known force [kg, or kg·m²].
    stiffness : float
        Stiffness of a servo, whose errors of position are also in its force; 0 for other joints.
    mixing : Mixing
        The forces of which the columns of `beside` are made.
    """

    trial: Whole
    piece: Whole
    way: Array
    force: Array
    acceleration: Array
    force_rate: Array
    lagging_rate: Array
    force_curvature: Array
    time_s: Array
    speed: Array
    travel: Array
    position: Array
    drive: Array
    passes: Array
    dwell_s: Array
    since_rest: Array
    temperature: Array
    known_held: Array
    known_moved: Array
    position_lag: Array
    force_lag: Array
    held_lag: Array
    instruments: Array
    simulated: Array
    beside: Array
    place: Whole
    load_motions: LoadMotions
    position_sd: float
    force_sd: float
    half_s: float
    hop: float
    known_inertia: float = 0.0
    stiffness: float = 0.0
    mixing: Mixing = field(default_factory=Mixing)

    @property
    def count(self) -> int:
        """Number of windows, W."""
        return self.trial.size

    @property
    def weights(self) -> Array:
        """Weights of the places inside a window, for a mean under φ, shape (P,)."""
        return node_weights()[1]

    @cached_property
    def mean_speed(self) -> Array:
        """Mean speed of each window, (W,) [m/s or rad/s]."""
        return np.asarray(self.speed @ self.weights)

    @cached_property
    def mean_position(self) -> Array:
        """Mean position of each window, (W,) [m or rad]."""
        return np.asarray(self.position @ self.weights)

    @property
    def law_columns(self) -> Array:
        """Force of each window by the law per unit mass, Coulomb and viscous friction, (W, 3)."""
        return np.column_stack([self.acceleration, np.ones(self.count), self.mean_speed])

    @property
    def gravity_columns(self) -> Array:
        """Sine and cosine of the angle along the motion, the means of each window, (W, 2)."""
        pulls = np.stack([np.sin(self.position), np.cos(self.position)]) @ self.weights
        return np.asarray((self.way * pulls).T)

    @property
    def acceleration_sd(self) -> float:
        """Rms error of the acceleration due to errors of the positions."""
        return float(self.position_sd * np.sqrt(np.mean(self.position_lag[:, 0])))

    def lag_of_positions(self, mass: float, damping: float) -> Array:
        """Return the covariance of a window with the l-th next one by errors of positions, (W, L).

        The errors have standard deviation 1. In the log of a servo, an error e adds
        K ∫ φ e + m ∫ φ'' e − D ∫ φ' e to a window. The terms of stiffness and mass have opposite
        signs and cancel at the servo's own frequency, so they are not independent.

        Parameters
        ----------
        mass, damping : float
            Mass and damping of the law [kg, N s/m; or kg·m², N·m s/rad].
        """
        moved = mass**2 * self.position_lag
        if not self.stiffness:
            return moved
        by_number = np.array([self.stiffness**2, damping**2, self.stiffness * mass])
        return np.asarray(moved + self.held_lag @ by_number)

    @property
    def independent_acceleration_share(self) -> float:
        """Share of the independent acceleration's mean square that is not due to position errors.

        The independent acceleration is its residual after regression on a constant, speed,
        direction and the force of a weight on a lever.
        """
        square = self._independent_square
        return 1 - self.acceleration_sd**2 / square if square > 0 else 0.0

    @property
    def swings_alike(self) -> bool:
        """Whether position, direction and speed explain the acceleration, as if a joint swings."""
        whole = float(np.mean(self.acceleration**2))
        return bool(self._independent_square < AXIS_RULES.like_a_curve * whole)

    @property
    def _independent_square(self) -> float:
        place, ones = self.mean_position, np.ones(self.count)
        pulls = self.way[:, None] * np.column_stack([ones, np.sin(place), np.cos(place)])
        others = np.column_stack([ones, self.mean_speed, pulls])
        if self.count < FEW_ROWS * others.shape[1]:
            return np.inf  # the residuals of so few windows would be too small
        fitted = np.linalg.lstsq(others, self.acceleration, rcond=SINGULAR)[0]
        residual = self.acceleration - others @ fitted
        return float(residual @ residual / max(self.count - others.shape[1], 1))

    @property
    def weight_pulls(self) -> float:
        """Rms gravity torque of a weight on a lever, fitted by least squares with the law [N·m]."""
        place = self.mean_position
        pulls = self.way[:, None] * np.column_stack([np.sin(place), np.cos(place)])
        columns = np.column_stack([self.law_columns, self.way, pulls])
        fitted = np.linalg.lstsq(columns, self.force, rcond=SINGULAR)[0]
        return float(np.sqrt(np.mean((pulls @ fitted[-2:]) ** 2)))

    def of(self, trials: Whole) -> "Readings":
        """Return the windows of some trials, and number these trials in the given order."""
        place = np.full(int(self.trial.max()) + 1, -1, dtype=np.intp)
        place[trials] = np.arange(trials.size)
        rows = np.flatnonzero(place[self.trial] >= 0)
        chosen = self.at(rows[np.argsort(place[self.trial[rows]], kind="stable")])
        piece = np.cumsum(np.diff(chosen.piece, prepend=chosen.piece[:1]) != 0)
        return replace(chosen, trial=place[chosen.trial], piece=piece)

    def at(self, rows: Whole) -> "Readings":
        """Return some windows in the given order; their trials and pieces keep their numbers."""
        whole = {item.name: getattr(self, item.name) for item in fields(self)}
        chosen: dict[str, Any] = {
            name: of[rows] for name, of in whole.items() if isinstance(of, np.ndarray)
        }
        return replace(self, **chosen)


def readings_of(
    logs: Sequence[EvenLog],
    starts: Sequence[Whole],
    resolution: float | None,
    like: Readings | None = None,
    limit: float = np.inf,
) -> Readings | None:
    """Reduce runs to windows; None if no window has a single direction of motion.

    Parameters
    ----------
    logs : sequence of EvenLog
        The runs.
    starts : sequence of ndarray of int
        For each run, the samples at which its trials begin; the first is 0.
    resolution : float or None
        Resolution of the encoder [m or rad].
    like : Readings or None
        Windows whose width and noise are used, without a delay; None: all three are estimated.
    limit : float
        Force limit of the drive, which clips commands [N or N·m].
    """
    stroke = max(float(np.ptp(run_log.position)) for run_log in logs)
    if like is None:
        noise, half_s, hop, late_s = windows_of(logs, resolution, stroke, limit)
    else:
        noise, half_s, hop, late_s = like.position_sd, like.half_s, like.hop, 0.0
    parts: list[dict[str, Any]] = []
    paths, trials, pieces = [], 0, 0
    for log, begin in zip(logs, starts, strict=True):
        half = half_samples(half_s, log)
        test = test_function(half, log.interval_s)
        part = rows_of_run(log, test, max(1, round(hop * half)), noise, stroke, late_s, limit)
        centres = part["centre"].astype(np.intp)
        path = part.pop("path")
        paths.append(_drive_path(path, log.interval_s, test, centres, part["way"]))
        place = np.searchsorted(begin, part.pop("centre"), side="right")
        part["trial"] = np.asarray(trials + place - 1, dtype=np.float64)
        part["piece"] = pieces + _pieces(part.pop("neighbour"), part["trial"])
        trials += begin.size
        pieces = int(part["piece"].max()) + 1 if part["piece"].size else pieces
        parts.append(part)
    joined = _joined(parts)
    if not joined["way"].size:
        return None
    whole: dict[str, Any] = {name: joined.pop(name).astype(np.intp) for name in ("trial", "piece")}
    whole["place"] = np.arange(joined["way"].size)
    joined["beside"], mixing = leading(_with_split_error(joined, logs[0]), joined["force"])
    return Readings(
        **whole,
        **joined,
        load_motions=LoadMotions(paths),
        position_sd=noise,
        force_sd=float(np.median([sample_noise(log.force) for log in logs])),
        half_s=half_s,
        hop=hop,
        known_inertia=float(np.mean([log.known_inertia for log in logs])),
        stiffness=logs[0].stiffness,
        mixing=mixing,
    )


def _joined(parts: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return the windows of all runs, with covariances padded to the same number of lags."""
    widest = max(part["position_lag"].shape[1] for part in parts)
    for part in parts:
        for name in ("position_lag", "force_lag", "held_lag"):
            short = widest - part[name].shape[1]
            nothing = np.zeros((len(part[name]), short, *part[name].shape[2:]))
            part[name] = np.concatenate([part[name], nothing], axis=1)
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _with_split_error(joined: dict[str, Array], log: EvenLog) -> Array:
    """Return forces beside the law, with a known force's error in two columns and one of its clock.

    The relative error of a known force is split into the part that the law can imitate, and the
    rest; each has an amount of its own. If a joint moves alone, the known force is an inertia
    times the acceleration, except for errors of positions and clocks. With a single amount, these
    errors would seem to determine the inertia. With two amounts they do not, and the inertia stays
    uncertain. The clock of the known force may be off, like that of the drive force.

    Parameters
    ----------
    joined : dict of str to ndarray
        Fields of W windows.
    log : EvenLog
        Any run: whether the first column of ``beside`` is a relative error is the same in all.
    """
    way, beside, rate = joined["way"], joined["beside"], joined.pop("known_rate")
    if not log.known_to_a_share:
        return beside
    speed = joined["speed"] @ node_weights()[1]
    law = np.column_stack([joined["acceleration"], np.ones(way.size), speed, way])
    share = beside[:, 0]
    like_law = law @ np.linalg.lstsq(law, share, rcond=SINGULAR)[0]
    clock = margin_s(log.interval_s) * rate
    return np.column_stack([like_law, share - like_law, clock, beside[:, 1:]])


def _drive_path(
    path: Array, interval_s: float, test: TestFunction, centres: Whole, way: Array
) -> DrivePath:
    """Return the path along which loads are simulated, thinned out if windows have many samples.

    Half a window keeps at least :data:`SAMPLES_PER_HALF` samples.
    """
    every = test.half // SAMPLES_PER_HALF
    if every < 2:
        return DrivePath(path, interval_s, test, centres, way)
    fewer = test_function(test.half // every, every * interval_s)
    path = path[::every]
    middles = np.clip(np.round(centres / every), fewer.half, path.size - fewer.half - 1)
    return DrivePath(path, every * interval_s, fewer, middles.astype(np.intp), way)


def rough_law_of(rows: Readings, inside: Flags, *, viscous: bool = True) -> RoughLaw:
    """Return a rough estimate of mass and friction; see :func:`.rough.rough_law`.

    Parameters
    ----------
    rows : Readings
        W windows.
    inside : ndarray of bool, shape (W,)
        Windows that are used.
    viscous : bool
        Whether the law has viscous friction.
    """
    speed = viscous * rows.mean_speed
    pull = pull_columns(rows.mean_position, rows.way)
    # An acceleration that consists of position errors alone does not determine a mass.
    acceleration = rows.acceleration * (rows.acceleration_sd < np.std(rows.acceleration))
    columns = np.column_stack([acceleration, np.ones(rows.count), speed])
    force = rows.force - rough_amounts(columns, rows.beside, rows.force, inside)
    return rough_law(force[inside], acceleration[inside], speed[inside], pull[inside])


def _pieces(place: Array, trial: Array) -> Array:
    """Return the number of each window's piece: up to :data:`PIECE` neighbours of one trial."""
    if not place.size:
        return place
    breaks = (np.diff(place, prepend=place[0]) > 1) | (np.diff(trial, prepend=trial[0]) != 0)
    stretch = np.cumsum(breaks)
    first = np.flatnonzero(np.diff(stretch, prepend=-1))
    inside = np.arange(place.size) - first[stretch]
    return np.asarray(np.cumsum(breaks | ((inside > 0) & (inside % PIECE == 0))), dtype=float)
