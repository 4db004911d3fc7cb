"""Responses of the gravity board's rows to effects: to forces, and to errors of readings.

In a stray trial, friction is far from that of other trials of its assembly. The cable may have
caught once, or the trial nearly stalled. This is not an effect. If the trial were kept, it would
increase the estimated scatter of all trials.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bayesfric.arrays import Array, Flags
from bayesfric.effects import ActsOn, Effect, Reading
from bayesfric.effects.candidates import Candidate, unit_response
from bayesfric.observation.layout import COEFFICIENTS, ModelColumns
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.gravity_board.event_columns import EventColumns
from bayesfric.rigs.gravity_board.measured_motion import LEAST_ACCELERATION
from bayesfric.rigs.gravity_board.paths import motion_unknown
from bayesfric.rigs.gravity_board.reference_motion import PUSHED

EQUIVALENT_WINDOWS = 8  # windows of a trial in which an error of readings is expressed as a force
NO_FORCE = Unsupported("it is an error of readings, or its phase differs from trial to trial")
NO_READING = Unsupported("it is a force, or its phase differs from trial to trial")
NO_CURRENT = Unsupported("it acts on a motor's current, and no motor drives these trials")


class GravityRows(EventColumns):
    """Events as rows of a linear model, with their responses to effects."""

    def where(self, acts_on: ActsOn) -> Any:
        """Return the states at which a law that acts so is evaluated, or Unsupported."""
        if acts_on == "current":
            return NO_CURRENT
        return self.readings() if acts_on == "reading" else self.state

    def _unsupported(self, effect: Effect) -> Unsupported | None:
        if effect.acts_on == "current":
            return NO_CURRENT
        return motion_unknown(effect, self._gravity, self.constants)

    def candidate_columns(self, candidate: Candidate) -> Array | Unsupported:
        """Return the response of each row to an effect of amplitude 1, shape (E, C) [m].

        C is 1 for an effect without phases. With phases, it is the number of components, or for
        an effect on readings the number of components times that of sensors.
        """
        effect = candidate.effect
        if reason := self._unsupported(effect):
            return reason
        if effect.acts_on == "reading":
            error = self._reading_error(candidate)
            if not effect.components:
                return np.asarray(-np.broadcast_to(error, self.residual.shape)[:, None])
            sensors = self.events.of_sensors
            return np.stack([-part * seen for part in error for seen in sensors], axis=1)
        return self.forces(self.candidate_forces(candidate))

    def candidate_forces(self, candidate: Candidate) -> Array:
        """Return the forces of an effect of amplitude 1 along the paths, (C, N, P) [N]."""
        force = unit_response(candidate, self.state)
        if candidate.effect.components:
            return force
        # The force may be a scalar, such as 0 for an effect of the direction of motion.
        return np.broadcast_to(force, self._travel.shape)[None]

    def filled(self, model: ModelColumns, force_n: Array) -> Array:
        """Return the local columns of a model, not yet scaled, shape (E, q) [m].

        The columns of effects with phases are 0, because phases have random columns.

        Parameters
        ----------
        model : ModelColumns
            Specification of the columns.
        force_n : ndarray, shape (N,)
            Scale of smooth forces in each trial [N].
        """
        shape = self._travel.shape

        def along(forces: Array) -> Array:
            return np.broadcast_to(forces, (len(forces), *shape)).reshape(len(forces), -1).T

        def force(candidate: Candidate) -> Array | Unsupported:
            effect = candidate.effect
            if effect.acts_on == "reading" or effect.components:
                return NO_FORCE
            return self._unsupported(effect) or self.candidate_forces(candidate).ravel()

        def reading(candidate: Candidate) -> Array | Unsupported:
            effect = candidate.effect
            if effect.acts_on != "reading" or effect.components:
                return NO_READING
            columns = self.candidate_columns(candidate)
            return columns if isinstance(columns, Unsupported) else columns[:, 0]

        # The forces of all columns are integrated together.
        forces = model.filled(
            self.name,
            along(self.coefficient_forces()),
            lambda smooth: along(self.smooth_forces(smooth, force_n)),
            force,
        )
        columns = self.forces(forces.T.reshape(-1, *shape))
        none = np.zeros((self.residual.size, COEFFICIENTS))
        columns += model.filled(self.name, none, lambda _: np.zeros(()), reading)
        return columns

    def release_column(self, candidate: Candidate) -> Array | None:
        """Return the change of an effect's column if the travel before the first event is longer.

        The travel is longer by one standard deviation of its error.

        Returns
        -------
        ndarray, shape (E,), or None
            Change of the column [m]; None for an effect that does not depend on travel.
        """
        effect = candidate.effect
        if effect.acts_on not in ("friction", "drive") or effect.components:
            return None
        further = self._travel + (PUSHED * self._travel_to_first)[:, None]
        response = unit_response(candidate, self.state._replace(travel_m=further))
        change = response - unit_response(candidate, self.state)
        return self.forces(change) if np.any(change) else None

    def uneven_column(self, candidate: Candidate) -> Array:
        """Return the response to the part of an effect that varies between trials, (E,) [m].

        It is not 0 only for an error of one sensor, in trials with two sensors. Slip of a cable
        depends on friction and other conditions that vary between trials. Events are known to
        about 30 µm, so without this variation a slip of centimetres would have to follow its law
        to a thousandth.
        """
        effect = candidate.effect
        column = np.zeros_like(self.residual)
        if effect.acts_on != "reading" or effect.components or self._unsupported(effect):
            return column
        if self._of_one_sensor(candidate):
            column -= self._reading_error(candidate) * self._seen_by_both()
        return column

    def relative_force(self, candidate: Candidate) -> Array | Unsupported:
        """Return the force of an effect of amplitude 1, or its equivalent, relative to friction.

        An error of readings is expressed as the force that it is mistaken for. Without phases,
        this is (m1 + m2) times the acceleration of a parabola fitted to the error. With phases,
        it is a force in each of several windows of the travel.

        Returns
        -------
        ndarray
            Force relative to the friction of the reference law, broadcasts to (C, N, P). C is the
            number of components of the effect, or 1 without components.
        """
        effect, friction = candidate.effect, self.friction_n[:, None]
        if reason := self._unsupported(effect):
            return reason
        if effect.acts_on == "reading":
            columns = self.candidate_columns(candidate)
            assert not isinstance(columns, Unsupported)
            if effect.components:
                return np.asarray(self._equivalent_forces(columns) / self.friction_n[:, None])
            acceleration = np.array(
                [self._parabola(rows, columns[rows]) for rows in self.rows_of_trials()]
            )
            force = self.condition.total_mass_kg * acceleration.T
            return np.asarray(force / self.friction_n)[:, :, None]
        force = unit_response(candidate, self.state) / friction
        return force if effect.components else force[None]

    def _equivalent_forces(self, columns: Array) -> Array:
        """Return the forces in windows for which errors of readings are mistaken, (C, N, W) [N]."""
        newton, _ = self.window_columns(EQUIVALENT_WINDOWS)
        forces = np.zeros((columns.shape[1], len(self.table), EQUIVALENT_WINDOWS))
        for trial, rows in enumerate(self.rows_of_trials()):
            design = np.column_stack([newton[:, rows].T, self.events.nuisances(rows).T])
            size = np.linalg.norm(design, axis=0)
            size = np.where(size > 0, size, 1.0)
            solved = np.linalg.lstsq(design / size, columns[rows], rcond=1e-9)[0] / size[:, None]
            forces[:, trial] = solved[:EQUIVALENT_WINDOWS].T
        return forces

    def size_of(self, candidate: Candidate) -> float:
        """Return the rms response to amplitude 1: relative to friction, or a reading in metres."""
        if candidate.effect.acts_on == "reading":
            columns = self.candidate_columns(candidate)
            assert not isinstance(columns, Unsupported)
            return float(np.sqrt((columns.sum(axis=1) ** 2).mean()))
        return super().size_of(candidate)

    def strays(self) -> tuple[str, ...]:
        """Return the trials whose friction differs greatly from that of their assembly."""
        far = far_from_their_own(self.relative_deviation(), self.table["setup"].to_numpy())
        return tuple(str(trial) for trial in self.table["trial"][far])

    def relative_deviation(self) -> Array:
        """Return each trial's friction minus that of the law, relative to the latter, (N,)."""
        acceleration = np.array(
            [self._parabola(rows, self.residual[rows, None])[0] for rows in self.rows_of_trials()]
        )
        return np.asarray(-self.condition.total_mass_kg * acceleration / self.friction_n)

    def _parabola(self, rows: slice, displacement: Array) -> Array:
        """Return the accelerations of parabolas fitted to columns of one trial, (C,) [m/s²]."""
        design = np.column_stack([self.events.tau[rows] ** 2 / 2, *self.events.nuisances(rows)])
        return np.asarray(np.linalg.lstsq(design, displacement, rcond=None)[0][0])

    def window_columns(self, count: int) -> tuple[Array, dict[str, Array]]:
        """Return the responses to a force in each window of travel, and the windows' covariates.

        Parameters
        ----------
        count : int
            W, the number of windows of each trial; they have equal travel.

        Returns
        -------
        columns : ndarray, shape (W, E)
            Response to 1 N opposing the motion in each window [m/N].
        covariates : dict of str to ndarray of shape (N, W)
            Mean of each covariate over each window.
        """
        start, end = self._travel[:, :1], self._travel[:, -1:]
        share = (self._travel - start) / np.where(end > start, end - start, 1.0)
        window = np.minimum((share * count).astype(int), count - 1)
        inside = window == np.arange(count)[:, None, None]
        columns = self.forces(inside / self._feedback).T
        weight = inside / np.maximum(inside.sum(axis=2, keepdims=True), 1)
        shape = self._travel.shape
        places = {
            name: (weight * np.broadcast_to(values, shape)).sum(axis=2).T
            for name, values in self.covariates().items()
        }
        return columns, places

    def _reading_error(self, candidate: Candidate) -> Array:
        """Return how far magnets pass beyond their recorded places at amplitude 1 [m]."""
        reading = self.readings()
        if self._of_one_sensor(candidate):
            # With two sensors, the other one distinguishes the error of one sensor from any
            # motion. It is then evaluated at the measured displacement and speed.
            both = self._seen_by_both()
            reading = reading._replace(
                displacement_m=np.where(both, self.events.displacement, reading.displacement_m),
                speed_m_s=np.where(both, self._speed, reading.speed_m_s),
            )
        return unit_response(candidate, reading)

    def _of_one_sensor(self, candidate: Candidate) -> bool:
        """Return whether an effect is an error of one of the sensors only, in all trials."""
        board, key = self._whole_board, (candidate.effect.name, candidate.law, candidate.shape)
        if key not in self._one_sided:
            reading = board.readings()
            at_ends = [np.full_like(board.residual, end) for end in (0.0, 1.0)]
            has_error = [
                np.any(unit_response(candidate, reading._replace(is_load=end))) for end in at_ends
            ]
            self._one_sided[key] = not all(has_error)
        return self._one_sided[key]

    def _seen_by_both(self) -> Flags:
        """Return which rows belong to trials that both sensors recorded, shape (E,)."""
        sensors = self.events.of_sensors
        both = [sensors[:, rows].any(axis=1).all() for rows in self.rows_of_trials()]
        return np.array(both)[self.events.trial]

    def readings(self) -> Reading:
        """Return states of cable and sensors at every row, by the reference law."""
        events, condition = self.events, self.condition
        trial, is_load = events.trial, (events.regressors[1] != 0).astype(np.float64)
        # Along the measured motion, an error proportional to the reading could explain any
        # deviation from the law. The motion is therefore that of the reference law.
        rate = np.maximum(self.acceleration, LEAST_ACCELERATION)[trial]
        first, tau = self._paths.speed_m_s[trial, 0], events.tau
        spacing = self.constants.hall_spacing_m or 1.0
        return Reading(
            displacement_m=first * tau + rate * tau**2 / 2,
            event=np.round(events.displacement / spacing),
            is_load=is_load,
            time_s=first / rate + tau,
            speed_m_s=first + rate * tau,
            acceleration_m_s2=rate,
            mass_drive_kg=np.asarray(condition.mass_drive_kg)[trial],
            mass_load_kg=np.asarray(condition.mass_load_kg)[trial],
            magnets_per_revolution=self.constants.magnets_per_revolution or 1,
        )


FEWEST = 3  # least number of trials of an assembly for a median
FAR = 10.0  # distance of a stray trial, relative to the usual distance
MAD = 1.4826  # standard deviation of a normal over its median absolute deviation


def far_from_their_own(deviation: Array, setup: NDArray[Any]) -> Flags:
    """Return which trials are far from the others of their assembly.

    The distance of a trial is that of its relative deviation from the median of its assembly. The
    usual distance is the median absolute deviation, scaled to the standard deviation of a normal
    distribution. An effect increases the usual distance, and a single trial does not.

    Parameters
    ----------
    deviation : ndarray, shape (N,)
        Friction of each trial minus that of the law, relative to the latter.
    setup : ndarray, shape (N,)
        Name of each trial's assembly.
    """
    distance = np.zeros_like(deviation)
    for name in dict.fromkeys(setup):
        own = setup == name
        if np.count_nonzero(own) >= FEWEST:
            distance[own] = np.abs(deviation[own] - np.median(deviation[own]))
    usual = MAD * float(np.median(distance[distance > 0])) if (distance > 0).any() else np.inf
    return np.asarray(distance > FAR * usual)
