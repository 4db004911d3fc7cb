"""A recording and an analysis become a stored fit: posteriors and diagnostics."""

import time
from collections.abc import Callable, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis, analysis_sha256
from bayesfric.checkpoint import Checkpoint
from bayesfric.errors import Fault, InputError
from bayesfric.laplace import laplace_approximation
from bayesfric.likelihood.gravity import GravityLikelihood
from bayesfric.likelihood.model import Model
from bayesfric.likelihood.screening import screen_trials
from bayesfric.predictive import predict
from bayesfric.priors import log_density
from bayesfric.recording.tables import Recording
from bayesfric.results import (
    draws_tree,
    json_bytes,
    provenance,
    replace_outputs,
    write_netcdf,
)
from bayesfric.sampling import Progress, sample
from bayesfric.schemas import FitFile, RecordingId, TimingsFile
from bayesfric.summary import summarise

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
        What ``predictive.nc`` holds, see :mod:`bayesfric.predictive`.
    seconds : dict of str to float
        Wall time by stage.
    """

    summary: FitFile
    draws: xr.DataTree
    predictive: xr.DataTree
    seconds: Mapping[str, float]

    def write(self, folder: Path | str, *, csv: bool = False) -> None:
        """Write ``fit.json``, ``draws.nc``, ``predictive.nc`` and ``timings.json``.

        Parameters
        ----------
        folder : Path or str
            Created if it is not there; other files in it are left alone.
        csv : bool
            Also write the posterior as ``draws.csv``.

        Raises
        ------
        InputError
            The folder cannot be written.
        """
        timings = TimingsFile(seconds=dict(self.seconds))
        writers: dict[str, Callable[[Path], object]] = {
            "fit.json": lambda path: path.write_bytes(json_bytes(self.summary)),
            "draws.nc": lambda path: write_netcdf(self.draws, path),
            "predictive.nc": lambda path: write_netcdf(self.predictive, path),
            "timings.json": lambda path: path.write_bytes(json_bytes(timings)),
        }
        if csv:
            writers["draws.csv"] = lambda path: _write_csv(self.draws, path)
        replace_outputs(Path(folder), writers)


def fit(
    recording: Recording,
    analysis: Analysis | None = None,
    *,
    progress: Progress | None = None,
    checkpoint: Path | None = None,
) -> Fit:
    """Draw from the posterior of the paper's law given a recording.

    Parameters
    ----------
    recording : Recording
        With gravity trials; other kinds are not used.
    analysis : Analysis or None
        Priors, scatter, sampler and seed; None for the defaults.
    progress : callable or None
        Called with the sampler's steps done and steps in all.
    checkpoint : Path or None
        Folder that keeps the draws on the way: a fit that is killed and called
        again goes on to the same result. Remove it when the fit is written.

    Returns
    -------
    Fit
        Posterior, predictions and diagnostics.

    Raises
    ------
    InputError
        The recording has no gravity trials that could enter.
    """
    analysis = Analysis() if analysis is None else analysis
    if recording.gravity is None:
        raise InputError([Fault(recording.name, "gravity_trials.csv, the only kind fitted yet")])
    attributes = provenance(
        seed=analysis.seed,
        recording=RecordingId(name=recording.name, title=recording.title, sha256=recording.sha256),
        analysis_sha256=analysis_sha256(analysis),
        created=recording.created,
    )
    seconds: dict[str, float] = {}
    with threadpool_limits(limits=1):  # one BLAS thread: the same bytes, and faster
        with _timed(seconds, "reduce"):
            screened = screen_trials(recording.gravity, recording.rig)
            if screened.gravity.trials.empty:
                raise InputError(
                    [Fault(recording.name, "a trial that enters the fit; all stalled")]
                )
            likelihood = GravityLikelihood(screened.gravity, recording.rig, analysis)
            model = Model([likelihood])
        with _timed(seconds, "laplace"):
            laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
        with _timed(seconds, "draws"):
            draws = sample(
                model.log_posterior,
                laplace,
                analysis.sampler,
                analysis.seed,
                progress,
                Checkpoint(checkpoint, attributes.model_dump_json()),
            )
        with _timed(seconds, "summary"):
            theta = model.natural(draws.z)
            summary = summarise(
                attributes.model_dump(), recording, screened, model, draws, theta, analysis
            )
            tree = _draws_tree(model, likelihood, theta, attributes.model_dump(mode="json"))
        with _timed(seconds, "predictive"):
            predictive = predict(
                likelihood, screened.gravity, recording.rig, model, theta, analysis
            )
    return Fit(summary, tree, predictive, seconds)


@contextmanager
def _timed(seconds: dict[str, float], stage: str) -> Any:
    start = time.perf_counter()
    yield
    seconds[stage] = time.perf_counter() - start


def _draws_tree(
    model: Model, likelihood: GravityLikelihood, theta: Array, attributes: dict[str, Any]
) -> xr.DataTree:
    ensembles, kept, walkers, size = theta.shape
    chains = theta.transpose(0, 2, 1, 3).reshape(ensembles * walkers, kept, size)
    posterior = _variables(model, chains)
    prior_terms = np.stack(
        [log_density(p.prior, chains[..., place]) for place, p in enumerate(model.parameters)],
        axis=-1,
    )
    stride = max(1, -(-chains.shape[0] * kept // POINTWISE_DRAWS))
    some = chains[:, ::stride]
    named = model.by_name(some.reshape(-1, size))
    shape = some.shape[:2]
    pointwise = {
        "setup": likelihood.setup_log_likelihood(named).reshape(*shape, -1),
        "trial": likelihood.trial_log_likelihood(named).reshape(*shape, -1),
    }
    tree = draws_tree(
        {
            "posterior": posterior,
            "log_prior": _variables(model, prior_terms),
        },
        dims={name: ["pulley"] for name, values in posterior.items() if values.ndim == 3},
        coords={"pulley": list(likelihood.sizes)},
        ensemble=np.repeat(np.arange(ensembles), walkers),
        attributes=_flat(attributes),
    )
    likelihoods = draws_tree(
        {"log_likelihood": pointwise},
        dims={"setup": ["setup_id"], "trial": ["trial_id"]},
        coords={
            "setup_id": list(likelihood.setups),
            "trial_id": likelihood.trials["trial"].tolist(),
            "draw": np.arange(kept)[::stride],
        },
        ensemble=np.repeat(np.arange(ensembles), walkers),
        attributes={},
    )
    tree["log_likelihood"] = likelihoods["log_likelihood"]
    return tree


def _variables(model: Model, values: Array) -> dict[str, Array]:
    """Gather ``c1[small]``, ``c1[medium]``, … of the last axis into ``c1`` over pulleys."""
    variables: dict[str, list[Array]] = {}
    for place, name in enumerate(model.names):
        variables.setdefault(name.partition("[")[0], []).append(values[..., place])
    grouped = {name.partition("[")[0] for name in model.names if "[" in name}
    return {
        name: np.stack(columns, axis=-1) if name in grouped else columns[0]
        for name, columns in variables.items()
    }


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
