"""The verdict, from judged hypotheses, held-out data and objections to the causes."""

from dataclasses import dataclass
from itertools import chain

import numpy as np

from bayesfric.diagnosis.causes import implausible
from bayesfric.diagnosis.compared import Compared
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.instrumental import why_biased, why_unconfirmed, why_uncorrected
from bayesfric.diagnosis.judging import Judged
from bayesfric.diagnosis.measured import Measured
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.other_joints import amounts_of, looks_like_others
from bayesfric.diagnosis.overruling import (
    Overruled,
    accounts_for_residual,
    overruled,
    why_beyond_rivals,
    why_overruled,
)
from bayesfric.diagnosis.question import Question
from bayesfric.diagnosis.remainder import all_left, remainder_of
from bayesfric.diagnosis.showing import few_windows, loosely_known, why_not_shown
from bayesfric.diagnosis.structure import differs_within_runs, unlike_scatter
from bayesfric.diagnosis.verdict import Verdict, decide, sets_of_one
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.effects.candidates import Candidate
from bayesfric.rigs.base import RigTrials
from bayesfric.rigs.model_amounts import ModelAmounts
from bayesfric.schemas.causes import Remainder
from bayesfric.schemas.gap import Gap
from bayesfric.schemas.instrument import Instrument


@dataclass(frozen=True)
class Objections:
    """Objections to the causes.

    Parameters
    ----------
    rivals : list of str
        Effects of which one is a cause, if there is no objection.
    held_out : str or None
        The rule by which held-out data contradict the causes; None if they do not.
    loop : str or None
        Why the control loop may imitate the causes; None if an instrument confirms them.
    other_joints : bool
        Whether forces of other joints may imitate the causes.
    amounts : ModelAmounts or None
        Estimated errors of the machine's model.
    instrument : Instrument or str
        Estimates by an instrument, or why there are none.
    """

    rivals: list[str]
    held_out: str | None
    loop: str | None
    other_joints: bool
    amounts: ModelAmounts | None
    instrument: Instrument | str

    @property
    def contradict(self) -> bool:
        """Whether an unknown force replaces the causes."""
        return self.held_out is not None or self.other_joints

    @property
    def raised(self) -> bool:
        """Whether any objection demotes the causes to considered effects."""
        return self.contradict or self.loop is not None


@dataclass(frozen=True)
class Conclusion:
    """The verdict on the effects, and the rules behind it.

    Parameters
    ----------
    overruled : Overruled
        Hypotheses and effects after causes that held-out data contradict count as an unknown
        force.
    objections : Objections
        Objections to the causes.
    open_because : str or None
        Why an unknown force is not reported, or why causes stay open; None if neither is the case.
    together : tuple of tuple of str
        Sets of effects of which one acts.
    not_shown : str or None
        Why these data could not have shown a gap.
    unlike_scatter : str or None
        Description of a residual that scatter does not explain.
    remainder : Remainder
        What the causes leave; without causes, the unknown force.
    verdict : str
        As of :func:`~bayesfric.diagnosis.verdict.decide`.
    probability : float
        Probability of the verdict.
    """

    overruled: Overruled
    objections: Objections
    open_because: str | None
    together: tuple[tuple[str, ...], ...]
    not_shown: str | None
    unlike_scatter: str | None
    remainder: Remainder
    verdict: Verdict
    probability: float

    @property
    def contradicted(self) -> bool:
        """Whether the effects that would be causes are only considered."""
        return self.objections.raised


def conclude(
    question: Question,
    compared: Compared,
    judged: Judged,
    measured: Measured,
    order: np.random.Generator,
) -> Conclusion:
    """Return the verdict after the check on held-out data.

    Parameters
    ----------
    question, compared, judged
        As of :func:`~bayesfric.diagnosis.measured.measure`.
    measured : Measured
        The gap on held-out data.
    order : Generator
        Source of randomness for redrawn residuals.
    """
    model, practical = compared.model, question.practical
    gap_share = float(np.median(judged.posterior.gap)) / judged.residuals.friction_rms
    remainder = remainder_of(model, judged.search, judged.search.best(), gap_share, measured.left)
    objections = _objections_to(question, compared, judged, measured, remainder)
    apart = _as_judged(judged)
    if objections.contradict:
        apart = _without_causes(judged, objections.rivals)
    chances = apart.search.probabilities()
    together: tuple[tuple[str, ...], ...] = ()
    if not objections.other_joints:
        together = sets_of_one(chances, apart.effects_known, judged.named)
    causes = [effect for effect in apart.effects_known if effect.effect in judged.named]
    not_shown = _why_not_shown(model, apart.search, judged, objections.instrument, practical)
    left_in_order = _why_no_scatter(model, judged, measured, practical, order)
    verdict, probability = decide(
        chances,
        [] if objections.raised else causes,
        judged.above,
        together,
        none_before=question.analysis.diagnosis.hypotheses.none,
        shown=not_shown is None and left_in_order is None,
    )
    open_because = _why_open(verdict, objections, model.data.rigs[0], judged, measured.gap)
    if objections.loop is None and open_because is not None:
        verdict, probability, together = "undecided", max(judged.above, 1 - judged.above), ()
    if verdict == "unknown" and apart.search.unknown is not None:
        remainder = all_left(apart.search, apart.search.unknown)
    return Conclusion(
        apart,
        objections,
        open_because,
        together,
        not_shown,
        left_in_order,
        remainder,
        verdict,
        probability,
    )


def _objections_to(
    question: Question,
    compared: Compared,
    judged: Judged,
    measured: Measured,
    remainder: Remainder,
) -> Objections:
    """Return the objections of held-out data, other joints and the control loop."""
    model, named = compared.model, judged.named
    best, rig = judged.search.best(), compared.data.rigs[0]
    rivals = list(chain(*sets_of_one(judged.search.probabilities(), judged.effects_known, named)))
    amounts = amounts_of(model, best)
    others = _other_joints_of(rig)
    other_joints = looks_like_others(
        named, rivals, question.examined, others, measured.gap, amounts
    )
    held_out = None
    if named:
        held_out = _why_overruled(model, judged, measured, question.practical, remainder)
    acting = model.amplitudes(best.at, best.acting)
    instrument = rig.instrument(acting, model.laws)
    loop = None
    if held_out is None and not other_joints:
        loop = _why_not_confirmed(instrument, named, best, acting)
    return Objections(rivals, held_out, loop, other_joints, amounts, instrument)


def _why_overruled(
    model: LinearModel, judged: Judged, measured: Measured, practical: float, remainder: Remainder
) -> str | None:
    """Return the rule by which held-out data contradict the causes; None if there is none."""
    beyond: list[str] = []
    if model.data.rigs[0].along_path:
        beyond = implausible(judged.named, model, judged.search, judged.posterior)
    why = why_overruled(
        measured.judging,
        practical,
        in_remainder=accounts_for_residual(remainder, measured.judging),
        force_left=remainder.significant,
        implausible=beyond,
    )
    if why is None or not measured.beside:
        return why
    return f"with {' and '.join(measured.beside)} beside, {why}"


def _why_no_scatter(
    model: LinearModel,
    judged: Judged,
    measured: Measured,
    practical: float,
    order: np.random.Generator,
) -> str | None:
    """Return a description of a residual that is not scatter; None if there is none.

    Ordered residuals and friction that changes within runs are not scatter. A present error of
    the sensors explains residuals that make no gap.
    """
    sensing = {effect.effect for effect in judged.effects_known if effect.measuring}
    if sensing & set(judged.present):
        return differs_within_runs(model.noise.named(judged.settled.psi), practical)
    left = measured.held_out.inside[1]
    return unlike_scatter(
        measured.gap, judged.residuals, left, judged.posterior, practical, order
    ) or differs_within_runs(model.noise.named(judged.settled.psi), practical)


def _why_not_confirmed(
    instrument: Instrument | str,
    named: list[str],
    best: Weighed,
    acting: list[tuple[Candidate, float]],
) -> str | None:
    """Return why the control loop may imitate the causes (laws may be those of their twins)."""
    whose = {
        law.effect: candidate.effect.name
        for law, (candidate, _) in zip(best.acting.laws, acting, strict=True)
    }
    return why_unconfirmed(instrument, {name: whose.get(name, name) for name in named})


def _other_joints_of(rig: RigTrials) -> str | None:
    """Return what other joints did; ``still`` if the log has no information on friction."""
    return "still" if "coulomb" in rig.untold else rig.other_joints


def _why_open(
    verdict: Verdict, objections: Objections, rig: RigTrials, judged: Judged, gap: Gap
) -> str | None:
    """Return why causes, rivals or an unknown force stay open; None if they do not.

    If held-out data contradict causes, something else certainly acts, except in a log without
    information on friction.
    """
    if objections.loop is not None:
        return objections.loop
    if "coulomb" in rig.untold and verdict in ("named", "unseparated", "unknown"):
        return rig.why_no_finding
    if objections.contradict and verdict == "unknown":
        return None
    if rig.along_path and verdict == "unseparated":
        return why_beyond_rivals(gap)
    if not rig.along_path or verdict != "unknown":
        return None
    few = few_windows(judged.residuals, along_path=True)
    return rig.why_no_finding or few or why_uncorrected(objections.instrument)


def _as_judged(judged: Judged) -> Overruled:
    """Return hypotheses and effects without any overruling."""
    return Overruled(judged.search, judged.effects_known, judged.present, judged.possible)


def _without_causes(judged: Judged, rivals: list[str]) -> Overruled:
    """Return hypotheses and effects after the causes (or, without causes, rivals) are overruled."""
    gone = [judged.named] if judged.named else [[name] for name in rivals]
    return overruled(judged.search, judged.effects_known, gone, judged.above)


def _why_not_shown(
    model: LinearModel,
    search: Search,
    judged: Judged,
    instrument: Instrument | str,
    practical: float,
) -> str | None:
    """Return the first reason why these data could not have shown a gap; None if they could."""
    rig = model.data.rigs[0]
    if "coulomb" in rig.untold:
        return rig.why_no_finding
    first = (
        why_not_shown(search, judged.residuals, along_path=rig.along_path)
        or loosely_known(model, judged.residuals, judged.posterior, practical)
        or why_biased(instrument)
        or why_uncorrected(instrument)
    )
    return first and "; ".join(filter(None, (first, rig.why_no_finding)))
