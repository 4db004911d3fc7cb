"""The true gap of a case: without noise, after the baseline is refitted.

The same case is made without noise, scatter and background, and the baseline is fitted
to it with the weights of a usual noise. The residual is then systematic, and so is the part
of it that the named causes leave.
"""

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.linear_model import Acting, LinearModel
from bayesfric.diagnosis.reference import fitted_laws
from bayesfric.diagnosis.residuals import Residuals, fitted, residuals_of
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import Candidate, candidates_of
from bayesfric.recording.tables import Recording
from bayesfric.rigs import all_rigs
from bayesfric.rigs.data import Data
from bayesfric.simulate import table1_coefficients

__all__ = ["CleanCase"]

Array = NDArray[np.float64]
GRAVITY_SCATTER = (0.01, 0.015)  # of a trial and an assembly
EVENT_SD_M = 30e-6
MOTOR_NOISE = (0.01, 0.015, 0.002, 0.005)  # likewise; of a current [A], and per load
FALSE_ALARMS = 0.02  # of the oracle, as many as are promised of the diagnosis
ROUNDS = 2  # of fitting the law and linearising around it


class CleanCase:
    """A recording without noise, and the baseline that was fitted to it.

    Parameters
    ----------
    recording : Recording
        Without noise, of the paper's pulley sizes.
    analysis : Analysis
        Priors.

    Attributes
    ----------
    gap : float
        Rms of the residual friction over rms friction, equal weight a condition.
    """

    def __init__(self, recording: Recording, analysis: Analysis) -> None:
        opened = (rig.trials(recording, exclude=False) for rig in all_rigs().values())
        data = Data(tuple(one for one in opened if one is not None))
        laws = {size: table1_coefficients()[size] for size in data.sizes}
        share = analysis.diagnosis.practical_share
        model = LinearModel(data, laws, (), analysis, share, discrepancy=False)
        self._psi = _usual_noise(model)
        for _ in range(ROUNDS - 1):
            laws = fitted_laws(model, self._psi, Acting())
            model = model.around(laws, (), discrepancy=False)
        self._model = model
        residuals = residuals_of(model, self._psi)
        self._friction = float(np.sqrt((residuals.weight * residuals.friction_n**2).sum()))
        self.gap = self._left(model, residuals, Acting()) / self._friction

    def shrink(self, causes: Sequence[tuple[str, str]]) -> float | None:
        """Return which part of the squared gap some causes take up.

        Parameters
        ----------
        causes : sequence of (str, str)
            Name and law of each; its shape is the one of the usual nodes that fits best.

        Returns
        -------
        float or None
            None where a cause has phases that nobody records, or is no effect of ours.
        """
        known = all_effects()
        if not causes or self.gap <= 0.0:
            return None
        if any(name not in known or known[name].components for name, _ in causes):
            return None
        each = [[c for c in candidates_of(known[name]) if c.law == law] for name, law in causes]
        every: list[Candidate] = [candidate for own in each for candidate in own]
        model = self._model.around(self._model.laws, every, discrepancy=False)
        residuals = residuals_of(model, self._psi)
        places, start = [], 0
        for own in each:
            places.append(range(start, start + len(own)))
            start += len(own)
        left = min(self._left(model, residuals, Acting(choice)) for choice in product(*places))
        return 1 - (left / self._friction / self.gap) ** 2

    def oracle_power(self) -> float:
        """Return the power of the best test that knows the force that is there.

        Neyman and Pearson: the likelihood ratio, at 2 % false alarms. Its signal-to-noise
        ratio is the norm of what the refitted baseline leaves, whitened by the measurement
        error and by the scatter of trials and of assemblies.
        """
        model, residuals = self._model, residuals_of(self._model, self._psi)
        rest = self._rest(model, residuals, Acting())
        # Events are stated for the noise that they have here, which is none.
        gravity, _ = model.noise(self._psi)
        trials = 0 if model.gravity is None else len(model.gravity.rows.trials)
        kappa = 1.0 if gravity is None else gravity.kappa
        tau, omega = residuals.scatter.T
        square = 0.0
        for setup in np.unique(residuals.setup):
            rows = np.flatnonzero(residuals.setup == setup)
            trial = residuals.trial[rows]
            same = trial[:, None] == trial
            friction = residuals.friction_n[rows]
            spread = np.outer(tau[rows], tau[rows]) * same + np.outer(omega[rows], omega[rows])
            covariance = spread * np.outer(friction, friction)
            for one in np.unique(trial):
                own = np.flatnonzero(trial == one)
                scale = kappa if one < trials else 1.0
                covariance[np.ix_(own, own)] += scale * residuals.covariance[one]
            square += float(rest[rows] @ np.linalg.solve(covariance, rest[rows]))
        return float(norm.cdf(np.sqrt(square) - norm.isf(FALSE_ALARMS)))

    def _rest(self, model: LinearModel, residuals: Residuals, acting: Acting) -> Array:
        numbers, _ = fitted(model, self._psi, acting)
        return residuals.left(model, numbers)

    def _left(self, model: LinearModel, residuals: Residuals, acting: Acting) -> float:
        rest = self._rest(model, residuals, acting)
        return float(np.sqrt((residuals.weight * rest**2).sum()))


def _usual_noise(model: LinearModel) -> Array:
    """Return the logarithms of a usual board's noise; these events have none of their own."""
    noise: list[float] = []
    if model.gravity is not None:
        first = float(np.median(model.gravity.rows.variance))
        noise += [*GRAVITY_SCATTER, EVENT_SD_M**2 / first]
    if model.motor is not None:
        noise += MOTOR_NOISE
    return np.log(noise)
