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

from bayesfric.analysis import Analysis, analysis_sha256
from bayesfric.checkpoint import Checkpoint
from bayesfric.errors import Fault, InputError
from bayesfric.fitting.predictive import predict
from bayesfric.fitting.predictive.left_out import LeftOut, leave_out
from bayesfric.fitting.predictive.reported import predictions, uniformities
from bayesfric.fitting.summary import summarise, summarise_without_exclusions
from bayesfric.inference.diagnostics import diagnose_all
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.model import Model, RigLikelihood
from bayesfric.inference.priors import log_density
from bayesfric.inference.sampling import Chart, Draws, Progress, sample
from bayesfric.physics.laws import BASELINES, Baseline
from bayesfric.recording.tables import Recording
from bayesfric.results import (
    draws_tree,
    json_bytes,
    provenance,
    replace_outputs,
    write_netcdf,
)
from bayesfric.rigs.gravity_board.likelihood import GravityLikelihood
from bayesfric.rigs.gravity_board.screening import Screened, screen_trials
from bayesfric.rigs.motor_board.likelihood import MotorLikelihood
from bayesfric.schemas import FitFile, RecordingId, TimingsFile

__all__ = ["Fit", "fit"]

Array = NDArray[np.float64]
RIGS = ("gravity", "motor")
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
    rigs: Sequence[str] | None = None,
    baseline: str = "paper",
) -> Fit:
    """Draw from the posterior of the paper's law given a recording.

    Parameters
    ----------
    recording : Recording
        With gravity trials, motor runs or both.
    analysis : Analysis or None
        Priors, scatter, sampler and seed; None for the defaults.
    progress : callable or None
        Called with the sampler's steps done and steps in all.
    checkpoint : Path or None
        Folder that keeps the draws on the way: a fit that is killed and called
        again goes on to the same result. Remove it when the fit is written.
    rigs : sequence of str or None
        Whose data enter: ``gravity``, ``motor`` or both. None is the gravity board
        where there is one, else the motor board.
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
    chosen = _choose(recording, rigs)
    if baseline not in BASELINES:
        raise InputError([Fault("baseline", f"one of {', '.join(BASELINES)}", value=baseline)])
    law = BASELINES[baseline]
    attributes = provenance(
        seed=analysis.seed,
        recording=RecordingId(name=recording.name, title=recording.title, sha256=recording.sha256),
        analysis_sha256=analysis_sha256(analysis),
        created=recording.created,
    )
    seconds: dict[str, float] = {}
    with threadpool_limits(limits=1):  # one BLAS thread: the same bytes, and faster
        with _timed(seconds, "reduce"):
            screened = None
            if "gravity" in chosen and recording.gravity is not None:
                screened = screen_trials(recording.gravity, recording.rig)
                if screened.gravity.trials.empty:
                    expected = "a trial that enters the fit; all are left out"
                    raise InputError([Fault(recording.name, expected)])
            likelihoods = _likelihoods(recording, chosen, screened, analysis, law)
            model = Model(list(likelihoods.values()))
        key = ",".join([*chosen, baseline]) + attributes.model_dump_json()
        draws = _draw(model, analysis, Checkpoint(checkpoint, key), progress, seconds)
        with _timed(seconds, "without_exclusions"):
            whole, why = _all_that_can_enter(recording, screened)
            without = None
            if whole is not None:
                again = Model(list(_likelihoods(recording, chosen, whole, analysis, law).values()))
                folder = None if checkpoint is None else checkpoint / "without-exclusions"
                without = summarise_without_exclusions(
                    len(whole.gravity.trials),
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
                for name, rig in likelihoods.items()
            }
        with _timed(seconds, "summary"):
            fields = {
                "rigs": chosen,
                "baseline": baseline,
                "without_exclusions": without,
                "without_exclusions_why": why,
                "prediction": predictions(left_out),
                "uniformity": uniformities(left_out),
            }
            summary = summarise(
                attributes.model_dump() | fields, recording, screened, model, draws, theta
            )
            tree = _draws_tree(
                model, likelihoods, theta, left_out, attributes.model_dump(mode="json")
            )
        with _timed(seconds, "predictive"):
            predictive = predict(
                recording, screened, likelihoods, model, theta, left_out, analysis, law
            )
    return Fit(summary, tree, predictive, seconds)


def _choose(recording: Recording, rigs: Sequence[str] | None) -> tuple[str, ...]:
    """Return the rigs to fit, in the order of :data:`RIGS`."""
    there = [rig for rig in RIGS if getattr(recording, rig) is not None]
    if rigs is None:
        if not there:
            expected = "gravity_trials.csv or motor_runs.csv, the kinds that can be fitted"
            raise InputError([Fault(recording.name, expected)])
        return (there[0],)
    unknown = [Fault("rigs", f"one of {', '.join(RIGS)}", value=r) for r in rigs if r not in RIGS]
    absent = [
        Fault(recording.name, f"data of the rig {rig!r}, which was asked for")
        for rig in rigs
        if rig in RIGS and rig not in there
    ]
    if unknown or absent or not rigs:
        raise InputError([*unknown, *absent] or [Fault("rigs", f"one of {', '.join(RIGS)}")])
    return tuple(rig for rig in RIGS if rig in rigs)


def _likelihoods(
    recording: Recording,
    chosen: Sequence[str],
    screened: Screened | None,
    analysis: Analysis,
    law: Baseline,
) -> dict[str, RigLikelihood]:
    """Return the likelihood of each rig that is fitted."""
    likelihoods: dict[str, RigLikelihood] = {}
    if screened is not None:
        gravity = GravityLikelihood(screened.gravity, recording.rig, analysis, law)
        likelihoods["gravity"] = gravity
    if "motor" in chosen and recording.motor is not None:
        likelihoods["motor"] = MotorLikelihood(recording.motor, recording.rig, analysis, law)
    return likelihoods


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
            chart=Chart(model.linear, model.from_linear, model.linear_log_slope),
        )


def _all_that_can_enter(
    recording: Recording, screened: Screened | None
) -> tuple[Screened | None, str | None]:
    """Return the trials with those that a rule left out, or why there are no others."""
    if screened is None or recording.gravity is None:
        return None, "the gravity board, whose trials the rules are for, does not enter"
    if not screened.excluded:
        return None, "no trial was left out"
    whole = screen_trials(recording.gravity, recording.rig, exclude=False)
    if len(whole.gravity.trials) == len(screened.gravity.trials):
        return None, "no trial that was left out has a motion that can be computed"
    return whole, None


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
    likelihoods: Mapping[str, RigLikelihood],
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
    before = {name: f"{name}/" if len(likelihoods) > 1 else "" for name in likelihoods}
    tree = draws_tree(
        {
            "posterior": posterior,
            "log_prior": _variables(model, prior_terms),
        },
        dims={name: ["pulley"] for name, values in posterior.items() if values.ndim == 3},
        coords={"pulley": _sizes(model)},
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
            "setup_id": [before[n] + s for n, rig in likelihoods.items() for s in rig.setups],
            "trial_id": [
                before[n] + t for n, rig in likelihoods.items() for t in rig.trials["trial"]
            ],
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
        if set(everywhere) <= set(columns):
            variables[stem] = np.stack([columns[of_size] for of_size in everywhere], axis=-1)
        else:
            variables[name] = column
    return variables


def _sizes(model: Model) -> list[str]:
    """Return the pulley sizes of all rigs."""
    return [name[3:-1] for name in model.names if name.startswith("c1[")]


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
