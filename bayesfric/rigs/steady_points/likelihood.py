"""Likelihood of steady points: readings of friction, one grouped normal.

Point j on assembly i reads

    F = f (1 + η_i + ε_ij) + noise,

f being the law's friction and that of effects, η and ε normal, and the noise normal with the
standard error that was recorded or, where there is none, σ_F. Where no two points share an
assembly there is no η.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.effects.terms import ActiveEffect, parameters_of, rough_values, total
from bayesfric.inference.grouped_normal import GroupedNormal, Groups
from bayesfric.inference.priors import Parameter
from bayesfric.physics.laws import FrictionLaw
from bayesfric.rigs.coefficients import SizeIndex, coefficient_parameters
from bayesfric.rigs.grouped import GroupedLikelihood
from bayesfric.rigs.steady_points.bench import Bench
from bayesfric.rigs.steady_points.errors import OMEGA, SIGMA, TAU, error_prior, known_errors
from bayesfric.rigs.steady_points.places import CONDITION, state_of

__all__ = ["PointsLikelihood"]


class PointsLikelihood(GroupedLikelihood):
    """The density of all readings, given coefficients, scatter and noise.

    Parameters
    ----------
    bench : Bench
        N points.
    analysis : Analysis
        Priors.
    baseline : FrictionLaw
        The friction law.
    effects : sequence of ActiveEffect
        What acts beside the law, all of it supported.

    Attributes
    ----------
    parameters : tuple of Parameter
        What the likelihood depends on.
    trials : DataFrame
        The points in the order of every result.
    setups, sizes : tuple of str
        Assemblies and pulley sizes.
    """

    def __init__(
        self,
        bench: Bench,
        analysis: Analysis,
        baseline: FrictionLaw,
        effects: Sequence[ActiveEffect] = (),
    ) -> None:
        self._bench, self._effects = bench, tuple(effects)
        self._friction = baseline.at_tension
        self.trials = bench.table
        codes, setups = pd.factorize(self.trials["setup"])
        self.setups = tuple(str(setup) for setup in setups)
        self._groups = Groups(np.flatnonzero(np.diff(codes, prepend=-1)), codes.size)
        self._size = SizeIndex.of(self.trials["pulley_size"])
        self.sizes = self._size.sizes
        self._without = frozenset(baseline.without) | bench.coefficients_without()
        self._known_sd = known_errors(bench)
        self._reading = self.trials["friction_n"].to_numpy(dtype=np.float64)
        priors = analysis.priors
        self.parameters = (
            *coefficient_parameters(self.sizes, analysis, self._without, bench.force_unit),
            Parameter(TAU, "1", priors.tau, "scatter", power=0.5),
            *([Parameter(OMEGA, "1", priors.omega, "scatter", power=0.5)] if bench.shared else []),
            *(
                [Parameter(SIGMA, bench.force_unit, error_prior(bench, priors), "noise")]
                if np.isnan(self._known_sd).any()
                else []
            ),
            *(parameter for one in self._effects for parameter in parameters_of(one)),
        )

    def law(self, theta: Mapping[str, Array]) -> Array:
        """Return the friction of each point by the law and the effects, (W, N) [N]."""
        law = self._size.coefficients(theta)
        n, wrap, tension = (self.trials[name].to_numpy(dtype=np.float64) for name in CONDITION)
        friction = self._friction(law, n, wrap, tension)
        if self._effects:
            friction = friction + total(self._effects, theta, state_of(self._bench, law))
        return np.asarray(friction, dtype=np.float64)

    def normal(self, theta: Mapping[str, Array]) -> GroupedNormal:
        """Return the normal of W sets of parameters."""
        law = self.law(theta)
        variance = (theta[TAU][:, None] * law) ** 2 + self._error(theta) ** 2
        shared = theta[OMEGA][:, None] * law if self._bench.shared else np.zeros_like(law)
        return GroupedNormal(self._groups, self._reading - law, variance, shared[None])

    def _error(self, theta: Mapping[str, Array]) -> Array:
        """Return the standard error of each reading, broadcastable to (W, N) [N]."""
        if SIGMA not in theta:
            return self._known_sd[None]
        return np.where(np.isnan(self._known_sd), theta[SIGMA][:, None], self._known_sd)

    def draw_scatter(
        self, theta: Mapping[str, Array], rng: np.random.Generator, *, together: bool = False
    ) -> Array:
        """Draw η + ε of new points, each on a new assembly or all on new ones, (W, N)."""
        count, points = len(theta[TAU]), len(self.trials)
        own = theta[TAU][:, None] * rng.standard_normal((count, points))
        if not self._bench.shared:
            return own
        eta = rng.standard_normal((count, len(self.setups) if together else points))
        eta = eta[:, self._groups.of_each] if together else eta
        return np.asarray(theta[OMEGA][:, None] * eta + own)

    def draw_observed(
        self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator
    ) -> Array:
        """Draw readings of friction that deviates so from the law, (…, W, N) [N]."""
        noise = self._error(theta) * rng.standard_normal(deviation.shape)
        return np.asarray(self.law(theta) * (1 + deviation) + noise)

    def start(self) -> dict[str, float]:
        """Return rough estimates by least squares, a place to climb from."""
        n, wrap, tension = (self.trials[name].to_numpy(dtype=np.float64) for name in CONDITION)
        reading, without = self._reading, self._without
        rough = self._size.rough_coefficients(n, wrap, tension, reading, without)
        rms = float(np.sqrt((self._reading**2).mean()))
        noise = {TAU: 0.02, OMEGA: 0.02, SIGMA: 0.01 * rms}
        return rough | noise | rough_values(self._effects)
