"""Fits the population of several boards, from the fit of each recording."""

import hashlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.attention.fit import of_pooled, unsettled
from bayesfric.chains import by_walker
from bayesfric.errors import Fault, InputError
from bayesfric.fitting.inference_data import flat_attributes
from bayesfric.fitting.pooling import BETWEEN, PooledDraws, Population, draw_pooled
from bayesfric.fitting.posterior import model_of_law, opened
from bayesfric.fitting.result import Fit
from bayesfric.fitting.summary import parameter_summaries
from bayesfric.inference.diagnostics import diagnose_all
from bayesfric.inference.sampling import Progress
from bayesfric.inference.sampling_rules import SAMPLING_RULES
from bayesfric.observation.coefficients import coefficient_name, sizes_of
from bayesfric.recording.tables import Recording
from bayesfric.results import (
    draws_tree,
    identified,
    provenance,
    recording_id,
)
from bayesfric.rigs.opening import chosen_rigs
from bayesfric.schemas import FitFile
from bayesfric.schemas.base import Interval, Provenance, RecordingId
from bayesfric.schemas.fit import DataQuality, SamplerSummary
from bayesfric.schemas.parameter import ParameterSummary
from bayesfric.schemas.pooled import BoardCoefficient, Pooled, PooledBoard, PooledCoefficient

SHARED = (
    "of each coefficient and pulley size, the mean of the population of boards and the standard "
    "deviation between them"
)
OWN = "its coefficients, and all scatter and noise, with the priors of a fit of it alone"


def board_folder(name: str) -> str:
    """Return the folder of one board's fit, relative to that of the pooled fit."""
    return f"boards/{name}"


def check_boards(
    recordings: Mapping[str, Recording], analysis: Analysis, rigs: Sequence[str] | None
) -> tuple[str, ...]:
    """Return the rigs of recordings; raise an error if they cannot be pooled.

    Parameters
    ----------
    recordings : mapping of str to Recording
        By the name of the board.
    analysis : Analysis
        Its priors.
    rigs : sequence of str or None
        Rigs to fit, as for a fit.

    Raises
    ------
    InputError
        Two recordings are the same, have data of different rigs or pulley sizes, or have no
        pulleys.
    """
    seen: dict[str, str] = {}
    sizes: dict[str, tuple[str, ...]] = {}
    chosen: tuple[str, ...] = ()
    for name, recording in recordings.items():
        # A recording in memory has no checksum.
        if recording.sha256 and recording.sha256 in seen:
            expected = f"other data than those of {seen[recording.sha256]}: a board counts once"
            raise InputError([Fault(name, expected)])
        seen[recording.sha256] = name
        present = chosen_rigs(recording, rigs)
        if chosen and present != chosen:
            expected = f"data of the rigs {', '.join(chosen)}, as the others: name them by --rigs"
            raise InputError([Fault(name, expected, value=", ".join(present))])
        chosen = present
        data, law, own = opened(recording, analysis, present, "paper")
        sizes[name] = sizes_of(model_of_law(data, own, law).names)
    first, *others = sizes
    if not sizes[first]:
        raise InputError([Fault(first, "a board with pulleys: of these alone several are pooled")])
    for name in others:
        if set(sizes[name]) != set(sizes[first]):
            raise InputError(
                [
                    Fault(
                        name,
                        f"the pulley sizes of {first} ({', '.join(sizes[first])}); a population "
                        "has the same coefficients on every board",
                        value=", ".join(sizes[name]),
                    )
                ]
            )
    return chosen


def pool(
    recordings: Mapping[str, Recording],
    fits: Mapping[str, Fit],
    analysis: Analysis,
    *,
    progress: Progress | None = None,
) -> Fit:
    """Fit the population from which the coefficients of several boards are drawn.

    Parameters
    ----------
    recordings : mapping of str to Recording
        By the name of the board, as :func:`check_boards` accepts them.
    fits : mapping of str to Fit
        The fit of each board, with the same rigs, law and analysis.
    analysis : Analysis
        Sampler, seed, and the prior of the scatter between boards.
    progress : callable or None
        Called with the sampler's steps done and steps in all.

    Returns
    -------
    Fit
        The fit of the population: ``draws.nc`` has a ``posterior`` with its ``c1`` and its
        scatter ``between_c1`` over ``pulley``, and ``board_c1`` over ``board`` and ``pulley``;
        ``predictive.nc`` has ``new_board``, the coefficients of an unmeasured board.
    """
    first = next(iter(fits.values())).summary
    models, alone = {}, {}
    for name, recording in recordings.items():
        data, law, own = opened(recording, analysis, first.rigs, first.baseline)
        models[name] = model_of_law(data, own, law)
        alone[name] = _stored(fits[name], models[name].names)
    drawn = draw_pooled(models, alone, analysis, progress)
    attributes = provenance(
        recording=_all_of(recordings),
        analysis=analysis,
        created=max(recording.created or "" for recording in recordings.values()) or None,
    )
    own_names = {name: model.names for name, model in models.items()}
    summary = identified(_summary(attributes, fits, drawn, alone, own_names, analysis))
    origin = attributes.model_dump(mode="json", exclude={"analysis", "run_id"})
    draws, predictive = _trees(drawn, own_names, flat_attributes(origin), analysis.seed)
    return Fit(summary, draws, predictive, {})


def _stored(fit: Fit, names: Sequence[str]) -> Array:
    """Return the stored draws of a fit in the order of names, shape (S, D)."""
    posterior = by_walker(fit.draws["posterior"].to_dataset())
    columns = []
    for name in names:
        stem, _, size = name.partition("[")
        coefficient = (
            posterior[name] if name in posterior else posterior[stem].sel(pulley=size[:-1])
        )
        columns.append(coefficient.to_numpy().ravel())
    return np.stack(columns, axis=-1)


def _all_of(recordings: Mapping[str, Recording]) -> RecordingId:
    identities = sorted(
        (own.sha256, own.rig_sha256) for own in map(recording_id, recordings.values())
    )
    tables, rigs = ("".join(part) for part in zip(*identities, strict=True))
    return RecordingId(
        name=" + ".join(recordings),
        title=f"{len(recordings)} boards of one population",
        sha256=hashlib.sha256(tables.encode()).hexdigest(),
        rig_sha256=hashlib.sha256(rigs.encode()).hexdigest(),
    )


def _summary(
    attributes: Provenance,
    fits: Mapping[str, Fit],
    drawn: PooledDraws,
    alone: Mapping[str, Array],
    own_names: Mapping[str, Sequence[str]],
    analysis: Analysis,
) -> FitFile:
    """Return the content of ``fit.json``."""
    population, theta = drawn.population, drawn.theta
    convergence = dict(zip(population.names, diagnose_all(theta[:, :, None]), strict=True))
    entries = parameter_summaries(population, theta, convergence, theta)  # all are stored
    chains, draws, _ = theta.shape
    least = min(figures.ess_bulk for figures in convergence.values())
    reliable = drawn.pareto_k <= SAMPLING_RULES.pareto_k
    converged = all(figures.converged for figures in convergence.values())
    return FitFile(
        **attributes.model_dump(),
        rigs=next(iter(fits.values())).summary.rigs,
        baseline=next(iter(fits.values())).summary.baseline,
        converged=converged and reliable and all(fit.summary.converged for fit in fits.values()),
        attention=tuple(
            of_pooled(
                {name: fit.summary for name, fit in fits.items()},
                drawn.pareto_k,
                list(unsettled(convergence, entries)),
            )
        ),
        pulleys=_by_size(entries, *_stems_and_sizes(population)),
        scatter={},
        noise={},
        parameters={},
        without_exclusions_why="in the fit of each board",
        without_stalls_why="in the fit of each board",
        sampler=SamplerSummary(
            ensembles=chains,
            walkers=1,
            steps=draws,
            thin=1,
            draws=chains * draws,
            acceptance=drawn.acceptance,
            autocorrelation_time=chains * draws / least,
        ),
        data_quality=_quality(fits),
        pooled=_pooled(fits, drawn, alone, own_names, entries, _new_boards(drawn, analysis.seed)),
    )


def _stems_and_sizes(population: Population) -> tuple[list[str], tuple[str, ...]]:
    """Return the names of the coefficients without a size, and the pulley sizes."""
    stems = list(dict.fromkeys(name.partition("[")[0] for name in population.names))
    return [stem for stem in stems if not stem.startswith(BETWEEN)], sizes_of(population.names)


def _pooled(
    fits: Mapping[str, Fit],
    drawn: PooledDraws,
    alone: Mapping[str, Array],
    own_names: Mapping[str, Sequence[str]],
    entries: Mapping[str, ParameterSummary],
    new: Array,
) -> Pooled:
    """Return the coefficients of the population, and the change of each board's by pooling."""
    population = drawn.population

    def of_board(stem: str, size: str) -> PooledCoefficient:
        name = coefficient_name(stem, size)
        k = population.names.index(name)
        spread = population.split(drawn.theta)[1][..., k]
        boards = {}
        for board, names in own_names.items():
            place = names.index(name)
            before = alone[board][:, place]
            boards[board] = BoardCoefficient(
                alone=Interval.of_draws(before),
                pooled=Interval.of_draws(drawn.boards[board][..., place]),
                shrinkage=float((before.var() / (before.var() + spread**2)).mean()),
            )
        return PooledCoefficient(
            between=entries[BETWEEN + name], new_board=Interval.of_draws(new[..., k]), boards=boards
        )

    stems, sizes = _stems_and_sizes(population)
    infinite = not np.isfinite(drawn.pareto_k)
    return Pooled(
        shared=SHARED,
        own=OWN,
        boards={
            name: PooledBoard(
                recording=fit.summary.recording,
                folder=board_folder(name),
                converged=fit.summary.converged,
            )
            for name, fit in fits.items()
        },
        pulleys={size: {stem: of_board(stem, size) for stem in stems} for size in sizes},
        pareto_k=None if infinite else drawn.pareto_k,
        pareto_k_why="hardly any weight is not zero" if infinite else None,
    )


def _by_size(
    entries: Mapping[str, ParameterSummary], stems: Sequence[str], sizes: Sequence[str]
) -> dict[str, dict[str, ParameterSummary]]:
    return {size: {stem: entries[coefficient_name(stem, size)] for stem in stems} for size in sizes}


def _quality(fits: Mapping[str, Fit]) -> DataQuality:
    """Return counts of all boards together; excluded trials are named by board and id."""
    qualities = {name: fit.summary.data_quality for name, fit in fits.items()}
    totals: dict[str, Any] = {
        key: sum(getattr(quality, key) for quality in qualities.values())
        for key in (
            "trials",
            "trials_used",
            "setups",
            "events",
            "points",
            "motor_runs",
            "replicated_cells",
        )
    }
    return DataQuality(
        **totals,
        excluded=tuple(
            out.model_copy(update={"trial": f"{name}/{out.trial}"})
            for name, quality in qualities.items()
            for out in quality.excluded
        ),
        notes=tuple(
            f"{name}: {note}" for name, quality in qualities.items() for note in quality.notes
        ),
    )


def _new_boards(drawn: PooledDraws, seed: int) -> Array:
    """Draw coefficients of an unmeasured board, shape (chains, draws, K)."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, 12]))
    mean, sd = drawn.population.split(drawn.theta)
    return np.asarray(rng.normal(mean, sd))


def _trees(
    drawn: PooledDraws,
    own_names: Mapping[str, Sequence[str]],
    attributes: Mapping[str, Any],
    seed: int,
) -> tuple[xr.DataTree, xr.DataTree]:
    """Return the contents of ``draws.nc`` and ``predictive.nc``."""
    names, sizes = drawn.population.names, sizes_of(drawn.population.names)
    units = {
        parameter.name.partition("[")[0]: parameter.unit
        for parameter in drawn.population.parameters
    }
    new = _new_boards(drawn, seed)
    posterior: dict[str, Array] = {}
    later: dict[str, Array] = {}
    dims: dict[str, list[str]] = {}
    for stem in units:
        places = [names.index(coefficient_name(stem, size)) for size in sizes]
        posterior[stem], dims[stem] = drawn.theta[..., places], ["pulley"]
        if not stem.startswith(BETWEEN):
            later[stem] = new[..., places]
            by_board = [
                drawn.boards[board][..., [own.index(names[place]) for place in places]]
                for board, own in own_names.items()
            ]
            posterior[f"board_{stem}"] = np.stack(by_board, axis=2)
            dims[f"board_{stem}"] = ["board", "pulley"]
    layout: dict[str, Any] = {
        "coords": {"pulley": list(sizes), "board": list(own_names)},
        "ensembles": len(new),
        "attributes": attributes,
        "units": units | {f"board_{stem}": unit for stem, unit in units.items()},
    }
    draws = draws_tree({"posterior": posterior}, dims=dims, **layout)
    return draws, draws_tree({"new_board": later}, dims=dims, **layout)
