"""Events of the gravity board, row by row, linear around the reference law's motion.

An event's displacement deviates from the motion that the reference law predicts by an
offset a sensor, a first speed, and what every force and every error of a reading does
to it. A force h(τ) along the path moves the cable by ``−∫∫ h dτ² / (m1 + m2)``; where
tension adds friction of its own, by that times a feedback. A trial that has an
acceleration alone is one row: the travel that it makes from rest.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.effects import Law, Reading, State
from bayesfric.effects.candidates import Candidate, unit_values
from bayesfric.inference.smooths import Smooth
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG, Coefficients
from bayesfric.physics.gravity import coulomb_acceleration, nominal_tension, tension_feedback
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.likelihood import trial_condition
from bayesfric.rigs.gravity_board.measured_motion import MeasuredMotion, travel_to_speed
from bayesfric.rigs.gravity_board.trial_motion import Events, prepare_events

__all__ = ["GravityRows", "rank"]

Array = NDArray[np.float64]
STATED_SD = 0.01  # m/s², of an acceleration that comes without its standard error
ROUGH = 9.0  # times the noise: squared, what no smooth path follows
LEAST_ACCELERATION = 0.02  # m/s², where the reference law predicts that the cable stands


class GravityRows:
    """Events as rows of a linear model.

    Parameters
    ----------
    gravity : Gravity
        N trials that enter, those of an assembly adjacent.
    rig : RigConstants
        The board.
    laws : mapping of str to Coefficients
        The reference law of each pulley size.
    radii : mapping of str to float
        Pulley radius of each size [m].
    measured : MeasuredMotion
        Of the trials.
    acting : sequence of (Candidate, float)
        Effects on friction, with their amplitudes, with which a trial starts to move: its
        first speed tells how far it has come by the first event.

    Attributes
    ----------
    trials : DataFrame
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
    """

    def __init__(
        self,
        gravity: Gravity,
        rig: RigConstants,
        laws: Mapping[str, Coefficients],
        radii: Mapping[str, float],
        measured: MeasuredMotion,
        acting: Sequence[tuple[Candidate, float]] = (),
    ) -> None:
        self.trials, self._rig = gravity.trials, rig
        self.condition = trial_condition(gravity.trials, rig)
        sizes = gravity.trials["pulley_size"]
        self.law = Coefficients(*(np.array(c) for c in zip(*(laws[s] for s in sizes), strict=True)))
        predicted = coulomb_acceleration(self.law, self.condition)
        mass = self.condition.total_mass_kg
        self.friction_n = self.condition.drive_force_n - mass * predicted
        self.acceleration = np.maximum(predicted, 0.0)
        self.order = rank(gravity.trials)
        self._radius = np.array([radii[size] for size in sizes])
        self._paths, self._rough = measured
        self._feedback = tension_feedback(self.law, self.condition)[:, None]
        self._slowed = self._feedback / mass[:, None]
        self._before = self._travel_before(acting)
        self._travel = self._travelled()
        self.state = self._state()
        self.events, alone, stated = self._rows(gravity)
        displacement = self.events.displacement
        self.residual = displacement - predicted[self.events.trial] * self.events.tau**2 / 2
        self._speed = self._at_rows(self._paths.speed_m_s)
        self.variance = self._noise(alone, stated)

    def covariates(self) -> dict[str, Array]:
        """Return where every trial is along its path, arrays that broadcast to (N, P)."""
        return {
            "velocity": self._paths.speed_m_s,
            "displacement": self._travel,
            "tension": np.asarray(self.state.tension_n),
            "n_pulleys": np.asarray(self.state.n_pulleys, dtype=np.float64),
            "wrap_angle": np.asarray(self.state.wrap_angle_deg, dtype=np.float64),
            "order": self.order[:, None],
            "acceleration": self.acceleration[:, None],
        }

    def forces(self, force_n: Array) -> Array:
        """Return what a force against the motion does to each row, shape (E,) [m].

        Parameters
        ----------
        force_n : ndarray
            Along the paths, broadcasts to (N, P) [N].
        """
        slowing = np.broadcast_to(-self._slowed * force_n, self._travel.shape)
        return self._paths.response(self.events, slowing)

    def coefficient_columns(self) -> Array:
        """Return what c1, c2 and c3 do to each row, shape (E, 3) [m per unit]."""
        n = np.asarray(self.state.n_pulleys, dtype=np.float64)
        tension = np.asarray(self.state.tension_n)
        turn = np.asarray(self.state.wrap_angle_deg) - REFERENCE_WRAP_ANGLE_DEG
        each = (n * tension, n, n * tension * turn)
        return np.stack([self.forces(force) for force in each], axis=1)

    def scatter_column(self) -> Array:
        """Return what a relative deviation of friction of 1 does to each row, (E,) [m]."""
        # Friction of the reference law is what it is with its tension: no feedback twice.
        return self.forces(self.friction_n[:, None] / self._feedback)

    def smooth_columns(self, smooth: Smooth, force_n: Array) -> Array:
        """Return what a smooth force of unit size does, shape (E, k) [m].

        Parameters
        ----------
        smooth : Smooth
            The process.
        force_n : ndarray, shape (N,)
            Unit of the force in each trial, unless it is friction [N].
        """
        shapes = smooth.columns(self.covariates())
        unit = self.friction_n if smooth.relative else force_n
        return np.stack([self.forces(unit[:, None] * shape) for shape in shapes], axis=1)

    def candidate_columns(self, candidate: Candidate) -> Array:
        """Return what an effect of amplitude 1 does, shape (E, C) [m].

        C is 1; of an effect with phases it is the number of its components, of one on
        readings for each sensor.
        """
        effect = candidate.effect
        if effect.acts_on == "current":
            return np.zeros((self.events.tau.size, 1))
        values, small = unit_values(candidate)
        law = effect.laws[candidate.law]
        if effect.acts_on == "reading":
            beyond = self._beyond(law, values) / small
            if not effect.components:
                return np.asarray(-np.broadcast_to(beyond, self.residual.shape)[:, None])
            sensors = self.events.regressors[:2] != 0
            return np.stack([-part * seen for part in beyond for seen in sensors], axis=1)
        force = np.asarray(law(values, self.state)) / small
        parts = force if effect.components else force[None]
        return np.stack([self.forces(part) for part in parts], axis=1)

    def relative_force(self, candidate: Candidate) -> Array:
        """Return what an effect of amplitude 1 adds to friction, or its equivalent.

        The equivalent of an error of readings is (m1 + m2) times the acceleration that a
        parabola through the events takes it for.

        Returns
        -------
        ndarray
            As a share of the reference law's friction, broadcasts to (C, N, P); C is the
            number of an effect's components, else 1.
        """
        effect, friction = candidate.effect, self.friction_n[:, None]
        if effect.acts_on == "current":
            return np.zeros((1, len(self.trials), 1))
        if effect.acts_on == "reading":
            column = self.candidate_columns(candidate).sum(axis=1)
            off = np.array([self._parabola(rows, column[rows]) for rows in self.rows_of_trials()])
            return np.asarray(self.condition.total_mass_kg * off / self.friction_n)[None, :, None]
        values, small = unit_values(candidate)
        force = np.asarray(effect.laws[candidate.law](values, self.state)) / small / friction
        return force if effect.components else force[None]

    def relative_deviation(self) -> Array:
        """Return how far each trial's friction is from the law, as a share of it, (N,)."""
        off = [self._parabola(rows, self.residual[rows]) for rows in self.rows_of_trials()]
        return np.asarray(-self.condition.total_mass_kg * np.array(off) / self.friction_n)

    def _parabola(self, rows: slice, displacement: Array) -> float:
        """Return the acceleration of a parabola through one trial's rows [m/s²]."""
        nuisance = self.events.regressors[:3, rows]
        nuisance = nuisance[(nuisance != 0).any(axis=1)]
        design = np.column_stack([self.events.tau[rows] ** 2 / 2, *nuisance])
        return float(np.linalg.lstsq(design, displacement, rcond=None)[0][0])

    def window_columns(self, count: int) -> tuple[Array, dict[str, Array]]:
        """Return what a newton in each of some windows does, and where the windows lie.

        Parameters
        ----------
        count : int
            Windows a trial, of equal travel, W.

        Returns
        -------
        columns : ndarray, shape (W, E)
            Per newton against the motion [m/N].
        covariates : dict of str to ndarray of shape (N, W)
            Means over each window.
        """
        start, end = self._travel[:, :1], self._travel[:, -1:]
        share = (self._travel - start) / np.where(end > start, end - start, 1.0)
        window = np.minimum((share * count).astype(int), count - 1)
        inside = window == np.arange(count)[:, None, None]
        columns = np.stack([self.forces(chosen / self._feedback) for chosen in inside])
        weight = inside / np.maximum(inside.sum(axis=2, keepdims=True), 1)
        shape = self._travel.shape
        places = {
            name: (weight * np.broadcast_to(values, shape)).sum(axis=2).T
            for name, values in self.covariates().items()
        }
        return columns, places

    def _travelled(self) -> Array:
        """Return the travel since the release along every path, shape (N, P) [m]."""
        speed = self._paths.speed_m_s
        step = self._paths.step_s * 0.5 * (speed[:, 1:] + speed[:, :-1])
        before = self._before[:, None]
        return np.concatenate([before, before + np.cumsum(step, axis=1)], axis=1)

    def _travel_before(self, acting: Sequence[tuple[Candidate, float]]) -> Array:
        """Return the travel from the release to the first event, shape (N,) [m]."""

        def acceleration(travel: Array, speed: Array) -> Array:
            state = self._state_at(travel, speed)
            force = np.zeros_like(travel)
            for candidate, amplitude in acting:
                values, small = unit_values(candidate)
                law = candidate.effect.laws[candidate.law]
                force = force + amplitude / small * np.asarray(law(values, state))
            return np.asarray(self.acceleration[:, None] - self._slowed * force)

        return travel_to_speed(self._paths.speed_m_s[:, 0], acceleration)

    def _state(self) -> State:
        return self._state_at(self._travel, self._paths.speed_m_s)

    def _state_at(self, travel_m: Array, speed_m_s: Array) -> State:
        condition = self.condition
        return State.of(
            Coefficients(*(np.asarray(part)[:, None] for part in self.law)),
            np.asarray(condition.n_pulleys)[:, None],
            np.asarray(condition.wrap_angle_deg)[:, None],
            nominal_tension(condition, self.acceleration)[:, None],
            speed_m_s,
            travel_m=travel_m,
            acceleration_m_s2=self.acceleration[:, None],
            radius_m=self._radius[:, None],
            order=self.order[:, None],
            gravity_m_s2=condition.gravity_m_s2,
        )

    def _rows(self, gravity: Gravity) -> tuple[Events, NDArray[np.bool_], Array]:
        """Return all rows, which of them are of an acceleration alone, and its sd [m/s²]."""
        trials = gravity.trials
        events = prepare_events(gravity.events, trials["trial"])
        alone = np.flatnonzero(~np.isin(np.arange(len(trials)), events.trial))
        duration = self._paths.step_s[alone, 0] * (self._travel.shape[1] - 1)
        stated = np.full(len(trials), np.nan)
        if "acceleration_m_s2" in trials:
            stated = trials["acceleration_m_s2"].to_numpy(dtype=np.float64)
        travel = stated[alone] * duration**2 / 2
        trial = np.concatenate([events.trial, alone])
        order = np.argsort(trial, kind="stable")
        regressors = np.hstack([events.regressors, np.zeros((4, alone.size))])[:, order]
        rows = replace(
            events,
            trial=trial[order],
            tau=np.concatenate([events.tau, duration])[order],
            displacement=np.concatenate([events.displacement, travel])[order],
            regressors=regressors,
            starts=np.flatnonzero(np.diff(trial[order], prepend=-1)),
        )
        sd = np.full(len(trials), STATED_SD)
        if "acceleration_sd_m_s2" in trials:
            given = trials["acceleration_sd_m_s2"].to_numpy(dtype=np.float64)
            sd = np.where(np.isfinite(given), given, sd)
        return rows, np.isin(rows.trial, alone), sd

    def _at_rows(self, values: Array) -> Array:
        """Interpolate what is known along the paths to the rows, shape (E,)."""
        place = self.events.tau / self._paths.step_s[self.events.trial, 0]
        left = np.minimum(place.astype(int), values.shape[1] - 2)
        share = place - left
        rows = self.events.trial
        return np.asarray((1 - share) * values[rows, left] + share * values[rows, left + 1])

    def _beyond(self, law: Law, values: Mapping[str, Any]) -> Array:
        """Return how far magnets pass beyond their places [m]."""
        reading = self.readings()
        at_ends = [np.full_like(self.residual, end) for end in (0.0, 1.0)]
        if not all(np.any(law(values, reading._replace(is_load=end))) for end in at_ends):
            # Seen by one sensor alone: where there is another one, that tells it from any
            # motion, so that the measured motion may stand for the true one.
            both = self._seen_by_both()
            travel = self._at_rows(self._travel) - self._before[self.events.trial]
            reading = reading._replace(
                displacement_m=np.where(both, travel, reading.displacement_m),
                speed_m_s=np.where(both, self._speed, reading.speed_m_s),
            )
        return np.asarray(law(values, reading))

    def _seen_by_both(self) -> NDArray[np.bool_]:
        """Return which rows are of trials that both sensors recorded, shape (E,)."""
        sensors = self.events.regressors[:2] != 0
        both = [sensors[:, rows].any(axis=1).all() for rows in self.rows_of_trials()]
        return np.array(both)[self.events.trial]

    def readings(self) -> Reading:
        """Return where cable and sensors are at every row, by the reference law."""
        events, condition = self.events, self.condition
        trial, is_load = events.trial, (events.regressors[1] != 0).astype(np.float64)
        # The reference law's motion, not the measured one: a reading's error in proportion
        # to what was read would explain everything.
        rate = np.maximum(self.acceleration, LEAST_ACCELERATION)[trial]
        first, tau = self._paths.speed_m_s[trial, 0], events.tau
        spacing = self._rig.hall_spacing_m or 1.0
        return Reading(
            displacement_m=first * tau + rate * tau**2 / 2,
            event=np.round(events.displacement / spacing),
            is_load=is_load,
            time_s=first / rate + tau,
            speed_m_s=first + rate * tau,
            acceleration_m_s2=rate,
            mass_drive_kg=np.asarray(condition.mass_drive_kg)[trial],
            mass_load_kg=np.asarray(condition.mass_load_kg)[trial],
            magnets_per_revolution=self._rig.magnets_per_revolution or 1,
        )

    def _noise(self, alone: NDArray[np.bool_], stated_sd: Array) -> Array:
        """Return the variance of each row by residuals from each trial's smooth motion."""
        travel = self.events.tau**2 / 2
        stated = (stated_sd[self.events.trial] * travel) ** 2
        if alone.all():
            return np.asarray(stated)
        square, speed2 = np.zeros_like(self.residual), self._speed**2
        square[~alone] = self._rough**2
        slope, level = np.polyfit(speed2[~alone], square[~alone], 1)
        # Neither part of the noise is negative.
        if level < 0:
            level, slope = 0.0, square[~alone].mean() / speed2[~alone].mean()
        elif slope < 0:
            level, slope = square[~alone].mean(), 0.0
        variance = level + slope * speed2
        for rows in self.rows_of_trials():
            # Where no smooth path follows a trial, as where the cable all but stops, what a
            # force does along it is not known: the trial counts by so much less.
            rough = square[rows].mean() / variance[rows].mean()
            variance[rows] *= rough if rough > ROUGH else 1.0
        return np.where(alone, stated, variance)

    def rows_of_trials(self) -> Iterator[slice]:
        """Yield the rows of each trial."""
        ends = np.append(self.events.starts[1:], self.events.tau.size)
        for start, end in zip(self.events.starts, ends, strict=True):
            yield slice(start, end)


def rank(trials: pd.DataFrame) -> Array:
    """Return each row's place in the order of the recording, 0 to 1, shape (N,)."""
    if "order" not in trials or trials["order"].isna().any() or len(trials) < 2:
        return np.full(len(trials), 0.5)
    return np.asarray((trials["order"].rank().to_numpy(dtype=np.float64) - 1) / (len(trials) - 1))
