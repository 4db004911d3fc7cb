"""A recording and an analysis become a stored fit: posteriors and diagnostics."""

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis
from bayesfric.checkpoint import Checkpoint
from bayesfric.fitting.drawing import draw_posterior
from bayesfric.fitting.inference_data import Stored, draws_of_fit, write_csv
from bayesfric.fitting.joints import fitted_together
from bayesfric.fitting.predictive import covered, predict
from bayesfric.fitting.predictive.assemblies import assemblies_of
from bayesfric.fitting.predictive.left_out import leave_out
from bayesfric.fitting.predictive.reported import assembly_checks, predictions, uniformities
from bayesfric.fitting.summary import summarise, summarise_without_exclusions
from bayesfric.fitting.tested import tested_conditions
from bayesfric.inference.model import Model
from bayesfric.inference.sampling import Progress
from bayesfric.physics.laws import FrictionLaw
from bayesfric.recording.joints import parted_by_joint
from bayesfric.recording.tables import Recording
from bayesfric.results import (
    identified,
    json_bytes,
    provenance,
    replace_outputs,
    write_netcdf,
)
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import baseline_of, chosen_rigs, open_rigs, with_own_priors
from bayesfric.schemas import FitFile, RecordingId, TimingsFile

__all__ = ["Fit", "fit", "model_of_law", "opened"]


@dataclass(frozen=True)
class Fit:
    """The posterior of a recording, ready to be written.

    Parameters
    ----------
    summary : FitFile
        What ``fit.json`` says.
    draws : DataTree
        What ``draws.nc`` holds, see :mod:`bayesfric.fitting.inference_data`.
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
            writers["draws.csv"] = lambda path: write_csv(self.draws, path)
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
    if parted := parted_by_joint(recording):

        def of_joint(own: Recording, kept: Path | None) -> Fit:
            return fit(
                own, analysis, progress=progress, checkpoint=kept, rigs=rigs, baseline=baseline
            )

        return fitted_together(parted, of_joint, checkpoint)
    chosen = chosen_rigs(recording, rigs)
    seconds: dict[str, float] = {}
    with threadpool_limits(limits=1):  # one BLAS thread: the same bytes, and faster
        with _timed(seconds, "reduce"):
            data, law, analysis = opened(recording, analysis, chosen, baseline)
            model = model_of_law(data, analysis, law)
        # With the rigs' own priors, so that what is stored says all that was used.
        attributes = provenance(
            recording=RecordingId(
                name=recording.name, title=recording.title, sha256=recording.sha256
            ),
            analysis=analysis,
            created=recording.created,
        )
        machine = None if recording.axis is None else (recording.axis.joint, recording.rig)
        key = ",".join([*chosen, baseline, str(machine)]) + attributes.model_dump_json()
        with _timed(seconds, "draws"):
            draws = draw_posterior(
                model, analysis, progress, Checkpoint(checkpoint, key), recording=recording.name
            )
        with _timed(seconds, "without_exclusions"):
            whole, why = _all_that_can_enter(recording, data)
            without = None
            if whole is not None:
                again = model_of_law(whole, analysis, law)
                folder = None if checkpoint is None else checkpoint / "without-exclusions"
                without = summarise_without_exclusions(
                    _under_rules(whole),
                    again,
                    draw_posterior(again, analysis, progress, Checkpoint(folder, key)),
                )
        with _timed(seconds, "without_stalls"):
            moved, why_moved = _all_that_moved(data)
            without_stalls = None
            if moved is not None:
                again = model_of_law(moved, analysis, law)
                folder = None if checkpoint is None else checkpoint / "without-stalls"
                without_stalls = summarise_without_exclusions(
                    _under_rules(moved),
                    again,
                    draw_posterior(again, analysis, progress, Checkpoint(folder, key)),
                )
        theta = model.natural(draws.z)
        with _timed(seconds, "leave_out"):
            trials = sum(len(rig.trials) for rig in model.likelihoods)
            stored = Stored.of(draws.z, theta, draws.log_density, trials)
            rng = np.random.default_rng(np.random.SeedSequence([analysis.seed, 5]))
            start = draws.z.reshape(-1, draws.z.shape[-1])[np.argmax(draws.log_density)]
            left_out = {
                name: leave_out(model, rig, stored.flat, start, analysis.seed, rng)
                for name, rig in zip(chosen, model.likelihoods, strict=True)
            }
            assemblies = {
                name: assemblies_of(left_out[name], rig.setups, analysis.seed)
                for name, rig in zip(chosen, model.likelihoods, strict=True)
            }
        with _timed(seconds, "predictive"):
            predictive = predict(data, model, theta, left_out, assemblies, analysis, law)
        with _timed(seconds, "summary"):
            fields = {
                "rigs": chosen,
                "baseline": law.name,
                "without_exclusions": without,
                "without_exclusions_why": why,
                "without_stalls": without_stalls,
                "without_stalls_why": why_moved,
                "prediction": predictions(left_out),
                "uniformity": uniformities(left_out),
                "assemblies": assembly_checks(assemblies),
            }
            summary = summarise(
                attributes.model_dump() | fields,
                recording,
                data,
                model,
                draws,
                theta,
                covered(predictive),
            )
        with _timed(seconds, "inference_data"):
            observed = {
                trials.rig.name: predictive[trials.rig.words.trials]["friction_n"].to_numpy()
                for trials in data.rigs
            }
            origin = attributes.model_dump(mode="json", exclude={"analysis", "run_id"})
            origin |= tested_conditions(data, summary.pulleys)
            tree = draws_of_fit(model, observed, stored, left_out, rng, origin)
    return Fit(identified(summary), tree, predictive, seconds)


def opened(
    recording: Recording, analysis: Analysis, rigs: Sequence[str], baseline: str
) -> tuple[Data, FrictionLaw, Analysis]:
    """Return what enters a fit, its law, and the analysis with the rigs' own priors.

    Parameters and errors are those of :func:`fit`.
    """
    data = Data(open_rigs(recording, rigs))
    return data, baseline_of(baseline, data.rigs), with_own_priors(analysis, data.rigs)


def model_of_law(data: Data, analysis: Analysis, law: FrictionLaw) -> Model:
    """Return the posterior of a law that nothing acts beside."""
    return Model([trials.likelihood(analysis, law) for trials in data.rigs])


def _all_that_can_enter(recording: Recording, data: Data) -> tuple[Data | None, str | None]:
    """Return the trials with those that a rule left out, or why there are no others."""
    ruled = [trials for trials in data.rigs if trials.excluded is not None]
    if not ruled:
        return None, "no rule keeps a trial of these rigs from entering"
    if not any(trials.excluded for trials in ruled):
        return None, "no trial was left out"
    whole = Data(open_rigs(recording, [trials.rig.name for trials in data.rigs], exclude=False))
    if _under_rules(whole) == _under_rules(data):
        return None, "no trial that was left out has a motion that can be computed"
    return whole, None


def _all_that_moved(data: Data) -> tuple[Data | None, str | None]:
    """Return the trials that moved all the way, or why there are no others."""
    moved = [trials.moved() for trials in data.rigs]
    if not any(moved):
        return None, "all trials that enter moved all the way, or none did"
    kept = zip(moved, data.rigs, strict=True)
    return Data(tuple(moving if moving is not None else whole for moving, whole in kept)), None


def _under_rules(data: Data) -> int:
    """Return how many trials enter of the rigs that have rules."""
    return sum(len(trials.table) for trials in data.rigs if trials.excluded is not None)


@contextmanager
def _timed(seconds: dict[str, float], stage: str) -> Any:
    start = time.perf_counter()
    yield
    seconds[stage] = time.perf_counter() - start
