"""Events of the gravity board, row by row, and what forces along the paths do to them.

An event's displacement deviates from the motion that the reference law predicts by an
offset a sensor, a first speed, and what every force and every error of a reading does
to it. A force h(τ) along the path moves the cable by ``−∫∫ h dτ² / (m1 + m2)``; where
tension adds friction of its own, by that times a feedback. A trial that has an
acceleration alone is one row: the travel that it makes from rest.
"""

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from functools import cached_property
from typing import Any, Self

import numpy as np

from bayesfric.arrays import Array
from bayesfric.effects.candidates import Candidate
from bayesfric.inference.cosines import cosines
from bayesfric.inference.smooths import Smooth
from bayesfric.observation.linear import LinearRows
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG, Coefficients
from bayesfric.physics.laws import BASELINES, FrictionLaw
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.double_integral import POINTS, ROWS_AT_ONCE, DoubleIntegral
from bayesfric.rigs.gravity_board.event_rows import variance_of, with_accelerations
from bayesfric.rigs.gravity_board.late_clock import clock_sd_s, clock_shifts, late_column
from bayesfric.rigs.gravity_board.measured_motion import MeasuredMotion
from bayesfric.rigs.gravity_board.measurements import optional_column
from bayesfric.rigs.gravity_board.reference_motion import ReferenceMotion


class EventColumns(ReferenceMotion, LinearRows):
    """Events as rows of a linear model, and what forces along the paths do to them.

    Parameters
    ----------
    gravity : Gravity
        N trials that enter, those of an assembly adjacent.
    rig : RigConstants
        The board.
    laws : mapping of str to Coefficients
        The reference law of each pulley size.
    measured : MeasuredMotion
        Of the trials.
    acting : sequence of (Candidate, float)
        Effects on friction, with their amplitudes, with which a trial starts to move: its
        first speed tells how far it has come by the first event.

    Attributes
    ----------
    table : DataFrame
        The N trials.
    law : Coefficients
        Of each trial, arrays of shape (N,).
    friction_n, acceleration : ndarray, shape (N,)
        By the reference law; no acceleration below zero counts as motion.
    order : ndarray, shape (N,)
        Place in the recording, 0 to 1; 0.5 where there is no order.
    events : Events
        E rows, sorted by trial; its regressors are those of a motion.
    residual : ndarray, shape (E,)
        Displacement less that of the reference motion, offset and first speed left in [m].
    variance : ndarray, shape (E,)
        Of a row, by a first estimate of the noise [m²].
    unstated : bool
        Whether all trials have an acceleration alone, without its standard error.
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
        self.events, alone, stated = with_accelerations(self.table, measured.events, duration)
        displacement = self.events.displacement
        self.residual = displacement - self._predicted[self.events.trial] * self.events.tau**2 / 2
        self.unstated = bool(
            alone.all() and np.isnan(optional_column(self.table, "acceleration_sd_m_s2")).all()
        )
        self._speed = self._at_rows(self._paths.speed_m_s)
        self._longest_m = float(self._travel.max())
        self._whole: Any = self
        self._one_sided: dict[tuple[Any, ...], bool] = {}
        self.variance = variance_of(self.events, measured.rough, self._speed**2, alone, stated)

    def parts(self) -> Iterator[tuple[slice, Self]]:
        """Yield trials, some at a time: which they are, and they alone."""
        ends = np.append(self.events.starts[1:], self.events.tau.size)
        start = 0
        while start < len(self.table):
            most = self.events.starts[start] + ROWS_AT_ONCE
            stop = max(start + 1, int(np.searchsorted(ends, most, side="right")))
            yield slice(start, stop), self.part(slice(start, stop))
            start = stop

    def part(self, trials: slice) -> Self:
        """Return some trials that lie next to each other."""
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
        """Return what forces against the motion do to each row, shape (E, …) [m].

        Parameters
        ----------
        force_n : ndarray
            Along the paths, (…, N, P) or what broadcasts to it [N].
        """
        shape = (*np.shape(force_n)[:-2], *self._travel.shape)
        along = np.broadcast_to(force_n, shape).reshape(-1, *self._travel.shape)
        travel = -self._slowed[self.events.trial] * self._integral.of(along)
        return np.asarray(travel.reshape(self.events.tau.size, *shape[:-2]))

    @cached_property
    def _integral(self) -> DoubleIntegral:
        step = self._paths.step_s[self.events.trial, 0]
        return DoubleIntegral(self.events.trial, self.events.tau / step, step, len(self.table))

    def coefficient_forces(self) -> Array:
        """Return the force of c1, c2 and c3 along the paths, shape (3, N, 1) [N per unit]."""
        n = np.asarray(self.state.n_pulleys, dtype=np.float64)
        tension = np.asarray(self.state.tension_n)
        turn = np.asarray(self.state.wrap_angle_deg) - REFERENCE_WRAP_ANGLE_DEG
        return np.stack([n * tension, n, n * tension * turn])

    def scatter_columns(self, waves: int) -> Array:
        """Return what relative deviations of friction do to each row.

        Parameters
        ----------
        waves : int
            Cosines along the travel.

        Returns
        -------
        ndarray, shape (E, 2 + waves)
            Of all friction, of the intercept's part, and of each cosine [m].
        """
        # Friction of the reference law is what it is with its tension: no feedback twice.
        friction, intercept = (
            force[:, None] / self._feedback for force in (self.friction_n, self.intercept_n)
        )
        wander = friction * cosines(self._travel / self._longest_m, waves)
        both = np.broadcast_to(np.stack([friction, intercept]), (2, *self._travel.shape))
        return self.forces(np.concatenate([both, wander]))

    @cached_property
    def _clock(self) -> Array:
        """What the load sensor's clock adds where it is late by a prior standard deviation."""
        return late_column(self.events, self._speed) * clock_sd_s(self.constants)

    def clock_column(self) -> Array:
        """Return what the offset between the sensors' clocks does at unit size, (E,) [m].

        It is late by a standard deviation of its prior, in trials that both sensors recorded.
        """
        return self._clock

    @cached_property
    def clock_residual(self) -> Array:
        """The residual with the offset counted from its prior mean, shape (E,) [m].

        Times may have been moved by the most likely offset of a trial.
        """
        sd = clock_sd_s(self.constants)
        shifts = clock_shifts(self._gravity.events, self.table["trial"])
        if not shifts.any():
            return self.residual
        return np.asarray(self.residual + self._clock * shifts[self.events.trial] / sd)

    def smooth_forces(self, smooth: Smooth, force_n: Array) -> Array:
        """Return a smooth force of unit size, broadcasts to (k, N, P) [N].

        Parameters
        ----------
        smooth : Smooth
            The process.
        force_n : ndarray, shape (N,)
            Unit of the force in each trial, unless it is friction [N].
        """
        shapes = smooth.columns(self.covariates())
        unit = self.friction_n if smooth.relative else force_n
        return np.asarray(unit[:, None] * shapes)

    def _at_rows(self, values: Array) -> Array:
        """Interpolate what is known along the paths to the rows, shape (E,)."""
        place = self.events.tau / self._paths.step_s[self.events.trial, 0]
        left = np.minimum(place.astype(int), values.shape[1] - 2)
        share = place - left
        rows = self.events.trial
        return np.asarray((1 - share) * values[rows, left] + share * values[rows, left + 1])

    def rows_of_trials(self) -> Iterator[slice]:
        """Yield the rows of each trial."""
        return self.events.rows_of_trials()
