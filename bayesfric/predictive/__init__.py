"""What a fit predicts, laid out for the figures: curves, bands and trials.

Figures draw from these arrays and compute nothing.
"""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bayesfric.analysis import Analysis
from bayesfric.baseline import Baseline
from bayesfric.likelihood.gravity import GravityLikelihood
from bayesfric.likelihood.model import Model, RigLikelihood
from bayesfric.likelihood.motor import MotorLikelihood
from bayesfric.likelihood.screening import Screened
from bayesfric.predictive.bands import QUANTILES
from bayesfric.predictive.gravity import curves, trials
from bayesfric.predictive.motor import runs
from bayesfric.predictive.parameters import coefficients, densities, ranks
from bayesfric.predictive.slopes import paper_slopes
from bayesfric.predictive.trajectories import trajectories
from bayesfric.recording.tables import Recording

__all__ = ["QUANTILES", "predict"]

Array = NDArray[np.float64]
DRAWS = 1000  # enough for a 5 % quantile to a twentieth of an sd


def predict(
    recording: Recording,
    screened: Screened | None,
    likelihoods: Mapping[str, RigLikelihood],
    model: Model,
    theta: Array,
    analysis: Analysis,
    baseline: Baseline,
) -> xr.DataTree:
    """Compute predictions from draws.

    Parameters
    ----------
    recording : Recording
        As read.
    screened : Screened or None
        The gravity trials that entered; None where that board did not.
    likelihoods : mapping of str to RigLikelihood
        Of the fit, by rig.
    model : Model
        Of the fit.
    theta : ndarray, shape (ensembles, draws, walkers, D)
        Posterior draws in the parameters' units.
    analysis : Analysis
        For the seed and the form of the scatter.
    baseline : Baseline
        The friction law of the fit.

    Returns
    -------
    DataTree
        ``coefficients``: quantiles, and their ratio to Table I for its sizes.
        ``densities``: of each parameter, prior and posterior.
        ``ranks``: how the draws of each ensemble rank among all.
        Of the gravity board, ``trials``: friction observed, and predicted for a new
        trial on a new assembly, with z and coverage; ``curves``: friction against tension
        at each (size, n, θ) cell, of the law and of Table I; ``tension_lines`` and
        ``wrap_lines``: the paper's slopes; ``trajectories``: a few trials, measured and
        predicted from their first speed alone. Of the motor board, ``runs``: friction
        observed, and predicted for a new run on a new assembly, with z and coverage.
    """
    rng = np.random.default_rng(np.random.SeedSequence([analysis.seed, 1]))
    checks = np.random.default_rng(np.random.SeedSequence([analysis.seed, 2]))
    flat = theta.reshape(-1, theta.shape[-1])
    some = flat[np.linspace(0, len(flat) - 1, min(DRAWS, len(flat))).astype(int)]
    named = model.by_name(some)
    groups = {
        "coefficients": coefficients(model, flat),
        "densities": densities(model, flat),
        "ranks": ranks(model, theta),
    }
    for likelihood in likelihoods.values():
        factor = 1 + likelihood.draw_scatter(named, rng)
        if isinstance(likelihood, GravityLikelihood) and screened is not None:
            assert recording.gravity is not None
            recorded = recording.gravity.trials
            groups["trials"] = trials(likelihood, recorded, named, factor, checks)
            groups["curves"] = curves(likelihood, named, baseline)
            groups |= paper_slopes(
                likelihood, screened.gravity, recording.rig, named, baseline, checks
            )
            groups["trajectories"] = trajectories(
                likelihood, screened.gravity, recording.rig, named, factor, baseline
            )
        elif isinstance(likelihood, MotorLikelihood):
            assert recording.motor is not None
            groups["runs"] = runs(likelihood, recording.motor.runs, named, factor, checks)
    return xr.DataTree.from_dict(groups)
