"""A claim, the data that it is judged on, and the finding."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from numpy.typing import NDArray

from bayesfric.analysis import Analysis, ClaimRules
from bayesfric.arrays import Array
from bayesfric.claims.entered import PAPER, Entered
from bayesfric.claims.studies import Studied, Task
from bayesfric.effects import Effect, all_effects
from bayesfric.fitting.hypothesis import LawWithEffects
from bayesfric.recording.tables import Recording
from bayesfric.rigs.base import Regime

Verdict = Literal["supported", "refuted", "undecided", "not-testable"]
WORDS = {
    "tension": "tension",
    "n_pulleys": "number of pulleys",
    "wrap_angle_deg": "wrap angle",
    "tension_n": "tension",
    "velocity_m_s": "speed",
}
COLUMNS = ("n_pulleys", "wrap_angle_deg", "tension_n", "velocity_m_s")
"""Of friction at constant speed, which a table of points may lack; a board has them all."""


def verdict_by(rules: ClaimRules, probability: float) -> Verdict:
    """Return the verdict on a claim, given the probability that it holds."""
    if probability >= rules.support_probability:
        return "supported"
    return "refuted" if probability <= rules.refute_probability else "undecided"


@dataclass(frozen=True)
class Finding:
    """The result of a claim on a recording.

    Parameters
    ----------
    verdict : {"supported", "refuted", "undecided", "not-testable"}
        Verdict by the rules of the analysis.
    reason : str
        A sentence on the verdict, with its numbers.
    figures : mapping
        Figures behind the verdict by name: numbers, texts or booleans.
    log10_bayes_factor, log10_bayes_factor_se : float or None
        Bayes factor in favour of the claim against its best rival.
    elpd_difference, elpd_difference_se : float or None
        Positive if the claim predicts assemblies better than its best rival.
    why : str
        Why a number above is missing.
    by_pulley : mapping of str to (float or None, float or None, str)
        Bayes factor from each size alone, its error, and why there is none.
    curve : mapping of str to ndarray
        ``log10_bayes_factor`` and ``verdict`` over the ``width`` of the rivals' priors;
        empty without.
    """

    verdict: Verdict
    reason: str
    figures: Mapping[str, Any] = field(default_factory=dict)
    log10_bayes_factor: float | None = None
    log10_bayes_factor_se: float | None = None
    elpd_difference: float | None = None
    elpd_difference_se: float | None = None
    why: str = ""
    by_pulley: Mapping[str, tuple[float | None, float | None, str]] = field(default_factory=dict)
    curve: Mapping[str, NDArray[Any]] = field(default_factory=dict)


@dataclass(frozen=True)
class Claim:
    """A statement of the paper.

    Parameters
    ----------
    name : str
        Its id.
    place : int
        Position in the order of the report.
    statement : str
        The claim in words.
    paper : str
        The paper's statement, and its place there.
    judge : callable
        Function of (claim, case) that returns a finding.
    regime : {"accelerated", "steady"} or None
        Motion of the trials that the claim is about; the first rig with such trials is used.
        None if the claim needs no data.
    instead : {"accelerated", "steady"} or None
        Motion of the trials that are used instead if there are none of `regime`; all of
        :data:`COLUMNS` must be recorded for them.
    beside : {"accelerated", "steady"} or None
        Motion of the trials of a second rig that is studied together with the first.
    effects : tuple of Effect
        Effects of the rivals that are not in :func:`bayesfric.effects.all_effects`: other forms
        of the law, which a diagnosis does not examine.
    rivals : tuple of LawWithEffects
        Rival hypotheses. In a rival with the paper's law, this is replaced by the claimed law.
    levels : mapping of str to int
        Least number of different values of a column of the trials, so that the rivals differ
        from the claim; ``tension`` counts the loads of the cable.
    speeds : int
        Least number of different absolute speeds of trials at constant speed.
    by_size : bool
        Whether each pulley size is also compared alone.
    about_these_data : bool
        Whether the verdict depends on these data; if not, it rests on the paper's numbers or
        on priors.
    """

    name: str
    place: int
    statement: str
    paper: str
    judge: Callable[["Claim", "Case"], Finding]
    regime: Regime | None = None
    instead: Regime | None = None
    beside: Regime | None = None
    effects: tuple[Effect, ...] = ()
    rivals: tuple[LawWithEffects, ...] = ()
    levels: Mapping[str, int] = field(default_factory=dict)
    speeds: int = 1
    by_size: bool = True
    about_these_data: bool = True

    def subject(self, entered: Entered) -> str:
        """Return the name of the data that the claim is judged on, if it is testable."""
        needed = (self.moving(entered), self.beside)
        return "+".join(str(entered.first(regime)) for regime in needed if regime is not None)

    def moving(self, entered: Entered) -> Regime | None:
        """Return the motion of the trials on which the claim is judged with these data."""
        for regime in (self.regime, self.instead):
            if regime is not None and entered.first(regime) is not None:
                return regime
        return self.regime

    def against(self, entered: Entered) -> tuple[LawWithEffects, ...]:
        """Return the rivals; effects of a rival on the paper's law are added to the claimed law."""
        return tuple(
            replace(rival, law=entered.law) if rival.law == PAPER else rival
            for rival in self.rivals
        )

    def untestable(self, entered: Entered) -> str:
        """Return what the data lack to compare the claim with its rivals; empty if nothing."""
        if not entered.has_pulleys:
            return "The claim is about cables over pulleys, and these data have none."
        for regime in (self.moving(entered), self.beside):
            if regime is not None and entered.first(regime) is None:
                return entered.lack(regime)
        if self.regime is None:
            return ""
        if self.beside is not None:
            shared = self.subject(entered) in entered.data
            return "" if shared else "The two boards have no pulley size in common."
        trials = entered.trials(self.subject(entered))
        if self.moving(entered) != self.regime:
            if absent := [WORDS[name] for name in COLUMNS if name not in trials.asked]:
                are = "is" if len(absent) == 1 else "are"
                return f"The {' and the '.join(absent)} {are} not recorded."
            if (levels := trials.recorded["velocity_m_s"].abs().nunique()) < self.speeds:
                return f"The speed takes {levels} of at least {self.speeds} values."
        for name, least in self.levels.items():
            if (levels := trials.levels(name)) < least:
                return f"The {WORDS[name]} takes {levels} of at least {least} values."
        effects_by_name = all_effects() | {effect.name: effect for effect in self.effects}
        for effect in dict.fromkeys(name for rival in self.rivals for name, _ in rival.effects):
            if (missing := trials.supports(effects_by_name[effect])) is not None:
                return missing.reason
        return ""

    def elsewhere(self, entered: Entered) -> str:
        """Return a sentence if the claim is judged on another rig than its own; else nothing."""
        if self.moving(entered) == self.regime or self.untestable(entered):
            return ""
        words = entered.trials(self.subject(entered)).rig.words
        return f" Judged on {words.trials} of the {words.rig}, at constant speed."

    def tasks(self, entered: Entered) -> list[Task]:
        """Return the studies that the claim needs and these data allow."""
        if self.regime is None or self.untestable(entered):
            return []
        subject = self.subject(entered)
        names = [subject]
        if self.beside is not None:  # draws given the first rig's data are used for those of both
            names.insert(0, Task(subject, entered.claimed).of_first.data)
        if self.by_size:
            names += [name for name in entered.data if name.startswith(f"{subject}/")]
        return [
            Task(name, hypothesis)
            for name in names
            for hypothesis in (entered.claimed, *self.against(entered))
        ]


@dataclass(frozen=True)
class Case:
    """The data and studies that claims are judged on.

    Parameters
    ----------
    recording : Recording
        The recording as read.
    analysis : Analysis
        Rules, priors and seed.
    entered : Entered
        The data by rig and size.
    studied : mapping of Task to Studied
        The result of every task of every claim.
    effects : mapping of str to Effect
        Effects of all rivals by name, with the priors of the analysis.
    posterior : mapping of str to mapping of str to ndarray
        Draws of the law by rig and parameter, from existing fits of single rigs.
    """

    recording: Recording
    analysis: Analysis
    entered: Entered
    studied: Mapping[Task, Studied]
    effects: Mapping[str, Effect] = field(default_factory=dict)
    posterior: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)

    def draws(self, rig: str) -> Mapping[str, Array]:
        """Return draws of the law by parameter given one rig's data; empty if there are none."""
        return self.posterior.get(rig) or self.studied[Task(rig, self.entered.claimed)].theta

    def undrawn(self, rig: str) -> Finding | None:
        """Return an undecided finding if the law has no draws given one rig's data; else None."""
        if self.draws(rig):
            return None
        why = self.studied[Task(rig, self.entered.claimed)].why
        return Finding("undecided", f"The posterior could not be drawn: {why}.")
