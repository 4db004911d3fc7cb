"""Where trials of the gravity board are when an effect acts, and what it does there.

Effects are evaluated along the measured motion, at coefficients by least squares. A force
along the path adds an acceleration, and so a travel; an error of a reading lets the events
say another displacement than the cable's. It is evaluated where the events lie on the
measured motion, so that the slope of what is read remains the measured speed, which stands
in the Jacobian.
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
from bayesfric.rigs.gravity_board.paths import Paths, motion_untold, trial_paths
from bayesfric.rigs.gravity_board.trial_motion import (
    Events,
    pilot_coefficients,
    pilot_of,
    prepare_events,
    trial_condition,
)

ON_CURRENT = Unsupported("It acts on the current of a motor, and this board has none.")
SHAPED_PHASES = Unsupported(
    "Nobody recorded its phases, and how it varies between them is not known either."
)
LEAST_ACCELERATION = 1e-3  # m/s², of a trial that is said to start from rest
BENT_READING = Unsupported(
    "It rings faster than the likelihood's few fixed responses follow, its rate being unknown."
)


class TrialPlaces:
    """N trials, roughly: coefficients by least squares, and the measured motion.

    Parameters
    ----------
    gravity : Gravity
        Trials and their events.
    rig : RigConstants
        The board.

    Attributes
    ----------
    condition : Condition
        Of each trial, arrays of shape (N,).
    size : SizeIndex
        Pulley size of each trial.
    acceleration : ndarray, shape (N,)
        By plain least squares [m/s²].
    rough : dict of str to float
        Coefficients by name.
    law : Coefficients
        The same for each trial, arrays of shape (1, N).
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
        """What a newton of each cosine of the wander adds."""
        shape = cosines(np.minimum(self.travel_m / self.extent_m, 1.0), MODES)
        return self.columns(list(-shape / self.condition.total_mass_kg[:, None]))

    @cached_property
    def extent_m(self) -> float:
        """The longest travel of a trial with events, along which friction wanders [m]."""
        return float(self.travel_m[self.with_events].max())

    @cached_property
    def table(self) -> EventTable | None:
        """The events where nothing but wander changes along the trials; None without any."""
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
        """Rms residual of the events of trials of constant acceleration; 0 without any [m]."""
        return 0.0 if self.events is None else pilot_of(self.events).rms_residual

    @property
    def with_events(self) -> Flags:
        """Which trials have events, shape (N,)."""
        trials, events = self._gravity.trials, self._gravity.events
        return np.asarray(stands_in(trials["trial"], events["trial"]))

    def state(self, law: Coefficients, acceleration: Array) -> State:
        """Return where trials are on average, arrays of shape (W, N).

        Parameters
        ----------
        law : Coefficients
            Arrays of shape (W, N).
        acceleration : ndarray, broadcastable to (W, N)
            Sets the tension too [m/s²].
        """
        return self._state(law, acceleration, 0.0)

    def typical_state(self, law: Coefficients) -> State:
        """Return where trials are at their mean speed and rough acceleration, (W, N)."""
        speed = self.paths.speed_m_s.mean(axis=1)
        return self._state(law, self.acceleration, speed)

    def slowing(self, active: ActiveEffect, values: Mapping[str, Any]) -> Array:
        """Return the acceleration that a force adds along the paths, (…, N, P) [m/s²]."""
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
        """Return what accelerations along the paths do.

        Parameters
        ----------
        added : sequence of K ndarrays, shape (N, P)
            Along the paths, at unit amplitude [m/s²].
        """
        seen, events = self.with_events, self.events
        travel = np.empty((0, 0))
        if events is not None:
            paths = self.paths.of(np.flatnonzero(seen))
            travel = paths.response(events, np.stack([force[seen] for force in added]))
        return Columns(travel, np.stack([force.mean(axis=-1) for force in added]))

    def read_columns(self, travel: Array) -> Columns:
        """Return what errors of readings do, shape (K, E) [m]: an acceleration has none."""
        return Columns(travel, np.zeros((len(travel), self.acceleration.size)))

    def misread(self, active: ActiveEffect, values: Mapping[str, Any]) -> Array:
        """Return the travel that an error of readings takes from each event, (…, E) [m]."""
        law = active.effect.laws[active.law]
        return np.asarray(-np.asarray(law(values, self._reading)), dtype=np.float64)

    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why an effect cannot enter the likelihood; None where it can."""
        if effect.acts_on == "current":
            return ON_CURRENT
        if reason := motion_untold(effect, self._gravity, self._rig):
            return reason
        if effect.components and effect.shape is not None:
            return SHAPED_PHASES
        if effect.acts_on == "reading" and effect.shape is not None:
            return BENT_READING
        for law in effect.laws:
            active = ActiveEffect(effect, law)
            values = small_values(effect)
            if effect.acts_on == "reading":
                response = self.misread(active, values)
            elif effect.along_path or effect.components:
                response = self.slowing(active, values)
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

        The board is taken to have come to its first speed at its first acceleration, over one
        spacing of the magnets at most: a push spares some travel.
        """
        speed, acceleration = self.paths.speed_m_s[:, :1], self.paths.acceleration_m_s2[:, :1]
        start = speed**2 / (2 * np.maximum(acceleration, LEAST_ACCELERATION))
        most = self._rig.hall_spacing_m or np.inf
        return np.asarray(np.minimum(start, most) + self.paths.travel_m)

    @cached_property
    def _reading(self) -> Reading:
        """Where the cable and a sensor are at each event, arrays of shape (E,)."""
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
