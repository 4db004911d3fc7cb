r"""Hall events of a gravity-board trial, reduced to sufficient statistics of its motion.

An event of sensor s at displacement d is passed at the time t with

    x(t) − o_s − d = δ + v(t) ε,   δ ~ N(0, σ_x²),  ε ~ N(0, σ_t²),

where x(t) = v0 τ + a τ²/2 + Σ_k A_k u_k(τ) is the travel since the trial's first
event; u_k is what an effect that changes along the trial adds to the travel
(:mod:`bayesfric.rigs.gravity_board.paths`), and the baseline has none. The density of the raw
event *times* is that of the residual times the speed v(t), the Jacobian. The offsets
o_s (uniform over one spacing: phase on a circle), the first speed v0 (half-normal) and by how
much the clock of one sensor is late (normal; its column is the pilot's speed) are
marginalised in closed form, since the residual is linear in them; what is left of
a trial is a quadratic form in w = (a − â₀, A_1, …, A_K), â₀ being a pilot's:

    log p(times | w, σ) = C − (wᵀ G w − 2 bᵀ w) / 2.

G, b and C depend on ρ = σ_t/σ_x only, apart from the overall scale
S² = σ_x² + v*² σ_t². They are interpolated over log ρ by polynomials on intervals; each
interval is tabulated when it is first needed.

Speeds in the weights and in the Jacobian are those of a pilot fit of each trial. If events
determine the offset of the clocks far better than its prior does, it is integrated out once, with a
first estimate of the noise. Otherwise the offset is one more variable of the form and is integrated
out with the noise of each walker.
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
LOG_RHO_SPAN = 9.25  # ± about 1/v*: beyond it one noise is 1e-4 of the other
CACHED = 200_000  # numbers of forms at a time: more are given back to the system each time
INTERVAL = 1.0  # of log ρ
DEGREE = 11  # of a polynomial: 1e-5 nat of the paper's protocol


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
        this form of (w, −1), up to a constant.
    log_constant : ndarray, shape (W, N)
        C, without what the squares take from it.
    """

    origin: Array
    triangle: Array
    log_constant: Array

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
    """Sufficient statistics of N trials and K effects along them.

    Parameters
    ----------
    events : Events
        Their regressors are those of the nuisances, then those of the form.
    residual : ndarray, shape (E,)
        Displacement less that of the pilot [m].
    speed : ndarray, shape (E,)
        Of the pilot [m/s].
    typical_speed : float
        v*, which splits the noise into scale and ratio [m/s].
    tick_variance : float
        Variance of rounding the clock, added to σ_t² [s²].
    degrees_of_freedom : ndarray, shape (N,)
        Events minus nuisances.
    constant : ndarray, shape (N,)
        The part of C that no parameter moves.
    origin : ndarray, shape (N,)
        Pilot accelerations [m/s²].
    first_speed : ndarray, shape (N,)
        Of the pilot, at the trial's first event [m/s].
    prior : ClockPrior
        Of how late the clock of one sensor is.
    intervals : dict of int to ndarray, shape (R, N, 1 + DEGREE)
        Of those of log ρ that were asked for, R statistics a trial as coefficients of
        Chebyshev polynomials.
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
        """Return the same with a half-normal prior of the first speed, of this scale [m/s]."""
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
        """Evaluate the statistics.

        Parameters
        ----------
        sigma_x, sigma_t : ndarray, shape (W,)
            Position [m] and clock [s] noise, above zero.
        variances : sequence of B ndarrays, shape (W, N)
            Of the normal numbers that are drawn anew in each trial; they are integrated out.
        motions : pair of sequence of 2 + K arrays or floats, broadcastable to (W, N), or None
            Multiples of two motions (w, −1) take the place of w.

        Returns
        -------
        TrialForm
            Of W noises and N trials.
        """
        if self.prior.drawn:
            variances = [np.ones((len(sigma_x), 1)), *variances]
        clock = np.sqrt(sigma_t**2 + self.tick_variance) * self.typical_speed
        scale2 = (sigma_x**2 + clock**2)[:, None]
        log_ratio = np.clip(np.log(clock / sigma_x), -LOG_RHO_SPAN, LOG_RHO_SPAN)
        interval, within = np.divmod(log_ratio, INTERVAL)
        # The scale goes into the few polynomials, not into all that comes of them.
        polynomials = chebyshev.chebvander(2 * within / INTERVAL - 1, DEGREE) / scale2
        asked = np.unique(interval).astype(int).tolist()
        if len(asked) == 1:
            forms = self._without(asked[0], polynomials, variances, motions)
        else:
            walkers = [np.flatnonzero(interval == place) for place in asked]
            parts = [
                self._without(
                    place,
                    polynomials[chosen],
                    [_of(variance, chosen) for variance in variances],
                    None if motions is None else [[_of(x, chosen) for x in y] for y in motions],
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

    def _without(
        self,
        interval: int,
        weights: Array,
        variances: Sequence[Array],
        motions: Motions | None,
    ) -> Array:
        """Integrate numbers out of the statistics of one interval.

        Returns
        -------
        ndarray, shape (s (s + 1)/2 + 1, N, W)
            The form that is left, then the log determinant of all that was integrated out.
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
            # Walkers next to each other in memory: what follows is faster so.
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

        They are exact, and touch all events.
        """
        ratio2 = np.exp(2 * log_ratio)[:, None]
        relative2 = (self.speed / self.typical_speed) ** 2
        spread = (1 + ratio2 * relative2) / (1 + ratio2)  # event variance over S²
        events = self.events
        whole = events.normal_equations(1 / spread, self.residual)
        count = NUISANCES
        if self.prior.taken:
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


def _of(values: ArrayLike, walkers: Whole) -> Array:
    """Return the rows of some walkers, which lie next to each other in memory."""
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
    """Tabulate the sufficient statistics of trials over the ratio of the noises.

    Parameters
    ----------
    events : DataFrame
        Event table of a recording; each trial has at least five events of one sensor.
    trial_ids : Series of str, length N
        The trials, in the order of the result.
    spacing_m : float
        Travel between two events: the support of a phase [m].
    tick_s : float
        Resolution of the clock [s].
    responses : ndarray, shape (K, E), or None
        u_k, what each effect adds to the travel at unit amplitude, by event [m].
    scattered : ndarray, shape (B, E), or None
        The same of numbers that are drawn anew in each trial; they come first in the form.
    clock_sd_s : float
        Standard deviation of how late the clock of one sensor is [s].

    Returns
    -------
    EventTable
        With a flat prior of the first speed; see :meth:`EventTable.with_first_speed`.
    """
    table = prepare_events(events, trial_ids)
    pilot = pilot_of(table)
    fit = pilot_coefficients(table)
    residual = table.displacement - (table.regressors * fit[table.trial].T).sum(axis=0)
    speed = pilot.first_speed[table.trial] + pilot.acceleration[table.trial] * table.tau
    late = late_column(table, speed) * clock_sd_s
    table = _beside(table, NUISANCES, scattered)
    prior = none_late(pilot.acceleration.size)
    if late.any():
        table = _beside(table, CLOCK, late[None])
        prior = clock_prior(table, residual, -clock_shifts(events, trial_ids) / clock_sd_s)
        residual = residual - late * prior.moved[table.trial]
    table = _beside(table, len(table.regressors), responses)
    sensors = table.present[:2].sum(axis=0)
    return EventTable(
        events=table,
        residual=residual,
        speed=speed,
        typical_speed=float(np.exp(np.mean(np.log(speed)))),
        tick_variance=tick_s**2 / 12,
        degrees_of_freedom=_events_of_trials(table) - sensors - 1.0 - prior.share_of_events,
        constant=table.total(np.log(speed)) - sensors * np.log(spacing_m) + prior.constant,
        origin=pilot.acceleration,
        first_speed=pilot.first_speed,
        prior=prior,
    )


def _events_of_trials(table: Events) -> Array:
    """Return how many events each trial has, shape (N,)."""
    return table.total(np.ones_like(table.tau))


def _beside(table: Events, place: int, columns: Array | None) -> Events:
    """Return events with further regressors at a place among them."""
    if columns is None:
        return table
    before, after = table.regressors[:place], table.regressors[place:]
    return replace(table, regressors=np.concatenate([before, columns, after]))
