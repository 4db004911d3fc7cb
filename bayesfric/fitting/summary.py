"""The numbers of ``fit.json`` from draws: intervals, diagnostics, data quality."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.attention.fit import Coverage, of_fit
from bayesfric.inference.diagnostics import (
    Convergence,
    diagnose_all,
    of_chains,
    power_scaling,
)
from bayesfric.inference.informed import informed_by_data
from bayesfric.inference.model import Model
from bayesfric.inference.priors import LOG_2PI, Kind, Parameter
from bayesfric.inference.sampling import Draws
from bayesfric.observation.coefficients import sizes_of
from bayesfric.observation.exact import ExactLikelihood
from bayesfric.observation.scatter import kept_normal
from bayesfric.recording.tables import Recording
from bayesfric.rigs.data import Data
from bayesfric.schemas import FitFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.fit import DataQuality, PointEstimate, SamplerSummary, WithoutExclusions
from bayesfric.schemas.parameter import ParameterSummary, StoredDraws

COEFFICIENTS = ("c1", "c2", "c3")
NO_SD = "the prior has no standard deviation"
Summary = TypeVar("Summary", bound=Interval)


def summarise(
    attributes: dict[str, Any],
    recording: Recording,
    analysis: Analysis,
    data: Data,
    model: Model,
    draws: Draws,
    theta: Array,
    chains: Array,
    coverage: Sequence[Coverage],
) -> FitFile:
    """Return the content of ``fit.json``.

    Parameters
    ----------
    attributes : dict
        The fields of :class:`bayesfric.schemas.Provenance`, rigs, baseline, and the results
        with excluded trials.
    recording : Recording
        The recording as read.
    analysis : Analysis
        Contains the settings of scatter, some of which a rig may ignore.
    data : Data
        Trials that were used.
    model, draws
        The posterior and its draws.
    theta : ndarray, shape (ensembles, draws, walkers, D)
        The draws in the parameters' units.
    chains : ndarray, shape (ensembles, stored draws, D)
        Stored draws in the same units.
    coverage : sequence of Coverage
        Shares of trials inside their predictive intervals, rig by rig.
    """
    convergence = dict(zip(model.names, diagnose_all(theta), strict=True))
    entries = parameter_summaries(model, theta, convergence, chains)
    for name, moved in _sensitivity(model, draws, theta).items():
        entries[name] = entries[name].model_copy(update=moved)
    quality = _quality(recording, data)
    return FitFile(
        **attributes,
        converged=all(figures.converged for figures in convergence.values()),
        attention=(
            *of_fit(
                convergence,
                entries,
                model.parameters,
                quality,
                uniformity=attributes["uniformity"],
                assemblies=attributes["assemblies"],
                coverage=coverage,
                untold=data.untold,
            ),
            *_ignored_settings(analysis, data, model),
        ),
        **_by_kind(model, entries),
        paper_estimator=_paper_estimates(data),
        sampler=_sampler(draws, theta, min(figures.ess_bulk for figures in convergence.values())),
        data_quality=quality,
    )


def _ignored_settings(analysis: Analysis, data: Data, model: Model) -> tuple[str, ...]:
    """Return a sentence for each setting that has no effect on this fit."""
    normal = [
        line
        for trials, likelihood in zip(data.rigs, model.likelihoods, strict=True)
        if isinstance(likelihood, ExactLikelihood)
        for line in kept_normal(
            analysis.scatter, trials.rig.words.rig, likelihood.model.scatter.heavy_levels
        )
    ]
    elsewhere = [
        f"priors.pulleys.{size} is of no pulley size of these data "
        f"({', '.join(data.sizes)}), and changes nothing"
        for size in analysis.priors.pulleys
        if size not in data.sizes
    ]
    return (*normal, *elsewhere)


def _sampler(draws: Draws, theta: Array, least_ess: float) -> SamplerSummary:
    """Return the summary of the sampler; `least_ess` is that of the slowest parameter."""
    ensembles, kept, walkers, _ = theta.shape
    return SamplerSummary(
        ensembles=ensembles,
        walkers=walkers,
        steps=draws.steps,
        thin=draws.thin,
        extensions=draws.extensions,
        draws=ensembles * kept * walkers,
        acceptance=float(draws.acceptance.mean()),
        autocorrelation_time=ensembles * walkers * draws.steps / least_ess,
    )


def summarise_without_exclusions(trials: int, model: Model, draws: Draws) -> WithoutExclusions:
    """Return the coefficients of a fit to all trials, including excluded ones.

    Parameters
    ----------
    trials : int
        Number of its trials of rigs with exclusion rules.
    model : Model
        The posterior.
    draws : Draws
        As sampled.
    """
    theta = model.natural(draws.z)
    places = {name: place for place, name in enumerate(model.names)}
    return WithoutExclusions(
        trials_used=trials,
        converged=all(figures.converged for figures in diagnose_all(theta)),
        pulleys=_by_pulley(
            {
                name: Interval.of_draws(theta[..., place])
                for name, place in places.items()
                if name.partition("[")[0] in COEFFICIENTS
            }
        ),
    )


def _by_pulley(entries: Mapping[str, Summary]) -> dict[str, dict[str, Summary]]:
    """Return the summaries of the law's coefficients by pulley size."""
    return {
        size: {c: entries[f"{c}[{size}]"] for c in COEFFICIENTS if f"{c}[{size}]" in entries}
        for size in sizes_of(entries)
    }


def _by_kind(model: Model, entries: Mapping[str, ParameterSummary]) -> dict[str, Any]:
    """Return the fields with the parameters."""
    of_all_sizes = {
        name: entry
        for name, entry in _of_kind(model, entries, "coefficient").items()
        if "[" not in name
    }
    return {
        "pulleys": _by_pulley(entries),
        "scatter": _of_kind(model, entries, "scatter"),
        "noise": _of_kind(model, entries, "noise"),
        "parameters": of_all_sizes | _of_kind(model, entries, "other"),
    }


def _paper_estimates(data: Data) -> dict[str, PointEstimate]:
    """Return the estimates by the paper's method, by pulley size."""
    return {
        size: estimate
        for trials in data.rigs
        for size, estimate in trials.paper_estimates().items()
    }


def _of_kind(
    model: Model, entries: Mapping[str, ParameterSummary], kind: Kind
) -> dict[str, ParameterSummary]:
    return {p.name: entries[p.name] for p in model.parameters if p.kind == kind}


def parameter_summaries(
    model: Model, theta: Array, convergence: Mapping[str, Convergence], chains: Array
) -> dict[str, ParameterSummary]:
    """Return the summary of each parameter of a model.

    Parameters
    ----------
    model : Model
        D parameters.
    theta : ndarray, shape (…, D)
        Their draws.
    convergence : mapping of str to Convergence
        Convergence figures of each parameter.
    chains : ndarray, shape (chains, draws, D)
        Stored draws.
    """
    informed = informed_by_data(model, theta.reshape(-1, theta.shape[-1]))
    return {
        parameter.name: _summarised(
            parameter, theta[..., k], convergence[parameter.name], chains[..., k], bool(informed[k])
        )
        for k, parameter in enumerate(model.parameters)
    }


def _summarised(
    parameter: Parameter, draws: Array, figures: Convergence, chains: Array, informed: bool
) -> ParameterSummary:
    sd = parameter.sd()
    return ParameterSummary(
        **Interval.of_draws(draws).model_dump(),
        unit=parameter.unit,
        prior=parameter.described(),
        mcse_mean=figures.mcse_mean,
        ess_bulk=figures.ess_bulk,
        ess_tail=figures.ess_tail,
        r_hat=figures.r_hat,
        r_hat_walkers=figures.r_hat_walkers,
        stored=StoredDraws(**of_chains(chains)._asdict()),
        contraction=1 - float(draws.std()) / sd if np.isfinite(sd) else None,
        contraction_why=None if np.isfinite(sd) else NO_SD,
        informed=informed,
    )


def _sensitivity(model: Model, draws: Draws, theta: Array) -> dict[str, dict[str, float | None]]:
    """Return the power-scaling sensitivity of each coefficient to priors and likelihood."""
    by_walker = draws.z.shape[:-1]
    prior = model.log_prior(theta.reshape(-1, theta.shape[-1])).reshape(by_walker)
    # The density is that in the sampling space, in which every prior is N(0, 1).
    likelihood = draws.log_density + 0.5 * (LOG_2PI + draws.z**2).sum(axis=-1)
    places = {p.name: i for i, p in enumerate(model.parameters) if p.kind == "coefficient"}
    values = theta[..., list(places.values())].reshape(len(theta), -1, len(places))
    moved = {}
    for key, component in (("prior", prior), ("likelihood", likelihood)):
        flat = component.reshape(len(theta), -1)
        # Powers of a uniform prior are constant.
        moved[key] = power_scaling(values, flat) if np.ptp(flat) > 0 else np.zeros(len(places))
    return {
        name: {
            f"{key}_sensitivity{suffix}": value
            for key, sensitivities in moved.items()
            for suffix, value in (("", float(sensitivities[place])), ("_why", None))
        }
        for place, name in enumerate(places)
    }


def _quality(recording: Recording, data: Data) -> DataQuality:
    """Return counts of used and excluded trials of all rigs."""
    fields: dict[str, Any] = {
        "trials": 0,
        "trials_used": 0,
        "setups": 0,
        "events": 0,
        "replicated_cells": 0,
        "excluded": (),
    }
    for trials in data.rigs:
        fields |= trials.quality()
    return DataQuality(**fields, notes=recording.notes)
