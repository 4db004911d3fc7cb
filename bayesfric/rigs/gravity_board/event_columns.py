"""Events of the gravity board as rows of a linear model, and responses to forces along the paths.

The displacement of an event is that of the reference law, plus an offset of the sensor, a first
speed times time, and responses to all forces and errors of readings. A force h(τ) along the path
moves the cable by ``−∫∫ h dτ² / (m1 + m2)`` times a feedback factor, because the force changes
tension and so friction. A trial with only an acceleration is one row, its travel from rest.
"""

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import Any, Self

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags
from bayesfric.effects.candidates import Candidate
from bayesfric.inference.cosines import cosines
from bayesfric.inference.smooths import Smooth
from bayesfric.observation.linear import LinearRows
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG, Coefficients
from bayesfric.physics.laws import BASELINES, FrictionLaw
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.late_clock import clock_sd_s, clock_shifts, late_column
from bayesfric.rigs.gravity_board.measured_motion import MeasuredMotion
from bayesfric.rigs.gravity_board.measurements import optional_column
from bayesfric.rigs.gravity_board.paths import POINTS, ROWS_AT_ONCE, DoubleIntegral
from bayesfric.rigs.gravity_board.reference_motion import ReferenceMotion
from bayesfric.rigs.gravity_board.trial_motion import Events

ROUGH_SD = 0.01  # m/s², assumed for an acceleration without a standard error
LEAST_SD_M = 1e-7  # of an event: smaller residuals, as of data without noise, are rounding errors
ROUGH = 9.0  # mean square residual over variance: beyond it, no smooth path fits the trial


def with_accelerations(
    trials: pd.DataFrame, events: Events, duration_s: Array
) -> tuple[Events, Flags, Array]:
    """Add a row for each trial without events: the travel from rest at its acceleration.

    Parameters
    ----------
    trials : DataFrame
        The N trials.
    events : Events
        Events of the trials that have some.
    duration_s : ndarray, shape (N,)
        Duration of each trial [s].

    Returns
    -------
    rows : Events
        E rows, sorted by trial.
    without_events : ndarray of bool, shape (E,)
        Which rows are those of trials with only an acceleration.
    sd : ndarray, shape (N,)
        Standard error of each trial's acceleration [m/s²].
    """
    added = np.flatnonzero(~np.isin(np.arange(len(trials)), events.trial))
    duration = duration_s[added]
    travel = optional_column(trials, "acceleration_m_s2")[added] * duration**2 / 2
    trial = np.concatenate([events.trial, added])
    order = np.argsort(trial, kind="stable")
    regressors = np.hstack([events.regressors, np.zeros((4, added.size))])[:, order]
    rows = replace(
        events,
        trial=trial[order],
        tau=np.concatenate([events.tau, duration])[order],
        displacement=np.concatenate([events.displacement, travel])[order],
        regressors=regressors,
        starts=np.flatnonzero(np.diff(trial[order], prepend=-1)),
    )
    sd = optional_column(trials, "acceleration_sd_m_s2")
    return rows, np.isin(rows.trial, added), np.where(np.isfinite(sd), sd, ROUGH_SD)


def variance_of(
    rows: Events, residual: Array, speed2: Array, without_events: Flags, stated_sd: Array
) -> Array:
    """Return the variance of each row, from residuals of the trials' smooth motions [m²].

    Parameters
    ----------
    rows : Events
        E rows.
    residual : ndarray
        Residuals of the rows that are events, from the smooth motions [m].
    speed2 : ndarray, shape (E,)
        Squared speed [m²/s²].
    without_events, stated_sd : ndarray
        Results `without_events` and `sd` of :func:`with_accelerations`.
    """
    travel = rows.tau**2 / 2
    stated = (stated_sd[rows.trial] * travel) ** 2
    if without_events.all():
        return np.asarray(stated)
    square = np.zeros_like(speed2)
    square[~without_events] = residual**2
    slope, level = np.polyfit(speed2[~without_events], square[~without_events], 1)
    # Neither variance, of position or of the clock, may be negative.
    if level < 0:
        level, slope = 0.0, square[~without_events].mean() / speed2[~without_events].mean()
    elif slope < 0:
        level, slope = square[~without_events].mean(), 0.0
    variance = level + slope * speed2
    for own in rows.rows_of_trials():
        # If no smooth path fits a trial, as when the cable nearly stops, the response to a force
        # is not known. The trial then has less weight.
        beyond = square[own].mean() / variance[own].mean()
        variance[own] *= beyond if beyond > ROUGH else 1.0
    return np.where(without_events, stated, np.maximum(variance, LEAST_SD_M**2))


class EventColumns(ReferenceMotion, LinearRows):
    """Events as rows of a linear model, and their responses to forces along the paths.

    Parameters
    ----------
    gravity : Gravity
        N trials that are used; those of an assembly are adjacent.
    rig : RigConstants
        Constants of the board.
    laws : mapping of str to Coefficients
        Reference law of each pulley size.
    measured : MeasuredMotion
        Measured motion of the trials.
    acting : sequence of (Candidate, float)
        Effects on friction, with their amplitudes. They act before the first event: the travel
        up to it is computed from the first speed, with the law and these effects.
    law : FrictionLaw
        The friction law.

    Attributes
    ----------
    table : DataFrame
        The N trials.
    law : Coefficients
        Coefficients of each trial, arrays of shape (N,).
    friction_n, acceleration : ndarray, shape (N,)
        Friction [N] and acceleration [m/s²] by the reference law; the latter is at least 0.
    order : ndarray, shape (N,)
        Position in the order of the recording, 0 to 1; 0.5 without an order.
    events : Events
        E rows, sorted by trial, with the regressors of a constant acceleration.
    residual : ndarray, shape (E,)
        Displacement minus that of the reference motion from rest, so that offsets and first
        speed are still included [m].
    variance : ndarray, shape (E,)
        Variance of each row by a first estimate of the noise [m²].
    unstated : bool
        Whether all trials have only an acceleration, without its standard error.
    """

    name = "gravity"
    loads = ("mass_drive_kg", "mass_load_kg")
    trial_axes = ("displacement", "order", "acceleration", "drive_end", "trial_in_setup")

    def __init__(
        self,
        gravity: Gravity,
        rig: RigConstants,
        laws: Mapping[str, Coefficients],
        measured: MeasuredMotion,
        acting: Sequence[tuple[Candidate, float]] = (),
        law: FrictionLaw = BASELINES["paper"],
    ) -> None:
        super().__init__(gravity, rig, laws, measured, acting, law)
        duration = self._paths.step_s[:, 0] * (POINTS - 1)
        self.events, without_events, stated = with_accelerations(
            self.table, measured.events, duration
        )
        displacement = self.events.displacement
        self.residual = (
            displacement - self._law_acceleration[self.events.trial] * self.events.tau**2 / 2
        )
        self.unstated = bool(
            without_events.all()
            and np.isnan(optional_column(self.table, "acceleration_sd_m_s2")).all()
        )
        self._speed = self._at_rows(self._paths.speed_m_s)
        self._longest_m = float(self._travel.max())
        self._whole_board: Any = self  # of all trials, also in a part
        self._one_sided: dict[tuple[Any, ...], bool] = {}
        self.variance = variance_of(
            self.events, measured.residual, self._speed**2, without_events, stated
        )

    def parts(self) -> Iterator[tuple[slice, Self]]:
        """Yield blocks of adjacent trials: their slice, and the rows of these trials alone."""
        ends = np.append(self.events.starts[1:], self.events.tau.size)
        start = 0
        while start < len(self.table):
            most = self.events.starts[start] + ROWS_AT_ONCE
            stop = max(start + 1, int(np.searchsorted(ends, most, side="right")))
            yield slice(start, stop), self.part(slice(start, stop))
            start = stop

    def part(self, trials: slice) -> Self:
        """Return the rows of some adjacent trials."""
        starts = np.append(self.events.starts, self.events.tau.size)
        rows = slice(int(starts[trials.start]), int(starts[trials.stop]))
        counts = {len(self.table): trials, self.events.tau.size: rows}

        def own(values: Any) -> Any:
            is_array = isinstance(values, np.ndarray) and values.ndim > 0
            return values[counts[len(values)]] if is_array and len(values) in counts else values

        part = copy(self)
        vars(part).update((name, own(values)) for name, values in vars(self).items())
        vars(part).pop("_integral", None)
        part.table, part.events = self.table[trials], self.events.part(trials, rows)
        part._paths = self._paths.of(trials)
        part.law = Coefficients(*map(own, self.law))
        part.condition = type(self.condition)(*map(own, self.condition))
        part.state = type(self.state)(*map(own, self.state))
        part.clock_residual = self.clock_residual[rows]
        return part

    def forces(self, force_n: Array) -> Array:
        """Return the response of each row to forces opposing the motion, shape (E, …) [m].

        Parameters
        ----------
        force_n : ndarray, broadcasts to (…, N, P)
            Forces along the paths [N].
        """
        shape = (*np.shape(force_n)[:-2], *self._travel.shape)
        along = np.broadcast_to(force_n, shape).reshape(-1, *self._travel.shape)
        travel = -self._deceleration_per_n[self.events.trial] * self._integral.of(along)
        return np.asarray(travel.reshape(self.events.tau.size, *shape[:-2]))

    @cached_property
    def _integral(self) -> DoubleIntegral:
        step = self._paths.step_s[self.events.trial, 0]
        return DoubleIntegral(self.events.trial, self.events.tau / step, step, len(self.table))

    def coefficient_forces(self) -> Array:
        """Return the derivatives of the force by c1, c2 and c3, shape (3, N, 1) [N per unit]."""
        n = np.asarray(self.state.n_pulleys, dtype=np.float64)
        tension = np.asarray(self.state.tension_n)
        wrap_change = np.asarray(self.state.wrap_angle_deg) - REFERENCE_WRAP_ANGLE_DEG
        return np.stack([n * tension, n, n * tension * wrap_change])

    def scatter_columns(self, waves: int) -> Array:
        """Return the responses of each row to relative deviations of friction.

        Parameters
        ----------
        waves : int
            Number of cosines along the travel.

        Returns
        -------
        ndarray, shape (E, 2 + waves)
            Responses to a deviation of all friction, of its intercept, and of each cosine [m].
        """
        # The friction is that at its own tension, so the feedback factor must not act again.
        friction, intercept = (
            force[:, None] / self._feedback for force in (self.friction_n, self.intercept_n)
        )
        wander = friction * cosines(self._travel / self._longest_m, waves)
        both = np.broadcast_to(np.stack([friction, intercept]), (2, *self._travel.shape))
        return self.forces(np.concatenate([both, wander]))

    @cached_property
    def _clock(self) -> Array:
        """Response to a load sensor's clock that is late by one prior standard deviation."""
        return late_column(self.events, self._speed) * clock_sd_s(self.constants)

    def clock_column(self) -> Array:
        """Return the response to a clock offset of one prior standard deviation, (E,) [m].

        It is 0 in trials that only one sensor recorded.
        """
        return self._clock

    @cached_property
    def clock_residual(self) -> Array:
        """The residual for a clock offset whose prior mean is 0, shape (E,) [m].

        :attr:`residual` may contain times that were shifted by the most likely offset.
        """
        sd = clock_sd_s(self.constants)
        shifts = clock_shifts(self._gravity.events, self.table["trial"])
        if not shifts.any():
            return self.residual
        return np.asarray(self.residual + self._clock * shifts[self.events.trial] / sd)

    def smooth_forces(self, smooth: Smooth, force_n: Array) -> Array:
        """Return the forces of a smooth process at unit coefficients, broadcasts to (k, N, P) [N].

        Parameters
        ----------
        smooth : Smooth
            The smooth process.
        force_n : ndarray, shape (N,)
            Scale of the force in each trial, if it is not relative to friction [N].
        """
        shapes = smooth.columns(self.covariates())
        unit = self.friction_n if smooth.relative else force_n
        return np.asarray(unit[:, None] * shapes)

    def _at_rows(self, values: Array) -> Array:
        """Interpolate values on the grids of the paths to the times of the rows, shape (E,)."""
        place = self.events.tau / self._paths.step_s[self.events.trial, 0]
        left = np.minimum(place.astype(int), values.shape[1] - 2)
        share = place - left
        rows = self.events.trial
        return np.asarray((1 - share) * values[rows, left] + share * values[rows, left + 1])

    def rows_of_trials(self) -> Iterator[slice]:
        """Return the slices of the rows of each trial."""
        return self.events.rows_of_trials()
