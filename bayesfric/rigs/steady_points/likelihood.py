"""Likelihood of steady points: readings of friction, one grouped normal.

Point j on assembly i reads

    F = f (1 + η_i + ε_ij) + noise,

f being the law's friction and that of effects, η and ε normal, and the noise normal with the
standard error that was recorded or, where there is none, σ_F. Where no two points share an
assembly there is no η.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.effects.terms import ActiveEffect, parameters_of, rough_values, total
from bayesfric.inference.priors import Parameter
from bayesfric.observation.coefficients import SizeIndex, coefficient_parameters
from bayesfric.observation.exact import ExactModel, Shown
from bayesfric.observation.scatter import ScatterLevels
from bayesfric.physics.laws import FrictionLaw
from bayesfric.rigs.base import CONDITION
from bayesfric.rigs.steady_points.bench import Bench
from bayesfric.rigs.steady_points.errors import OMEGA, SIGMA, TAU, error_prior, known_errors
from bayesfric.rigs.steady_points.places import state_of


class PointsModel(ExactModel):
    """Readings of friction given the law; see :class:`bayesfric.observation.exact.ExactModel`.

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
        self._size = SizeIndex.of(self.trials["pulley_size"])
        self._without = frozenset(baseline.without) | bench.coefficients_without()
        self._known_sd = known_errors(bench)
        self._reading = self.trials["friction_n"].to_numpy(dtype=np.float64)
        priors = analysis.priors
        sizes, unit = self._size.sizes, bench.force_unit
        self.coefficients = coefficient_parameters(sizes, analysis, self._without, unit)
        levels = 2 if bench.shared else 1
        self.scatter = ScatterLevels(
            (TAU, OMEGA)[:levels], (priors.tau, priors.omega)[:levels], self._size
        )
        self.further = (
            *(
                [Parameter(SIGMA, unit, error_prior(bench, priors), "noise")]
                if np.isnan(self._known_sd).any()
                else []
            ),
            *(parameter for active in self._effects for parameter in parameters_of(active)),
        )

    def law(self, theta: Mapping[str, Array]) -> Array:
        """Return the friction of each point by the law and the effects, (W, N) [N]."""
        law = self._size.coefficients(theta)
        n, wrap, tension = (self.trials[name].to_numpy(dtype=np.float64) for name in CONDITION)
        friction = self._friction(law, n, wrap, tension)
        if self._effects:
            friction = friction + total(self._effects, theta, state_of(self._bench, law))
        return np.asarray(friction, dtype=np.float64)

    def shown(self, theta: Mapping[str, Array]) -> Shown:
        """Return the readings: each shows its friction itself."""
        law = self.law(theta)
        error = np.broadcast_to(self._error(theta), law.shape)
        return Shown(self._reading - law, error**2, law)

    def _error(self, theta: Mapping[str, Array]) -> Array:
        """Return the standard error of each reading, broadcastable to (W, N) [N]."""
        if SIGMA not in theta:
            return self._known_sd[None]
        return np.where(np.isnan(self._known_sd), theta[SIGMA][:, None], self._known_sd)

    def read(self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator) -> Array:
        """Draw readings of friction that deviates so from the law, (…, W, N) [N]."""
        noise = self._error(theta) * rng.standard_normal(deviation.shape)
        return np.asarray(self.law(theta) * (1 + deviation) + noise)

    def start(self) -> dict[str, float]:
        """Return rough estimates by least squares, a place to climb from."""
        n, wrap, tension = (self.trials[name].to_numpy(dtype=np.float64) for name in CONDITION)
        reading, without = self._reading, self._without
        rough = self._size.rough_coefficients(n, wrap, tension, reading, without)
        rms = float(np.sqrt((self._reading**2).mean()))
        return rough | {SIGMA: 0.01 * rms} | rough_values(self._effects)
