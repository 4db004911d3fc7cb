"""Trials of one reading each, linearised around a reference law.

A reading is friction times a known factor, plus a curve that all readings share. Readings at rest
may inform this curve.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd

from bayesfric.analysis import Priors
from bayesfric.arrays import Array
from bayesfric.effects import ActsOn, State
from bayesfric.effects.candidates import Candidate
from bayesfric.inference.smooths import Smooth
from bayesfric.observation.linear import NoiseParameter
from bayesfric.observation.part import LaidRows
from bayesfric.observation.unsupported import Unsupported
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG, Coefficients

NO_EVENTS = Unsupported("it acts on readings of events, and steady runs have none")
NO_MOTOR = Unsupported("it acts on a motor's current, which nobody reads here")
AVERAGES = Unsupported("it goes round with the pulleys, which averages out in a steady run")


@dataclass(frozen=True)
class PointRows(LaidRows):
    """Trials of one reading each, linearised around a reference law.

    Parameters
    ----------
    name : str
        Name of the rig.
    table : DataFrame
        N trials, with ``trial``, ``setup`` and ``pulley_size``.
    loads : tuple of str
        Columns that define a condition, together with size, number and wrap angle.
    state : State
        Steady state of each trial.
    friction_n : ndarray, shape (N,)
        Friction of the reference law, opposing the motion [N].
    feedback : ndarray, shape (N,)
        Factor of a force, because it increases the tension too.
    reading : ndarray, shape (N,)
        Measured minus predicted reading of the reference law, in any unit.
    per_newton : ndarray, shape (N,)
        Change of a reading by 1 N that opposes the motion.
    errors : tuple of ndarray, shape (N,)
        Factor of each error of the noise in a reading.
    noise : callable
        Function of the priors that returns the noise parameters: scatter of a trial, of a load
        and of an assembly; with an `intercept`, its scatter of a load and of an assembly; then
        the errors.
    curve : ndarray, shape (N, K)
        Columns of numbers that all readings share.
    still_curve, still : ndarray, shape (M, K) and (M,)
        Columns of the curve at rest, and the readings at rest; their error is the first one.
    curve_sd : callable
        Function of the priors that returns prior standard deviations of these numbers.
    direct : str or None
        Value of `acts_on` for effects that add to the reading itself.
    known_error : ndarray, shape (N,), or float
        Stated standard error of each reading, in addition to the noise.
    further : mapping of str to ndarray, shape (N,)
        Covariates of this recording, by name.
    intercept : ndarray, shape (N,), or None
        Reading by the friction that does not grow with tension; None if it has no separate
        scatter.
    lacks : frozenset of str
        Coefficients that are not defined, such as the slope if no load was recorded.
    """

    unseen_phases = AVERAGES

    name: str
    table: pd.DataFrame
    loads: tuple[str, ...]
    state: State
    friction_n: Array
    feedback: Array
    reading: Array
    per_newton: Array
    errors: tuple[Array, ...]
    noise: Callable[[Priors], tuple[NoiseParameter, ...]]
    curve: Array
    still_curve: Array
    still: Array
    curve_sd: Callable[[Priors], tuple[float, ...]] = lambda _: ()
    direct: ActsOn | None = None
    known_error: Array | float = 0.0
    further: Mapping[str, Array] = field(default_factory=dict)
    intercept: Array | None = None
    lacks: frozenset[str] = frozenset()

    @property
    def trial_axes(self) -> tuple[str, ...]:
        """Covariates of this rig alone."""
        return tuple(self.further)

    def covariates(self) -> dict[str, Array]:
        """Return the covariates of every trial, arrays of shape (N,)."""
        state, count = self.state, len(self.table)
        values = {
            "velocity": state.speed_m_s,
            "tension": state.tension_n,
            "n_pulleys": state.n_pulleys,
            "wrap_angle": state.wrap_angle_deg,
        }
        return {
            name: np.broadcast_to(np.asarray(value, dtype=np.float64), (count,))
            for name, value in (values | dict(self.further)).items()
        }

    def where(self, acts_on: ActsOn) -> Any:
        """Return the states at which a law that acts so is evaluated, or Unsupported."""
        if acts_on == self.direct or acts_on in ("friction", "drive"):
            return self.state
        return NO_EVENTS if acts_on == "reading" else NO_MOTOR

    def readings(self, force_n: Array) -> Array:
        """Return the change of each reading by a force that opposes the motion, (…, N)."""
        return np.asarray(self.per_newton * self.feedback * force_n)

    def coefficient_columns(self) -> Array:
        """Return the derivatives of each reading by c1, c2 and c3, shape (N, 3)."""
        where = self.covariates()
        n, tension = where["n_pulleys"], where["tension"]
        turn = where["wrap_angle"] - REFERENCE_WRAP_ANGLE_DEG
        columns = self.readings(np.stack([n * tension, n, n * tension * turn])).T
        return columns * [name not in self.lacks for name in Coefficients._fields]

    def smooth_columns(self, smooth: Smooth, force_n: Array) -> Array:
        """Return the columns of a smooth force, (N, k); `force_n` is its unit, (N,)."""
        unit = self.friction_n if smooth.relative else force_n
        return self.readings(unit * smooth.columns(self.covariates())).T

    def nuisance_columns(self) -> Array:
        """Return the columns of numbers that all readings share, (N, K)."""
        return self.curve

    def scatter_column(self) -> Array:
        """Return the change of each reading by a relative deviation of friction of 1, (N,)."""
        return np.asarray(self.per_newton * self.friction_n)

    def added(self, acts_on: ActsOn, size: Array) -> Array:
        """Return the change of each reading by a force, or by an error of the reading, (N,)."""
        added = np.broadcast_to(size, (len(self.table),))
        return added if acts_on == self.direct else self.readings(added)

    def relative_force(self, candidate: Candidate) -> Array | Unsupported:
        """Return the force of amplitude 1 relative to friction, (1, N, 1)."""
        column = self.candidate_column(candidate)
        if isinstance(column, Unsupported):
            return column
        return np.asarray(column / self.per_newton / self.friction_n)[None, :, None]

    def nuisance_scales(self, priors: Priors) -> tuple[float, ...]:
        """Return the prior standard deviations of the shared curve."""
        return self.curve_sd(priors)
