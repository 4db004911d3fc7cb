"""Predictions of a fit as arrays for the figures: curves, bands and trials.

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
from bayesfric.inference.model import Model
from bayesfric.physics.laws import FrictionLaw
from bayesfric.rigs.bands import bands
from bayesfric.rigs.base import Predictive, Rig, RigTrials
from bayesfric.rigs.data import Data
from bayesfric.rigs.remaking import remake
from bayesfric.stored_names import tree_of

__all__ = ["covered", "predict"]

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
        Trials that were used.
    model : Model
        Model of the fit, with a likelihood of each rig of `data`.
    theta : ndarray, shape (ensembles, draws, walkers, D)
        Posterior draws in the parameters' units.
    left_out, assemblies : mapping of str to LeftOut, and to Assemblies or None
        Leave-one-out predictions of trials and of assemblies, by rig.
    analysis : Analysis
        Contains the seed and the form of the scatter.
    baseline : FrictionLaw
        The friction law of the fit.

    Returns
    -------
    DataTree
        ``coefficients``: quantiles, and their ratio to Table I for its sizes.
        ``densities``: of each parameter, prior and posterior.
        ``ranks``: how the draws of each ensemble rank among all.
        Of each rig a group that is called as its trials are (``trials``, ``runs``), with its words
        as attributes: friction observed, and predicted for a new trial on a new assembly, with z
        and coverage; ``loo_pit``, the probability of less friction had the trial been left out,
        and ``pareto_k`` of its weights. ``trial_checks`` (``run_checks``): how far these are from
        uniform, and coverage by condition; ``trial_assemblies`` (``run_assemblies``): the same of
        assemblies left out. Beside it what the rig alone can show.
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
        factor = 1 + likelihood.draw_scatter(named, rng)
        remade = remake(likelihood, named, factor - 1, checks)
        view = Predictive(likelihood, baseline, named, factor, remade, checks)
        name, table = trials.rig.name, _with_words(trials.predicted(view), trials.rig)
        groups |= _checked(trials, table, view, left_out[name], assemblies[name])
        if "prior" not in groups and any("[" in p.name for p in likelihood.parameters):
            groups["prior"] = _prior(trials, table, model, named, analysis, baseline)
        groups |= trials.figures(view)
    return tree_of(groups)


def covered(predictive: xr.DataTree) -> tuple[Coverage, ...]:
    """Return the share of each rig's trials inside their predictive intervals.

    Parameters
    ----------
    predictive : DataTree
        From :func:`predict`.
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


def _with_words(table: xr.Dataset, rig: Rig) -> xr.Dataset:
    """Return a rig's table of trials with its words as attributes."""
    words = rig.words
    return table.assign_attrs(
        rig=rig.name,
        title=words.rig,
        trial=words.trial,
        trials=words.trials,
        group=words.group,
        id=words.trial,
    )


def _checked(
    trials: RigTrials,
    table: xr.Dataset,
    view: Predictive,
    left: LeftOut,
    assemblies: Assemblies | None,
) -> dict[str, xr.Dataset]:
    """Return the table of trials with their leave-one-out figures, and checks over all trials."""
    words, likelihood = trials.rig.words, view.likelihood
    observed = table["friction_n"].to_numpy()
    checks = coverage(likelihood.trials, likelihood.sizes, trials.loads, view.remade, observed)
    if left.trials is not None:
        table = table.assign(
            loo_pit=(words.trial, left.pit), pareto_k=(words.trial, left.trials.pareto_k)
        )
        uniform = uniformity(left.pit, left.again)
        checks = checks.assign_coords(probability=uniform.grid).assign(
            pit_difference=("probability", uniform.difference),
            pit_band=(("end", "probability"), np.stack([uniform.low, uniform.high])),
            score=("rank", np.sort(scores(left.pit))),
            score_expected=(("rank", "quantile"), bands(np.sort(scores(left.again), axis=-1))),
        )
    checked = {words.trials: table, f"{words.trial}_checks": checks}
    if assemblies is not None:
        checked[f"{words.trial}_assemblies"] = assemblies.table(likelihood.trials)
    return checked


def _prior(
    trials: RigTrials,
    table: xr.Dataset,
    model: Model,
    named: dict[str, Array],
    analysis: Analysis,
    baseline: FrictionLaw,
) -> xr.Dataset:
    """Return the prior predictive friction by condition."""
    rng = np.random.default_rng(np.random.SeedSequence([analysis.seed, 4]))
    prior = model.by_name(model.draw_prior(PRIOR_DRAWS, rng))
    likelihood = model.likelihoods[0]
    key = [*CELL, *trials.loads]
    # Without a recorded tension the column contains a placeholder.
    tension = table if "tension_n" in table else likelihood.trials
    measured = {
        "tension_n": np.asarray(tension["tension_n"]),
        "friction_n": table["friction_n"].to_numpy(),
    }
    # Friction at constant speed has the sign of the motion in the table.
    if trials.rig.words.regime == "steady":
        measured["friction_n"] = np.abs(measured["friction_n"])
    rows = likelihood.trials[key].assign(**measured)
    rows = rows.groupby(key, sort=False, as_index=False).mean()
    return friction_of_prior(rows, trials.resting(rows), prior, named, baseline)
