"""The prior of what scatters, in logarithms, and where its mode is looked for."""

import numpy as np
from numpy.typing import NDArray

from bayesfric.analysis import Priors
from bayesfric.inference.priors import log_density
from bayesfric.rigs.gravity_board.linear import GravityNoise
from bayesfric.rigs.motor_board.linear import MotorNoise

__all__ = ["bounds", "log_prior"]

Array = NDArray[np.float64]
KAPPA_SD_LOG = 0.3  # of the events' variance over its first estimate
SMALLEST, LARGEST = 1e-4, 1.0  # scatter of friction that is looked at


def log_prior(
    priors: Priors, psi: Array, gravity: GravityNoise | None, motor: MotorNoise | None
) -> float:
    """Return the log prior density of the logarithms of the noise.

    Parameters
    ----------
    priors : Priors
        Of scatter and noise.
    psi : ndarray
        The logarithms, those of the gravity board first.
    gravity : GravityNoise or None
    motor : MotorNoise or None
        Their exponentials.
    """
    total = float(psi.sum())  # a density of logarithms
    if gravity is not None:
        total += float(log_density(priors.tau, gravity.tau))
        total += float(log_density(priors.omega, gravity.omega))
        deviation = np.log(gravity.kappa) / KAPPA_SD_LOG
        total -= np.log(gravity.kappa) + 0.5 * deviation**2
    if motor is not None:
        total += float(log_density(priors.tau_motor, motor.tau))
        total += float(log_density(priors.omega_motor, motor.omega))
        total += float(log_density(priors.sigma_current, motor.sigma_a))
        total += float(log_density(priors.load_noise, motor.load))
    return total


def bounds(gravity: bool, motor: bool) -> list[tuple[float, float]]:
    """Return the lowest and highest logarithm of each noise of the boards that are there."""
    scatter = (np.log(SMALLEST), np.log(LARGEST))
    found: list[tuple[float, float]] = []
    if gravity:
        found += [scatter, scatter, (np.log(0.05), np.log(1e4))]
    if motor:
        found += [scatter, scatter, (np.log(1e-5), 0.0), (np.log(1e-4), np.log(0.5))]
    return found
