"""The state of a board, an axis or a sensor: everything on which an effect may depend."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.arrays import Array
from bayesfric.physics.friction import (
    REFERENCE_WRAP_ANGLE_DEG,
    Coefficients,
    coulomb_friction,
    tension_slope,
)

REFERENCE_TENSION_N = 15.0
MEDIUM_RADIUS_M = 7.82e-3  # Table I
STANDARD_GRAVITY_M_S2 = 9.80665
Load = Callable[[str, float, ArrayLike], tuple[ArrayLike, ArrayLike]]
"""Simulates a load that follows a drive in ``play`` or on a ``spring``.

Arguments: how it is held; its share of the mass over its share of the friction; a length (the play,
or the travel over which friction winds the spring up). Results: the load's acceleration less the
drive's, and its friction less that of a load fixed to the drive, as a share of the latter.
"""


def _fixed(held: str, heavy: float, length: ArrayLike) -> tuple[ArrayLike, ArrayLike]:
    """Return zeros: the load is fixed to the drive."""
    del held, heavy, length
    return 0.0, 0.0


class State(NamedTuple):
    """The state of a board or an axis; arrays that broadcast.

    Parameters
    ----------
    n_pulleys, wrap_angle_deg : array_like
        Number of pulleys and their average wrap angle [deg].
    tension_n : array_like
        Nominal tension [N].
    speed_m_s : array_like
        Cable speed, not negative [m/s].
    tension_friction_n : array_like
        The part of the baseline's friction that grows with tension [N].
    constant_friction_n : array_like
        The rest of the baseline's friction [N].
    pulley_friction_n : array_like
        The baseline's friction of one pulley of this size at 15 N and 85° [N]: a scale
        that does not depend on the condition.
    load_current_a : array_like
        Motor current beyond that of the idle motor [A]; 0 on the gravity board.
    travel_m : array_like
        Travel of the cable since the trial was released [m]; 0 in a steady run.
    passes_m : sequence of array_like
        For a driven axis: travel of the passes before the present one, the last first [m].
    acceleration_m_s2 : array_like
        Acceleration of the cable [m/s²]; 0 in a steady run.
    radius_m : array_like
        Radius of the pulleys, at the cable [m].
    order : array_like
        Place in the order of the recording, from 0 (first) to 1 (last).
    gravity_m_s2 : array_like
        Local acceleration of free fall [m/s²].
    drive_end : array_like
        The physical end that carried the drive mass: −0.5 left, 0.5 right, 0 if not recorded.
    trial_in_setup : array_like
        Number of earlier trials of the same assembly; 0 for the first.
    position_m, direction : array_like
        For a driven axis: its position [m, or rad if it turns], and the direction of motion, 1
        or −1; else 0.
    drive_force_n : array_like
        For a driven axis: the drive force, positive along the position [N, or N·m].
    mass_kg : array_like
        For a driven axis: all the mass that moves, by the baseline [kg, or kg·m²].
    force_rate_n_s, force_curvature_n_s2 : array_like
        First and second derivative of the drive force along the motion [N/s], [N/s²]. The
        first is taken half a delay earlier.
    lagging_rate_n_s : array_like
        First derivative of the force of an actuator that follows the command with a lag [N/s].
    wave_from_m : array_like
        Position at which a periodic force that was found along the path rises through zero [m
        or rad].
    tested : array_like
        1 in a run of role ``test``, which may differ from calibration; else 0.
    load : Load
        For a driven axis: simulates a load behind its drive.
    mass_over_friction : float
        For such a load: its share of the mass over its share of the friction, as found by a
        search.
    carried_n, held_n : array_like
        For a driven axis: the load that its gear carries, positive along the position.
        `carried_n` includes the inertia of the moving mass; `held_n` is gravity and springs
        alone [N, or N·m].
    dwell_s, since_rest_m : array_like
        For a driven axis: duration of its last rest [s], and travel since then [m].
    warmth : array_like
        From −0.5 (coldest of the recording) to 0.5 (warmest), less its mean.
    wrap_spread_deg : array_like
        Standard deviation of the pulleys' individual wrap angles [deg]; nan if they are not
        recorded.
    steady : bool
        Whether the cable has run at this speed for a long time. Transients, such as those of
        the first stretch of travel, are then over, and periodic forces average out.
    covariates : mapping of str to array_like
        Further columns of the recording, by name.
    """

    n_pulleys: ArrayLike
    wrap_angle_deg: ArrayLike
    tension_n: ArrayLike
    speed_m_s: ArrayLike
    tension_friction_n: ArrayLike
    constant_friction_n: ArrayLike
    pulley_friction_n: ArrayLike
    load_current_a: ArrayLike = 0.0
    travel_m: ArrayLike = 0.0
    passes_m: Sequence[ArrayLike] = ()
    acceleration_m_s2: ArrayLike = 0.0
    radius_m: ArrayLike = MEDIUM_RADIUS_M
    order: ArrayLike = 0.5
    gravity_m_s2: ArrayLike = STANDARD_GRAVITY_M_S2
    drive_end: ArrayLike = 0.0
    trial_in_setup: ArrayLike = 0.0
    position_m: ArrayLike = 0.0
    direction: ArrayLike = 0.0
    drive_force_n: ArrayLike = 0.0
    mass_kg: ArrayLike = 0.0
    force_rate_n_s: ArrayLike = 0.0
    lagging_rate_n_s: ArrayLike = 0.0
    force_curvature_n_s2: ArrayLike = 0.0
    wave_from_m: ArrayLike = 0.0
    tested: ArrayLike = 0.0
    load: Load = _fixed
    mass_over_friction: float = 1.0
    carried_n: ArrayLike = 0.0
    held_n: ArrayLike = 0.0
    dwell_s: ArrayLike = 0.0
    since_rest_m: ArrayLike = 0.0
    warmth: ArrayLike = 0.0
    wrap_spread_deg: ArrayLike = np.nan
    steady: bool = False
    covariates: Mapping[str, ArrayLike] = MappingProxyType({})

    @classmethod
    def of(
        cls,
        coefficients: Coefficients,
        n_pulleys: ArrayLike,
        wrap_angle_deg: ArrayLike,
        tension_n: ArrayLike,
        speed_m_s: ArrayLike,
        load_current_a: ArrayLike = 0.0,
        **rest: Any,
    ) -> "State":
        """Return the state with the parts of friction by eq. (15); `rest` are other fields."""
        slope = tension_slope(coefficients, n_pulleys, wrap_angle_deg)
        return cls(
            n_pulleys,
            wrap_angle_deg,
            tension_n,
            speed_m_s,
            slope * np.asarray(tension_n),
            np.asarray(n_pulleys) * np.asarray(coefficients.c2),
            coulomb_friction(coefficients, 1.0, REFERENCE_WRAP_ANGLE_DEG, REFERENCE_TENSION_N),
            load_current_a,
            **rest,
        )

    @property
    def friction_n(self) -> Array:
        """The baseline's friction [N]."""
        total = np.asarray(self.tension_friction_n) + np.asarray(self.constant_friction_n)
        return np.asarray(total, dtype=np.float64)

    @property
    def settling_friction_n(self) -> Array:
        """Friction that builds up after a start; 0 in a steady run, where this is over [N]."""
        return np.asarray(self.friction_n * (not self.steady))


class Reading(NamedTuple):
    """The state of the cable and a sensor at an event; arrays that broadcast.

    Parameters
    ----------
    displacement_m : array_like
        Recorded travel since the sensor's first event [m].
    event : array_like
        Number of the event at its sensor, 0 being the first.
    is_load : array_like
        1 at the load end's sensor, 0 at the drive end's.
    time_s : array_like
        Time since the release [s].
    speed_m_s, acceleration_m_s2 : array_like
        Speed and acceleration of the cable [m/s], [m/s²].
    mass_drive_kg, mass_load_kg : array_like
        Masses on the two ends [kg].
    magnets_per_revolution : int
        Number of magnets of the sensor pulley.
    """

    displacement_m: ArrayLike
    event: ArrayLike
    is_load: ArrayLike
    time_s: ArrayLike
    speed_m_s: ArrayLike
    acceleration_m_s2: ArrayLike
    mass_drive_kg: ArrayLike
    mass_load_kg: ArrayLike
    magnets_per_revolution: int
