r"""Hall events of a gravity-board trial, reduced to what they say of its motion.

An event of sensor s at displacement d is passed at the time t with

    x(t) − o_s − d = δ + v(t) ε,   δ ~ N(0, σ_x²),  ε ~ N(0, σ_t²),

where x(t) = v0 τ + a τ²/2 + Σ_k A_k u_k(τ) is the travel since the trial's first
event; u_k is what an effect that changes along the trial adds to the travel
(:mod:`bayesfric.rigs.gravity_board.paths`), and the baseline has none. The density of the raw
event *times* is that of the residual times the speed v(t), the Jacobian. The offsets
o_s (uniform over one spacing: phase on a circle) and the first speed v0 (half-normal)
are marginalised in closed form, since the residual is linear in them; what is left of
a trial is a quadratic form in w = (a − â₀, A_1, …, A_K), â₀ being a pilot's:

    log p(times | w, σ) = C − (wᵀ G w − 2 bᵀ w) / 2.

G, b and C depend on ρ = σ_t/σ_x only, apart from the overall scale
S² = σ_x² + v*² σ_t². They are tabulated once over log ρ, and the table is
reduced to its few leading singular vectors.

Speeds in the weights and in the Jacobian are those of a pilot fit a trial.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.interpolate import BSpline, make_interp_spline

from bayesfric.arrays import Array
from bayesfric.inference.quadratic import eliminate
from bayesfric.rigs.gravity_board.trial_motion import (
    NUISANCES,
    Events,
    pilot_coefficients,
    pilot_of,
    prepare_events,
)

__all__ = [
    "EventTable",
    "TrialAcceleration",
    "TrialForm",
    "reduce_events",
]

LOG_2PI = float(np.log(2 * np.pi))
LOG_RHO_SPAN = 9.25  # ± about 1/v*: beyond it one noise is 1e-4 of the other
GRID_STEP = 0.125
SPLINE_DEGREE = 7
REDUCED_TO = 1e-9  # singular values kept, relative to the largest: 1e-5 nat of quick


class TrialAcceleration(NamedTuple):
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


class TrialForm(NamedTuple):
    """A trial's events given the noise: a quadratic form in its motion w.

    Parameters
    ----------
    origin : ndarray, shape (N,)
        â₀, from which acceleration is counted [m/s²].
    triangle : ndarray, shape (s (s + 1)/2, W, N)
        Upper triangle of [[G, b], [bᵀ, squares]] row by row: minus twice the log density is
        this form of (w, −1), up to a constant. Numbers that are drawn anew in each trial
        stand before w until they are integrated out.
    log_constant : ndarray, shape (W, N)
        C, without what the squares take from it.
    """

    origin: Array
    triangle: Array
    log_constant: Array

    def without(self, variances: Sequence[Array]) -> "TrialForm":
        """Return the form with its leading numbers integrated out.

        Parameters
        ----------
        variances : sequence of B ndarrays, shape (W, N)
            Of the normal numbers that stand before the acceleration.
        """
        if not variances:
            return self
        triangle, log_determinant = eliminate(self.triangle, variances)
        constant = self.log_constant - 0.5 * log_determinant
        return TrialForm(self.origin, np.ascontiguousarray(triangle), constant)

    def acceleration(self) -> TrialAcceleration:
        """Return the normal density of the acceleration where no effect acts."""
        precision, slope, squares = self.triangle
        return TrialAcceleration(
            self.origin + slope / precision,
            1 / precision,
            self.log_constant
            - 0.5 * squares
            + 0.5 * (slope**2 / precision + LOG_2PI - np.log(precision)),
        )


@dataclass(frozen=True)
class EventTable:
    """Tabulated sufficient statistics of N trials and K effects along them.

    Parameters
    ----------
    typical_speed : float
        v*, which splits the noise into scale and ratio [m/s].
    tick_variance : float
        Variance of rounding the clock, added to σ_t² [s²].
    spline : BSpline
        From log(ρ v*) to L coefficients.
    basis : ndarray, shape (1 + L, R N)
        Mean of the table and its leading singular vectors; R statistics a trial.
    degrees_of_freedom : ndarray, shape (N,)
        Events minus nuisances.
    constant : ndarray, shape (N,)
        The part of C that no parameter moves.
    origin : ndarray, shape (N,)
        Pilot accelerations [m/s²].
    first_speed : ndarray, shape (N,)
        Of the pilot, at the trial's first event [m/s].
    """

    typical_speed: float
    tick_variance: float
    spline: BSpline
    basis: Array
    degrees_of_freedom: Array
    constant: Array
    origin: Array
    first_speed: Array

    def with_first_speed(self, scale_m_s: float) -> "EventTable":
        """Return the same with a half-normal prior of the first speed, of this scale [m/s]."""
        log_prior = (
            np.log(2 / scale_m_s) - 0.5 * LOG_2PI - 0.5 * (self.first_speed / scale_m_s) ** 2
        )
        return replace(self, constant=self.constant + log_prior)

    def at(self, sigma_x: Array, sigma_t: Array) -> TrialForm:
        """Evaluate the statistics.

        Parameters
        ----------
        sigma_x, sigma_t : ndarray, shape (W,)
            Position [m] and clock [s] noise, above zero.

        Returns
        -------
        TrialForm
            Of W noises and N trials.
        """
        clock = np.sqrt(sigma_t**2 + self.tick_variance) * self.typical_speed
        scale2 = (sigma_x**2 + clock**2)[:, None]
        log_ratio = np.clip(np.log(clock / sigma_x), -LOG_RHO_SPAN, LOG_RHO_SPAN)
        # The scale goes into the few coefficients, not into all that comes of them.
        rows = self.basis.T @ (np.insert(self.spline(log_ratio), 0, 1.0, axis=1) / scale2).T
        # Walkers next to each other in memory: what follows is faster so.
        parts = rows.reshape(-1, self.origin.size, len(sigma_x)).transpose(0, 2, 1)
        log_determinant = parts[-1] * scale2
        return TrialForm(
            self.origin,
            parts[:-1],
            self.constant
            + log_determinant
            - 0.5 * self.degrees_of_freedom * (LOG_2PI + np.log(scale2)),
        )


def reduce_events(
    events: pd.DataFrame,
    trial_ids: pd.Series,
    *,
    spacing_m: float,
    tick_s: float,
    responses: Array | None = None,
    scattered: Array | None = None,
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
    responses : ndarray, shape (K, E), or None
        u_k, what each effect adds to the travel at unit amplitude, in the order of
        :func:`prepare_events` [m].
    scattered : ndarray, shape (B, E), or None
        The same of numbers that are drawn anew in each trial; they come first in the form.

    Returns
    -------
    EventTable
        To be evaluated at the noise of each walker; the first speed has a flat prior until
        :meth:`EventTable.with_first_speed` gives it another.
    """
    table = prepare_events(events, trial_ids)
    pilot = pilot_of(table)
    fit = pilot_coefficients(table)
    residual = table.displacement - (table.regressors * fit[table.trial].T).sum(axis=0)
    none = np.empty((0, table.tau.size))
    parts = [
        table.regressors[:NUISANCES],
        none if scattered is None else scattered,
        table.regressors[NUISANCES:],
        none if responses is None else responses,
    ]
    table = replace(table, regressors=np.concatenate(parts))
    speed = pilot.first_speed[table.trial] + pilot.acceleration[table.trial] * table.tau
    typical = float(np.exp(np.mean(np.log(speed))))
    relative2 = (speed / typical) ** 2
    log_ratio = np.arange(-LOG_RHO_SPAN, LOG_RHO_SPAN + GRID_STEP / 2, GRID_STEP)
    rows = np.stack([_statistics(table, relative2, ratio, residual) for ratio in log_ratio])
    # Each statistic in a unit of its own, so that a cut of the table is fair to all.
    unit = np.abs(rows).mean(axis=0)
    unit[unit == 0] = 1.0
    rows /= unit
    centre = rows.mean(axis=0)
    # A triangle of the few ratios has the singular values and vectors of the wide table.
    triangle = np.asarray(np.linalg.qr((rows - centre).T, mode="r"))
    left, singular, _ = np.linalg.svd(triangle.T, full_matrices=False)
    leading = left[:, singular > REDUCED_TO * singular[0]]
    sensors = table.present[:2].sum(axis=0)
    return EventTable(
        typical_speed=typical,
        tick_variance=tick_s**2 / 12,
        spline=make_interp_spline(log_ratio, leading, k=SPLINE_DEGREE),
        basis=np.vstack([centre, leading.T @ (rows - centre)]) * unit,
        degrees_of_freedom=table.total(np.ones_like(table.tau)) - sensors - 1.0,
        constant=table.total(np.log(speed)) - sensors * np.log(spacing_m),
        origin=pilot.acceleration,
        first_speed=pilot.first_speed,
    )


def _statistics(table: Events, relative2: Array, log_ratio: float, residual: Array) -> Array:
    """Return the form (upper triangle) and the log determinant at one noise ratio, (R N,)."""
    ratio2 = np.exp(2 * log_ratio)
    spread = (1 + ratio2 * relative2) / (1 + ratio2)  # event variance over S²
    matrix, right = table.normal_equations(1 / spread, residual)
    nuisance, mixed = matrix[:, :NUISANCES, :NUISANCES], matrix[:, :NUISANCES, NUISANCES:]
    # Integrating over the nuisances leaves the Schur complement.
    solved = np.linalg.solve(nuisance, np.concatenate([mixed, right[:, :NUISANCES, None]], axis=2))
    curvature = matrix[:, NUISANCES:, NUISANCES:] - mixed.transpose(0, 2, 1) @ solved[..., :-1]
    slope = right[:, NUISANCES:] - (mixed * solved[..., -1:]).sum(axis=1)
    squares = table.total(residual**2 / spread) - (right[:, :NUISANCES] * solved[..., -1]).sum(1)
    determinant = np.linalg.slogdet(nuisance)[1]
    rows = [
        [*curvature[:, place, place:].T, slope[:, place]] for place in range(curvature.shape[1])
    ]
    last = [squares, -0.5 * (table.total(np.log(spread)) + determinant)]
    return np.concatenate([one for row in rows for one in row] + last)
