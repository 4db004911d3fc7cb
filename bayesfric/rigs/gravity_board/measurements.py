"""The measurements of a trial of the gravity board: Hall events, or only an acceleration.

The log density of both is a quadratic form in the trial's acceleration and in the amplitudes of
effects that change along it, plus terms that do not depend on the friction law. If a trial has
both, its events are used. An acceleration without events is the mean over a trial from rest.
"""

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pandas as pd

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array, Whole
from bayesfric.inference.priors import LOG_2PI, Parameter
from bayesfric.inference.quadratic import contract, eliminate, gram
from bayesfric.recording.frames import stands_in
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.hall_events import (
    EventTable,
    Motions,
    TrialForm,
    reduce_events,
)
from bayesfric.rigs.gravity_board.late_clock import clock_sd_s
from bayesfric.rigs.gravity_board.trial_motion import pilot_fits

START_SIGMA_A = 0.01  # m/s², starting value


def pilot_accelerations(gravity: Gravity) -> Array:
    """Return each trial's acceleration, by least squares or as recorded, shape (N,) [m/s²]."""
    trials = gravity.trials
    with_events = stands_in(trials["trial"], gravity.events["trial"]).to_numpy()
    acceleration = optional_column(trials, "acceleration_m_s2")
    if with_events.any():
        pilot = pilot_fits(gravity.events, trials["trial"][with_events])
        acceleration[with_events] = pilot.acceleration
    return acceleration


class Columns(NamedTuple):
    """Responses of N trials to K effects along them, at unit amplitude.

    Parameters
    ----------
    travel : ndarray, shape (K, E)
        Response of the travel at each event, in the order of
        :func:`bayesfric.rigs.gravity_board.trial_motion.prepare_events` [m].
    acceleration : ndarray, shape (K, N)
        Response of the mean acceleration of each trial [m/s²].
    """

    travel: Array
    acceleration: Array


def joined(*parts: Columns | None) -> Columns | None:
    """Return the columns of all parts, one part after the other; None if there are none."""
    given = [part for part in parts if part is not None]
    if not given:
        return None
    travel, acceleration = zip(*given, strict=True)
    return Columns(np.concatenate(travel), np.concatenate(acceleration))


def event_table(
    gravity: Gravity,
    rig: RigConstants,
    columns: Columns | None = None,
    scattered: Columns | None = None,
) -> EventTable | None:
    """Return a table of the events of all trials that have some; None if there are no events.

    Parameters
    ----------
    gravity : Gravity
        Trials and their events.
    rig : RigConstants
        Constants of the board.
    columns, scattered : Columns or None
        As for :class:`TrialMeasurements`.
    """
    trials = gravity.trials
    seen = stands_in(trials["trial"], gravity.events["trial"])
    if not seen.any():
        return None
    assert rig.hall_spacing_m and rig.timer_resolution_s
    return reduce_events(
        gravity.events,
        trials["trial"][seen],
        spacing_m=rig.hall_spacing_m,
        tick_s=rig.timer_resolution_s,
        responses=None if columns is None else columns.travel,
        scattered=None if scattered is None else scattered.travel,
        clock_sd_s=clock_sd_s(rig),
    )


def noise_parameters(gravity: Gravity, analysis: Analysis) -> tuple[Parameter, ...]:
    """Return the noise parameters of the measurements.

    They are sigma_x and sigma_t if there are events, and sigma_a if a trial without events has an
    acceleration without a standard error.
    """
    trials, priors = gravity.trials, analysis.priors
    seen = stands_in(trials["trial"], gravity.events["trial"])
    parameters: tuple[Parameter, ...] = ()
    if seen.any():
        parameters += (
            Parameter("sigma_x", "m", priors.sigma_x, "noise", power=0.5),
            Parameter("sigma_t", "s", priors.sigma_t, "noise", power=0.5),
        )
    if np.isnan(optional_column(trials[~seen], "acceleration_sd_m_s2")).any():
        parameters += (Parameter("sigma_a", "m/s²", priors.sigma_a, "noise"),)
    return parameters


def rough_noise(parameters: Sequence[Parameter], residual_m: float) -> dict[str, float]:
    """Return rough estimates of noise parameters, from the rms residual of the events [m]."""
    rough = {"sigma_x": residual_m, "sigma_t": 0.1 * residual_m, "sigma_a": START_SIGMA_A}
    return {parameter.name: rough[parameter.name] for parameter in parameters}


class TrialMeasurements:
    """The measurements of N trials as quadratic forms in their motion.

    Parameters
    ----------
    gravity : Gravity
        Trials and their events.
    table : EventTable or None
        Table of the events, see :func:`event_table`.
    analysis : Analysis
        Priors of the noise.
    columns : Columns or None
        Responses to effects along the trials.
    scattered : Columns or None
        Responses to coefficients that are independent in each trial; they come first in the form.
    """

    def __init__(
        self,
        gravity: Gravity,
        table: EventTable | None,
        analysis: Analysis,
        columns: Columns | None = None,
        scattered: Columns | None = None,
    ) -> None:
        trials, priors = gravity.trials, analysis.priors
        with_events = stands_in(trials["trial"], gravity.events["trial"]).to_numpy()
        self._by_events = np.flatnonzero(with_events)
        self._by_acceleration = np.flatnonzero(~with_events)
        if table is not None:
            self._events = table.with_first_speed(priors.first_speed.scale)
        if self._by_acceleration.size:
            alone = trials.iloc[self._by_acceleration]
            self._acceleration = alone["acceleration_m_s2"].to_numpy(dtype=np.float64)
            self._stated_sd = optional_column(alone, "acceleration_sd_m_s2")
            responses = []  # of the mean acceleration, to each variable of the form
            if scattered is not None:
                responses += list(scattered.acceleration[:, self._by_acceleration])
            responses.append(np.ones(self._by_acceleration.size))
            if columns is not None:
                responses += list(columns.acceleration[:, self._by_acceleration])
            self._responses = np.stack(responses)

    def at(
        self,
        theta: Mapping[str, Array],
        variances: Sequence[Array] = (),
        motions: Motions | None = None,
    ) -> TrialForm:
        """Return the quadratic forms of the trials at the noise of each walker.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
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
        if not self._by_acceleration.size:
            return self._events.at(theta["sigma_x"], theta["sigma_t"], variances, motions)
        alone = self._alone(theta, *_columns(self._by_acceleration, variances, motions))
        if not self._by_events.size:
            return alone
        with_events = _columns(self._by_events, variances, motions)
        seen = self._events.at(theta["sigma_x"], theta["sigma_t"], *with_events)
        place = np.argsort(np.concatenate([self._by_events, self._by_acceleration]))
        return TrialForm(
            *(
                np.concatenate([np.broadcast_to(a, (*b.shape[:-1], a.shape[-1])), b], axis=-1)[
                    ..., place
                ]
                for a, b in zip(seen, alone, strict=True)
            )
        )

    @cached_property
    def origin(self) -> Array:
        """Acceleration of each trial at which w is 0, shape (N,) [m/s²]."""
        origin = np.empty(self._by_events.size + self._by_acceleration.size)
        if self._by_events.size:
            origin[self._by_events] = self._events.origin
        if self._by_acceleration.size:
            origin[self._by_acceleration] = self._acceleration
        return origin

    def _alone(
        self, theta: Mapping[str, Array], variances: Sequence[Array], motions: Motions | None
    ) -> TrialForm:
        """Return the forms of the trials that have only an acceleration."""
        walkers = max((len(values) for values in theta.values()), default=1)
        unknown = theta["sigma_a"][:, None] if "sigma_a" in theta else np.nan
        sd = np.where(np.isfinite(self._stated_sd), self._stated_sd, unknown)
        precision = np.broadcast_to(1 / sd**2, (walkers, sd.shape[-1]))
        # The residual is 0, because each recorded acceleration is its own origin.
        columns = [*self._responses, np.zeros_like(self._acceleration)]
        form = gram(columns, np.ones_like(self._acceleration), np.asarray)[:, None] * precision
        if motions is not None:
            first, second = (
                np.stack([np.broadcast_to(x, precision.shape) for x in y]) for y in motions
            )
            form = contract(form, (first, second))
        form, log_determinant = eliminate(form, variances)
        return TrialForm(
            self._acceleration, form, 0.5 * (np.log(precision) - LOG_2PI - log_determinant)
        )


def _columns(
    trials: Whole, variances: Sequence[Array], motions: Motions | None
) -> tuple[list[Array], Motions | None]:
    """Return variances and motions of some of the trials."""
    of_motions = motions and [
        [x if np.ndim(x) == 0 else np.asarray(x)[:, trials] for x in y] for y in motions
    ]
    return [variance[:, trials] for variance in variances], of_motions


def optional_column(table: pd.DataFrame, name: str) -> Array:
    """Return an optional column, or NaN if the table lacks it."""
    if name not in table:
        return np.full(len(table), np.nan)
    return table[name].to_numpy(dtype=np.float64, copy=True)
