"""Windows of an axis, linear around a reference law in coefficients, effects and nuisances."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from bayesfric.analysis import Priors
from bayesfric.arrays import Array, Flags
from bayesfric.effects import ActsOn, State
from bayesfric.effects.candidates import Candidate
from bayesfric.inference.smooths import Smooth
from bayesfric.observation.linear import rank
from bayesfric.observation.part import LaidRows
from bayesfric.physics.axis import AxisLaw
from bayesfric.physics.friction import Coefficients
from bayesfric.recording.columns import TAKEN
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.single_axis.carried import warmth_of
from bayesfric.rigs.single_axis.measures import Measures
from bayesfric.rigs.single_axis.readings import Readings
from bayesfric.rigs.single_axis.simulated import SimulatedBaseline

NO_SENSOR = Unsupported("it acts on readings of sensors that an axis does not have")
UNKNOWN_PHASE = Unsupported(
    "its phase would change from run to run, and an axis records its position"
)
OWN_COLUMNS = ("run", "order", "setup", "role")


@dataclass(frozen=True)
class AxisRows(LaidRows):
    """Windows of an axis, linear around a reference law.

    Parameters
    ----------
    name : str
        Name of the rig.
    table : DataFrame
        N trials.
    readings : Readings
        W windows.
    law : AxisLaw
        The reference law.
    state : State
        State of the axis at P places inside each window, arrays that broadcast to (W, P).
    stroke : float
        Range of positions [m or rad].
    latency_s : float
        Prior standard deviation of the difference between the clocks of force and position [s].
    lacks : tuple of str
        Coefficients that the law does not have, of c1 (mass), c2 (Coulomb friction) and c3
        (viscous friction).
    offset_n : float
        Prior standard deviation of a constant force; 0 if the law has none [N or N·m].
    simulated : SimulatedBaseline or None
        A simulator that replaces the law. `law` then only gives scales.
    theta : tuple of float
        The simulator's parameters at the reference.
    loads : tuple of str
        For proposed runs: columns that together define a condition.
    further : tuple of str
        The user's own columns that varied.
    """

    unseen_phases = UNKNOWN_PHASE

    name: str
    table: pd.DataFrame
    readings: Readings
    law: AxisLaw
    state: State
    stroke: float
    latency_s: float
    lacks: tuple[str, ...] = ()
    offset_n: float = 0.0
    simulated: SimulatedBaseline | None = None
    theta: tuple[float, ...] = ()
    loads: tuple[str, ...] = ()
    further: tuple[str, ...] = ()

    @property
    def trial_axes(self) -> tuple[str, ...]:
        """Covariates that only this rig has.

        Position is one of them, although the scatter of friction varies along the path: wear at
        the same position in every run is not scatter. Acceleration is not, because it contains
        the window's own error.
        """
        return ("displacement", *self.further)

    @property
    def scattering_axes(self) -> tuple[str, ...]:
        """All trial axes: scatter varies along the path and between runs."""
        return self.trial_axes

    @property
    def clock_nuisances(self) -> tuple[int, ...]:
        """Index of the clocks' difference among the nuisances."""
        return (0,)

    @property
    def friction_n(self) -> Array:
        """Mean friction of each trial by the reference law, (N,) [N or N·m]."""
        rows = self.readings
        count = np.bincount(rows.trial, minlength=len(self.table))
        total = np.bincount(rows.trial, self.friction_of_row, len(self.table))
        return np.asarray(total / np.maximum(count, 1))

    @property
    def friction_of_row(self) -> Array:
        """Friction of each window by the reference law, (W,) [N or N·m]."""
        return np.asarray(self.law.coulomb + self.law.viscous * self.readings.mean_speed)

    @property
    def moved_mass(self) -> float:
        """Mass by which position errors enter the force: that of the law and of the known force."""
        return float(self.law.mass + self.readings.known_inertia)

    def mean(self, values: Array) -> Array:
        """Return means over the windows of values at places inside them, (W,).

        `values` broadcasts to (W, P).
        """
        rows = self.readings
        return np.asarray(np.broadcast_to(values, rows.speed.shape) @ rows.weights)

    def covariates(self) -> dict[str, Array]:
        """Return the covariates of each window, arrays of shape (W,)."""
        rows = self.readings
        ones = np.ones(rows.count)
        own = {name: self.table[name].to_numpy(dtype=np.float64) for name in self.further}
        return {name: values[rows.trial] for name, values in own.items()} | {
            "velocity": rows.mean_speed,
            "tension": ones,
            "n_pulleys": ones,
            "wrap_angle": ones,
            "displacement": rows.mean_position,
            "acceleration": rows.acceleration,
        }

    def where(self, acts_on: ActsOn) -> Any:
        """Return the states at which an effect's law is evaluated, or why it has none."""
        return self.state if acts_on in ("friction", "drive") else NO_SENSOR

    def coefficient_columns(self) -> Array:
        """Return derivatives of each window's force by the law's coefficients, (W, 3).

        If a simulator replaces the law, they are those by its parameters.
        """
        rows = self.readings
        if self.simulated is not None:
            return self.simulated.columns(rows)
        return rows.law_columns * [name not in self.lacks for name in Coefficients._fields]

    def residual(self) -> Array:
        """Return each window's force minus that of the reference law or simulator, (W,) [N]."""
        if self.simulated is not None:
            return self.readings.force - self.simulated.needed(self.readings, self.theta)
        return np.asarray(self.readings.force - self.coefficient_columns() @ np.array(self.law))

    def smooth_columns(self, smooth: Smooth, force_n: Array) -> Array:
        """Return the columns of a smooth force, (W, k); `force_n` (N,) is its unit."""
        unit = self.friction_of_row if smooth.relative else force_n[self.readings.trial]
        return np.asarray(unit * smooth.columns(self.covariates())).T

    def scatter_column(self) -> Array:
        """Return the force of a relative deviation of friction by 1 in each window, (W,)."""
        return self.friction_of_row

    def added(self, acts_on: ActsOn, size: Array) -> Array:
        """Return the mean in each window of a force at places inside it, (W,)."""
        del acts_on
        return self.mean(size)

    def relative_force(self, candidate: Candidate) -> Array | Unsupported:
        """Return the force of an effect with amplitude 1, relative to friction, (1, 1, W)."""
        column = self.candidate_column(candidate)
        if isinstance(column, Unsupported):
            return column
        return np.asarray(column / self.friction_of_row)[None, None]

    def nuisance_scales(self, priors: Priors) -> tuple[float, ...]:
        """Return prior standard deviations of the nuisances in :meth:`nuisance_columns`.

        They are the clocks' difference [s], an offset [N] if there is one, and the amounts of
        forces beside the law.
        """
        del priors
        offset = (self.offset_n,) if self.offset_n else ()
        return (self.latency_s, *offset, *[1.0] * self.readings.beside.shape[1])

    def nuisance_columns(self) -> Array:
        """Return derivatives of each window's force by the nuisances, (W, m)."""
        rows = self.readings
        offset = [rows.way] if self.offset_n else []
        return np.stack([rows.force_rate, *offset, *rows.beside.T], axis=1)


def varied_columns(runs: pd.DataFrame) -> tuple[str, ...]:
    """Return the user's own columns of a table of runs that have more than one value."""
    own = [str(name) for name in runs if name not in {*OWN_COLUMNS, *TAKEN}]
    return tuple(name for name in own if np.ptp(runs[name].to_numpy(dtype=np.float64)) > 0)


def state_of(
    rows: Readings,
    law: AxisLaw,
    table: pd.DataFrame,
    tested: Flags,
    measures: Measures,
    constants: RigConstants,
    further: Sequence[str] = (),
) -> State:
    """Return the state of the axis at places inside windows, in arrays that broadcast to (W, P).

    Parameters
    ----------
    rows : Readings
        W windows, with P places each.
    law : AxisLaw
        The baseline.
    table : DataFrame
        N trials.
    tested : ndarray of bool, shape (N,)
        Trials that may differ from calibration.
    measures, constants : Measures, RigConstants
        Scales of the whole recording, and constants of the machine.
    further : sequence of str
        The user's own columns.
    """
    order = rank(table)[rows.trial]
    held, moved = _carried(rows, table, measures)
    warm = warmth_of(rows, order)
    return State(
        n_pulleys=1.0,
        wrap_angle_deg=85.0,
        tension_n=15.0,
        speed_m_s=rows.speed,
        tension_friction_n=0.0,
        constant_friction_n=law.coulomb + law.viscous * rows.speed,
        pulley_friction_n=law.coulomb,
        travel_m=rows.travel,
        passes_m=tuple(rows.passes.T[..., None]),
        acceleration_m_s2=rows.acceleration[:, None],
        order=order[:, None],
        gravity_m_s2=constants.gravity_m_s2,
        position_m=rows.position,
        direction=np.broadcast_to(rows.way[:, None], rows.speed.shape),
        drive_force_n=rows.drive,
        mass_kg=law.mass + rows.known_inertia,
        force_rate_n_s=rows.force_rate[:, None],
        lagging_rate_n_s=rows.lagging_rate[:, None],
        force_curvature_n_s2=rows.force_curvature[:, None],
        wave_from_m=measures.wave.start,
        load=measures.load(rows),
        mass_over_friction=measures.mass_over_friction,
        carried_n=held + moved,
        held_n=held,
        dwell_s=rows.dwell_s[:, None],
        since_rest_m=rows.since_rest[:, None],
        warmth=0.0 if warm is None else warm[:, None],
        tested=tested.astype(np.float64)[rows.trial][:, None],
        covariates=_covariates(rows, table, further),
    )


def _carried(rows: Readings, table: pd.DataFrame, measures: Measures) -> tuple[Array, Array]:
    """Return the gear's load by weights and springs, and by the inertia of the moving mass."""
    if measures.carried is None:
        return np.zeros(1), np.zeros(1)
    return measures.carried.at(rows, table)


def _covariates(rows: Readings, table: pd.DataFrame, names: Sequence[str]) -> dict[str, Array]:
    """Return the values of the trials' columns in each window, shape (W, 1)."""
    return {name: table[name].to_numpy(dtype=np.float64)[rows.trial][:, None] for name in names}
