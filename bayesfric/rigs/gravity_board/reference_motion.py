"""States of the gravity board's trials along their paths, by the reference law.

The speed along a path is the measured one. The travel before the first event was not measured and
is computed with the reference law.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from bayesfric.arrays import Array
from bayesfric.effects import State
from bayesfric.effects.candidates import Candidate, unit_response
from bayesfric.observation.coefficients import intercept_of, law_of_rows
from bayesfric.observation.linear import rank
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import nominal_tension, tension_feedback
from bayesfric.physics.laws import FrictionLaw
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.acting import drive_end, trial_in_setup
from bayesfric.rigs.gravity_board.measured_motion import MeasuredMotion, travel_to_speed
from bayesfric.rigs.gravity_board.trial_motion import trial_condition
from bayesfric.rigs.pulley_radii import pulley_radii

PUSHED = 0.15  # share by which a push reduces the travel from rest to the first speed, and its sd
SPACING_M = 0.01  # spacing of events if the rig does not state one


class ReferenceMotion:
    """N trials at P times along their paths.

    Parameters
    ----------
    gravity, rig, laws, measured, acting, law
        As in :class:`bayesfric.rigs.gravity_board.event_columns.EventColumns`.
    """

    def __init__(
        self,
        gravity: Gravity,
        rig: RigConstants,
        laws: Mapping[str, Coefficients],
        measured: MeasuredMotion,
        acting: Sequence[tuple[Candidate, float]],
        law: FrictionLaw,
    ) -> None:
        self.table, self.constants, self._gravity = gravity.trials, rig, gravity
        self.condition = trial_condition(gravity.trials, rig)
        sizes = gravity.trials["pulley_size"]
        self.law = law_of_rows(laws, sizes)
        mass = self.condition.total_mass_kg
        self.friction_n = law.gravity(self.law, self.condition)
        self._law_acceleration = (self.condition.drive_force_n - self.friction_n) / mass
        self.acceleration = np.maximum(self._law_acceleration, 0.0)
        self.order = rank(gravity.trials)
        radii = pulley_radii(list(sizes.unique()), rig)
        self._radius = np.array([radii[size] for size in sizes])
        self._paths = measured.paths
        self._feedback = tension_feedback(self.law, self.condition)[:, None]
        self._deceleration_per_n = self._feedback / mass[:, None]
        self._travel_to_first = self._travel_before(acting)
        self._travel = self._travel_along_paths()
        self.state = self._state_at(self._travel, self._paths.speed_m_s)

    def covariates(self) -> dict[str, Array]:
        """Return covariates of every trial along its path, arrays that broadcast to (N, P)."""
        return {
            "velocity": self._paths.speed_m_s,
            "displacement": self._travel,
            "tension": np.asarray(self.state.tension_n),
            "n_pulleys": np.asarray(self.state.n_pulleys, dtype=np.float64),
            "wrap_angle": np.asarray(self.state.wrap_angle_deg, dtype=np.float64),
            "order": self.order[:, None],
            "acceleration": self.acceleration[:, None],
            "drive_end": np.asarray(self.state.drive_end),
            "trial_in_setup": np.asarray(self.state.trial_in_setup),
        }

    @property
    def intercept_n(self) -> Array:
        """Force to which the scatter of the intercept is relative, shape (N,) [N]."""
        return np.asarray(self.condition.n_pulleys) * intercept_of(self.law)

    def _travel_along_paths(self) -> Array:
        """Return the travel since the release along every path, shape (N, P) [m]."""
        speed = self._paths.speed_m_s
        step = self._paths.step_s * 0.5 * (speed[:, 1:] + speed[:, :-1])
        first = self._travel_to_first[:, None]
        return np.concatenate([first, first + np.cumsum(step, axis=1)], axis=1)

    def _travel_before(self, acting: Sequence[tuple[Candidate, float]]) -> Array:
        """Return the travel from the release to the first event, shape (N,) [m]."""

        def acceleration(travel: Array, speed: Array) -> Array:
            state = self._state_at(travel, speed)
            force = np.zeros_like(travel)
            for candidate, amplitude in acting:
                force = force + amplitude * unit_response(candidate, state)
            return np.asarray(self.acceleration[:, None] - self._deceleration_per_n * force)

        from_rest = travel_to_speed(self._paths.speed_m_s[:, 0], acceleration)
        # The first event is at most one spacing after the release; a push shortens the travel.
        most = np.minimum(from_rest, self.constants.hall_spacing_m or SPACING_M)
        return np.asarray((1 - PUSHED) * most)

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
            drive_end=drive_end(self.table)[:, None],
            trial_in_setup=trial_in_setup(self.table)[:, None],
            gravity_m_s2=condition.gravity_m_s2,
        )
