"""What a trial of the gravity board measured: Hall events, or an acceleration alone.

Either is a normal density of the trial's acceleration, times factors that the
friction law does not touch. Events win where both are there.
"""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.analysis import Analysis
from bayesfric.likelihood.hall_events import TrialAcceleration, reduce_events
from bayesfric.priors import Parameter
from bayesfric.recording.tables import Gravity, Rig

__all__ = ["TrialMeasurements"]

Array = NDArray[np.float64]
START_SIGMA_A = 0.01  # m/s², a place to climb from


class TrialMeasurements:
    """The measurements of N trials as normal densities of their accelerations.

    Parameters
    ----------
    gravity : Gravity
        Trials and their events.
    rig : Rig
        The board.
    analysis : Analysis
        Priors of the noise.

    Attributes
    ----------
    parameters : tuple of Parameter
        Noise that these measurements have: sigma_x and sigma_t where there are
        events, sigma_a where an acceleration comes without its standard error.
    """

    def __init__(self, gravity: Gravity, rig: Rig, analysis: Analysis) -> None:
        trials, priors = gravity.trials, analysis.priors
        with_events = trials["trial"].isin(gravity.events["trial"]).to_numpy()
        self._by_events = np.flatnonzero(with_events)
        self._by_acceleration = np.flatnonzero(~with_events)
        self.parameters: tuple[Parameter, ...] = ()
        if self._by_events.size:
            assert rig.hall_spacing_m and rig.timer_resolution_s
            self._events = reduce_events(
                gravity.events,
                trials["trial"][with_events],
                spacing_m=rig.hall_spacing_m,
                tick_s=rig.timer_resolution_s,
                first_speed_scale=priors.first_speed.scale,
            )
            self.parameters += (
                Parameter("sigma_x", "m", priors.sigma_x),
                Parameter("sigma_t", "s", priors.sigma_t),
            )
        if self._by_acceleration.size:
            alone = trials.iloc[self._by_acceleration]
            self._acceleration = alone["acceleration_m_s2"].to_numpy(dtype=np.float64)
            self._stated_sd = _column(alone, "acceleration_sd_m_s2")
            if np.isnan(self._stated_sd).any():
                self.parameters += (Parameter("sigma_a", "m/s²", priors.sigma_a),)

    def at(self, theta: Mapping[str, Array]) -> TrialAcceleration:
        """Evaluate the measurements at the noise of each walker.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.

        Returns
        -------
        TrialAcceleration
            Arrays of shape (W, N).
        """
        if not self._by_acceleration.size:
            return self._events.at(theta["sigma_x"], theta["sigma_t"])
        walkers = max((len(values) for values in theta.values()), default=1)
        shape = (walkers, self._by_events.size + self._by_acceleration.size)
        mean, variance, constant = np.empty(shape), np.empty(shape), np.zeros(shape)
        if self._by_events.size:
            found = self._events.at(theta["sigma_x"], theta["sigma_t"])
            mean[:, self._by_events] = found.mean
            variance[:, self._by_events] = found.variance
            constant[:, self._by_events] = found.log_constant
        mean[:, self._by_acceleration] = self._acceleration
        unknown = theta["sigma_a"][:, None] if "sigma_a" in theta else np.nan
        stated = np.isfinite(self._stated_sd)
        variance[:, self._by_acceleration] = np.where(stated, self._stated_sd, unknown) ** 2
        return TrialAcceleration(mean, variance, constant)

    def start(self) -> dict[str, float]:
        """Return rough estimates of the noise."""
        scale = self._events.pilot_scale if self._by_events.size else 0.0
        rough = {"sigma_x": scale, "sigma_t": 0.1 * scale, "sigma_a": START_SIGMA_A}
        return {parameter.name: rough[parameter.name] for parameter in self.parameters}


def _column(table: pd.DataFrame, name: str) -> Array:
    """Return an optional column, NaN where it is absent."""
    if name not in table:
        return np.full(len(table), np.nan)
    return table[name].to_numpy(dtype=np.float64)
