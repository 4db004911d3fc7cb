"""What a fit predicts, laid out for the figures: curves, bands and trials.

Figures draw from these arrays and compute nothing.
"""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.attention.fit import Coverage
from bayesfric.fitting.predictive.assemblies import Assemblies
from bayesfric.fitting.predictive.coverage import CELL, coverage
from bayesfric.fitting.predictive.left_out import LeftOut, scores, uniformity
from bayesfric.fitting.predictive.parameters import coefficients, densities, ranks
from bayesfric.fitting.predictive.prior import PRIOR_DRAWS, friction_of_prior
from bayesfric.inference.model import Model, RigLikelihood
from bayesfric.physics.laws import FrictionLaw
from bayesfric.rigs.bands import QUANTILES, bands
from bayesfric.rigs.base import Predictive, RigTrials
from bayesfric.rigs.data import Data
from bayesfric.rigs.remaking import Remade, remake
from bayesfric.stored_names import tree_of

__all__ = ["QUANTILES", "covered", "predict"]

DRAWS = 1000  # enough for a 5 % quantile to a twentieth of an sd


def predict(
    data: Data,
    model: Model,
    theta: Array,
    left_out: Mapping[str, LeftOut],
    assemblies: Mapping[str, Assemblies | None],
    analysis: Analysis,
    baseline: FrictionLaw,
) -> xr.DataTree:
    """Compute predictions from draws.

    Parameters
    ----------
    data : Data
        Trials that entered.
    model : Model
        Of the fit; its likelihoods are those of the rigs of `data`.
    theta : ndarray, shape (ensembles, draws, walkers, D)
        Posterior draws in the parameters' units.
    left_out : mapping of str to LeftOut
        What the fit predicts of trials that it has not seen, by rig.
    assemblies : mapping of str to Assemblies or None
        What it predicts of assemblies that it has not seen, by rig.
    analysis : Analysis
        For the seed and the form of the scatter.
    baseline : FrictionLaw
        The friction law of the fit.

    Returns
    -------
    DataTree
        ``coefficients``: quantiles, and their ratio to Table I for its sizes.
        ``densities``: of each parameter, prior and posterior.
        ``ranks``: how the draws of each ensemble rank among all.
        Of each rig a group that is called as its trials are (``trials``, ``runs``), with
        the attributes ``rig``, ``title``, ``trial``, ``trials`` and ``id`` (its dimension):
        friction observed, and predicted
        for a new trial on a new assembly, with z and coverage; ``loo_pit``, the
        probability of less friction had the trial been left out, and ``pareto_k`` of its
        weights. Of each rig ``trial_checks`` (``run_checks``): how far these are from
        uniform, and coverage by condition; ``trial_assemblies`` (``run_assemblies``): the
        same of assemblies left out. Beside it what the rig alone can show.
        ``prior``: friction that the priors alone imply, of the first rig.
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
    for trials, likelihood in zip(data.rigs, model.likelihoods, strict=True):
        rig, words = trials.rig, trials.rig.words
        factor = 1 + likelihood.draw_scatter(named, rng)
        remade = remake(likelihood, named, factor - 1, checks)
        view = Predictive(likelihood, baseline, named, factor, remade, checks)
        table = trials.predicted(view).assign_attrs(
            rig=rig.name,
            title=words.rig,
            trial=words.trial,
            trials=words.trials,
            group=words.group,
            id=words.trial,
        )
        groups[words.trials], groups[f"{words.trial}_checks"] = _checked(
            trials, table, likelihood, left_out[rig.name], remade
        )
        if (left := assemblies[rig.name]) is not None:
            groups[f"{words.trial}_assemblies"] = left.table(likelihood.trials)
        if "prior" not in groups and any("[" in p.name for p in likelihood.parameters):
            groups["prior"] = _prior(trials, table, model, named, analysis, baseline)
        groups |= trials.figures(view)
    return tree_of(groups)


def covered(predictive: xr.DataTree) -> tuple[Coverage, ...]:
    """Return the share of each rig's trials inside their predictive intervals.

    Parameters
    ----------
    predictive : DataTree
        As of :func:`predict`.
    """
    coverages = []
    for group in predictive.children.values():
        table = group.to_dataset()
        if "covered_share" in table:
            low, _, high = (float(value) for value in table["covered_expected"].to_numpy())
            coverages.append(
                Coverage(str(table.attrs["rig"]), float(table["covered_share"]), low, high)
            )
    return tuple(coverages)


def _checked(
    trials: RigTrials, table: xr.Dataset, likelihood: RigLikelihood, left: LeftOut, remade: Remade
) -> tuple[xr.Dataset, xr.Dataset]:
    """Return the table of trials with their leave-one-out figures, and checks over all trials."""
    observed = table["friction_n"].to_numpy()
    checks = coverage(likelihood.trials, likelihood.sizes, trials.loads, remade, observed)
    if left.trials is None:
        return table, checks
    trial = trials.rig.words.trial
    table = table.assign(loo_pit=(trial, left.pit), pareto_k=(trial, left.trials.pareto_k))
    uniform = uniformity(left.pit, left.again)
    return table, checks.assign_coords(probability=uniform.grid).assign(
        pit_difference=("probability", uniform.difference),
        pit_band=(("end", "probability"), np.stack([uniform.low, uniform.high])),
        score=("rank", np.sort(scores(left.pit))),
        score_expected=(("rank", "quantile"), bands(np.sort(scores(left.again), axis=-1))),
    )


def _prior(
    trials: RigTrials,
    table: xr.Dataset,
    model: Model,
    named: dict[str, Array],
    analysis: Analysis,
    baseline: FrictionLaw,
) -> xr.Dataset:
    """Return what the priors imply of friction, by condition."""
    rng = np.random.default_rng(np.random.SeedSequence([analysis.seed, 4]))
    prior = model.by_name(model.draw_prior(PRIOR_DRAWS, rng))
    likelihood = model.likelihoods[0]
    key = [*CELL, *trials.loads]
    # Without a recorded tension a placeholder stands in the column.
    tension = table if "tension_n" in table else likelihood.trials
    measured = {
        "tension_n": np.asarray(tension["tension_n"]),
        "friction_n": table["friction_n"].to_numpy(),
    }
    # Friction at constant speed is negative in the table where the motion is.
    if trials.rig.words.regime == "steady":
        measured["friction_n"] = np.abs(measured["friction_n"])
    rows = likelihood.trials[key].assign(**measured)
    rows = rows.groupby(key, sort=False, as_index=False).mean()
    return friction_of_prior(rows, trials.resting(rows), prior, named, baseline)
