"""A recording to a diagnosis: where it misses, which effect causes it, how far it shrinks."""

import time
from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import Executor
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.attention import of_diagnosis
from bayesfric.checkpoint import Checkpoint
from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.baseline import data_of, fitted_baseline
from bayesfric.diagnosis.causes import causes_of, implausible, inclusion_of
from bayesfric.diagnosis.checked import Checked, noise_checked
from bayesfric.diagnosis.checking import looked_at, not_followed
from bayesfric.diagnosis.classes import classes_of
from bayesfric.diagnosis.climbing import climb, curvature_at
from bayesfric.diagnosis.diagnosed import Diagnosed
from bayesfric.diagnosis.entering import numbers_to_enter
from bayesfric.diagnosis.examined import examinable, examined_effects, no_effects, widened
from bayesfric.diagnosis.forms import other_forms
from bayesfric.diagnosis.held_out import HeldOut, measure_gap
from bayesfric.diagnosis.held_out_density import BlockDensities, block_densities
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.instrumental import by_the_instrument, not_held, why_bent
from bayesfric.diagnosis.joints import diagnosed_together
from bayesfric.diagnosis.judging import judge
from bayesfric.diagnosis.law import law_of_diagnosis, scatter_of_runs
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.nearby import around_nearby
from bayesfric.diagnosis.next_experiment import next_experiment
from bayesfric.diagnosis.other_joints import amounts_of, looks_like_others, model_error_words
from bayesfric.diagnosis.overruling import density_of, overruled, why_overruled
from bayesfric.diagnosis.remainder import all_left, remainder_of
from bayesfric.diagnosis.search import Steps, compare, search
from bayesfric.diagnosis.sentence import Statement, held_out_words, sentence_of
from bayesfric.diagnosis.shipped import Shipped, held_of, shipped_numbers, shipped_of
from bayesfric.diagnosis.showing import (
    few_windows,
    loosely_known,
    share_of_friction,
    why_not_shown,
    windows_told,
)
from bayesfric.diagnosis.simulated import own_law_of, simulator_used
from bayesfric.diagnosis.squeezing import squeezed
from bayesfric.diagnosis.stored import curves_of, gap_of
from bayesfric.diagnosis.strays import far_rows, without_strays
from bayesfric.diagnosis.structure import changes_slowly, unlike_scatter
from bayesfric.diagnosis.target import check_target, friction_at
from bayesfric.diagnosis.undeclared import undeclared
from bayesfric.diagnosis.unknown import Unknown, unknown_force
from bayesfric.diagnosis.verdict import decide, sets_of_one, unseparated_of
from bayesfric.diagnosis.weighing import Weighed, weigh
from bayesfric.diagnosis.where import where_it_lies
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects import Effect, with_priors
from bayesfric.effects.candidates import Candidate, candidates_of
from bayesfric.hypothesis import NONE, UNKNOWN, Hypothesis, printed
from bayesfric.recording.joints import parted_by_joint
from bayesfric.recording.tables import Recording
from bayesfric.results import identified, provenance
from bayesfric.rigs.base import RigTrials
from bayesfric.rigs.model_amounts import ModelAmounts, model_errors
from bayesfric.rigs.opening import with_own_priors
from bayesfric.schemas import Absorbed, Cause, DiagnosisFile, LawNumber, RecordingId
from bayesfric.simulators import Simulator, SimulatorCalls

NOTHING_TOLD = "these data tell no number of the model"

LN10 = float(np.log(10))
ROUNDS = 2  # of linearising around the law that was fitted with the leader


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
        All trials of all rigs that it has enter.
    analysis : Analysis or None
        Priors, rules and seed; None for the defaults.
    fixed : collection of str
        Numbers that are held at their shipped values, as ``c3``, ``c3[small]`` or ``mass``.
    effects : collection of Effect
        Effects of the user's own, examined beside those of :mod:`bayesfric.effects`; one
        of the same name takes the other's place.
    shipped : mapping of str to Coefficients or to float, or None
        The simulator's values as it was shipped: laws by pulley size, or numbers by name as
        ``fit.json`` has them, say ``mass``; None is Table I.
    baseline : str
        The friction law, a name in :data:`bayesfric.physics.laws.BASELINES`.
    simulator : Simulator, str or None
        A simulator of the user's own in the place of the law: an object, or
        ``module:object``; see :class:`bayesfric.simulators.Simulator`.
    target : DataFrame or None
        Conditions at which friction is asked for, as of
        :func:`bayesfric.recording.read_conditions`.
    executor : Executor or None
        Over which calls of the simulator are spread; None makes one after another.
    announce : callable or None
        Is told how many calls of the simulator are coming.
    checkpoint : Path or None
        Folder that keeps what is weighed, so that a diagnosis that was interrupted goes on
        to the same result. Remove it when that is written. With effects or a simulator of the
        user's own nothing is kept: whether their code has changed cannot be told.

    Returns
    -------
    Diagnosed
        Verdict, causes, where, and how far it shrinks.

    Raises
    ------
    InputError
        There is no rig to diagnose, the law is unknown, a fixed coefficient is unknown
        or has no value, or a simulator cannot be called.
    """
    began = time.perf_counter()
    analysis = Analysis() if analysis is None else analysis
    if parted := parted_by_joint(recording):

        def of_joint(own: Recording, kept: Path | None) -> Diagnosed:
            return diagnose(
                own,
                analysis,
                fixed=fixed,
                effects=effects,
                shipped=shipped,
                baseline=baseline,
                simulator=simulator,
                target=target,
                executor=executor,
                announce=announce,
                checkpoint=kept,
            )

        return diagnosed_together(parted, of_joint, checkpoint)
    calls = None
    if simulator is not None:
        calls = SimulatorCalls(simulator, executor=executor, announce=announce)
    with threadpool_limits(limits=1):
        summary, curves, amounts = _diagnose(
            recording, analysis, fixed, effects, shipped, baseline, calls, target, checkpoint
        )
    own = looked_at(summary.model_copy(update={"attention": of_diagnosis(summary)}))
    words = f"{own.sentence}{model_error_words(own.model_error)}"
    summary = own.model_copy(update={"sentence": words})
    seconds = time.perf_counter() - began
    return Diagnosed(identified(summary), curves, seconds, amounts, own.sentence)


def _diagnose(
    recording: Recording,
    analysis: Analysis,
    fixed: Collection[str],
    effects: Collection[Effect],
    shipped: Shipped | None,
    baseline: str,
    simulator: SimulatorCalls | None,
    target: pd.DataFrame | None,
    checkpoint: Path | None,
) -> tuple[DiagnosisFile, xr.DataTree, ModelAmounts | None]:
    data, law = data_of(recording, baseline, simulator)
    own = own_law_of(data)
    if target is not None:
        check_target(target, data.rigs[0], data.sizes)
    analysis = with_own_priors(analysis, data.rigs)
    practical = analysis.diagnosis.practical_share
    law_shipped = shipped_of(shipped, data)
    held = held_of(fixed, data, law_shipped)
    examined, lacking = examinable(data, {effect.name: effect for effect in effects})
    examined = with_priors(examined, analysis.priors.effects)
    examined = {name: widened(effect, analysis) for name, effect in examined.items()}
    attributes = provenance(
        recording=RecordingId(name=recording.name, title=recording.title, sha256=recording.sha256),
        analysis=analysis,
        created=recording.created,
    )
    joint = None if recording.axis is None else recording.axis.joint
    inputs = (baseline, sorted(fixed), shipped, recording.rig, recording.metadata, joint)
    if effects or simulator is not None:
        checkpoint = None
    keeping = Checkpoint(checkpoint, f"{inputs} {attributes.model_dump_json()}")
    climbing = keeping.keep_each_call("climb", At, climb)
    steps = Steps(
        keeping.keep_each_call("weigh", Weighed, weigh),
        keeping.keep_each_call("unknown", Unknown | None, unknown_force),
    )
    data, stray, laws, psi = fitted_baseline(data, analysis, held, law_shipped, law, climbing)
    candidates = [candidate for effect in examined.values() for candidate in candidates_of(effect)]
    first = LinearModel(data, laws, candidates, analysis, held | frozenset(law.without))
    first = squeezed(first, psi)
    first_found = _first_look(first, climbing(first, psi, Acting()), steps)

    def with_weights(weights: Mapping[str, Array]) -> tuple[LinearModel, Search]:
        around = first.full.around(first.laws, candidates, row_weights=weights)
        around = squeezed(around, psi)
        return around, _first_look(around, climbing(around, psi, Acting()), steps)

    first, first_found = without_strays(first, first_found, with_weights)
    model, searched = _finals(first, first_found, steps)
    fold_rng, gap_rng, where_rng, draw_rng, check_rng, block_rng, order_rng, law_rng = (
        np.random.default_rng(child) for child in np.random.SeedSequence(analysis.seed).spawn(8)
    )
    judged = judge(model, searched, law_shipped, practical, draw_rng)
    searched, best = judged.search, judged.search.best()
    residuals, posterior, arms = judged.residuals, judged.posterior, judged.arms
    effects_known, named, settled = judged.effects_known, judged.named, judged.settled
    present, possible = judged.present, judged.possible
    chances = searched.probabilities()
    friction, above, plain = residuals.friction_rms, judged.above, judged.plain
    held_out = keeping.record("held-out", HeldOut, lambda: measure_gap(arms, plain, fold_rng))
    gap, left = gap_of(held_out, posterior, residuals, arms, practical, gap_rng, data.unit)
    gap = gap.model_copy(update=share_of_friction(model, residuals, posterior))
    densities = keeping.record(
        "held-out-density",
        BlockDensities | None,
        lambda: block_densities(model, searched, named, block_rng),
    )
    gap = gap.model_copy(update=density_of(densities, named, like_clocks=arms.like_clocks(plain)))
    gap_share, asked = float(np.median(posterior.gap)) / friction, searched
    remainder = remainder_of(model, asked, best, gap_share, left) if named else None
    others = data.rigs[0].other_joints
    rivals = [name for effects in sets_of_one(chances, effects_known, named) for name in effects]
    amounts = amounts_of(model, best)
    elsewhere = looks_like_others(named, rivals, examined, others, gap, amounts)
    why = None
    if remainder is not None:
        beyond = implausible(named, model, searched, posterior) if data.rigs[0].along_path else ()
        why = why_overruled(
            gap, practical, told_as_remainder=remainder.significant, implausible=beyond
        )
    acting = model.amplitudes(best.at, best.acting)
    instrument = data.rigs[0].instrument(acting)
    whose = {
        law.effect: candidate.effect.name
        for law, (candidate, _) in zip(best.acting.laws, acting, strict=True)
    }
    open_because = None
    if why is None and not elsewhere:
        open_because = not_held(instrument, {name: whose.get(name, name) for name in named})
    contradicted = why is not None or elsewhere or open_because is not None
    if contradicted and open_because is None:
        apart = overruled(
            searched, effects_known, [named] if named else [[name] for name in rivals], above
        )
        searched, effects_known = apart.search, apart.effects_known
        present, possible = apart.present, apart.possible
        chances = searched.probabilities()
    together = () if elsewhere else sets_of_one(chances, effects_known, named)
    not_shown = why_not_shown(searched, residuals, along_path=data.rigs[0].along_path)
    not_shown = not_shown or loosely_known(model, residuals, posterior)
    not_shown = not_shown or why_bent(instrument)
    unexplained_by_scatter = unlike_scatter(
        gap, residuals, held_out.inside[1], posterior, practical, order_rng
    ) or changes_slowly(model.noise.named(settled.psi), practical)
    verdict, chance = decide(
        chances,
        [] if contradicted else [effect for effect in effects_known if effect.effect in named],
        above,
        together,
        none_before=analysis.diagnosis.hypotheses.none,
        shown=not_shown is None and unexplained_by_scatter is None,
    )
    if verdict == "unknown" and not contradicted and data.rigs[0].along_path:
        open_because = data.rigs[0].open_still or few_windows(residuals, along_path=True)
        verdict, chance = (
            ("undecided", max(above, 1 - above)) if open_because else (verdict, chance)
        )
    where, unexplained, why_all = where_it_lies(
        plain, held_out.before, residuals, posterior, examined, where_rng
    )
    floor = gap.floor.q50 / gap.friction_rms

    checks: dict[Hypothesis, Checked] = {}

    def check(hypothesis: Weighed | Unknown) -> Checked:
        acting = UNKNOWN if isinstance(hypothesis, Unknown) else hypothesis.hypothesis
        if acting not in checks:
            checks[acting] = noise_checked(model, searched, hypothesis, check_rng)
        return checks[acting]

    def causes_named(names: list[str]) -> tuple[Cause, ...]:
        return causes_of(names, model, searched, posterior, practical, floor, check)

    causes, beside = causes_named(named), causes_named(present)
    considered: tuple[Cause, ...] = ()
    if contradicted:
        considered = causes if named else causes_named(rivals)
        causes = ()
    unseparated = unseparated_of(searched.classes, together)
    proposals, no_proposal = next_experiment(model, searched, chances)
    scatter = scatter_of_runs(model, plain, held_out.inside[2])
    law_found = law_of_diagnosis(model, psi, posterior, residuals, scatter, law_rng)
    law_found = by_the_instrument(law_found, instrument)
    to_enter, not_entered = numbers_to_enter(model, law_found, posterior, causes, gap, residuals)
    asked_for = None
    if target is not None:
        doubt = chances.get(UNKNOWN, 0.0)
        asked_for = friction_at(target, model, law, law_found, posterior, named, examined, doubt)
    if verdict == "unknown" and searched.unknown is not None:
        remainder = all_left(searched, searched.unknown)
    elif remainder is None:
        remainder = remainder_of(model, asked, best, gap_share, left)
    prior = analysis.diagnosis.hypotheses
    statement = Statement(
        verdict,
        chance,
        gap,
        practical,
        causes,
        where,
        unseparated,
        beside,
        considered,
        not_shown if above < RULES.likely else None,
        others if elsewhere else None,
        why,
        unexplained_by_scatter if above < RULES.likely else None,
        windows_told(residuals),
        open_because,
    )
    errors = () if amounts is None else model_errors([amounts])
    summary = DiagnosisFile(
        **attributes.model_dump(),
        rigs=tuple(rig.rig.name for rig in data.rigs),
        baseline=law.name,
        simulator=simulator_used(own, model, settled),
        fixed=tuple(sorted(held)),
        shipped=None if shipped is None else shipped_numbers(law_shipped, data),
        stray_trials=stray,
        attention=(
            *_doubted(data.rigs, law_found),
            *undeclared(recording.rig, verdict, others, [*named, *rivals, *possible], examined),
            *far_rows(first),
            *not_followed(analysis),
        ),
        practical_share=practical,
        verdict=verdict,
        verdict_probability=chance,
        sentence=f"{sentence_of(statement)} {held_out_words(gap, causes or considered)}",
        probabilities=printed(chances),
        hypothesis_prior=prior.model_dump(),
        prior_sensitivity={
            "0.1": printed(searched.probabilities(0.1)),
            "0.9": printed(searched.probabilities(0.9)),
        },
        unvisited_probability=searched.unvisited(),
        inclusion=inclusion_of(effects_known, posterior, practical),
        causes=causes,
        present=beside,
        possible=causes_named(possible),
        considered=considered,
        overruled_by=why or (open_because if contradicted else None),
        enter=to_enter,
        enter_why=not_entered,
        untold={name: reason for rig in data.rigs for name, reason in rig.untold.items()},
        scatter=model.noise.named(settled.psi),
        law=law_found,
        unseparated=unseparated,
        absorbed=tuple(
            Absorbed(effect=effect.effect, by=effect.by, bias=effect.bias, unit=effect.unit)
            for effect in searched.classes.absorbed
        ),
        remainder=remainder,
        where=where,
        unexplained=unexplained,
        all_unexplained_because=why_all,
        gap=gap,
        effects=examined_effects(
            first_found,
            [*examined, *lacking],
            lacking,
            no_effects(data, [effect.name for effect in effects]),
        ),
        next_experiment=proposals,
        next_experiment_why=no_proposal,
        target=asked_for,
        joint=joint,
        joint_in_model=_in_model(recording),
        other_joints=others,
        model_error=errors,
        instrument=None if isinstance(instrument, str) else instrument,
        instrument_why=instrument if isinstance(instrument, str) else None,
        model_error_why=None if amounts is None or errors else NOTHING_TOLD,
    )
    amplitudes = {name: posterior.amplitudes[name] for name in named}
    return summary, curves_of(held_out, amplitudes, posterior.law), amounts


def _in_model(recording: Recording) -> str | None:
    """Return what the machine's model calls the joint; None without one, or of no joint."""
    robot = recording.rig.robot
    if robot is None or recording.axis is None:
        return None
    named = recording.axis.joint or next(iter(robot.joints), None)
    return None if named is None else robot.joints.get(named)


def _doubted(rigs: Sequence[RigTrials], law: Mapping[str, LawNumber]) -> tuple[str, ...]:
    """Return what the data contradict of what was declared, the first thing to know."""
    return tuple(line for rig in rigs for line in rig.doubts(law))


def _first_look(model: LinearModel, at: At, steps: Steps) -> Search:
    """Weigh hypotheses around the baseline."""
    classes = classes_of(model, at.psi)
    model.merge(classes.members)
    curvature = curvature_at(model, at, Acting())
    inverse = np.asarray(np.linalg.inv(curvature), dtype=np.float64)
    none = steps.weigh(model, (), [at.psi], inverse, 0.0)
    return search(model, none, inverse, 0.0, classes, steps)


def _finals(first: LinearModel, searched: Search, steps: Steps) -> tuple[LinearModel, Search]:
    """Compare the finalists alike, around the law that was fitted with the leader."""
    model = first
    if searched.probabilities().get(NONE, 0.0) > RULES.sure:
        # All are compared alike already, and nothing is large enough to have another form.
        return model, searched
    for _ in range(ROUNDS):
        leader = searched.best()
        acting = model.amplitudes(leader.at, leader.acting)
        forms = other_forms([rig.rows for rig in model.rigs], _acting_once(model, searched))
        around = around_nearby(
            model,
            model.fitted_laws(leader.at),
            first.candidates,
            scattering=acting,
            forms=forms,
        )
        around.merge(searched.classes.members)
        around = squeezed(around, leader.at.psi)
        model, searched = around, compare(around, searched, steps)
        if searched.best().names == leader.names:
            break
    return model, searched


def _acting_once(model: LinearModel, searched: Search) -> list[tuple[Candidate, float]]:
    """Return each effect of the likeliest hypotheses, as the best with it has it."""
    ranked = sorted(searched.weighed.values(), key=lambda weighed: -searched.worth(weighed))
    top = searched.worth(ranked[0])
    acting: dict[str, tuple[Candidate, float]] = {}
    for weighed in ranked:
        if searched.worth(weighed) < top - RULES.followed_within:
            break
        for candidate, amplitude in model.amplitudes(weighed.at, weighed.acting):
            acting.setdefault(candidate.effect.name, (candidate, amplitude))
    return list(acting.values())
