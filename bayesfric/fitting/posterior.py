"""Fits a recording: posterior, predictions and diagnostics."""

import time
from collections.abc import Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.chains import in_chains
from bayesfric.checkpoint import Checkpoint
from bayesfric.effects import all_effects, with_priors
from bayesfric.fitting.drawing import draw_posterior
from bayesfric.fitting.inference_data import Stored, draws_of_fit
from bayesfric.fitting.joints import fit_joints
from bayesfric.fitting.predictive import covered, predict
from bayesfric.fitting.predictive.assemblies import Assemblies, assemblies_of
from bayesfric.fitting.predictive.left_out import LeftOut, leave_out
from bayesfric.fitting.predictive.reported import assembly_checks, predictions, uniformities
from bayesfric.fitting.result import Fit
from bayesfric.fitting.summary import summarise, summarise_without_exclusions
from bayesfric.inference.model import Model
from bayesfric.inference.sampling import Draws, Progress
from bayesfric.physics.laws import FrictionLaw
from bayesfric.recording.joints import parted_by_joint
from bayesfric.recording.tables import Recording
from bayesfric.results import identified, provenance_of
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import baseline_of, chosen_rigs, open_rigs, with_own_priors
from bayesfric.schemas.fit import WithoutExclusions
from bayesfric.schemas.parameter import ParameterSummary

AXES = ("n_pulleys", "wrap_angle_deg")


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
        Contains trials of at least one rig that can be fitted; trials of role ``test`` are
        not used.
    analysis : Analysis or None
        Priors, scatter, sampler and seed; None for the defaults.
    progress : callable or None
        Called with the sampler's steps done and steps in all.
    checkpoint : Path or None
        Folder that stores draws during the run: an interrupted fit that is called again
        continues to the same result. Remove it after the fit is written.
    rigs : sequence of str or None
        Names of the rigs whose data are used (:func:`bayesfric.rigs.all_rigs`). None is the
        first rig of the recording.
    baseline : str
        The friction law, a name in :data:`bayesfric.physics.laws.BASELINES`.

    Returns
    -------
    Fit
        Posterior, predictions and diagnostics.

    Raises
    ------
    InputError
        A rig is unknown or has no data in the recording, or no trial can be used.
    """
    analysis = Analysis() if analysis is None else analysis
    with_priors(all_effects(None), analysis.priors.effects)  # refuses unknown names
    if parted := parted_by_joint(recording):

        def of_joint(own: Recording, kept: Path | None) -> Fit:
            return fit(
                own, analysis, progress=progress, checkpoint=kept, rigs=rigs, baseline=baseline
            )

        return fit_joints(parted, of_joint, checkpoint)
    chosen = chosen_rigs(recording, rigs)
    with threadpool_limits(limits=1):  # one BLAS thread: the same bytes, and faster
        return _fit_rigs(recording, chosen, baseline, analysis, progress, checkpoint)


def _fit_rigs(
    recording: Recording,
    rigs: Sequence[str],
    baseline: str,
    analysis: Analysis,
    progress: Progress | None,
    checkpoint: Path | None,
) -> Fit:
    """Fit one law to the data of rigs, stage by stage."""
    seconds: dict[str, float] = {}
    with _timed(seconds, "reduce"):
        data, law, analysis = opened(recording, analysis, rigs, baseline)
        model = model_of_law(data, analysis, law)
    # The analysis includes the rigs' priors, so that the file contains all priors that were used.
    attributes = provenance_of(recording, analysis)
    joint = None if recording.axis is None else recording.axis.joint
    key = ",".join([*rigs, baseline, str(joint)]) + attributes.model_dump_json()
    with _timed(seconds, "draws"):
        draws = draw_posterior(
            model, analysis, progress, Checkpoint(checkpoint, key), recording=recording.name
        )

    def fit_again(other: Data | None, folder: str) -> WithoutExclusions | None:
        kept = Checkpoint(None if checkpoint is None else checkpoint / folder, key)
        return None if other is None else _fit_again(other, analysis, law, kept, progress)

    fields: dict[str, Any] = {"rigs": rigs, "baseline": law.name}
    with _timed(seconds, "without_exclusions"):
        whole, fields["without_exclusions_why"] = _all_that_can_enter(recording, data)
        fields["without_exclusions"] = fit_again(whole, "without-exclusions")
    with _timed(seconds, "without_stalls"):
        moved, fields["without_stalls_why"] = _all_that_moved(data)
        fields["without_stalls"] = fit_again(moved, "without-stalls")
    theta = model.natural(draws.z)
    rng = np.random.default_rng(np.random.SeedSequence([analysis.seed, 5]))
    with _timed(seconds, "leave_out"):
        trials = sum(len(likelihood.trials) for likelihood in model.likelihoods)
        stored = Stored.of(draws.z, theta, draws.log_density, trials)
        left_out, assemblies = _leave_each_out(model, rigs, draws, stored.flat, analysis.seed, rng)
    with _timed(seconds, "predictive"):
        predictive = predict(data, model, theta, left_out, assemblies, analysis, law)
    with _timed(seconds, "summary"):
        fields["prediction"] = predictions(left_out)
        fields["uniformity"] = uniformities(left_out)
        fields["assemblies"] = assembly_checks(assemblies)
        summary = summarise(
            attributes.model_dump() | fields, recording, analysis, data, model, draws, theta,
            in_chains(stored.theta, stored.ensembles), covered(predictive),
        )  # fmt: skip
    with _timed(seconds, "inference_data"):
        origin = attributes.model_dump(mode="json", exclude={"analysis", "run_id"})
        origin |= tested_conditions(data, summary.pulleys)
        observed = _measured_friction(data, predictive)
        tree = draws_of_fit(model, observed, stored, left_out, rng, origin)
    return Fit(identified(summary), tree, predictive, seconds)


def _fit_again(
    other: Data, analysis: Analysis, law: FrictionLaw, kept: Checkpoint, progress: Progress | None
) -> WithoutExclusions:
    """Return the coefficients from other trials of the same recording."""
    model = model_of_law(other, analysis, law)
    draws = draw_posterior(model, analysis, progress, kept)
    return summarise_without_exclusions(_under_rules(other), model, draws)


def _leave_each_out(
    model: Model,
    rigs: Sequence[str],
    draws: Draws,
    stored: Array,
    seed: int,
    rng: np.random.Generator,
) -> tuple[dict[str, LeftOut], dict[str, Assemblies | None]]:
    """Return by rig the leave-one-out predictions of trials and of assemblies."""
    start = draws.z.reshape(-1, draws.z.shape[-1])[np.argmax(draws.log_density)]
    by_rig = dict(zip(rigs, model.likelihoods, strict=True))
    left_out = {
        name: leave_out(model, likelihood, stored, start, seed, rng)
        for name, likelihood in by_rig.items()
    }
    assemblies = {
        name: assemblies_of(left_out[name], likelihood.setups, seed)
        for name, likelihood in by_rig.items()
    }
    return left_out, assemblies


def _measured_friction(data: Data, predictive: xr.DataTree) -> dict[str, Array]:
    """Return the measured friction of trials by rig, shape (N,) [N]."""
    return {
        trials.rig.name: predictive[trials.rig.words.trials]["friction_n"].to_numpy()
        for trials in data.rigs
    }


def opened(
    recording: Recording, analysis: Analysis, rigs: Sequence[str], baseline: str
) -> tuple[Data, FrictionLaw, Analysis]:
    """Return the data of a fit, its law, and the analysis with the rigs' own priors.

    Parameters and errors are those of :func:`fit`.
    """
    data = Data(open_rigs(recording, rigs))
    return data, baseline_of(baseline, data.rigs), with_own_priors(analysis, data.rigs)


def model_of_law(data: Data, analysis: Analysis, law: FrictionLaw) -> Model:
    """Return the posterior of a law without effects."""
    return Model([trials.likelihood(analysis, law) for trials in data.rigs])


def _all_that_can_enter(recording: Recording, data: Data) -> tuple[Data | None, str | None]:
    """Return all trials, including excluded ones, or why there are no excluded ones."""
    ruled = [trials for trials in data.rigs if trials.excluded is not None]
    if not ruled:
        return None, "these rigs have no rule that excludes trials"
    if not any(trials.excluded for trials in ruled):
        return None, "no trial was left out"
    whole = Data(open_rigs(recording, [trials.rig.name for trials in data.rigs], exclude=False))
    if _under_rules(whole) == _under_rules(data):
        return None, "no trial that was left out has a motion that can be computed"
    return whole, None


def _all_that_moved(data: Data) -> tuple[Data | None, str | None]:
    """Return the trials that moved to the end, or why there are no others."""
    moved = [trials.moved() for trials in data.rigs]
    if not any(moved):
        return None, "all trials that are used moved to the end, or none did"
    kept = zip(moved, data.rigs, strict=True)
    return Data(tuple(moving if moving is not None else whole for moving, whole in kept)), None


def _under_rules(data: Data) -> int:
    """Return the number of used trials of rigs with exclusion rules."""
    return sum(len(trials.table) for trials in data.rigs if trials.excluded is not None)


@contextmanager
def _timed(seconds: dict[str, float], stage: str) -> Any:
    start = time.perf_counter()
    yield
    seconds[stage] = time.perf_counter() - start


def tested_conditions(
    data: Data, pulleys: Mapping[str, Mapping[str, ParameterSummary]]
) -> dict[str, list[float] | str]:
    """Return attributes of ``draws.nc``: the conditions behind its coefficients.

    Parameters
    ----------
    data : Data
        The trials that were used.
    pulleys : mapping
        Summaries by size and coefficient, as in ``fit.json``.

    Returns
    -------
    dict
        ``tested.<size>.<axis>``: least and largest number of pulleys, wrap angle [deg] and,
        if a rig holds the cable at rest, nominal tension [N]; ``informed.<size>``: the
        coefficients that the recording informs, separated by spaces.
    """
    seen: dict[str, list[float]] = {}
    for trials in data.rigs:
        table = trials.table
        if not set(AXES) <= set(table.columns):
            continue
        resting = trials.resting(table)
        columns = {axis: table[axis].to_numpy(float) for axis in AXES}
        if resting is not None:
            columns["tension_n"] = np.asarray(resting.tension_n, dtype=np.float64)
        for size in sorted(set(table["pulley_size"])):
            at_size = (table["pulley_size"] == size).to_numpy()
            for axis, values in columns.items():
                seen.setdefault(f"tested.{size}.{axis}", []).extend(values[at_size])
    ranges: dict[str, list[float] | str] = {
        key: [float(min(values)), float(max(values))] for key, values in seen.items()
    }
    return ranges | {
        f"informed.{size}": " ".join(name for name, entry in entries.items() if entry.informed)
        for size, entries in pulleys.items()
    }
