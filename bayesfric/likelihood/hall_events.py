r"""Hall events of a gravity-board trial, reduced to its acceleration.

An event of sensor s at displacement d is passed at the time t with

    x(t) − o_s − d = δ + v(t) ε,   δ ~ N(0, σ_x²),  ε ~ N(0, σ_t²),

where x(t) = v0 τ + a τ²/2 is the travel since the trial's first event. The
density of the raw event *times* is that of the residual times the speed v(t),
the Jacobian. The offsets o_s (uniform over one spacing: phase on a circle) and
the first speed v0 (half-normal) are marginalised in closed form, since the
residual is linear in them; what is left of a trial is a normal density in its
acceleration, times factors that depend on the noise alone:

    log p(times | a, σ) = log N(â; a, S² V) + C.

â, V and C depend on ρ = σ_t/σ_x only, apart from the overall scale
S² = σ_x² + v*² σ_t². They are tabulated once over log ρ, and the table is
reduced to its few leading singular vectors.

Speeds in the weights and in the Jacobian are those of a pilot fit a trial.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.interpolate import BSpline, make_interp_spline

__all__ = ["EventTable", "TrialAcceleration", "pilot_fits", "reduce_events"]

Array = NDArray[np.float64]
LOG_2PI = float(np.log(2 * np.pi))
LOG_RHO_SPAN = 9.25  # ± about 1/v*: beyond it one noise is 1e-4 of the other
GRID_STEP = 0.125
SPLINE_DEGREE = 7
REDUCED_TO = 1e-10  # singular values kept, relative to the largest


@dataclass(frozen=True)
class TrialAcceleration:
    """A trial's events given the noise: a normal density of its acceleration.

    Parameters
    ----------
    mean : ndarray, shape (…, N)
        â, the acceleration that the events show [m/s²].
    variance : ndarray, shape (…, N)
        Variance of â around the true acceleration [m²/s⁴].
    log_constant : ndarray, shape (…, N)
        C: log p(times | a, σ) − log N(â; a, variance).
    """

    mean: Array
    variance: Array
    log_constant: Array


@dataclass(frozen=True)
class EventTable:
    """Tabulated sufficient statistics of N trials.

    Parameters
    ----------
    typical_speed : float
        v*, which splits the noise into scale and ratio [m/s].
    tick_variance : float
        Variance of rounding the clock, added to σ_t² [s²].
    spline : BSpline
        From log(ρ v*) to the coefficients of `basis`.
    basis : ndarray, shape (K, 4 N)
        Leading singular vectors of the table.
    centre : ndarray, shape (4 N,)
        Mean of the table.
    degrees_of_freedom : ndarray, shape (N,)
        Events minus nuisances minus one.
    constant : ndarray, shape (N,)
        The part of C that no parameter moves.
    pilot_scale : float
        Noise scale in which sums of squares are tabulated [m].
    """

    typical_speed: float
    tick_variance: float
    spline: BSpline
    basis: Array
    centre: Array
    degrees_of_freedom: Array
    constant: Array
    pilot_scale: float

    def at(self, sigma_x: Array, sigma_t: Array) -> TrialAcceleration:
        """Evaluate the statistics.

        Parameters
        ----------
        sigma_x, sigma_t : ndarray, shape (W,)
            Position [m] and clock [s] noise, above zero.

        Returns
        -------
        TrialAcceleration
            Arrays of shape (W, N).
        """
        clock = np.sqrt(sigma_t**2 + self.tick_variance) * self.typical_speed
        scale2 = sigma_x**2 + clock**2
        log_ratio = np.clip(np.log(clock / sigma_x), -LOG_RHO_SPAN, LOG_RHO_SPAN)
        rows = self.spline(log_ratio) @ self.basis + self.centre
        mean, log_variance, log_determinant, squares = np.split(rows, 4, axis=-1)
        scale2 = scale2[:, None]
        return TrialAcceleration(
            mean,
            scale2 * np.exp(log_variance),
            self.constant
            + log_determinant
            - 0.5 * self.degrees_of_freedom * (LOG_2PI + np.log(scale2))
            - 0.5 * squares * (self.pilot_scale**2 / scale2),
        )


@dataclass(frozen=True)
class PilotFit:
    """Least-squares motion of each trial, with its sensors' offsets.

    Parameters
    ----------
    first_speed, acceleration : ndarray, shape (N,)
        Speed at the trial's first event [m/s] and acceleration [m/s²].
    last_speed : ndarray, shape (N,)
        Speed at the trial's last event [m/s].
    least_speed : ndarray, shape (N,)
        Least speed at any event [m/s].
    rms_residual : float
        Of all the events [m].
    """

    first_speed: Array
    acceleration: Array
    last_speed: Array
    least_speed: Array
    rms_residual: float


@dataclass(frozen=True)
class _Events:
    """Events of N trials, sorted by trial, as flat arrays."""

    starts: NDArray[np.intp]
    trial: NDArray[np.intp]
    tau: Array
    displacement: Array
    regressors: Array  # (4, E): −[drive], −[load], τ, τ²/2
    present: NDArray[np.bool_]  # (4, N): regressor is there

    def total(self, values: Array) -> Array:
        """Sum events over each trial (last axis)."""
        return np.add.reduceat(values, self.starts, axis=-1)

    def normal_equations(self, weight: Array) -> tuple[Array, Array]:
        """Return XᵀWX, shape (N, 4, 4), and XᵀWd, shape (N, 4); absent rows are unit."""
        weighted = self.regressors * weight
        matrix = np.empty((self.starts.size, 4, 4))
        for row in range(4):
            for column in range(row, 4):
                matrix[:, row, column] = self.total(weighted[row] * self.regressors[column])
                matrix[:, column, row] = matrix[:, row, column]
        for row in range(4):
            matrix[~self.present[row], row, row] = 1.0
        return matrix, self.total(weighted * self.displacement).T


def _prepare(events: pd.DataFrame, trial_ids: pd.Series) -> _Events:
    place = pd.Index(trial_ids).get_indexer(events["trial"])
    order = np.argsort(place, kind="stable")[np.count_nonzero(place < 0) :]
    trial = place[order]
    starts = np.flatnonzero(np.diff(trial, prepend=-1))
    time = events["time_s"].to_numpy()[order]
    tau = time - np.minimum.reduceat(time, starts)[trial]
    drive = (events["sensor"].to_numpy() == "drive")[order]
    regressors = np.stack([-1.0 * drive, -1.0 * ~drive, tau, tau**2 / 2])
    present = np.logical_or.reduceat(regressors != 0, starts, axis=-1)
    displacement = events["displacement_m"].to_numpy()[order]
    return _Events(starts, trial, tau, displacement, regressors, present)


def pilot_fits(events: pd.DataFrame, trial_ids: pd.Series) -> PilotFit:
    """Fit each trial's motion by ordinary least squares.

    Parameters
    ----------
    events : DataFrame
        Event table of a recording; each of `trial_ids` has events.
    trial_ids : Series of str, length N
        The trials, in the order of the result.

    Returns
    -------
    PilotFit
        In the order of `trial_ids`.
    """
    return _pilot(_prepare(events, trial_ids))


def _pilot(table: _Events) -> PilotFit:
    matrix, right = table.normal_equations(np.ones_like(table.tau))
    fit = np.asarray(np.linalg.solve(matrix, right[..., None])[..., 0], dtype=np.float64)
    speed = fit[table.trial, 2] + fit[table.trial, 3] * table.tau
    residual = (table.regressors * fit[table.trial].T).sum(axis=0) - table.displacement
    freedom = table.tau.size - table.present.sum()
    return PilotFit(
        first_speed=fit[:, 2],
        acceleration=fit[:, 3],
        last_speed=fit[:, 2] + fit[:, 3] * np.maximum.reduceat(table.tau, table.starts),
        least_speed=np.minimum.reduceat(speed, table.starts),
        rms_residual=float(np.sqrt((residual**2).sum() / freedom)),
    )


def reduce_events(
    events: pd.DataFrame,
    trial_ids: pd.Series,
    *,
    spacing_m: float,
    tick_s: float,
    first_speed_scale: float,
) -> EventTable:
    """Tabulate the sufficient statistics of trials over the ratio of the noises.

    Parameters
    ----------
    events : DataFrame
        Event table of a recording; each of `trial_ids` has at least five events
        of one sensor.
    trial_ids : Series of str, length N
        The trials, in the order of the result.
    spacing_m : float
        Travel between two events: the support of a phase [m].
    tick_s : float
        Resolution of the clock [s].
    first_speed_scale : float
        Scale of the half-normal prior of the first speed [m/s].

    Returns
    -------
    EventTable
        To be evaluated at the noise of each walker.
    """
    table = _prepare(events, trial_ids)
    pilot = _pilot(table)
    speed = pilot.first_speed[table.trial] + pilot.acceleration[table.trial] * table.tau
    typical = float(np.exp(np.mean(np.log(speed))))
    relative2 = (speed / typical) ** 2
    log_ratio = np.arange(-LOG_RHO_SPAN, LOG_RHO_SPAN + GRID_STEP / 2, GRID_STEP)
    rows = np.stack(
        [_statistics(table, relative2, ratio, pilot.rms_residual) for ratio in log_ratio]
    )
    centre = rows.mean(axis=0)
    left, singular, right = np.linalg.svd(rows - centre, full_matrices=False)
    kept = singular > REDUCED_TO * singular[0]
    sensors = table.present[:2].sum(axis=0)
    log_speed_prior = (
        np.log(2 / first_speed_scale)
        - 0.5 * LOG_2PI
        - 0.5 * (pilot.first_speed / first_speed_scale) ** 2
    )
    return EventTable(
        typical_speed=typical,
        tick_variance=tick_s**2 / 12,
        spline=make_interp_spline(log_ratio, left[:, kept] * singular[kept], k=SPLINE_DEGREE),
        basis=right[kept],
        centre=centre,
        degrees_of_freedom=table.total(np.ones_like(table.tau)) - sensors - 2.0,
        constant=table.total(np.log(speed)) - sensors * np.log(spacing_m) + log_speed_prior,
        pilot_scale=pilot.rms_residual,
    )


def _statistics(table: _Events, relative2: Array, log_ratio: float, scale: float) -> Array:
    """Return [â, log V, log-determinant part of C, squares / scale²] at one noise ratio."""
    ratio2 = np.exp(2 * log_ratio)
    spread = (1 + ratio2 * relative2) / (1 + ratio2)  # event variance over S²
    matrix, right = table.normal_equations(1 / spread)
    fit = np.linalg.solve(matrix, right[..., None])[..., 0]
    residual = (table.regressors * fit[table.trial].T).sum(axis=0) - table.displacement
    variance = np.linalg.inv(matrix)[:, 3, 3]
    determinant = np.linalg.slogdet(matrix)[1]
    return np.concatenate(
        [
            fit[:, 3],
            np.log(variance),
            -0.5 * (table.total(np.log(spread)) + determinant),
            table.total(residual**2 / spread) / scale**2,
        ]
    )
