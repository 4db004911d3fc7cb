"""All runs reduced, once, to rows that are linear in mass and friction."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.beside import Mixing, leading, rough_amounts
from bayesfric.rigs.single_axis.even_log import EvenLog, given, sample_noise
from bayesfric.rigs.single_axis.following import DrivePath, LoadMotions
from bayesfric.rigs.single_axis.on_time import margin_s
from bayesfric.rigs.single_axis.rough import SINGULAR, RoughLaw, pull_columns, rough_law
from bayesfric.rigs.single_axis.run_rows import rows_of_run
from bayesfric.rigs.single_axis.weak_form import TestFunction, node_weights, test_function
from bayesfric.rigs.single_axis.windows import half_samples, late_by, position_sd, window_width

SAMPLES_PER_HALF = 12  # samples in half a window, of the path along which loads are followed
SPARSE = 24  # windows, below which they lie closer: their errors hang together the more
CLOSER = 0.5
PIECE = 16  # rows of a stretch whose friction wanders as one
FEW_ROWS = 3  # for each number of a curve over the place
LEVER = ("gravity_sine", "gravity_cosine")
"""What a weight on a lever pulls with, where it is a part of the law: the last of `beside`."""


@dataclass(frozen=True)
class Readings:
    """W rows: mean forces over windows, in the direction of the motion.

    Parameters
    ----------
    trial : ndarray of int, shape (W,)
        Place of the trial, ascending.
    piece : ndarray of int, shape (W,)
        Number of the stretch of neighbours, at most :data:`PIECE` each, ascending.
    way : ndarray, shape (W,)
        1 or −1.
    force, acceleration : ndarray, shape (W,)
        ∫ φ F dt, without what is known of it, and ∫ φ'' q dt, times the direction.
    force_rate, lagging_rate, force_curvature : ndarray, shape (W,)
        −∫ φ' F dt and ∫ φ'' F dt, times the direction. The first rate is of the force earlier
        by half of what it is late: F(t) − F(t − d) is d F'(t − d/2) up to the third order. The
        other is that of what an actuator gives which lags by as much.
    time_s : ndarray, shape (W,)
        Of the window's middle.
    speed, travel, position, drive : ndarray, shape (W, P)
        At places inside: speed, travel since the last reversal, position and drive force.
    passes : ndarray, shape (W, E)
        Travel of the passes before the present one, the last first.
    dwell_s, since_rest, temperature : ndarray, shape (W,)
        How long it rested before it moved as it does, travel since then, and the temperature;
        nan where none was logged.
    known_held, known_moved : ndarray, shape (W, P)
        At places inside, along the position: what is known of the load and is not in `force`.
    position_lag, force_lag : ndarray, shape (W, L)
        Covariance of a row with the l-th next by an error of position of 1, at every sample
        its own, per mass squared; and by an error of the force, of 1 where it is quiet.
    held_lag : ndarray, shape (W, L, 3)
        Of a servo, the further covariances by an error of position of 1: by stiffness, per
        stiffness squared; by damping, per damping squared; by stiffness and mass together, per
        their product. 0 of other joints.
    instruments : ndarray, shape (W, m)
        What the motion is told by without the window's own errors; see :mod:`.instruments`.
    simulated : ndarray, shape (W, K)
        Means of what a simulator says of the force, times the direction; K is 0 without one.
    beside : ndarray, shape (W, K)
        Means of forces that may be there in amounts N(0, 1), times the direction.
    place : ndarray of int, shape (W,)
        Of the row among all of `followed`.
    followed : LoadMotions
        Loads behind the drive, along the paths of the runs.
    position_sd, force_sd, half_s, hop : float
        Standard deviations of the errors that a position, and a force, has of its own; half a
        window [s], windows' distance over that.
    known_inertia : float
        What the model of a known force moves [kg, or kg·m²].
    stiffness : float
        Of a servo, whose error of position is one of its force too; 0 of other joints.
    mixing : Mixing
        Of what the columns of `beside` are made.
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
        """Number of rows."""
        return self.trial.size

    @property
    def weights(self) -> Array:
        """Of the places inside a window, shape (P,)."""
        return node_weights()[1]

    @property
    def acceleration_sd(self) -> float:
        """Rms error of the acceleration by those of the positions."""
        return float(self.position_sd * np.sqrt(np.mean(self.position_lag[:, 0])))

    def lag_of_positions(self, mass: float, damping: float) -> Array:
        """Return the covariance of a row with the l-th next by an error of position of 1, (W, L).

        In the log of a servo an error e adds K ∫ φ e + m ∫ φ'' e − D ∫ φ' e to a row. The terms of
        stiffness and mass have opposite signs and cancel at the servo's own frequency. They are
        therefore not independent errors.

        Parameters
        ----------
        mass, damping : float
            Of the law [kg, N s/m; or kg·m², N·m s/rad].
        """
        moved = mass**2 * self.position_lag
        if not self.stiffness:
            return moved
        by_number = np.array([self.stiffness**2, damping**2, self.stiffness * mass])
        return np.asarray(moved + self.held_lag @ by_number)

    @property
    def acceleration_of_its_own(self) -> float:
        """Part of the square of what only the acceleration has that is no error of positions.

        A weight on a lever, the speed and the way have the rest; in part of a swing, nearly all.
        """
        square = self._square_of_its_own
        return 1 - self.acceleration_sd**2 / square if square > 0 else 0.0

    @property
    def swings_alike(self) -> bool:
        """Whether the acceleration is nearly a curve over the place, as in one sine's swings."""
        whole = float(np.mean(self.acceleration**2))
        return bool(self._square_of_its_own < AXIS_RULES.like_a_curve * whole)

    @property
    def _square_of_its_own(self) -> float:
        place, speed = self.position @ self.weights, self.speed @ self.weights
        ones = np.ones(self.count)
        pulls = self.way[:, None] * np.column_stack([ones, np.sin(place), np.cos(place)])
        others = np.column_stack([ones, speed, pulls])
        if self.count < FEW_ROWS * others.shape[1]:
            return np.inf  # so few leave nothing of any column
        fitted = np.linalg.lstsq(others, self.acceleration, rcond=SINGULAR)[0]
        left = self.acceleration - others @ fitted
        return float(left @ left / max(self.count - others.shape[1], 1))

    @property
    def weight_pulls(self) -> float:
        """Rms of what a weight on a lever pulls with by least squares, beside the law [N·m]."""
        place, speed = self.position @ self.weights, self.speed @ self.weights
        pulls = self.way[:, None] * np.column_stack([np.sin(place), np.cos(place)])
        law = np.column_stack([self.acceleration, np.ones(self.count), speed, self.way])
        fitted = np.linalg.lstsq(np.hstack([law, pulls]), self.force, rcond=SINGULAR)[0]
        return float(np.sqrt(np.mean((pulls @ fitted[-2:]) ** 2)))

    def of(self, trials: Whole) -> "Readings":
        """Return the rows of some trials, which are numbered anew in that order."""
        place = np.full(int(self.trial.max()) + 1, -1, dtype=np.intp)
        place[trials] = np.arange(trials.size)
        rows = np.flatnonzero(place[self.trial] >= 0)
        chosen = self.at(rows[np.argsort(place[self.trial[rows]], kind="stable")])
        piece = np.cumsum(np.diff(chosen.piece, prepend=chosen.piece[:1]) != 0)
        return replace(chosen, trial=place[chosen.trial], piece=piece)

    def at(self, rows: Whole) -> "Readings":
        """Return some rows, in this order, whose trials and pieces keep their numbers."""
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
    """Reduce runs to rows; None where no window runs one way.

    Parameters
    ----------
    logs : sequence of EvenLog
        Runs.
    starts : sequence of ndarray of int
        Of each run, the samples at which its trials begin, 0 first.
    resolution : float or None
        Of the encoder.
    like : Readings or None
        Rows whose windows and noise these have, on time; None looks for them.
    limit : float
        Of the drive: what is commanded beyond it neither acts later nor changes what acts.
    """
    stroke = max(float(np.ptp(run_log.position)) for run_log in logs)
    if like is None:
        noise, half_s, hop, late_s = _windows_of(logs, resolution, stroke, limit)
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
    joined["beside"], mixing = leading(_parted(joined, logs[0]), joined["force"])
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


def _windows_of(
    logs: Sequence[EvenLog], resolution: float | None, stroke: float, limit: float
) -> tuple[float, float, float, float]:
    """Return the error of positions, half a window [s], its hop, and what a force is late [s]."""
    noise = position_sd(logs, resolution)
    half_s, hop = window_width(logs, noise, stroke)
    if _count(logs, half_s, noise, stroke) < SPARSE:
        half = half_samples(half_s, logs[0])
        hop *= max(1, round(CLOSER * half)) / half
    late_s = 0.0
    if all(log.sent is None for log in logs):  # what a servo is late by is known beforehand
        late_s = late_by([given(run_log, limit) for run_log in logs], half_s, noise, stroke)
    return noise, half_s, hop, late_s


def _joined(parts: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return the rows of all runs, whose correlations with neighbours reach equally far."""
    widest = max(part["position_lag"].shape[1] for part in parts)
    for part in parts:
        for name in ("position_lag", "force_lag", "held_lag"):
            short = widest - part[name].shape[1]
            nothing = np.zeros((len(part[name]), short, *part[name].shape[2:]))
            part[name] = np.concatenate([part[name], nothing], axis=1)
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _parted(joined: dict[str, Array], log: EvenLog) -> Array:
    """Return forces beside the law: of a known force its share in two, and what its clock makes.

    One part of the share has the law's form, and the other has not.

    The known force of a joint alone is an inertia times the acceleration, but for errors of the
    positions and of clocks. By one amount these errors tell how wrong that inertia is; by two
    nothing does, as it should be, and the rotor's inertia is as uncertain. Its clock may be off
    as that of the drive force is.

    Parameters
    ----------
    joined : dict of str to ndarray
        Fields of W rows.
    log : EvenLog
        Any of the runs, which says whether the first of ``beside`` is that share.
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


def with_lever(rows: Readings, force: float) -> Readings:
    """Return rows beside which a weight may pull with the angle, by its sine and its cosine.

    Parameters
    ----------
    rows : Readings
        Of a joint that turns.
    force : float
        What amounts of 1 pull with at most [N·m].
    """
    pulls = force * np.stack([np.sin(rows.position), np.cos(rows.position)]) @ rows.weights
    return replace(rows, beside=np.column_stack([rows.beside, (rows.way * pulls).T]))


def _count(logs: Sequence[EvenLog], half_s: float, noise: float, stroke: float) -> int:
    """Return how many windows run one way, each half a window behind the one before."""
    count = 0
    for log in logs:
        half = half_samples(half_s, log)
        rows = rows_of_run(log, test_function(half, log.interval_s), half, noise, stroke)
        count += rows["way"].size
    return count


def _drive_path(
    path: Array, interval_s: float, test: TestFunction, centres: Whole, way: Array
) -> DrivePath:
    """Return the path along which loads are followed, step by step: of no more than it takes.

    Where a window has many samples, every few of them tell the path as well.
    """
    every = test.half // SAMPLES_PER_HALF
    if every < 2:
        return DrivePath(path, interval_s, test, centres, way)
    fewer = test_function(test.half // every, every * interval_s)
    path = path[::every]
    middles = np.clip(np.round(centres / every), fewer.half, path.size - fewer.half - 1)
    return DrivePath(path, every * interval_s, fewer, middles.astype(np.intp), way)


def rough_law_of(rows: Readings, inside: Flags, *, viscous: bool = True) -> RoughLaw:
    """Return mass and friction by some rows; see :func:`.rough.rough_law`.

    Parameters
    ----------
    rows : Readings
        W rows.
    inside : ndarray of bool, shape (W,)
        Those that tell it.
    viscous : bool
        Whether friction may grow with the speed.
    """
    speed = viscous * (rows.speed @ rows.weights)
    pull = pull_columns(rows.position @ rows.weights, rows.way)
    # What the errors of positions make alone tells no mass.
    acceleration = rows.acceleration * (rows.acceleration_sd < np.std(rows.acceleration))
    columns = np.column_stack([acceleration, np.ones(rows.count), speed])
    force = rows.force - rough_amounts(columns, rows.beside, rows.force, inside)
    return rough_law(force[inside], acceleration[inside], speed[inside], pull[inside])


def _pieces(place: Array, trial: Array) -> Array:
    """Return the number of each row's piece: neighbours of one trial, at most some."""
    if not place.size:
        return place
    breaks = (np.diff(place, prepend=place[0]) > 1) | (np.diff(trial, prepend=trial[0]) != 0)
    stretch = np.cumsum(breaks)
    first = np.flatnonzero(np.diff(stretch, prepend=-1))
    inside = np.arange(place.size) - first[stretch]
    return np.asarray(np.cumsum(breaks | ((inside > 0) & (inside % PIECE == 0))), dtype=float)
