r"""Hall events of a gravity-board trial, reduced to sufficient statistics of its motion.

An event of sensor s at displacement d is passed at the time t with

    x(t) − o_s − d = δ + v(t) ε,   δ ~ N(0, σ_x²),  ε ~ N(0, σ_t²),

where x(t) = v0 τ + a τ²/2 + Σ_k A_k u_k(τ) is the travel since the trial's first event. u_k is the
response of the travel to an effect that changes along the trial
(:mod:`bayesfric.rigs.gravity_board.paths`); the baseline has no such effects. The density of the
raw event *times* is that of the residual times the speed v(t), the Jacobian.

The residual is linear in three nuisance parameters: the offsets o_s (uniform over one spacing, as a
phase), the first speed v0 (half-normal) and the delay of the load sensor's clock (normal). They are
marginalised in closed form. The result is a quadratic form in w = (a − â₀, A_1, …, A_K), where â₀
is the acceleration of a preliminary ("pilot") fit:

    log p(times | w, σ) = C − (wᵀ G w − 2 bᵀ w) / 2.

Apart from the overall scale S² = σ_x² + v*² σ_t², G, b and C depend only on ρ = σ_t/σ_x. They are
interpolated in log ρ by polynomials on intervals. Each interval is tabulated when it is first
needed.

Speeds in the weights and in the Jacobian are those of the pilot fit. If events determine the offset
of the clocks far better than its prior does, it is integrated out once, with a first estimate of
the noise. Otherwise the offset is one more variable of the form and is integrated out with the
noise of each walker.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple, TypeAlias

import numpy as np
import pandas as pd
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from bayesfric.arrays import Array, Whole
from bayesfric.inference.priors import LOG_2PI
from bayesfric.inference.quadratic import contract, eliminate
from bayesfric.rigs.gravity_board.late_clock import (
    CLOCK,
    ClockPrior,
    clock_prior,
    clock_shifts,
    late_column,
    none_late,
)
from bayesfric.rigs.gravity_board.trial_motion import (
    NUISANCES,
    Events,
    pilot_coefficients,
    pilot_of,
    prepare_events,
)

Motions: TypeAlias = Sequence[Sequence[Array | float]]
LOG_RHO_SPAN = 9.25  # largest |log(v* ρ)|: beyond it one noise is 1e-4 of the other
CACHED = 200_000  # numbers in an array: larger arrays are allocated anew by the system each time
INTERVAL = 1.0  # length of an interval of log ρ
DEGREE = 11  # of a polynomial: the error is 1e-5 nat for the paper's protocol


class TrialAcceleration(NamedTuple):
    """The events of N trials given the noise, as normal densities of their accelerations.

    Parameters
    ----------
    mean : ndarray, shape (…, N)
        â, the acceleration estimated from the events [m/s²].
    variance : ndarray, shape (…, N)
        Variance of â around the true acceleration [m²/s⁴].
    log_constant : ndarray, shape (…, N)
        C: log p(times | a, σ) − log N(â; a, variance).
    """

    mean: Array
    variance: Array
    log_constant: Array


class TrialForm(NamedTuple):
    """The events of N trials given the noise, as quadratic forms in their motions w.

    Parameters
    ----------
    origin : ndarray, shape (N,)
        â₀, the acceleration at which w is 0 [m/s²].
    triangle : ndarray, shape (s (s + 1)/2, W, N)
        Upper triangle of [[G, b], [bᵀ, squares]], row by row. Up to a constant, minus twice the
        log density is the value of this form at (w, −1).
    log_constant : ndarray, shape (W, N)
        C without the term −squares/2.
    """

    origin: Array
    triangle: Array
    log_constant: Array

    def acceleration(self) -> TrialAcceleration:
        """Return the normal density of the acceleration, for trials without effects."""
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
    """Sufficient statistics of N trials and K effects along them.

    Parameters
    ----------
    events : Events
        Events, with the regressors of the nuisances followed by those of the form.
    residual : ndarray, shape (E,)
        Displacement minus that of the pilot fit [m].
    speed : ndarray, shape (E,)
        Speed of the pilot fit [m/s].
    typical_speed : float
        v* [m/s].
    tick_variance : float
        Variance by rounding of the clock, added to σ_t² [s²].
    degrees_of_freedom : ndarray, shape (N,)
        Number of events minus that of nuisances.
    constant : ndarray, shape (N,)
        The part of C that does not depend on parameters.
    origin : ndarray, shape (N,)
        Accelerations of the pilot fit [m/s²].
    first_speed : ndarray, shape (N,)
        Speed of the pilot fit at the trial's first event [m/s].
    prior : ClockPrior
        Prior of the delay of the load sensor's clock.
    intervals : dict of int to ndarray, shape (R, N, 1 + DEGREE)
        Tabulated intervals of log ρ: R statistics of each trial, as coefficients of Chebyshev
        polynomials.
    """

    events: Events
    residual: Array
    speed: Array
    typical_speed: float
    tick_variance: float
    degrees_of_freedom: Array
    constant: Array
    origin: Array
    first_speed: Array
    prior: ClockPrior
    intervals: dict[int, Array] = field(default_factory=dict)

    def with_first_speed(self, scale_m_s: float) -> "EventTable":
        """Return the table with a half-normal prior of the first speed of this scale [m/s]."""
        log_prior = (
            np.log(2 / scale_m_s) - 0.5 * LOG_2PI - 0.5 * (self.first_speed / scale_m_s) ** 2
        )
        return replace(self, constant=self.constant + log_prior)

    def at(
        self,
        sigma_x: Array,
        sigma_t: Array,
        variances: Sequence[Array] = (),
        motions: Motions | None = None,
    ) -> TrialForm:
        """Return the quadratic forms of the trials at the noise of each walker.

        Parameters
        ----------
        sigma_x, sigma_t : ndarray, shape (W,)
            Position [m] and clock [s] noise, positive.
        variances : sequence of B ndarrays, shape (W, N)
            Variances of the normal coefficients that are independent in each trial. These
            coefficients are integrated out.
        motions : pair of sequence of 2 + K arrays or floats, broadcastable to (W, N), or None
            Two motions (w, −1). The form in their multiples replaces the form in w.

        Returns
        -------
        TrialForm
            Forms for W walkers and N trials.
        """
        if self.prior.in_form:
            variances = [np.ones((len(sigma_x), 1)), *variances]
        clock = np.sqrt(sigma_t**2 + self.tick_variance) * self.typical_speed
        scale2 = (sigma_x**2 + clock**2)[:, None]
        log_ratio = np.clip(np.log(clock / sigma_x), -LOG_RHO_SPAN, LOG_RHO_SPAN)
        interval, within = np.divmod(log_ratio, INTERVAL)
        # Dividing the few polynomials by the scale is cheaper than dividing all forms.
        polynomials = chebyshev.chebvander(2 * within / INTERVAL - 1, DEGREE) / scale2
        asked = np.unique(interval).astype(int).tolist()
        if len(asked) == 1:
            forms = self._integrated(asked[0], polynomials, variances, motions)
        else:
            walkers = [np.flatnonzero(interval == place) for place in asked]
            parts = [
                self._integrated(
                    place,
                    polynomials[chosen],
                    [_of_walkers(variance, chosen) for variance in variances],
                    motions and [[_of_walkers(x, chosen) for x in y] for y in motions],
                )
                for place, chosen in zip(asked, walkers, strict=True)
            ]
            forms = np.concatenate(parts, axis=-1)[..., np.argsort(np.concatenate(walkers))]
        rows = forms.transpose(0, 2, 1)
        return TrialForm(
            self.origin,
            rows[:-1],
            self.constant
            - 0.5 * rows[-1]
            - 0.5 * self.degrees_of_freedom * (LOG_2PI + np.log(scale2)),
        )

    def _integrated(
        self,
        interval: int,
        weights: Array,
        variances: Sequence[Array],
        motions: Motions | None,
    ) -> Array:
        """Integrate coefficients out of the statistics of one interval.

        Returns
        -------
        ndarray, shape (s (s + 1)/2 + 1, N, W)
            The remaining form, then the log determinant of everything that was integrated out.
        """
        coefficients = self._interval(interval)
        shape = self.origin.size, len(weights)
        drawn = [np.broadcast_to(variance.T, shape) for variance in variances]
        moved = None
        if motions is not None:
            moved = [[np.broadcast_to(np.transpose(x), shape) for x in y] for y in motions]
        step = max(1, CACHED // (len(coefficients) * len(weights)))
        parts = []
        for start in range(0, self.origin.size, step):
            trials = slice(start, start + step)
            # Walkers are the last axis, which makes the operations below faster.
            statistics = coefficients[:, trials] @ weights.T
            form = statistics[:-1]
            if moved is not None:
                first, second = (
                    np.stack([column[trials] for column in motion]) for motion in moved
                )
                form = contract(form, (first, second))
            form, gained = eliminate(form, [variance[trials] for variance in drawn])
            parts.append(np.concatenate([form, (statistics[-1] / weights[:, 0] + gained)[None]]))
        return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=1)

    def _interval(self, place: int) -> Array:
        """Return the polynomials of one interval of log ρ, shape (R, N, 1 + DEGREE)."""
        if place not in self.intervals:
            nodes = chebyshev.chebpts1(DEGREE + 1)
            values = self.statistics((place + (nodes + 1) / 2) * INTERVAL)
            solved = np.linalg.solve(
                chebyshev.chebvander(nodes, DEGREE), values.reshape(len(nodes), -1)
            )
            self.intervals[place] = np.ascontiguousarray(solved.T).reshape(
                *values.shape[1:], len(nodes)
            )
        return self.intervals[place]

    def statistics(self, log_ratio: Array) -> Array:
        """Return the form (upper triangle) and the log determinant at V noise ratios, (V, R, N).

        They are computed from all events, without interpolation.
        """
        ratio2 = np.exp(2 * log_ratio)[:, None]
        relative2 = (self.speed / self.typical_speed) ** 2
        spread = (1 + ratio2 * relative2) / (1 + ratio2)  # event variance over S²
        events = self.events
        whole = events.normal_equations(1 / spread, self.residual)
        count = NUISANCES
        if self.prior.integrated_once:
            whole[..., CLOCK, CLOCK] += self.prior.scale2
            for place in ((CLOCK, -1), (-1, CLOCK)):
                whole[..., *place] += self.prior.scale2 * self.prior.mean
            count += 1
        nuisance, mixed = whole[..., :count, :count], whole[..., :count, count:]
        # Integrating over the nuisances leaves the Schur complement.
        form = whole[..., count:, count:] - mixed.swapaxes(-1, -2) @ np.linalg.solve(
            nuisance, mixed
        )
        determinant = events.total(np.log(spread)) + np.linalg.slogdet(nuisance)[1]
        row, column = np.triu_indices(form.shape[-1])
        return np.concatenate(
            [form[..., row, column].transpose(0, 2, 1), determinant[:, None]], axis=1
        )


def _of_walkers(values: ArrayLike, walkers: Whole) -> Array:
    """Return the values of some walkers (first axis), with walkers adjacent in memory."""
    whole = np.asarray(values, dtype=np.float64)
    return whole if whole.ndim == 0 or len(whole) == 1 else whole.T[:, walkers].T


def reduce_events(
    events: pd.DataFrame,
    trial_ids: pd.Series,
    *,
    spacing_m: float,
    tick_s: float,
    responses: Array | None = None,
    scattered: Array | None = None,
    clock_sd_s: float = 0.0,
) -> EventTable:
    """Return a table of the sufficient statistics of trials.

    Parameters
    ----------
    events : DataFrame
        Event table of a recording; each trial has at least five events of one sensor.
    trial_ids : Series of str, length N
        Identifiers of the trials, in the order of the result.
    spacing_m : float
        Travel between two events, which is the range of an offset [m].
    tick_s : float
        Resolution of the clock [s].
    responses : ndarray, shape (K, E), or None
        u_k, the response of the travel to each effect at unit amplitude, for each event [m].
    scattered : ndarray, shape (B, E), or None
        Responses to coefficients that are independent in each trial; they come first in the form.
    clock_sd_s : float
        Prior standard deviation of the delay of the load sensor's clock [s].

    Returns
    -------
    EventTable
        Table with a flat prior of the first speed; see :meth:`EventTable.with_first_speed`.
    """
    table = prepare_events(events, trial_ids)
    pilot = pilot_of(table)
    fit = pilot_coefficients(table)
    residual = table.displacement - (table.regressors * fit[table.trial].T).sum(axis=0)
    speed = table.speed(fit)
    late = late_column(table, speed) * clock_sd_s
    table = _beside(table, NUISANCES, scattered)
    prior = none_late(pilot.acceleration.size)
    if late.any():
        table = _beside(table, CLOCK, late[None])
        prior = clock_prior(table, residual, -clock_shifts(events, trial_ids) / clock_sd_s)
        residual = residual - late * prior.centre[table.trial]
    table = _beside(table, len(table.regressors), responses)
    sensors = table.present[:2].sum(axis=0)
    return EventTable(
        events=table,
        residual=residual,
        speed=speed,
        typical_speed=float(np.exp(np.mean(np.log(speed)))),
        tick_variance=tick_s**2 / 12,
        degrees_of_freedom=_events_of_trials(table) - sensors - 1.0 - prior.event_share,
        constant=table.total(np.log(speed)) - sensors * np.log(spacing_m) + prior.constant,
        origin=pilot.acceleration,
        first_speed=pilot.first_speed,
        prior=prior,
    )


def _events_of_trials(table: Events) -> Array:
    """Return the number of events of each trial, shape (N,)."""
    return table.total(np.ones_like(table.tau))


def _beside(table: Events, place: int, columns: Array | None) -> Events:
    """Return events with further regressors, inserted before the regressor of index `place`."""
    if columns is None:
        return table
    before, after = table.regressors[:place], table.regressors[place:]
    return replace(table, regressors=np.concatenate([before, columns, after]))
