"""The noise of all rigs: scatter of friction, errors of events and of currents."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from bayesfric.analysis import Prior
from bayesfric.arrays import Array
from bayesfric.observation.linear import NoiseParameter, log_prior_of_logarithm

QUIET = 0.015  # relative scatter of a good rig
STEP = 1e-5  # of a logarithm, for derivatives


class Noise(tuple[NoiseParameter, ...]):
    """Parameters of the noise of all rigs, which are met as their logarithms."""

    @property
    def start(self) -> Array:
        """Rough logarithms, a place to climb from."""
        return np.log([parameter.start for parameter in self])

    def quiet(self, psi: Array) -> Array:
        """Return a noise whose friction scatters no more than on a good rig."""
        quieter = psi.copy()
        for place, parameter in enumerate(self):
            if parameter.scatters:
                quieter[place] = min(quieter[place], np.log(QUIET / 2))
        return quieter

    def named(self, psi: Array) -> dict[str, float]:
        """Return the noise by name; amplitudes behind it are left out."""
        values = np.exp(psi[: len(self)])
        return {parameter.name: float(value) for parameter, value in zip(self, values, strict=True)}

    def log_prior(self, psi: Array, amplitudes: Sequence[Prior]) -> tuple[float, Array]:
        """Return the log prior density of logarithms, and its gradient.

        Parameters
        ----------
        psi : ndarray
            Of the noise, then of amplitudes that are above zero.
        amplitudes : sequence of Prior
            Of these amplitudes.
        """
        densities = [parameter.log_prior for parameter in self]
        densities += [partial(log_prior_of_logarithm, prior) for prior in amplitudes]
        ends = np.exp(psi[:, None] + [0.0, STEP])
        values = np.array([density(pair) for density, pair in zip(densities, ends, strict=True)])
        values = values.reshape(-1, 2)  # of no parameters too
        return float(values[:, 0].sum()), (values[:, 1] - values[:, 0]) / STEP
