"""Scatter and errors of steady points: their names, and what is known of them beforehand."""

import numpy as np

from bayesfric.analysis import HalfNormal, Prior, Priors
from bayesfric.arrays import Array
from bayesfric.rigs.steady_points.bench import Bench
from bayesfric.rigs.steady_points.scale import Scale

NAME = "steady-points"
TAU, OMEGA, SIGMA = f"tau_{NAME}", f"omega_{NAME}", "sigma_friction"
SHARE = 0.05  # of the machine's friction, the scale of an error that nobody states


def error_prior(bench: Bench, priors: Priors) -> Prior:
    """Return the prior of the error of a reading without one."""
    return priors.sigma_friction or HalfNormal(scale=SHARE * _friction(bench))


def rough_error(bench: Bench) -> float:
    """Return the error of a reading of a good machine [N]."""
    return 0.1 * SHARE * _friction(bench)


def known_errors(bench: Bench) -> Array:
    """Return the standard error of each reading, NaN where nobody states it, (N,) [N]."""
    if "friction_sd_n" not in bench.given:
        return np.full(len(bench.table), np.nan)
    return bench.table["friction_sd_n"].to_numpy(dtype=np.float64)


def _friction(bench: Bench) -> float:
    return bench.scale.force * Scale.paper_force_n * float(bench.table["n_pulleys"].mean())
