"""What a fit predicts, laid out for the figures: curves, bands and trials.

Figures draw from these arrays and compute nothing.
"""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bayesfric.analysis import Analysis
from bayesfric.fitting.predictive.coverage import CELL, MASSES, coverage
from bayesfric.fitting.predictive.left_out import LeftOut, uniformity
from bayesfric.fitting.predictive.parameters import coefficients, densities, ranks
from bayesfric.fitting.predictive.prior import PRIOR_DRAWS, friction_of_prior
from bayesfric.inference.model import Model, RigLikelihood
from bayesfric.physics.gravity import Condition
from bayesfric.physics.laws import Baseline
from bayesfric.recording.tables import Recording
from bayesfric.rigs import all_rigs
from bayesfric.rigs.bands import QUANTILES
from bayesfric.rigs.gravity_board.likelihood import GravityLikelihood
from bayesfric.rigs.gravity_board.predictions import curves, trials
from bayesfric.rigs.gravity_board.screening import Screened
from bayesfric.rigs.gravity_board.slopes import paper_slopes
from bayesfric.rigs.gravity_board.trajectories import trajectories
from bayesfric.rigs.motor_board.likelihood import MotorLikelihood
from bayesfric.rigs.motor_board.predictions import runs
from bayesfric.rigs.remaking import Remade, remake

__all__ = ["QUANTILES", "predict"]

Array = NDArray[np.float64]
DRAWS = 1000  # enough for a 5 % quantile to a twentieth of an sd


def predict(
    recording: Recording,
    screened: Screened | None,
    likelihoods: Mapping[str, RigLikelihood],
    model: Model,
    theta: Array,
    left_out: Mapping[str, LeftOut],
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
    left_out : mapping of str to LeftOut
        What the fit predicts of trials that it has not seen, by rig.
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
        Both with ``loo_pit``, the probability of less friction had the trial been left
        out, and ``pareto_k`` of its weights; ``trial_checks`` and ``run_checks``: how far
        these are from uniform, and coverage by condition. ``prior``: friction that the
        priors alone imply, of the gravity board where it enters.
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
        remade = remake(likelihood, named, factor - 1, checks)
        if isinstance(likelihood, GravityLikelihood) and screened is not None:
            assert recording.gravity is not None
            recorded = recording.gravity.trials
            table = trials(likelihood, recorded, named, factor, remade)
            found = _checked("trial", table, likelihood, left_out["gravity"], remade)
            groups |= {"trials": _named("gravity", found[0]), "trial_checks": found[1]}
            groups["prior"] = _prior(table, likelihood, model, named, analysis, baseline)
            groups["curves"] = curves(likelihood, named, baseline)
            groups |= paper_slopes(
                likelihood, screened.gravity, recording.rig, named, baseline, checks
            )
            groups["trajectories"] = trajectories(
                likelihood, screened.gravity, recording.rig, named, factor, baseline
            )
        elif isinstance(likelihood, MotorLikelihood):
            assert recording.motor is not None
            table = runs(likelihood, recording.motor.runs, named, factor, remade)
            found = _checked("run", table, likelihood, left_out["motor"], remade)
            groups |= {"runs": _named("motor", found[0]), "run_checks": found[1]}
            if "prior" not in groups:
                groups["prior"] = _prior(table, likelihood, model, named, analysis, baseline)
    return xr.DataTree.from_dict(groups)


def _named(rig: str, table: xr.Dataset) -> xr.Dataset:
    """Return a table of trials that says of which rig they are, and what they are called."""
    words = all_rigs()[rig].words
    return table.assign_attrs(
        rig=rig,
        title=words.rig,
        trial=words.trial,
        trials=words.trials,
        id=str(table["z"].dims[0]),
    )


def _checked(
    trial: str, table: xr.Dataset, likelihood: RigLikelihood, left: LeftOut, remade: Remade
) -> tuple[xr.Dataset, xr.Dataset]:
    """Return the table of trials with what leaving them out says, and the checks over all."""
    checks = coverage(likelihood.trials, likelihood.sizes, remade, table["friction_n"].to_numpy())
    if left.trials is None:
        return table, checks
    table = table.assign(loo_pit=(trial, left.pit), pareto_k=(trial, left.trials.pareto_k))
    found = uniformity(left.pit, left.again)
    return table, checks.assign_coords(probability=found.grid).assign(
        pit_difference=("probability", found.difference),
        pit_band=(("end", "probability"), np.stack([found.low, found.high])),
    )


def _prior(
    table: xr.Dataset,
    likelihood: RigLikelihood,
    model: Model,
    named: dict[str, Array],
    analysis: Analysis,
    baseline: Baseline,
) -> xr.Dataset:
    """Return what the priors imply of friction, by condition."""
    rng = np.random.default_rng(np.random.SeedSequence([analysis.seed, 4]))
    prior = model.by_name(model.draw_prior(PRIOR_DRAWS, rng))
    key = [*CELL, *(name for name in MASSES if name in likelihood.trials)]
    measured = {name: table[name].to_numpy() for name in ("tension_n", "friction_n")}
    if isinstance(likelihood, MotorLikelihood):  # signed there: it is against the motion
        measured["friction_n"] = np.abs(measured["friction_n"])
    rows = likelihood.trials[key].assign(**measured)
    rows = rows.groupby(key, sort=False, as_index=False).mean()
    board = None
    if isinstance(likelihood, GravityLikelihood):
        n, wrap, drive, load = (rows[name].to_numpy(dtype=np.float64) for name in key[1:])
        board = Condition(n, wrap, drive, load, likelihood.condition.gravity_m_s2)
    return friction_of_prior(rows, board, prior, named, baseline)
