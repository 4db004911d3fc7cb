"""Steady points in the linear model: one reading a point."""

from collections.abc import Mapping

import numpy as np

from bayesfric.analysis import HalfNormal, Priors
from bayesfric.observation.linear import NoiseParameter, noise_parameter
from bayesfric.observation.points import LinearReadings
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import FrictionLaw
from bayesfric.rigs.base import CONDITION
from bayesfric.rigs.steady_points.bench import Bench
from bayesfric.rigs.steady_points.errors import (
    NAME,
    OMEGA,
    SIGMA,
    TAU,
    error_prior,
    known_errors,
    rough_error,
)
from bayesfric.rigs.steady_points.places import DIRECTION, covariates_of, state_of

SCATTER = (1e-4, 1.0)  # looked at
NEVER = HalfNormal(scale=2e-4)  # of what points would share, where none share anything


def points_rows(
    bench: Bench, loads: tuple[str, ...], law: FrictionLaw, laws: Mapping[str, Coefficients]
) -> LinearReadings:
    """Return the points around a reference law.

    Parameters
    ----------
    bench : Bench
        N points.
    loads : tuple of str
        Columns that make a condition, with size, number and wrap angle.
    law : FrictionLaw
        The friction law.
    laws : mapping of str to Coefficients
        Coefficients of each pulley size.
    """
    table = bench.table
    by_trial = zip(*(laws[size] for size in table["pulley_size"]), strict=True)
    coefficients = Coefficients(*(np.array(values) for values in by_trial))
    state = state_of(bench, coefficients)
    friction = law.at_tension(coefficients, *(table[name].to_numpy(float) for name in CONDITION))
    known_sd, ones = known_errors(bench), np.ones(len(table))
    unit = rough_error(bench)

    def noise(priors: Priors) -> tuple[NoiseParameter, ...]:
        shared = priors.omega if bench.shared else NEVER
        own = noise_parameter(TAU, priors.tau, 0.012, SCATTER, 0.01, scatters=True)
        load = noise_parameter(f"load_{NAME}", shared, 0.001, SCATTER, 0.001, scatters=True)
        usual = 0.015 if bench.shared else 0.001
        setup = noise_parameter(OMEGA, shared, 0.001, SCATTER, usual, scatters=True)
        bounds = (1e-3 * unit, 1e3 * unit)
        error = noise_parameter(SIGMA, error_prior(bench, priors), unit, bounds, unit)
        return own, load, setup, error

    return LinearReadings(
        name=NAME,
        table=table,
        loads=loads,
        state=state,
        friction_n=friction,
        feedback=ones,
        reading=table["friction_n"].to_numpy(dtype=np.float64) - friction,
        per_newton=ones,
        errors=(np.where(np.isnan(known_sd), 1.0, 0.0),),
        noise=noise,
        curve=np.zeros((len(table), 0)),
        still_curve=np.zeros((0, 0)),
        still=np.zeros(0),
        known_error=np.nan_to_num(known_sd),
        # Two directions leave a smooth force nothing that an effect of them does not say.
        further={name: at for name, at in covariates_of(bench).items() if name != DIRECTION},
        lacks=bench.coefficients_without(),
    )
