"""The content of ``diagnosis.json``, from all results of a diagnosis."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from bayesfric.diagnosis.causes import causes_of, inclusion_of
from bayesfric.diagnosis.checked import Checked, noise_checked
from bayesfric.diagnosis.checking import ignored_scatter_settings
from bayesfric.diagnosis.compared import Compared
from bayesfric.diagnosis.concluded import Conclusion
from bayesfric.diagnosis.entering import numbers_to_enter
from bayesfric.diagnosis.examined import examined_effects, no_effects
from bayesfric.diagnosis.gravity import NOT_APART, by_gravity, gravity_hides_inertia
from bayesfric.diagnosis.held_out_sentence import held_out_words
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.instrumental import by_the_instrument, causes_by_the_instrument
from bayesfric.diagnosis.judging import Judged
from bayesfric.diagnosis.law import law_of_diagnosis, scatter_of_runs
from bayesfric.diagnosis.measured import Measured
from bayesfric.diagnosis.next_experiment import next_experiment
from bayesfric.diagnosis.question import Question
from bayesfric.diagnosis.sentence import Statement, sentence_of
from bayesfric.diagnosis.shipped import held_values, shipped_numbers
from bayesfric.diagnosis.showing import window_words
from bayesfric.diagnosis.simulated import simulator_used
from bayesfric.diagnosis.strays import far_rows
from bayesfric.diagnosis.target import friction_at
from bayesfric.diagnosis.undeclared import undeclared
from bayesfric.diagnosis.unknown import Unknown
from bayesfric.diagnosis.verdict import unseparated_of
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.diagnosis.widening import (
    BELOW_ZERO,
    INERTIA,
    all_at_once,
    by_held_out,
    by_parts,
    by_sign,
    is_below_zero,
    is_open,
    widened,
)
from bayesfric.diagnosis_rules import RULES
from bayesfric.hypothesis import UNKNOWN, Hypothesis, printed
from bayesfric.recording.tables import Recording
from bayesfric.rigs.model_amounts import model_errors
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval, Provenance
from bayesfric.schemas.causes import Cause, LawNumber, Unseparated
from bayesfric.schemas.diagnosis import FrictionAsked
from bayesfric.schemas.gap import Axis

NOTHING_TOLD = "these data tell no number of the model"
PRIORS_OF_NONE = (0.1, 0.9)  # priors of no effect; probabilities are also reported under these


@dataclass(frozen=True)
class Answer:
    """All results of a diagnosis.

    Parameters
    ----------
    question : Question
        The recording and what is asked of it.
    compared : Compared
        The compared hypotheses.
    judged : Judged
        Effects, sorted.
    measured : Measured
        The gap on held-out data.
    conclusion : Conclusion
        The verdict.
    law : dict of str to LawNumber
        The law without and with the causes; estimates by the instrument if there is one.
    where : tuple of Axis
        Axes of the gap, the largest share first.
    unexplained : Interval
        Share of the gap that no axis explains.
    all_unexplained_because : str
        Why no axis explains any of it; empty otherwise.
    """

    question: Question
    compared: Compared
    judged: Judged
    measured: Measured
    conclusion: Conclusion
    law: dict[str, LawNumber]
    where: tuple[Axis, ...]
    unexplained: Interval
    all_unexplained_because: str

    @property
    def search(self) -> Search:
        """The hypotheses after the check on held-out data."""
        return self.conclusion.overruled.search


def reported_law(
    compared: Compared,
    judged: Judged,
    measured: Measured,
    conclusion: Conclusion,
    practical: float,
    rng: np.random.Generator,
) -> dict[str, LawNumber]:
    """Return the law without and with the causes, by the instrument if there is one.

    Parameters
    ----------
    compared, judged, measured, conclusion
        As of :class:`Answer`.
    practical : float
        Practical share of friction.
    rng : Generator
        Source of randomness for the scatter from run to run.
    """
    scatter = scatter_of_runs(compared.model, judged.plain, measured.held_out.inside[2])
    law = law_of_diagnosis(
        compared.model, compared.psi, judged.posterior, judged.residuals, scatter, rng
    )
    if not compared.data.rigs[0].along_path:
        return law
    hides = gravity_hides_inertia(compared.model, judged.residuals.turns)
    wide = (by_held_out(law, measured.gap, practical), by_gravity(hides, judged.named))
    speed = float(np.nanmean(np.abs(judged.residuals.covariates["velocity"])))
    unexplained = conclusion.verdict in ("unknown", "undecided")
    parts = by_parts(law, compared.model, judged.residuals.turns) if unexplained else {}
    factors = all_at_once((all_at_once(wide, at_least=parts),), at_least=by_sign(law, speed))
    return by_the_instrument(
        widened(law, factors), conclusion.objections.instrument, factors, scatter
    )


class ReportedCauses(NamedTuple):
    """Effects with their figures: causes, present or possible effects, and overruled causes."""

    causes: tuple[Cause, ...]
    present: tuple[Cause, ...]
    possible: tuple[Cause, ...]
    considered: tuple[Cause, ...]


def reported_causes(answer: Answer, rng: np.random.Generator) -> ReportedCauses:
    """Return the figures of causes, of present or possible effects, and of overruled causes.

    Parameters
    ----------
    answer : Answer
        Results of the diagnosis.
    rng : Generator
        Source of randomness for the importance draws that check evidences.
    """
    model, gap = answer.compared.model, answer.measured.gap
    checks: dict[Hypothesis, Checked] = {}

    def check(hypothesis: Weighed | Unknown) -> Checked:
        acting = UNKNOWN if isinstance(hypothesis, Unknown) else hypothesis.hypothesis
        if acting not in checks:
            checks[acting] = noise_checked(model, answer.search, hypothesis, rng)
        return checks[acting]

    def causes_named(names: Sequence[str]) -> tuple[Cause, ...]:
        return causes_of(
            names,
            model,
            answer.search,
            answer.judged.posterior,
            answer.question.practical,
            gap.floor.q50 / gap.friction_rms,
            check,
        )

    conclusion, named = answer.conclusion, answer.judged.named
    causes, present = causes_named(named), causes_named(conclusion.overruled.present)
    causes = causes_by_the_instrument(
        causes, conclusion.objections.instrument, answer.question.examined
    )
    considered: tuple[Cause, ...] = ()
    if conclusion.contradicted:
        considered = causes if named else causes_named(conclusion.objections.rivals)
        causes = ()
    return ReportedCauses(causes, present, causes_named(conclusion.overruled.possible), considered)


def file_of(answer: Answer, reported: ReportedCauses, attributes: Provenance) -> DiagnosisFile:
    """Return the content of ``diagnosis.json``.

    Parameters
    ----------
    answer : Answer
        Results of the diagnosis.
    reported : ReportedCauses
        Effects with their figures.
    attributes : Provenance
        Provenance that every file contains.
    """
    question, compared, judged = answer.question, answer.compared, answer.judged
    conclusion, gap, search = answer.conclusion, answer.measured.gap, answer.search
    model, data, law = compared.model, compared.data, answer.law
    unseparated = unseparated_of(search.classes, conclusion.together)
    proposals, no_proposal = next_experiment(model, search, search.probabilities())
    to_enter, not_entered = numbers_to_enter(
        model, law, judged.posterior, reported.causes, gap, judged.residuals
    )
    words = sentence_of(_statement(answer, reported, unseparated))
    considered = [cause for cause in reported.considered if is_named(cause.effect, words)]
    on_held_out = held_out_words(gap, reported.causes or considered, conclusion.verdict)
    return DiagnosisFile(
        **attributes.model_dump(),
        rigs=tuple(rig.rig.name for rig in data.rigs),
        baseline=question.law.name,
        simulator=simulator_used(question.own_law, model, judged.settled),
        fixed=question.fixed,
        fixed_at=held_values(question.held, data, question.law_shipped),
        shipped=question.shipped and shipped_numbers(question.law_shipped, data),
        stray_trials=compared.stray,
        attention=_attention(answer, law),
        practical_share=question.practical,
        verdict=conclusion.verdict,
        verdict_probability=conclusion.probability,
        sentence=f"{words} {on_held_out}",
        **_hypotheses(answer),
        **reported._asdict(),
        overruled_by=conclusion.objections.held_out or conclusion.objections.loop,
        enter=to_enter,
        enter_why=not_entered,
        untold=data.untold,
        scatter=model.noise.named(judged.settled.psi),
        law=law,
        unseparated=unseparated,
        remainder=conclusion.remainder,
        where=answer.where,
        unexplained=answer.unexplained,
        all_unexplained_because=answer.all_unexplained_because,
        gap=gap,
        next_experiment=proposals,
        next_experiment_why=no_proposal,
        target=_asked_for(answer, law),
        **_machine(answer),
    )


def is_named(effect: str, words: str) -> bool:
    """Return whether a sentence contains the name of an effect as a whole word."""
    return re.search(rf"(?<![\w-]){re.escape(effect)}(?![\w-])", words) is not None


def _statement(
    answer: Answer, reported: ReportedCauses, unseparated: tuple[Unseparated, ...]
) -> Statement:
    """Return the parts of the verdict sentence."""
    conclusion, is_open = answer.conclusion, answer.judged.above < RULES.likely
    return Statement(
        conclusion.verdict,
        conclusion.probability,
        answer.measured.gap,
        answer.question.practical,
        reported.causes,
        answer.where,
        unseparated,
        reported.present,
        reported.considered,
        conclusion.not_shown if is_open else None,
        answer.compared.data.rigs[0].other_joints if conclusion.objections.other_joints else None,
        conclusion.objections.held_out,
        conclusion.unlike_scatter if is_open else None,
        window_words(answer.judged.residuals),
        conclusion.open_because,
    )


def _attention(answer: Answer, law: Mapping[str, LawNumber]) -> tuple[str, ...]:
    """Return warnings for the reader; those that the data contradict come first."""
    question, conclusion, data = answer.question, answer.conclusion, answer.compared.data
    suspects = [*answer.judged.named, *conclusion.objections.rivals, *conclusion.overruled.possible]
    factor = gravity_hides_inertia(answer.compared.model, answer.judged.residuals.turns)
    hidden = factor is not None and (INERTIA not in law or is_open(law[INERTIA].after))
    axis = question.recording.axis
    return (
        *(line for rig in data.rigs for line in rig.doubts(law)),
        *([NOT_APART.format(factor=factor)] if hidden else []),
        *([BELOW_ZERO] if data.rigs[0].along_path and is_below_zero(law) else []),
        *undeclared(
            question.recording.rig,
            conclusion.verdict,
            data.rigs[0].other_joints,
            suspects,
            question.examined,
            has_force=axis is None or "force_n" in axis.samples,
        ),
        *far_rows(answer.compared.baseline),
        *ignored_scatter_settings(question.analysis, answer.compared.model),
        *question.remarks,
    )


def _hypotheses(answer: Answer) -> dict[str, Any]:
    """Return the probabilities of hypotheses and effects, and the entry of each effect."""
    question, search = answer.question, answer.search
    return {
        "probabilities": printed(search.probabilities()),
        "hypothesis_prior": question.analysis.diagnosis.hypotheses.model_dump(),
        "prior_sensitivity": {
            str(none): printed(search.probabilities(none)) for none in PRIORS_OF_NONE
        },
        "unvisited_probability": search.unvisited(),
        "inclusion": inclusion_of(
            answer.conclusion.overruled.effects_known, answer.judged.posterior, question.practical
        ),
        "absorbed": search.classes.absorbed,
        "effects": examined_effects(
            answer.compared.first,
            [*question.examined, *question.lacking],
            question.lacking,
            no_effects(answer.compared.data, question.own_effects),
        ),
    }


def _machine(answer: Answer) -> dict[str, Any]:
    """Return the joint's name, and the errors of the machine's model."""
    axis, conclusion = answer.question.recording.axis, answer.conclusion
    amounts, instrument = conclusion.objections.amounts, conclusion.objections.instrument
    errors = () if amounts is None else model_errors([amounts])
    return {
        "joint": None if axis is None else axis.joint,
        "joint_in_model": _in_model(answer.question.recording),
        "other_joints": answer.compared.data.rigs[0].other_joints,
        "model_error": errors,
        "model_error_why": None if amounts is None or errors else NOTHING_TOLD,
        "instrument": None if isinstance(instrument, str) else instrument,
        "instrument_why": instrument if isinstance(instrument, str) else None,
    }


def _asked_for(answer: Answer, law: Mapping[str, LawNumber]) -> FrictionAsked | None:
    """Return friction at the user's target conditions; None without such conditions."""
    question, judged = answer.question, answer.judged
    if question.target is None:
        return None
    return friction_at(
        question.target,
        answer.compared.model,
        question.law,
        law,
        judged.posterior,
        judged.named,
        question.examined,
        answer.search.probabilities().get(UNKNOWN, 0.0),
    )


def _in_model(recording: Recording) -> str | None:
    """Return the joint's name in the machine's model; None without a model or a joint."""
    robot = recording.rig.robot
    if robot is None or recording.axis is None:
        return None
    named = recording.axis.joint or next(iter(robot.joints), None)
    return None if named is None else robot.joints.get(named)
