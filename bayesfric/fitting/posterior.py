"""A recording and an analysis become a stored fit: posteriors and diagnostics."""

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis
from bayesfric.checkpoint import Checkpoint
from bayesfric.fitting.hypothesis import chart_of
from bayesfric.fitting.predictive import predict
from bayesfric.fitting.predictive.left_out import LeftOut, leave_out
from bayesfric.fitting.predictive.reported import predictions, uniformities
from bayesfric.fitting.summary import summarise, summarise_without_exclusions
from bayesfric.fitting.tested import tested_conditions
from bayesfric.inference.diagnostics import diagnose_all
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.model import Model
from bayesfric.inference.priors import log_density
from bayesfric.inference.sampling import Draws, Progress, sample
from bayesfric.physics.laws import Baseline
from bayesfric.recording.tables import Recording
from bayesfric.results import (
    draws_tree,
    identified,
    json_bytes,
    provenance,
    replace_outputs,
    write_netcdf,
)
from bayesfric.rigs.coefficients import sizes_of
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import baseline_of, chosen_rigs, open_rigs, with_own_priors
from bayesfric.schemas import FitFile, RecordingId, TimingsFile

__all__ = ["Fit", "fit"]

Array = NDArray[np.float64]
POINTWISE_DRAWS = 2000  # draws of which the log likelihood by trial is stored


@dataclass(frozen=True)
class Fit:
    """The posterior of a recording, ready to be written.

    Parameters
    ----------
    summary : FitFile
        What ``fit.json`` says.
    draws : DataTree
        What ``draws.nc`` holds: ``posterior``, ``log_likelihood``, ``log_prior``.
    predictive : DataTree
        What ``predictive.nc`` holds, see :mod:`bayesfric.fitting.predictive`.
    seconds : dict of str to float
        Wall time by stage.
    """

    summary: FitFile
    draws: xr.DataTree
    predictive: xr.DataTree
    seconds: Mapping[str, float]

    def write(
        self,
        folder: Path | str,
        *,
        csv: bool = False,
        inputs: Mapping[str, Sequence[str]] | None = None,
    ) -> None:
        """Write ``fit.json``, ``draws.nc``, ``predictive.nc`` and ``timings.json``.

        Parameters
        ----------
        folder : Path or str
            Created if it is not there; other files in it are left alone.
        csv : bool
            Also write the posterior as ``draws.csv``.
        inputs : mapping of str to sequence of str, or None
            Paths of what the run was made from, for ``timings.json``.

        Raises
        ------
        InputError
            The folder cannot be written.
        """
        run_id = self.summary.run_id
        timings = TimingsFile(seconds=dict(self.seconds), run_id=run_id, inputs=dict(inputs or {}))
        writers: dict[str, Callable[[Path], object]] = {
            "draws.nc": lambda path: write_netcdf(self.draws, path, run_id),
            "predictive.nc": lambda path: write_netcdf(self.predictive, path, run_id),
            "timings.json": lambda path: path.write_bytes(json_bytes(timings)),
        }
        if csv:
            writers["draws.csv"] = lambda path: _write_csv(self.draws, path)
        writers["fit.json"] = lambda path: path.write_bytes(json_bytes(self.summary))
        replace_outputs(Path(folder), writers)


def fit(
    recording: Recording,
    analysis: Analysis | None = None,
    *,
    progress: Progress | None = None,
    checkpoint: Path | None = None,
    rigs: Sequence[str] | None = None,
    baseline: str = "paper",
) -> Fit:
    """Draw from the posterior of the paper's law given a recording.

    Parameters
    ----------
    recording : Recording
        With trials of at least one rig that can be fitted; those of role ``test`` do not
        enter.
    analysis : Analysis or None
        Priors, scatter, sampler and seed; None for the defaults.
    progress : callable or None
        Called with the sampler's steps done and steps in all.
    checkpoint : Path or None
        Folder that keeps the draws on the way: a fit that is killed and called
        again goes on to the same result. Remove it when the fit is written.
    rigs : sequence of str or None
        Whose data enter, by name (:func:`bayesfric.rigs.all_rigs`). None is the first rig
        that the recording has.
    baseline : str
        The friction law, a name in :data:`bayesfric.physics.laws.BASELINES`.

    Returns
    -------
    Fit
        Posterior, predictions and diagnostics.

    Raises
    ------
    InputError
        A rig is unknown or has no data in the recording, or no trial could enter.
    """
    analysis = Analysis() if analysis is None else analysis
    chosen = chosen_rigs(recording, rigs)
    attributes = provenance(
        recording=RecordingId(name=recording.name, title=recording.title, sha256=recording.sha256),
        analysis=analysis,
        created=recording.created,
    )
    seconds: dict[str, float] = {}
    with threadpool_limits(limits=1):  # one BLAS thread: the same bytes, and faster
        with _timed(seconds, "reduce"):
            data = Data(open_rigs(recording, chosen))
            law, analysis = baseline_of(baseline, data.rigs), with_own_priors(analysis, data.rigs)
            model = _model(data, analysis, law)
        key = ",".join([*chosen, baseline]) + attributes.model_dump_json()
        draws = _draw(model, analysis, Checkpoint(checkpoint, key), progress, seconds)
        with _timed(seconds, "without_exclusions"):
            whole, why = _all_that_can_enter(recording, data)
            without = None
            if whole is not None:
                again = _model(whole, analysis, law)
                folder = None if checkpoint is None else checkpoint / "without-exclusions"
                without = summarise_without_exclusions(
                    _under_rules(whole),
                    again,
                    _draw(again, analysis, Checkpoint(folder, key), progress, {}),
                )
        with _timed(seconds, "without_stalls"):
            moved, why_moved = _all_that_moved(data)
            without_stalls = None
            if moved is not None:
                again = _model(moved, analysis, law)
                folder = None if checkpoint is None else checkpoint / "without-stalls"
                without_stalls = summarise_without_exclusions(
                    _under_rules(moved),
                    again,
                    _draw(again, analysis, Checkpoint(folder, key), progress, {}),
                )
        theta = model.natural(draws.z)
        with _timed(seconds, "leave_out"):
            some = _pointwise_draws(draws.z)
            start = draws.z.reshape(-1, draws.z.shape[-1])[np.argmax(draws.log_density)]
            flat = some.reshape(-1, some.shape[-1])
            left_out = {
                name: leave_out(model, rig, flat, start, analysis.seed)
                for name, rig in zip(chosen, model.likelihoods, strict=True)
            }
        with _timed(seconds, "summary"):
            fields = {
                "rigs": chosen,
                "baseline": baseline,
                "without_exclusions": without,
                "without_exclusions_why": why,
                "without_stalls": without_stalls,
                "without_stalls_why": why_moved,
                "prediction": predictions(left_out),
                "uniformity": uniformities(left_out),
            }
            summary = summarise(
                attributes.model_dump() | fields, recording, data, model, draws, theta
            )
            named = attributes.model_dump(mode="json", exclude={"analysis", "run_id"})
            named |= tested_conditions(data, summary.pulleys)
            tree = _draws_tree(model, chosen, theta, left_out, named)
        with _timed(seconds, "predictive"):
            predictive = predict(data, model, theta, left_out, analysis, law)
    return Fit(identified(summary), tree, predictive, seconds)


def _model(data: Data, analysis: Analysis, law: Baseline) -> Model:
    return Model([trials.likelihood(analysis, law) for trials in data.rigs])


def _draw(
    model: Model,
    analysis: Analysis,
    checkpoint: Checkpoint,
    progress: Progress | None,
    seconds: dict[str, float],
) -> Draws:
    """Draw from the posterior of a model."""
    with _timed(seconds, "laplace"):
        laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    with _timed(seconds, "draws"):
        return sample(
            model.log_posterior,
            laplace,
            analysis.sampler,
            analysis.seed,
            progress,
            checkpoint,
            converged=lambda z: all(f.converged for f in diagnose_all(model.natural(z))),
            chart=chart_of(model),
        )


def _all_that_can_enter(recording: Recording, data: Data) -> tuple[Data | None, str | None]:
    """Return the trials with those that a rule left out, or why there are no others."""
    ruled = [trials for trials in data.rigs if trials.excluded is not None]
    if not ruled:
        return None, "no rule keeps a trial of these rigs from entering"
    if not any(trials.excluded for trials in ruled):
        return None, "no trial was left out"
    whole = Data(open_rigs(recording, [one.rig.name for one in data.rigs], exclude=False))
    if _under_rules(whole) == _under_rules(data):
        return None, "no trial that was left out has a motion that can be computed"
    return whole, None


def _all_that_moved(data: Data) -> tuple[Data | None, str | None]:
    """Return the trials that moved all the way, or why there are no others."""
    moved = [trials.moved() for trials in data.rigs]
    if not any(moved):
        return None, "all trials that enter moved all the way, or none did"
    kept = zip(moved, data.rigs, strict=True)
    return Data(tuple(one if one is not None else whole for one, whole in kept)), None


def _under_rules(data: Data) -> int:
    """Return how many trials enter of the rigs that have rules."""
    return sum(len(trials.table) for trials in data.rigs if trials.excluded is not None)


@contextmanager
def _timed(seconds: dict[str, float], stage: str) -> Any:
    start = time.perf_counter()
    yield
    seconds[stage] = time.perf_counter() - start


def _pointwise_stride(chains: int, kept: int) -> int:
    return max(1, -(-chains * kept // POINTWISE_DRAWS))


def _pointwise_draws(z: Array) -> Array:
    """Return the draws of which the log likelihood by trial is stored, (chain, draw, D)."""
    ensembles, kept, walkers, size = z.shape
    chains = z.transpose(0, 2, 1, 3).reshape(ensembles * walkers, kept, size)
    return chains[:, :: _pointwise_stride(len(chains), kept)]


def _draws_tree(
    model: Model,
    rigs: Sequence[str],
    theta: Array,
    left_out: Mapping[str, LeftOut],
    attributes: dict[str, Any],
) -> xr.DataTree:
    ensembles, kept, walkers, size = theta.shape
    chains = theta.transpose(0, 2, 1, 3).reshape(ensembles * walkers, kept, size)
    posterior = _variables(model, chains)
    prior_terms = np.stack(
        [log_density(p.prior, chains[..., place]) for place, p in enumerate(model.parameters)],
        axis=-1,
    )
    stride = _pointwise_stride(ensembles * walkers, kept)
    shape = (ensembles * walkers, -1)
    setups = np.concatenate([left.setup_log_likelihood for left in left_out.values()], axis=-1)
    trials = np.concatenate([left.trial_log_likelihood for left in left_out.values()], axis=-1)
    # Two rigs may use the same ids: then the rig's name goes before them.
    before = [f"{name}/" if len(rigs) > 1 else "" for name in rigs]
    named = list(zip(before, model.likelihoods, strict=True))
    tree = draws_tree(
        {
            "posterior": posterior,
            "log_prior": _variables(model, prior_terms),
        },
        dims={name: ["pulley"] for name, values in posterior.items() if values.ndim == 3},
        coords={"pulley": _sizes(model)} if _sizes(model) else {},
        ensemble=np.repeat(np.arange(ensembles), walkers),
        attributes=_flat(attributes),
    )
    pointwise = draws_tree(
        {
            "log_likelihood": {
                "setup": setups.reshape(*shape, setups.shape[-1]),
                "trial": trials.reshape(*shape, trials.shape[-1]),
            }
        },
        dims={"setup": ["setup_id"], "trial": ["trial_id"]},
        coords={
            "setup_id": [prefix + setup for prefix, rig in named for setup in rig.setups],
            "trial_id": [prefix + trial for prefix, rig in named for trial in rig.trials["trial"]],
            "draw": np.arange(kept)[::stride],
        },
        ensemble=np.repeat(np.arange(ensembles), walkers),
        attributes={},
    )
    tree["log_likelihood"] = pointwise["log_likelihood"]
    return tree


def _variables(model: Model, values: Array) -> dict[str, Array]:
    """Gather ``c1[small]``, ``c1[medium]``, … of the last axis into ``c1`` over pulleys."""
    columns = dict(zip(model.names, np.moveaxis(values, -1, 0), strict=True))
    sizes = _sizes(model)
    variables: dict[str, Array] = {}
    for name, column in columns.items():
        stem = name.partition("[")[0]
        everywhere = [f"{stem}[{size}]" for size in sizes]
        if sizes and set(everywhere) <= set(columns):
            variables[stem] = np.stack([columns[of_size] for of_size in everywhere], axis=-1)
        else:
            variables[name] = column
    return variables


def _sizes(model: Model) -> list[str]:
    """Return the pulley sizes of all rigs."""
    return list(sizes_of(model.names))


def _flat(attributes: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Flatten provenance for netCDF attributes, which hold no mappings."""
    flat: dict[str, Any] = {}
    for key, value in attributes.items():
        if isinstance(value, Mapping):
            flat |= _flat(value, f"{prefix}{key}.")
        else:
            flat[f"{prefix}{key}"] = "" if value is None else value
    return flat


def _write_csv(tree: xr.DataTree, path: Path) -> None:
    """Write the posterior as a table, one row a draw."""
    posterior = tree["posterior"].to_dataset()
    posterior = posterior.stack(sample=("chain", "draw"))  # noqa: PD013 (not of pandas)
    columns = {}
    for name, variable in posterior.data_vars.items():
        if "pulley" in variable.dims:
            for size in posterior["pulley"].to_numpy():
                columns[f"{name}[{size}]"] = variable.sel(pulley=size).to_numpy()
        else:
            columns[str(name)] = variable.to_numpy()
    index = pd.MultiIndex.from_arrays(
        [posterior["chain"].to_numpy(), posterior["draw"].to_numpy()], names=["chain", "draw"]
    )
    pd.DataFrame(columns, index=index).to_csv(path, lineterminator="\n")
