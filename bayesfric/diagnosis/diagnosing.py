"""Diagnoses a recording: where the law misses, which effect causes it, how far it shrinks."""

import time
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis
from bayesfric.attention.diagnosis import of_diagnosis
from bayesfric.checkpoint import Checkpoint
from bayesfric.diagnosis.answer import Answer, file_of, reported_causes, reported_law
from bayesfric.diagnosis.beyond import too_tight, with_wider_priors
from bayesfric.diagnosis.checking import checked_diagnosis
from bayesfric.diagnosis.compared import Compared, compare_hypotheses
from bayesfric.diagnosis.concluded import conclude
from bayesfric.diagnosis.diagnosed import Diagnosed
from bayesfric.diagnosis.held_out_density import least_needed_cause
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.joints import diagnose_joints
from bayesfric.diagnosis.judging import Judged, judge
from bayesfric.diagnosis.measured import measure
from bayesfric.diagnosis.other_joints import model_error_words
from bayesfric.diagnosis.question import Question, question_of
from bayesfric.diagnosis.shipped import Shipped
from bayesfric.diagnosis.stored import curves_of
from bayesfric.diagnosis.where import where_it_lies
from bayesfric.effects import Effect
from bayesfric.recording.joints import parted_by_joint
from bayesfric.recording.tables import Recording
from bayesfric.results import identified, provenance_of
from bayesfric.rigs.model_amounts import ModelAmounts
from bayesfric.schemas import DiagnosisFile
from bayesfric.simulators import Simulator, SimulatorCalls


class _Asked(NamedTuple):
    """Parameters of :func:`diagnose` that hold for each part of a recording."""

    analysis: Analysis
    fixed: Collection[str]
    effects: Collection[Effect]
    shipped: Shipped | None
    baseline: str
    calls: Callable[[], SimulatorCalls] | None
    target: pd.DataFrame | None


def diagnose(
    recording: Recording,
    analysis: Analysis | None = None,
    *,
    fixed: Collection[str] = (),
    effects: Collection[Effect] = (),
    shipped: Shipped | None = None,
    baseline: str = "paper",
    simulator: Simulator | str | None = None,
    target: pd.DataFrame | None = None,
    executor: Executor | None = None,
    announce: Callable[[str], None] | None = None,
    checkpoint: Path | None = None,
) -> Diagnosed:
    """Diagnose the gap between a friction law and a recording.

    Parameters
    ----------
    recording : Recording
        All trials of all its rigs are used.
    analysis : Analysis or None
        Priors, rules and seed; None for the defaults.
    fixed : collection of str
        Numbers that are fixed at their shipped values, such as ``c3``, ``c3[small]`` or ``mass``.
    effects : collection of Effect
        The user's effects, in addition to :mod:`bayesfric.effects`; an equal name replaces.
    shipped : mapping of str to Coefficients or to float, or None
        Values in the shipped simulator: laws by pulley size, or numbers by their names in
        ``fit.json``, such as ``mass``; None is Table I.
    baseline : str
        The friction law, a name in :data:`bayesfric.physics.laws.BASELINES`.
    simulator : Simulator, str or None
        The user's simulator instead of the law; see :class:`bayesfric.simulators.Simulator`.
    target : DataFrame or None
        Conditions at which friction is predicted, from :func:`bayesfric.recording.read_conditions`.
    executor : Executor or None
        Runs calls of the simulator in parallel; None runs one after another.
    announce : callable or None
        Is called with a text about the number of simulator calls to come.
    checkpoint : Path or None
        Folder from which an interrupted diagnosis continues to the same result; remove it
        afterwards. Not used with the user's effects or simulator, whose code may change.

    Returns
    -------
    Diagnosed
        The verdict, the causes, where the gap lies, and how far it shrinks.

    Raises
    ------
    InputError
        No rig, unknown law or fixed coefficient, or a simulator that cannot be called.
    """
    calls = None
    if simulator is not None:
        calls = partial(SimulatorCalls, simulator, executor=executor, announce=announce)
    asked = _Asked(analysis or Analysis(), fixed, effects, shipped, baseline, calls, target)
    if joints := parted_by_joint(recording):
        return diagnose_joints(joints, partial(_diagnosed, asked), checkpoint)
    return _diagnosed(asked, recording, checkpoint)


def _diagnosed(asked: _Asked, recording: Recording, checkpoint: Path | None) -> Diagnosed:
    """Return the diagnosis of a recording of boards, or of one joint."""
    began = time.perf_counter()
    with threadpool_limits(limits=1):
        calls = None if asked.calls is None else asked.calls()
        question = question_of(
            recording,
            asked.analysis,
            asked.fixed,
            asked.effects,
            asked.shipped,
            asked.baseline,
            calls,
            asked.target,
        )
        kept = None if asked.effects or asked.calls else checkpoint
        summary, curves, amounts = _diagnose(question, asked.baseline, sorted(asked.fixed), kept)
    own = checked_diagnosis(summary.model_copy(update={"attention": of_diagnosis(summary)}))
    words = f"{own.sentence}{model_error_words(own.model_error)}"
    summary = own.model_copy(update={"sentence": words})
    seconds = time.perf_counter() - began
    return Diagnosed(identified(summary), curves, seconds, amounts, own.sentence)


def _diagnose(
    question: Question, baseline: str, fixed: Sequence[str], checkpoint: Path | None
) -> tuple[DiagnosisFile, xr.DataTree, ModelAmounts | None]:
    recording, analysis = question.recording, question.analysis
    attributes = provenance_of(recording, analysis)
    joint = None if recording.axis is None else recording.axis.joint
    inputs = (baseline, fixed, question.shipped, recording.metadata, joint)
    keeping = Checkpoint(checkpoint, f"{inputs} {attributes.model_dump_json()}")
    question, compared, judged = _compared_and_judged(question, keeping)
    folds, bootstrap, axes, _, checks, blocks, order, scatter = question.sources
    measured = measure(question, compared, judged, keeping, folds, bootstrap, blocks)
    conclusion = conclude(question, compared, judged, measured, order)
    where = where_it_lies(
        judged.plain,
        measured.held_out.before,
        judged.residuals,
        judged.posterior,
        question.examined,
        axes,
    )
    law = reported_law(compared, judged, measured, conclusion, question.practical, scatter)
    answer = Answer(question, compared, judged, measured, conclusion, law, *where)
    summary = file_of(answer, reported_causes(answer, checks), attributes)
    amplitudes = {name: judged.posterior.amplitudes[name] for name in judged.named}
    curves = curves_of(measured.held_out, amplitudes, judged.posterior.law)
    return summary, curves, conclusion.objections.amounts


def _compared_and_judged(
    question: Question, keeping: Checkpoint
) -> tuple[Question, Compared, Judged]:
    """Compare hypotheses and sort effects; priors that are too tight are widened first."""
    while True:
        compared = compare_hypotheses(question, keeping)
        draws, blocks = question.sources.draws, question.sources.blocks.spawn(1)[0]
        judged = _judged(question, compared, draws, blocks)
        tight = too_tight(question, compared, judged)
        if not tight:
            return question, compared, judged
        question = with_wider_priors(question, tight, judged)


def _judged(
    question: Question, compared: Compared, draws: np.random.Generator, blocks: np.random.Generator
) -> Judged:
    """Sort effects; several causes of a joint must each improve held-out predictions."""

    def sort(search: Search) -> Judged:
        return judge(compared.model, search, question.law_shipped, question.practical, draws)

    judged, search = sort(compared.search), compared.search
    if not compared.data.rigs[0].along_path:
        return judged
    while len(judged.named) > 1:
        name = least_needed_cause(compared.model, search, judged.named, blocks)
        if name is None or name in search.doubted:
            break
        search = replace(search, doubted=search.doubted | {name})
        judged = sort(search)
    return judged
