"""States of the gravity board's trials at which effects are evaluated, and their responses.

Effects are evaluated along the measured motion, at least-squares estimates of the coefficients. A
force along the path adds an acceleration, and so a travel. An error of a reading changes the
displacement of an event. It is evaluated at the events on the measured motion. The derivative of
the reading by time is then still the measured speed, which is the Jacobian of the density.
"""

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.effects import Effect, Reading, State
from bayesfric.effects.terms import ActiveEffect, small_values
from bayesfric.inference.cosines import MODES, cosines
from bayesfric.observation.coefficients import SizeIndex
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import Condition, nominal_tension
from bayesfric.recording.frames import stands_in
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.acting import surroundings
from bayesfric.rigs.base import Unsupported, why_inert
from bayesfric.rigs.gravity_board.hall_events import EventTable
from bayesfric.rigs.gravity_board.measurements import Columns, event_table, pilot_accelerations
from bayesfric.rigs.gravity_board.paths import Paths, motion_unknown, trial_paths
from bayesfric.rigs.gravity_board.trial_motion import (
    Events,
    pilot_coefficients,
    pilot_of,
    prepare_events,
    trial_condition,
)

ON_CURRENT = Unsupported("It acts on the current of a motor, and this board has none.")
SHAPED_PHASES = Unsupported("Neither its phases nor its shape over a turn were recorded.")
LEAST_ACCELERATION = 1e-3  # m/s², lower bound in a motion from rest
BENT_READING = Unsupported(
    "It rings, at an unknown rate, faster than the likelihood's fixed responses can represent."
)


class TrialPlaces:
    """N trials with rough coefficients by least squares, and their measured motion.

    Parameters
    ----------
    gravity : Gravity
        Trials and their events.
    rig : RigConstants
        Constants of the board.

    Attributes
    ----------
    condition : Condition
        Condition of each trial, arrays of shape (N,).
    size : SizeIndex
        Pulley size of each trial.
    acceleration : ndarray, shape (N,)
        Acceleration by ordinary least squares [m/s²].
    rough : dict of str to float
        Rough coefficients by name.
    law : Coefficients
        Rough coefficients of each trial, arrays of shape (1, N).
    """

    def __init__(self, gravity: Gravity, rig: RigConstants) -> None:
        self._gravity, self._rig = gravity, rig
        self.condition = trial_condition(gravity.trials, rig)
        self.size = SizeIndex.of(gravity.trials["pulley_size"])
        self.acceleration = pilot_accelerations(gravity)
        friction = self.condition.drive_force_n - self.condition.total_mass_kg * self.acceleration
        tension = nominal_tension(self.condition, self.acceleration)
        self.rough = self.size.rough_coefficients(
            self.condition.n_pulleys, self.condition.wrap_angle_deg, tension, friction
        )
        points = {name: np.array([value]) for name, value in self.rough.items()}
        self.law = self.size.coefficients(points)
        self._around = surroundings(gravity.trials, rig)

    @cached_property
    def paths(self) -> Paths:
        """Measured motion of the trials."""
        return trial_paths(self._gravity, self._rig)

    @cached_property
    def wander(self) -> Columns:
        """Responses to 1 N of each cosine of the wander."""
        shape = cosines(np.minimum(self.travel_m / self.extent_m, 1.0), MODES)
        return self.columns(list(-shape / self.condition.total_mass_kg[:, None]))

    @cached_property
    def extent_m(self) -> float:
        """The longest travel of a trial with events, which is the extent of the wander [m]."""
        return float(self.travel_m[self.with_events].max())

    @cached_property
    def table(self) -> EventTable | None:
        """Table of the events without effects along the trials, but with wander; None without."""
        wander = self.wander if self.with_events.any() else None
        return event_table(self._gravity, self._rig, scattered=wander)

    @cached_property
    def events(self) -> Events | None:
        """Events of the trials that have some; None without any."""
        with_events = self.with_events
        if not with_events.any():
            return None
        return prepare_events(self._gravity.events, self._gravity.trials["trial"][with_events])

    @cached_property
    def residual_m(self) -> float:
        """Rms residual of the events from constant accelerations; 0 without events [m]."""
        return 0.0 if self.events is None else pilot_of(self.events).rms_residual

    @property
    def with_events(self) -> Flags:
        """Which trials have events, shape (N,)."""
        trials, events = self._gravity.trials, self._gravity.events
        return np.asarray(stands_in(trials["trial"], events["trial"]))

    def state(self, law: Coefficients, acceleration: Array) -> State:
        """Return the state of each trial at speed 0, arrays of shape (W, N).

        Parameters
        ----------
        law : Coefficients
            Coefficients, arrays of shape (W, N).
        acceleration : ndarray, broadcastable to (W, N)
            Acceleration, which also determines the tension [m/s²].
        """
        return self._state(law, acceleration, 0.0)

    def typical_state(self, law: Coefficients) -> State:
        """Return the state of each trial at its mean speed and rough acceleration, (W, N)."""
        speed = self.paths.speed_m_s.mean(axis=1)
        return self._state(law, self.acceleration, speed)

    def added_acceleration(self, active: ActiveEffect, values: Mapping[str, Any]) -> Array:
        """Return the change of acceleration by an effect along the paths, (…, N, P) [m/s²]."""
        column = Condition(*(np.reshape(np.asarray(part), (-1, 1)) for part in self.condition))
        law = Coefficients(*(np.transpose(part) for part in self.law))
        around = {name: np.reshape(part, (-1, 1)) for name, part in self._around.items()}
        paths = self.paths
        state = State.of(
            law,
            column.n_pulleys,
            column.wrap_angle_deg,
            nominal_tension(column, paths.acceleration_m_s2),
            paths.speed_m_s,
            travel_m=self.travel_m,
            acceleration_m_s2=paths.acceleration_m_s2,
            **around,
        )
        force = active.effect.laws[active.law](values, state) / column.total_mass_kg
        return np.asarray(-np.broadcast_to(force, (*force.shape[:-2], *paths.speed_m_s.shape)))

    def columns(self, added: Sequence[Array]) -> Columns:
        """Return the responses to accelerations along the paths.

        Parameters
        ----------
        added : sequence of K ndarrays, shape (N, P)
            Added accelerations along the paths, at unit amplitude [m/s²].
        """
        seen, events = self.with_events, self.events
        travel = np.empty((0, 0))
        if events is not None:
            paths = self.paths.of(np.flatnonzero(seen))
            travel = paths.response(events, np.stack([force[seen] for force in added]))
        return Columns(travel, np.stack([force.mean(axis=-1) for force in added]))

    def read_columns(self, travel: Array) -> Columns:
        """Return the responses to errors of readings, (K, E) [m]; accelerations have none."""
        return Columns(travel, np.zeros((len(travel), self.acceleration.size)))

    def reading_response(self, active: ActiveEffect, values: Mapping[str, Any]) -> Array:
        """Return minus the error of each event's reading, (…, E) [m]."""
        law = active.effect.laws[active.law]
        return np.asarray(-np.asarray(law(values, self._reading)), dtype=np.float64)

    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why the likelihood cannot contain an effect; None if it can."""
        if effect.acts_on == "current":
            return ON_CURRENT
        if reason := motion_unknown(effect, self._gravity, self._rig):
            return reason
        if effect.components and effect.shape is not None:
            return SHAPED_PHASES
        if effect.acts_on == "reading" and effect.shape is not None:
            return BENT_READING
        for law in effect.laws:
            active = ActiveEffect(effect, law)
            values = small_values(effect)
            if effect.acts_on == "reading":
                response = self.reading_response(active, values)
            elif effect.along_path or effect.components:
                response = self.added_acceleration(active, values)
            else:
                response = np.asarray(
                    effect.laws[law](values, self.state(self.law, self.acceleration))
                )
            if reason := why_inert(response):
                return reason
        return None

    def _state(self, law: Coefficients, acceleration: Array, speed: Array | float) -> State:
        n, wrap = self.condition[:2]
        tension = nominal_tension(self.condition, acceleration)
        along = {**self._around, "acceleration_m_s2": acceleration}
        return State.of(law, n, wrap, tension, speed, **along)

    @cached_property
    def travel_m(self) -> Array:
        """Travel since the release along the paths, (N, P) [m].

        The travel before the first event is that from rest to the first speed at the first
        acceleration, but at most one spacing of events, because a push shortens it.
        """
        speed, acceleration = self.paths.speed_m_s[:, :1], self.paths.acceleration_m_s2[:, :1]
        start = speed**2 / (2 * np.maximum(acceleration, LEAST_ACCELERATION))
        most = self._rig.hall_spacing_m or np.inf
        return np.asarray(np.minimum(start, most) + self.paths.travel_m)

    @cached_property
    def _reading(self) -> Reading:
        """States of cable and sensor at each event, arrays of shape (E,)."""
        events, rig = self.events, self._rig
        assert events is not None and rig.hall_spacing_m
        fit = pilot_coefficients(events)[events.trial]
        trial = np.flatnonzero(self.with_events)[events.trial]
        speed = fit[:, 2] + fit[:, 3] * events.tau
        return Reading(
            displacement_m=(events.regressors * fit.T).sum(axis=0),
            event=np.rint(events.displacement / rig.hall_spacing_m),
            is_load=(events.regressors[1] != 0).astype(np.float64),
            time_s=speed / np.maximum(fit[:, 3], LEAST_ACCELERATION),
            speed_m_s=speed,
            acceleration_m_s2=fit[:, 3],
            mass_drive_kg=np.asarray(self.condition.mass_drive_kg)[trial],
            mass_load_kg=np.asarray(self.condition.mass_load_kg)[trial],
            magnets_per_revolution=rig.magnets_per_revolution or 1,
        )
