r"""The gravity board with a cable that stretches: the four-state model (3) of the paper.

With x1 and x2 the travel of the drive and the load mass (paper Sec. III.B, eq. (3)),

    m1 ẍ1 =  m1 g − k (x1 − x2) − b (ẋ1 − ẋ2) − fc/2 − (fv/4)(ẋ1 + ẋ2)
    m2 ẍ2 = −m2 g + k (x1 − x2) + b (ẋ1 − ẋ2) − fc/2 − (fv/4)(ẋ1 + ẋ2),

started with equal speeds. The paper prints m2 g in both rows; then the rows would
add up to no drive, so the first is read as m1 g.

Without fv the centre of mass moves as in eq. (4), and the stretch rings around T/k, T
the nominal tension of eq. (4): a closed form. The paper's way, 4th-order Runge-Kutta,
is :func:`integrate`; it is the reference, and takes fv too. Friction at rest is
set-valued: a board whose friction is no less than its drive stops when its centre of
mass does, and stays; ringing that is left is dropped.
"""

from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from physics.damped import DampedTrajectory
from scipy.optimize import elementwise

from bayesfric.arrays import Array, Flags
from bayesfric.physics.cable import Cable
from bayesfric.physics.gravity import Condition

STEP = 0.05  # of Runge-Kutta, times the rate of the stiff mode: (0.05)⁴/120 a radian
LEAST_SPLIT = 1e-12  # of the two rates of the stretch, where they would coincide


class Ends(NamedTuple):
    """Travel since the start and speed of the two ends of the cable.

    Parameters
    ----------
    drive_position_m, load_position_m : ndarray
        Of the falling mass downwards, of the rising one upwards [m].
    drive_speed_m_s, load_speed_m_s : ndarray
        Their speeds [m/s].
    """

    drive_position_m: Array
    load_position_m: Array
    drive_speed_m_s: Array
    load_speed_m_s: Array


@dataclass(frozen=True)
class CompliantMotion:
    """A trial of model (3); arrays of one shape, made by :func:`compliant_motion`.

    Parameters
    ----------
    mass_drive_kg, mass_load_kg : ndarray
        m1 and m2 [kg].
    gravity_m_s2 : ndarray
        g [m/s²].
    friction_n : ndarray
        fc [N].
    viscous_n_s_m : ndarray
        fv [N·s/m].
    stiffness_n_m, damping_n_s_m : ndarray
        k [N/m] and b [N·s/m].
    start_speed_m_s : ndarray
        Speed of both masses at time 0 [m/s].
    start_stretch_m : ndarray
        x1 − x2 at time 0 [m].
    """

    mass_drive_kg: Array
    mass_load_kg: Array
    gravity_m_s2: Array
    friction_n: Array
    viscous_n_s_m: Array
    stiffness_n_m: Array
    damping_n_s_m: Array
    start_speed_m_s: Array
    start_stretch_m: Array

    @property
    def total_mass_kg(self) -> Array:
        """The moving mass m1 + m2 [kg]."""
        return self.mass_drive_kg + self.mass_load_kg

    @property
    def reduced_mass_kg(self) -> Array:
        """Mass of the masses moving against each other, m1 m2 / (m1 + m2) [kg]."""
        return self.mass_drive_kg * self.mass_load_kg / self.total_mass_kg

    @property
    def surplus_n(self) -> Array:
        """Drive beyond friction, (m1 − m2) g − fc [N]; none: the board stops."""
        return (self.mass_drive_kg - self.mass_load_kg) * self.gravity_m_s2 - self.friction_n

    @property
    def rigid(self) -> DampedTrajectory:
        """The motion of eqs. (4) and (5): the same board with a cable that does not stretch."""
        return DampedTrajectory(
            self.surplus_n / self.total_mass_kg,
            self.viscous_n_s_m / self.total_mass_kg,
            self.start_speed_m_s,
        )

    @property
    def moving_stretch_m(self) -> Array:
        """The stretch around which the cable rings without fv, nominal tension over k [m]."""
        tension = (
            2 * self.reduced_mass_kg * self.gravity_m_s2
            + 0.5 * self.friction_n * (self.mass_drive_kg - self.mass_load_kg) / self.total_mass_kg
        )
        return tension / self.stiffness_n_m

    def ends(self, time_s: ArrayLike) -> Ends:
        """Return the motion of both ends in closed form, without viscous friction.

        Parameters
        ----------
        time_s : array_like
            Time ≥ 0 since the start [s]; broadcasts against the board's arrays.

        Raises
        ------
        ValueError
            With viscous friction, which couples the two modes.
        """
        if np.any(self.viscous_n_s_m):
            raise ValueError("viscous_n_s_m is not 0: integrate() solves it, no closed form does")
        rigid = self.rigid
        time = np.minimum(np.asarray(time_s, dtype=np.float64), rigid.stop_time)
        moving = np.asarray(time_s) < rigid.stop_time
        decay = self.damping_n_s_m / (2 * self.reduced_mass_kg)
        stiff2 = self.stiffness_n_m / self.reduced_mass_kg
        split = decay**2 / stiff2 - 1
        split = np.where(np.abs(split) < LEAST_SPLIT, LEAST_SPLIT, split)
        half = np.sqrt(stiff2 * split + 0j)
        slow, fast = np.exp((half - decay) * time), np.exp((-half - decay) * time)
        # unit response of s̈ + 2 decay ṡ + stiff2 s from s = 1 at rest, and its derivative
        ringing = (0.5 * (slow + fast) + 0.5 * decay * (slow - fast) / half).real
        rate = (-0.5 * stiff2 * (slow - fast) / half).real
        swing = self.start_stretch_m - self.moving_stretch_m
        stretching, stretching_speed = swing * (ringing - 1), swing * np.where(moving, rate, 0.0)
        drive_share = self.mass_load_kg / self.total_mass_kg
        load_share = self.mass_drive_kg / self.total_mass_kg
        centre, speed = rigid.position(time_s), rigid.speed(time_s)
        return Ends(
            centre + drive_share * stretching,
            centre - load_share * stretching,
            speed + drive_share * stretching_speed,
            speed - load_share * stretching_speed,
        )

    def time_at(self, position_m: ArrayLike, end: Literal["drive", "load"]) -> Array:
        """Return when an end has travelled a distance ≥ 0; inf where it stops before [s].

        Parameters
        ----------
        position_m : array_like
            Distance from the start [m]; broadcasts against the board's arrays.
        end : {"drive", "load"}
            Which end of the cable.
        """
        which = ("drive", "load").index(end)
        position, *columns = np.broadcast_arrays(
            np.asarray(position_m, dtype=np.float64),
            *(getattr(self, field.name) for field in fields(self)),
        )
        board = CompliantMotion(*columns)
        # An end is never further from the centre of mass than twice its swing.
        swing = 2 * np.abs(board.start_stretch_m - board.moving_stretch_m)
        rigid = board.rigid
        early = rigid.time_at(np.maximum(position - swing, 0.0))
        late = np.minimum(rigid.time_at(position + swing), rigid.stop_time)
        reached = np.asarray(board.ends(late)[which] >= position)
        time = np.full(position.shape, np.inf)

        def beyond(t: Array, x: Array, *values: Array) -> Array:
            return CompliantMotion(*values).ends(t)[which] - x

        result = elementwise.find_root(
            beyond,
            (early[reached], late[reached]),
            args=(position[reached], *(column[reached] for column in columns)),
            tolerances={"xatol": 1e-14, "xrtol": 1e-14},
        )
        time[reached] = result.x
        return time


def compliant_motion(
    condition: Condition,
    friction_n: ArrayLike,
    cable: Cable | None = None,
    *,
    viscous_n_s_m: ArrayLike = 0.0,
    start_speed_m_s: ArrayLike = 0.0,
    start_stretch_m: ArrayLike | None = None,
) -> CompliantMotion:
    """Return a trial of model (3).

    Parameters
    ----------
    condition : Condition
        Masses and gravity.
    friction_n : array_like
        fc [N]: a constant, or :func:`bayesfric.physics.gravity.board_friction` for the
        friction law, since the spring's tension in motion is the nominal one.
    cable : Cable or None
        None is its defaults.
    viscous_n_s_m : array_like
        fv for the whole board [N·s/m].
    start_speed_m_s : array_like
        Speed of both masses at the start, not negative [m/s].
    start_stretch_m : array_like or None
        Stretch at the start [m]; None is the static one, (m1 + m2) g / (2 k), at which
        friction that is split evenly between the sides holds both masses.

    Returns
    -------
    CompliantMotion
        Of the broadcast shape.
    """
    cable = Cable() if cable is None else cable
    m1, m2 = np.asarray(condition.mass_drive_kg), np.asarray(condition.mass_load_kg)
    gravity, stiffness = np.asarray(condition.gravity_m_s2), cable.stiffness_n_m
    # μ s̈ + b ṡ + k s = … of the reduced mass μ has the damping ratio b / (2 √(k μ))
    damping = 2 * np.asarray(cable.damping_ratio) * np.sqrt(stiffness * m1 * m2 / (m1 + m2))
    if start_stretch_m is None:
        start_stretch_m = (m1 + m2) * gravity / (2 * stiffness)
    arrays = np.broadcast_arrays(
        m1,
        m2,
        gravity,
        friction_n,
        viscous_n_s_m,
        stiffness,
        damping,
        start_speed_m_s,
        start_stretch_m,
    )
    return CompliantMotion(*(np.array(array, dtype=np.float64) for array in arrays))


def integrate(motion: CompliantMotion, time_s: ArrayLike) -> Ends:
    """Return the motion of both ends by 4th-order Runge-Kutta, as the paper did.

    Parameters
    ----------
    motion : CompliantMotion
        Boards, arrays of one shape (...), which all share the steps of the stiffest.
    time_s : array_like, shape (T,)
        Since the start, ≥ 0 and ascending [s].

    Returns
    -------
    Ends
        Arrays of shape (..., T).
    """
    times = np.asarray(time_s, dtype=np.float64)
    if times.ndim != 1 or (np.diff(times, prepend=0.0) < 0).any():
        raise ValueError(f"time_s is {times!r}; it is one axis of times ≥ 0, ascending")
    decay = motion.damping_n_s_m / motion.reduced_mass_kg
    rate = np.maximum(np.sqrt(motion.stiffness_n_m / motion.reduced_mass_kg), decay)
    longest = STEP / np.max(rate)
    rest = np.zeros_like(motion.start_speed_m_s)
    state = np.stack([rest, rest, motion.start_speed_m_s, motion.start_speed_m_s])
    moving = (motion.surplus_n > 0) | (motion.start_speed_m_s > 0)
    states = []
    for before, after in pairwise([0.0, *times]):
        count = int(np.ceil((after - before) / longest))
        for _ in range(count):
            state, moving = _advance(motion, state, moving, (after - before) / count)
        states.append(state)
    return Ends(*np.stack(states, axis=-1))


def _slope(motion: CompliantMotion, state: Array) -> Array:
    """Return the right-hand side of eq. (3) for states (x1, x2, v1, v2) since the start."""
    x1, x2, v1, v2 = state
    stretch = motion.start_stretch_m + x1 - x2
    pull = motion.stiffness_n_m * stretch + motion.damping_n_s_m * (v1 - v2)
    drag = 0.5 * motion.friction_n + 0.25 * motion.viscous_n_s_m * (v1 + v2)
    return np.stack(
        [
            v1,
            v2,
            motion.gravity_m_s2 - (pull + drag) / motion.mass_drive_kg,
            -motion.gravity_m_s2 + (pull - drag) / motion.mass_load_kg,
        ]
    )


def _step(motion: CompliantMotion, state: Array, step: Array) -> Array:
    first = _slope(motion, state)
    second = _slope(motion, state + 0.5 * step * first)
    third = _slope(motion, state + 0.5 * step * second)
    fourth = _slope(motion, state + step * third)
    return state + step / 6 * (first + 2 * second + 2 * third + fourth)


def _advance(
    motion: CompliantMotion, state: Array, moving: Flags, seconds: float
) -> tuple[Array, Flags]:
    """Take one step; land boards whose centre of mass stops within it, and hold them."""
    step = np.where(moving, seconds, 0.0)
    new = _step(motion, state, step)
    before, after = _centre_speed(motion, state), _centre_speed(motion, new)
    stopping = moving & (motion.surplus_n <= 0) & (after <= 0)
    if stopping.any():
        share = np.where(stopping, before / np.where(stopping, before - after, 1.0), 0.0)
        landed = _step(motion, state, step * share)
        landed[2:] = 0.0
        new = np.where(stopping, landed, new)
    return new, moving & ~stopping


def _centre_speed(motion: CompliantMotion, state: Array) -> Array:
    momentum = motion.mass_drive_kg * state[2] + motion.mass_load_kg * state[3]
    speed: Array = momentum / motion.total_mass_kg
    return speed
