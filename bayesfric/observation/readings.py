"""Both engines for rigs that measure friction itself, with one reading in each trial.

Reading j of assembly i is

    F = f (1 + η_i + ε_ij) + noise,

where f is the friction of the law and of effects, η and ε are normal, and the noise is normal with
the recorded standard error or, if there is none, with σ_F. If no two trials share an assembly,
there is no η.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import pandas as pd

from bayesfric.analysis import Analysis, HalfNormal, Prior, Priors
from bayesfric.arrays import Array
from bayesfric.effects import State
from bayesfric.effects.terms import ActiveEffect, parameters_of, rough_values, total
from bayesfric.inference.priors import Parameter
from bayesfric.observation.coefficients import (
    SizeIndex,
    coefficient_parameters,
    law_of_rows,
)
from bayesfric.observation.exact import ExactModel, Shown
from bayesfric.observation.linear import NoiseParameter, noise_parameter
from bayesfric.observation.points import LinearReadings
from bayesfric.observation.scatter import ScatterLevels
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import FrictionLaw

CONDITION = ("n_pulleys", "wrap_angle_deg", "tension_n")
SIGMA = "sigma_friction"
SCATTER = (1e-4, 1.0)  # range of the search for relative scatter
NEVER = HalfNormal(scale=2e-4)  # prior of the shared scatter if no trials share an assembly
SHARE = 0.05  # prior scale of an unstated error, relative to the machine's friction


@dataclass(frozen=True)
class Readings:
    """N readings of friction.

    Parameters
    ----------
    name : str
        Name of the rig; names of its scatter end with it.
    table : DataFrame
        One row for each trial: ``trial``, ``setup``, ``pulley_size``, ``n_pulleys``,
        ``wrap_angle_deg``, ``tension_n`` and ``friction_n`` [N]. Rows of an assembly are
        adjacent.
    loads : tuple of str
        Columns that define a condition, together with size, number and wrap angle.
    law : FrictionLaw
        The friction law.
    where : callable
        Function of the coefficients of each trial, shape (…, N), that returns their states.
    known_sd : ndarray, shape (N,)
        Stated standard error of each reading; NaN if there is none [N].
    friction_scale : float
        Size of the machine's friction, from which the prior of unstated errors follows [N].
    without : frozenset of str
        Coefficients that are not defined, such as the slope if no load was recorded.
    shared : bool
        Whether trials share assemblies.
    unit : str
        Unit of friction.
    further : mapping of str to ndarray, shape (N,)
        Covariates of this recording with smooth forces along them.
    """

    name: str
    table: pd.DataFrame
    loads: tuple[str, ...]
    law: FrictionLaw
    where: Callable[[Coefficients], State]
    known_sd: Array
    friction_scale: float
    without: frozenset[str] = frozenset()
    shared: bool = True
    unit: str = "N"
    further: Mapping[str, Array] = field(default_factory=dict)

    @cached_property
    def condition(self) -> tuple[Array, Array, Array]:
        """Number of pulleys, wrap angle [deg] and tension [N], shape (N,) each."""
        n, wrap, tension = (self.table[name].to_numpy(dtype=np.float64) for name in CONDITION)
        return n, wrap, tension

    @cached_property
    def friction_n(self) -> Array:
        """Measured friction, shape (N,) [N]."""
        return self.table["friction_n"].to_numpy(dtype=np.float64)

    @property
    def scatter_names(self) -> tuple[str, str]:
        """Names of the scatter of a trial and of an assembly."""
        return f"tau_{self.name}", f"omega_{self.name}"

    def mean(self, law: Coefficients) -> Array:
        """Return friction by the law alone, in the shape of its coefficients [N]."""
        return np.asarray(self.law.at_tension(law, *self.condition), dtype=np.float64)

    def error_prior(self, priors: Priors) -> Prior:
        """Return the prior of the error of readings without a stated one."""
        return priors.sigma_friction or HalfNormal(scale=SHARE * self.friction_scale)

    def linear(self, laws: Mapping[str, Coefficients]) -> LinearReadings:
        """Return the readings, linearised around a reference law of each pulley size."""
        law, ones = law_of_rows(laws, self.table["pulley_size"]), np.ones(len(self.table))
        friction = self.mean(law)
        return LinearReadings(
            name=self.name,
            table=self.table,
            loads=self.loads,
            state=self.where(law),
            friction_n=friction,
            feedback=ones,
            reading=self.friction_n - friction,
            per_newton=ones,
            errors=(np.where(np.isnan(self.known_sd), 1.0, 0.0),),
            noise=self._noise,
            curve=np.zeros((ones.size, 0)),
            still_curve=np.zeros((0, 0)),
            still=np.zeros(0),
            known_error=np.nan_to_num(self.known_sd),
            further=self.further,
            lacks=self.without,
        )

    def _noise(self, priors: Priors) -> tuple[NoiseParameter, ...]:
        """Return the scatter of a trial, of a load and of an assembly, and the error."""
        (tau, omega), load = self.scatter_names, f"load_{self.name}"
        shared, good = priors.omega if self.shared else NEVER, 0.1 * SHARE * self.friction_scale
        usual, bounds = 0.015 if self.shared else 0.001, (1e-3 * good, 1e3 * good)
        return (
            noise_parameter(tau, priors.tau, 0.012, SCATTER, 0.01, scatters=True),
            noise_parameter(load, shared, 0.001, SCATTER, 0.001, scatters=True),
            noise_parameter(omega, shared, 0.001, SCATTER, usual, scatters=True),
            noise_parameter(SIGMA, self.error_prior(priors), good, bounds, good),
        )


class ReadingsModel(ExactModel):
    """Readings of friction given the law; see :class:`bayesfric.observation.exact.ExactModel`.

    Parameters
    ----------
    readings : Readings
        N readings.
    analysis : Analysis
        Priors.
    effects : sequence of ActiveEffect
        Acting effects, all supported by the rig.
    """

    def __init__(
        self, readings: Readings, analysis: Analysis, effects: Sequence[ActiveEffect] = ()
    ) -> None:
        self._readings, self._effects, priors = readings, tuple(effects), analysis.priors
        self.trials = readings.table
        self._size = SizeIndex.of(self.trials["pulley_size"])
        self._without = frozenset(readings.law.without) | readings.without
        self.coefficients = coefficient_parameters(
            self._size.sizes, analysis, self._without, readings.unit
        )
        levels = 2 if readings.shared else 1
        self.scatter = ScatterLevels(
            readings.scatter_names[:levels], (priors.tau, priors.omega)[:levels], self._size
        )
        self.further = tuple(
            parameter for active in self._effects for parameter in parameters_of(active)
        )
        if np.isnan(readings.known_sd).any():
            error = Parameter(SIGMA, readings.unit, readings.error_prior(priors), "noise")
            self.further = (error, *self.further)

    def law(self, theta: Mapping[str, Array]) -> Array:
        """Return the friction of each trial by the law and the effects, (W, N) [N]."""
        law = self._size.coefficients(theta)
        friction = self._readings.mean(law)
        if self._effects:
            friction = friction + total(self._effects, theta, self._readings.where(law))
        return friction

    def shown(self, theta: Mapping[str, Array]) -> Shown:
        """Return the readings as measures of friction."""
        law = self.law(theta)
        error = np.broadcast_to(self._error(theta), law.shape)
        return Shown(self._readings.friction_n - law, error**2, law)

    def _error(self, theta: Mapping[str, Array]) -> Array:
        """Return the standard error of each reading, broadcastable to (W, N) [N]."""
        known_sd = self._readings.known_sd
        if SIGMA not in theta:
            return known_sd[None]
        return np.where(np.isnan(known_sd), theta[SIGMA][:, None], known_sd)

    def read(self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator) -> Array:
        """Draw readings, given relative deviations of friction from the law, (…, W, N) [N]."""
        noise = self._error(theta) * rng.standard_normal(deviation.shape)
        return np.asarray(self.law(theta) * (1 + deviation) + noise)

    def start(self) -> dict[str, float]:
        """Return starting values by least squares."""
        reading = self._readings.friction_n
        rough = self._size.rough_coefficients(*self._readings.condition, reading, self._without)
        rms = float(np.sqrt((reading**2).mean()))
        return rough | {SIGMA: 0.01 * rms} | rough_values(self._effects)
