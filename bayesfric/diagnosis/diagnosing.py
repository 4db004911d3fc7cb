"""A recording to a diagnosis: where it misses, which effect causes it, how far it shrinks."""

import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis, analysis_sha256
from bayesfric.diagnosis.causes import cause_draws, causes_of
from bayesfric.diagnosis.figures import curves_of, gap_figures
from bayesfric.diagnosis.linear_model import Acting, LinearModel
from bayesfric.diagnosis.next_experiment import next_experiment
from bayesfric.diagnosis.reference import amplitudes_of, fitted_laws, reference_laws
from bayesfric.diagnosis.remainder import remainder_of
from bayesfric.diagnosis.shapes import share_of_form, sharpened, sharpened_around, widened_by
from bayesfric.diagnosis.shrink import Arms, measure_gap
from bayesfric.diagnosis.strays import stray_trials
from bayesfric.diagnosis.trajectories import free_running
from bayesfric.diagnosis.verdict import decide, sentence_of, unseparated_of
from bayesfric.diagnosis.weighing import Weighed, weigh
from bayesfric.diagnosis.where import where_it_lies
from bayesfric.diagnosis.which import NONE, PRIOR, UNKNOWN, Which, look_closer, which_effect
from bayesfric.effects import Effect, all_effects, with_priors
from bayesfric.effects.candidates import candidates_of
from bayesfric.errors import Fault, InputError
from bayesfric.paper import table1
from bayesfric.physics.friction import Coefficients
from bayesfric.recording.tables import Recording
from bayesfric.results import json_bytes, provenance, replace_outputs, write_netcdf
from bayesfric.rigs import all_rigs
from bayesfric.rigs.base import RigTrials
from bayesfric.rigs.data import Data
from bayesfric.rigs.gravity_board.measured_motion import MeasuredMotion, measured_motion
from bayesfric.rigs.gravity_board.trials import GravityTrials
from bayesfric.schemas import Absorbed, DiagnosisFile, ExaminedEffect, RecordingId

__all__ = ["Diagnosed", "diagnose"]

Array = NDArray[np.float64]
LN10 = float(np.log(10))
MANY = 0.1  # of the trials, whose sensors disagree, from which on it is the rig's doing
MOSTLY = 0.5  # probability of none, or of an unknown force, that decides
ROUNDS = 2  # of linearising around the law that was fitted with the causes


@dataclass(frozen=True)
class Diagnosed:
    """A diagnosis, ready to be written.

    Parameters
    ----------
    summary : DiagnosisFile
        What ``diagnosis.json`` says.
    curves : DataTree
        What ``diagnosis.nc`` holds: ``residuals``, and where there are any
        ``trajectories`` and ``amplitudes``.
    seconds : float
        Wall time.
    """

    summary: DiagnosisFile
    curves: xr.DataTree
    seconds: float

    def write(self, folder: Path | str) -> None:
        """Write ``diagnosis.json`` and ``diagnosis.nc``.

        Parameters
        ----------
        folder : Path or str
            Created if it is not there; other files in it are left alone.

        Raises
        ------
        InputError
            The folder cannot be written.
        """
        writers: dict[str, Callable[[Path], object]] = {
            "diagnosis.json": lambda path: path.write_bytes(json_bytes(self.summary)),
            "diagnosis.nc": lambda path: write_netcdf(self.curves, path),
        }
        replace_outputs(Path(folder), writers)


def diagnose(
    recording: Recording,
    analysis: Analysis | None = None,
    *,
    fixed: Collection[str] = (),
    effects: Collection[Effect] = (),
    shipped: Mapping[str, Coefficients] | None = None,
) -> Diagnosed:
    """Diagnose the gap between the paper's law and a recording.

    Parameters
    ----------
    recording : Recording
        With a gravity board, a motor board or both; all that there is enters.
    analysis : Analysis or None
        Priors, rules and seed; None for the defaults.
    fixed : collection of str
        Coefficients that are held at their shipped values, as ``c3`` or ``c3[small]``.
    effects : collection of Effect
        Effects of the user's own, examined beside those of :mod:`bayesfric.effects`; one
        of the same name takes the other's place.
    shipped : mapping of str to Coefficients, or None
        The simulator's values as it was shipped, by pulley size; None is Table I.

    Returns
    -------
    Diagnosed
        Verdict, causes, where, and how far it shrinks.

    Raises
    ------
    InputError
        There is neither board, or a fixed coefficient is unknown or has no value.
    """
    began = time.perf_counter()
    analysis = Analysis() if analysis is None else analysis
    with threadpool_limits(limits=1):
        summary, curves = _diagnose(recording, analysis, fixed, effects, shipped)
    return Diagnosed(summary, curves, time.perf_counter() - began)


def _diagnose(
    recording: Recording,
    analysis: Analysis,
    fixed: Collection[str],
    effects: Collection[Effect],
    shipped: Mapping[str, Coefficients] | None,
) -> tuple[DiagnosisFile, xr.DataTree]:
    data = _data(recording)
    share = analysis.diagnosis.practical_share
    if shipped is None:
        shipped = {
            size: Coefficients(row.c1.value, row.c2.value, row.c3.value)
            for size, row in table1().items()
        }
    held = _held(fixed, data, shipped)
    known = all_effects() | {effect.name: effect for effect in effects}
    examined = with_priors(known, analysis.priors.effects)
    measured = _measured(data)
    laws, psi = reference_laws(data, analysis, share, held, shipped, measured)
    stray = stray_trials(data, laws, measured)
    if stray:
        data = _without(data, stray)
        measured = _measured(data)
        laws, psi = reference_laws(data, analysis, share, held, shipped, measured)
    candidates = [one for effect in examined.values() for one in candidates_of(effect)]
    model = LinearModel(data, laws, candidates, analysis, share, held, measured=measured)
    model, _ = sharpened(model, psi)
    which = which_effect(model, psi)
    found = _most_probable(which)
    around = model
    if found.names:
        around = sharpened_around(model, found)
        which = look_closer(around, which, found)
        found = _most_probable(which)
        # What was not weighed again is as it was.
        around = around if found.log_shares.size > 1 else model
    chances = which.probabilities()
    proposals, no_proposal = next_experiment(around, found.psi, chances)
    if found.names:
        model, found = _around_causes(model, around, found)
    fold_rng, gap_rng, where_rng, draw_rng = (
        np.random.default_rng(child) for child in np.random.SeedSequence(analysis.seed).spawn(4)
    )
    arms = _arms(model, found, which, {s: shipped[s] for s in data.sizes if s in shipped})
    figures = measure_gap(arms, fold_rng)
    free = free_running(arms, figures)
    gap, systematic = gap_figures(figures, free, arms, bool(found.names), gap_rng)
    taken = float(np.median(systematic)) if found.names else 0.0
    verdict, chance = decide(chances, systematic, share * gap.friction_rms)
    named = verdict in ("named", "unseparated")
    draws = cause_draws(model, found, draw_rng) if named else {}
    strength = figures.strengths(arms)
    floor = gap.floor.q50 / gap.friction_rms
    causes = causes_of(model, found, which, draws, strength, floor) if named else ()
    where = where_it_lies(arms.model, figures.residuals, figures.before, figures.fold, where_rng)
    attributes = provenance(
        seed=analysis.seed,
        recording=RecordingId(name=recording.name, title=recording.title, sha256=recording.sha256),
        analysis_sha256=analysis_sha256(analysis),
        created=recording.created,
    )
    unseparated = unseparated_of(which, chances, verdict)
    summary = DiagnosisFile(
        **attributes.model_dump(),
        rigs=tuple(one.rig.name for one in data.rigs),
        baseline="paper",
        fixed=tuple(sorted(held)),
        stray_trials=stray,
        practical_share=share,
        verdict=verdict,
        verdict_probability=chance,
        sentence=sentence_of(verdict, chance, causes, gap, where, unseparated),
        probabilities=chances,
        hypothesis_prior=PRIOR,
        prior_sensitivity={
            "0.1": which.probabilities(0.1),
            "0.9": which.probabilities(0.9),
        },
        unvisited_probability=which.unvisited(),
        causes=causes,
        unseparated=unseparated,
        absorbed=tuple(
            Absorbed(effect=one.effect, by=one.by, bias=one.bias, unit=one.unit)
            for one in which.classes.absorbed
        ),
        remainder=remainder_of(model, found, taken / gap.friction_rms),
        where=where,
        gap=gap,
        effects=_examined(which, sorted(examined)),
        next_experiment=proposals,
        next_experiment_why=no_proposal,
    )
    return summary, curves_of(figures, free, draws)


def _data(recording: Recording) -> Data:
    opened = [rig.trials(recording) for rig in all_rigs().values()]
    rigs = tuple(_entering(one, recording) for one in opened if one is not None)
    data = Data(tuple(one for one in rigs if not one.table.empty))
    if not data.rigs:
        raise InputError([Fault(recording.name, "a gravity trial or a motor run to diagnose")])
    return data


def _measured(data: Data) -> MeasuredMotion | None:
    """Return the motion of the trials, which no law changes."""
    return None if data.gravity is None else measured_motion(data.gravity, data.constants)


def _entering(trials: RigTrials, recording: Recording) -> RigTrials:
    """Return the trials that enter by the rules of a fit.

    Where the sensors of many trials disagree, it is no fault of a trial, but of the rig,
    and what the diagnosis is to find: these trials stay.
    """
    if not isinstance(trials, GravityTrials):
        return trials
    excluded = trials.screened.excluded
    disagreeing = [trial for trial, rule in excluded.items() if rule == "sensors-disagree"]
    if len(disagreeing) <= MANY * len(trials.recorded.trials):
        return trials
    whole = trials.rig.trials(recording, exclude=False)
    assert whole is not None
    kept = whole.select(~whole.table["trial"].isin(set(excluded) - set(disagreeing)))
    assert kept is not None
    return kept


def _without(data: Data, trials: Collection[str]) -> Data:
    kept = (one.select(~one.table["trial"].isin(trials)) for one in data.rigs)
    return Data(tuple(one for one in kept if one is not None))


def _held(
    fixed: Collection[str], data: Data, shipped: Mapping[str, Coefficients]
) -> frozenset[str]:
    known = set(Coefficients._fields) | {
        f"{f}[{size}]" for f in Coefficients._fields for size in data.sizes
    }
    faults = [
        Fault("command line", f"one of {', '.join(sorted(known))}", column="--fixed", value=name)
        for name in fixed
        if name not in known
    ]
    for name in fixed:
        sizes = [name.partition("[")[2].rstrip("]")] if "[" in name else list(data.sizes)
        faults += [
            Fault("command line", f"a shipped value of size {size}", column="--fixed", value=name)
            for size in sizes
            if name in known and size not in shipped
        ]
    if faults:
        raise InputError(faults)
    return frozenset(fixed)


def _most_probable(which: Which) -> Weighed:
    """Return the causes: of the most probable named hypothesis, none where none is needed."""
    chances = which.probabilities()
    if chances.get(NONE, 0.0) >= MOSTLY or chances.get(UNKNOWN, 0.0) >= MOSTLY:
        return which.weighed[NONE]
    named = [name for name in which.weighed if name in chances and name != NONE]
    return which.weighed[max(named, key=lambda name: chances[name])]


def _around_causes(
    model: LinearModel, around: LinearModel, found: Weighed
) -> tuple[LinearModel, Weighed]:
    """Linearise around the law that was fitted with the causes, and weigh them again.

    The discrepancy grows by what their laws are wrong by, as far as the data tell.
    """
    wrong = share_of_form(found)
    for _ in range(ROUNDS):
        laws = fitted_laws(around, found.psi, found.best)
        own = [c for c in around.candidates if c.effect.name in found.names]
        around = model.around(
            laws,
            own,
            scattering=amplitudes_of(around, found.psi, found.best),
            widened=widened_by(wrong, model, around, found),
        )
        found = weigh(around, found.names, found.psi)
    return around, found


def _arms(
    model: LinearModel,
    found: Weighed,
    which: Which,
    shipped: Mapping[str, Coefficients],
) -> Arms:
    acting = (*found.best.columns, *found.best.phases)
    chosen = [model.candidates[place] for place in acting]
    caused = model.around(model.laws, chosen, discrepancy=False)
    columns = len(found.best.columns)
    after = Acting(tuple(range(columns)), tuple(range(columns, len(chosen))))
    complete = set(shipped) == set(model.layout.sizes)
    # What scatters is known best where all that is systematic has been taken up.
    unknown = which.probabilities().get(UNKNOWN, 0.0) >= MOSTLY
    settled = which.unknown.psi if unknown and which.unknown is not None else found.psi
    known = model.around(model.laws, chosen)
    return Arms(caused, known, settled, after, shipped if complete else None)


def _examined(which: Which, names: list[str]) -> tuple[ExaminedEffect, ...]:
    absorbed = {one.effect for one in which.classes.absorbed}
    found = []
    for name in names:
        stands = which.representative.get(name)
        value, why = None, which.classes.left_out.get(name)
        if name in absorbed:
            why = "it only moves a parameter of the baseline"
        elif stands is not None:
            value = (which.log_evidence[stands] - which.log_evidence[NONE]) / LN10
        found.append(
            ExaminedEffect(effect=name, log10_bayes_factor=value, log10_bayes_factor_why=why)
        )
    return tuple(found)
