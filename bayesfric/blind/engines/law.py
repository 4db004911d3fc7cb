"""The law of the paper as this engine takes it: pulley by pulley.

A pulley's friction is (c1 + c3(θ − 85°)) T + c2 [Miyasaka et al., IROS 2015, eq. (16)],
where T is the tension of the cable that runs onto it, so the lower of the two.
"""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from bayesfric.blind.engines.state import Array

GRAVITY = 9.80665
SIZES = ("small", "medium", "large")
TABLE_I = np.array(
    [[0.0128, 0.0261, 2.79e-5], [0.00416, 0.0165, 1.02e-5], [0.00239, 0.0129, 0.737e-5]]
)
RADII_M = np.array([3.80e-3, 7.82e-3, 11.45e-3])
TYPICAL = {  # scatter and noise, as in Nature
    "tau": 0.01,
    "omega": 0.015,
    "tau_motor": 0.01,
    "omega_motor": 0.015,
    "sigma_x": 3e-5,
    "sigma_t": 2e-5,
    "sigma_current": 0.002,
    "load_noise": 0.005,
}
SPREAD = 0.15  # sd of a true value around Table I; ± 30 % is two of them, and never passed


@dataclass(frozen=True)
class Nature:
    """What is true in a case.

    Parameters
    ----------
    coefficients : ndarray, shape (3, 3)
        c1 [1], c2 [N], c3 [1/deg] of each size.
    tau, omega, tau_motor, omega_motor : float
        Relative scatter of friction by trial and setup, by run and motor setup.
    sigma_x, sigma_t : float
        Noise of a magnet's place [m] and of a time [s].
    sigma_current, load_noise : float
        Noise of a current [A], and as a share of the current of the load.
    idle : ndarray, shape (3,)
        Idle current in powers of speed [A, A s/m, A s²/m²].
    """

    coefficients: Array
    tau: float
    omega: float
    tau_motor: float
    omega_motor: float
    sigma_x: float
    sigma_t: float
    sigma_current: float
    load_noise: float
    idle: Array


def _around(rng: Generator, values: Array | float) -> Array:
    factor = 1 + np.clip(SPREAD * rng.standard_normal(np.shape(values)), -0.3, 0.3)
    return np.asarray(values * factor)


def draw_nature(rng: Generator) -> Nature:
    """Draw what is true, within 30 % of Table I and of typical scatter and noise."""
    return Nature(
        _around(rng, TABLE_I),
        **{name: float(_around(rng, value)) for name, value in TYPICAL.items()},
        idle=_around(rng, np.array([0.05, 0.012, 0.001])),
    )
