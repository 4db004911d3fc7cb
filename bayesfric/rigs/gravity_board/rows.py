"""Effects on the gravity board, as columns of its rows: of forces, and of errors of readings."""

from typing import Any

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.effects import ActsOn, Effect, Reading
from bayesfric.effects.candidates import Candidate, unit_response
from bayesfric.observation.layout import COEFFICIENTS, ModelColumns
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.gravity_board.event_columns import EventColumns
from bayesfric.rigs.gravity_board.measured_motion import LEAST_ACCELERATION
from bayesfric.rigs.gravity_board.paths import motion_untold
from bayesfric.rigs.gravity_board.reference_motion import PUSHED
from bayesfric.rigs.gravity_board.stray_trials import far_from_their_own

PRETENDED = 8  # windows of a trial
NO_FORCE = Unsupported("it is an error of readings, or its phase differs from trial to trial")
NO_READING = Unsupported("it is a force, or its phase differs from trial to trial")
NO_CURRENT = Unsupported("it acts on a motor's current, and no motor drives these trials")


class GravityRows(EventColumns):
    """Events as rows of a linear model, with what effects do to them."""

    def where(self, acts_on: ActsOn) -> Any:
        """Return the places of a law, or Unsupported."""
        if acts_on == "current":
            return NO_CURRENT
        return self.readings() if acts_on == "reading" else self.state

    def _untold(self, effect: Effect) -> Unsupported | None:
        if effect.acts_on == "current":
            return NO_CURRENT
        return motion_untold(effect, self._gravity, self.constants)

    def candidate_columns(self, candidate: Candidate) -> Array | Unsupported:
        """Return what an effect of amplitude 1 does, shape (E, C) [m].

        C is 1; of an effect with phases it is the number of its components, of one on
        readings for each sensor.
        """
        effect = candidate.effect
        if reason := self._untold(effect):
            return reason
        if effect.acts_on == "reading":
            beyond = self._beyond(candidate)
            if not effect.components:
                return np.asarray(-np.broadcast_to(beyond, self.residual.shape)[:, None])
            sensors = self.events.of_sensors
            return np.stack([-part * seen for part in beyond for seen in sensors], axis=1)
        return self.forces(self.candidate_forces(candidate))

    def candidate_forces(self, candidate: Candidate) -> Array:
        """Return the forces of an effect of amplitude 1 along the paths, (C, N, P) [N]."""
        force = unit_response(candidate, self.state)
        if candidate.effect.components:
            return force
        # One that knows no direction here is a number, and nothing.
        return np.broadcast_to(force, self._travel.shape)[None]

    def filled(self, model: ModelColumns, force_n: Array) -> Array:
        """Return the local columns of a model, not yet scaled, shape (E, q) [m].

        Those of effects with phases are 0: their phases scatter.

        Parameters
        ----------
        model : ModelColumns
            What the columns are.
        force_n : ndarray, shape (N,)
            Unit of smooth forces in each trial [N].
        """
        shape = self._travel.shape

        def along(forces: Array) -> Array:
            return np.broadcast_to(forces, (len(forces), *shape)).reshape(len(forces), -1).T

        def force(candidate: Candidate) -> Array | Unsupported:
            effect = candidate.effect
            if effect.acts_on == "reading" or effect.components:
                return NO_FORCE
            return self._untold(effect) or self.candidate_forces(candidate).ravel()

        def reading(candidate: Candidate) -> Array | Unsupported:
            effect = candidate.effect
            if effect.acts_on != "reading" or effect.components:
                return NO_READING
            columns = self.candidate_columns(candidate)
            return columns if isinstance(columns, Unsupported) else columns[:, 0]

        # Forces of all columns are integrated at once.
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

    def elsewhere(self, candidate: Candidate) -> Array | None:
        """Return how an effect's column changes as trials have come further by one sd.

        Returns
        -------
        ndarray, shape (E,), or None
            [m]; None where an effect does not depend on travel.
        """
        effect = candidate.effect
        if effect.acts_on not in ("friction", "drive") or effect.components:
            return None
        further = self._travel + (PUSHED * self._before)[:, None]
        moved = unit_response(candidate, self.state._replace(travel_m=further))
        change = moved - unit_response(candidate, self.state)
        return self.forces(change) if np.any(change) else None

    def uneven_column(self, candidate: Candidate) -> Array:
        """Return what an effect does that differs from trial to trial, shape (E,) [m].

        It is an error of one sensor alone, where there is another one; 0 of all other effects.
        How much a cable slips hangs on friction, which no two trials share, and on much else:
        with events known to some 30 µm a slip of centimetres would have to keep to its law
        within a thousandth.
        """
        effect = candidate.effect
        column = np.zeros_like(self.residual)
        if effect.acts_on != "reading" or effect.components or self._untold(effect):
            return column
        if self._of_one_sensor(candidate):
            column -= self._beyond(candidate) * self._seen_by_both()
        return column

    def relative_force(self, candidate: Candidate) -> Array | Unsupported:
        """Return what an effect of amplitude 1 adds to friction, or its equivalent.

        The equivalent of an error of readings is (m1 + m2) times the acceleration that a
        parabola through the events takes it for; of one that goes to and fro, the force that it
        pretends in windows of the travel.

        Returns
        -------
        ndarray
            As a share of the reference law's friction, broadcasts to (C, N, P); C is the
            number of an effect's components, else 1.
        """
        effect, friction = candidate.effect, self.friction_n[:, None]
        if reason := self._untold(effect):
            return reason
        if effect.acts_on == "reading":
            columns = self.candidate_columns(candidate)
            assert not isinstance(columns, Unsupported)
            if effect.components:
                return np.asarray(self._pretended(columns) / self.friction_n[:, None])
            off = np.array([self._parabola(rows, columns[rows]) for rows in self.rows_of_trials()])
            return np.asarray(self.condition.total_mass_kg * off.T / self.friction_n)[:, :, None]
        force = unit_response(candidate, self.state) / friction
        return force if effect.components else force[None]

    def _pretended(self, columns: Array) -> Array:
        """Return the force that errors of readings pretend in windows, (C, N, W) [N]."""
        newton, _ = self.window_columns(PRETENDED)
        forces = np.zeros((columns.shape[1], len(self.table), PRETENDED))
        for trial, rows in enumerate(self.rows_of_trials()):
            design = np.column_stack([newton[:, rows].T, self.events.nuisances(rows).T])
            size = np.linalg.norm(design, axis=0)
            size = np.where(size > 0, size, 1.0)
            solved = np.linalg.lstsq(design / size, columns[rows], rcond=1e-9)[0] / size[:, None]
            forces[:, trial] = solved[:PRETENDED].T
        return forces

    def size_of(self, candidate: Candidate) -> float:
        """Return the rms of what amplitude 1 does: a share of friction, of a reading in metres."""
        if candidate.effect.acts_on == "reading":
            columns = self.candidate_columns(candidate)
            assert not isinstance(columns, Unsupported)
            return float(np.sqrt((columns.sum(axis=1) ** 2).mean()))
        return super().size_of(candidate)

    def strays(self) -> tuple[str, ...]:
        """Return the trials whose friction is far from that of their assembly."""
        far = far_from_their_own(self.relative_deviation(), self.table["setup"].to_numpy())
        return tuple(str(trial) for trial in self.table["trial"][far])

    def relative_deviation(self) -> Array:
        """Return how far each trial's friction is from the law, as a share of it, (N,)."""
        off = [self._parabola(rows, self.residual[rows, None])[0] for rows in self.rows_of_trials()]
        return np.asarray(-self.condition.total_mass_kg * np.array(off) / self.friction_n)

    def _parabola(self, rows: slice, displacement: Array) -> Array:
        """Return the accelerations of parabolas through columns of one trial, (C,) [m/s²]."""
        design = np.column_stack([self.events.tau[rows] ** 2 / 2, *self.events.nuisances(rows)])
        return np.asarray(np.linalg.lstsq(design, displacement, rcond=None)[0][0])

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
        columns = self.forces(inside / self._feedback).T
        weight = inside / np.maximum(inside.sum(axis=2, keepdims=True), 1)
        shape = self._travel.shape
        places = {
            name: (weight * np.broadcast_to(values, shape)).sum(axis=2).T
            for name, values in self.covariates().items()
        }
        return columns, places

    def _beyond(self, candidate: Candidate) -> Array:
        """Return how far magnets pass beyond their places at amplitude 1 [m]."""
        reading = self.readings()
        if self._of_one_sensor(candidate):
            # Seen by one sensor alone: where there is another one, that tells it from any
            # motion, so that what was read and how fast may stand for the reference law's.
            both = self._seen_by_both()
            reading = reading._replace(
                displacement_m=np.where(both, self.events.displacement, reading.displacement_m),
                speed_m_s=np.where(both, self._speed, reading.speed_m_s),
            )
        return unit_response(candidate, reading)

    def _of_one_sensor(self, candidate: Candidate) -> bool:
        """Return whether an error is one sensor's alone, in any of all the trials."""
        whole, asked = self._whole, (candidate.effect.name, candidate.law, candidate.shape)
        if asked not in self._one_sided:
            reading = whole.readings()
            at_ends = [np.full_like(whole.residual, end) for end in (0.0, 1.0)]
            moved = [
                np.any(unit_response(candidate, reading._replace(is_load=end))) for end in at_ends
            ]
            self._one_sided[asked] = not all(moved)
        return self._one_sided[asked]

    def _seen_by_both(self) -> Flags:
        """Return which rows are of trials that both sensors recorded, shape (E,)."""
        sensors = self.events.of_sensors
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
