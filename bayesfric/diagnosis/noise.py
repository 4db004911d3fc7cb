"""The noise of all rigs: scatter of friction, errors of events and of currents."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from bayesfric.analysis import Prior
from bayesfric.arrays import Array
from bayesfric.observation.linear import NoiseParameter, log_prior_of_logarithm

QUIET = 0.015  # relative scatter of a good rig
STEP = 1e-5  # of a log noise parameter, for derivatives


class Noise(tuple[NoiseParameter, ...]):
    """Noise parameters of all rigs; functions take and return their logarithms."""

    @property
    def start(self) -> Array:
        """Logarithms from which a climb starts."""
        return np.log([parameter.start for parameter in self])

    def quiet(self, psi: Array) -> Array:
        """Return noise parameters with at most the scatter of friction on a good rig."""
        quieter = psi.copy()
        for place, parameter in enumerate(self):
            if parameter.scatters:
                quieter[place] = min(quieter[place], np.log(QUIET / 2))
        return quieter

    def named(self, psi: Array) -> dict[str, float]:
        """Return noise parameters by name; amplitudes that follow them are omitted."""
        values = np.exp(psi[: len(self)])
        return {parameter.name: float(value) for parameter, value in zip(self, values, strict=True)}

    def log_prior(self, psi: Array, amplitudes: Sequence[Prior]) -> tuple[float, Array]:
        """Return the log prior density of logarithms, and its gradient.

        Parameters
        ----------
        psi : ndarray
            Logarithms of the noise parameters, then of positive amplitudes.
        amplitudes : sequence of Prior
            Priors of these amplitudes.
        """
        densities = [parameter.log_prior for parameter in self]
        densities += [partial(log_prior_of_logarithm, prior) for prior in amplitudes]
        ends = np.exp(psi[:, None] + [0.0, STEP])
        values = np.array([density(pair) for density, pair in zip(densities, ends, strict=True)])
        values = values.reshape(-1, 2)  # also if there are no parameters
        return float(values[:, 0].sum()), (values[:, 1] - values[:, 0]) / STEP
