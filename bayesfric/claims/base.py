"""What a claim is, what it is judged on, and what is found."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import permutations
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from bayesfric.analysis import Analysis
from bayesfric.claims.studies import Studied, Task
from bayesfric.effects import all_effects
from bayesfric.errors import Fault, InputError
from bayesfric.fitting.hypothesis import Hypothesis
from bayesfric.physics.laws import BASELINES
from bayesfric.recording.tables import Recording
from bayesfric.rigs import all_rigs
from bayesfric.rigs.base import Motion, RigTrials
from bayesfric.rigs.data import Data

__all__ = ["PAPER", "Case", "Claim", "Entered", "Finding", "Verdict"]

Array = NDArray[np.float64]
Verdict = Literal["supported", "refuted", "undecided", "not-testable"]
PAPER = "paper"
WORDS = {
    "tension": "tension",
    "n_pulleys": "number of pulleys",
    "wrap_angle_deg": "wrap angle",
}


@dataclass(frozen=True)
class Finding:
    """What a recording says of a claim.

    Parameters
    ----------
    verdict : {"supported", "refuted", "undecided", "not-testable"}
        By the rules of the analysis.
    reason : str
        The verdict in a sentence, with its numbers.
    figures : mapping
        Numbers that the verdict rests on, name to number, text or bool.
    log10_bayes_factor, log10_bayes_factor_se : float or None
        In favour of the claim, against the best of its rivals.
    elpd_difference, elpd_difference_se : float or None
        Positive where the claim predicts assemblies better than its best rival.
    why : str
        Why a number above is missing.
    by_pulley : mapping of str to (float or None, float or None, str)
        Bayes factor, its error, and why there is none, for each size alone.
    curve : mapping of str to ndarray
        Log10 Bayes factor over the width of the rivals' priors: ``width`` and
        ``log10_bayes_factor``; empty without.
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
    curve: Mapping[str, Array] = field(default_factory=dict)


@dataclass(frozen=True)
class Entered:
    """The data of a recording that enter, whole and by pulley size, and the law.

    Parameters
    ----------
    data : mapping of str to Data
        By the name of a rig, in the order of :func:`bayesfric.rigs.all_rigs`; by that of
        a rig and a size as in ``RIG/small``; and by those of two rigs as in ``RIG+OTHER``,
        the second with the sizes that it shares with the first.
    left_out : tuple of str
        Rigs of the recording that were not asked for.
    law : str
        The friction law that claims are about, a name in
        :data:`bayesfric.physics.laws.BASELINES`.
    """

    data: Mapping[str, Data]
    left_out: tuple[str, ...] = ()
    law: str = PAPER

    @classmethod
    def of(
        cls, recording: Recording, rigs: Sequence[str] | None = None, law: str = PAPER
    ) -> "Entered":
        """Return the data of the rigs of a recording, or of those that are named.

        Raises
        ------
        InputError
            A rig or the law is unknown, or a rig that is named has no data.
        """
        opened = {name: rig.trials(recording) for name, rig in all_rigs().items()}
        there = {name: one for name, one in opened.items() if one is not None and len(one.table)}
        faults = [
            Fault("rigs", f"one of {', '.join(there)}, the rigs with data", value=name)
            for name in rigs or ()
            if name not in there
        ]
        if law not in BASELINES:
            faults.append(Fault("baseline", f"one of {', '.join(BASELINES)}", value=law))
        if faults:
            raise InputError(faults)
        data = {}
        for name, one in there.items():
            if rigs is None or name in rigs:
                data[name] = Data((one,))
        for name in list(data):
            for size in data[name].sizes:
                data[f"{name}/{size}"] = data[name].of_size(size)
        for first, second in permutations(rigs or there, 2):
            known = there[second].table["pulley_size"].isin(data[first].sizes)
            if (shared := there[second].select(known)) is not None:
                data[f"{first}+{second}"] = Data((there[first], shared))
        return cls(data, tuple(name for name in there if name not in data), law)

    @property
    def baseline(self) -> Hypothesis:
        """The law, and nothing beside it."""
        return Hypothesis(self.law)

    @property
    def rigs(self) -> tuple[str, ...]:
        """Names of the rigs."""
        return tuple(name for name in self.data if "/" not in name and "+" not in name)

    def whole(self) -> "Entered":
        """Return the data of all sizes together, without those of each."""
        return replace(self, data={name: self.data[name] for name in self.rigs})

    def trials(self, name: str) -> RigTrials:
        """Return the trials of a rig."""
        (trials,) = self.data[name].rigs
        return trials

    def first(self, motion: Motion) -> str | None:
        """Return the name of the first rig that moves so, if one has data."""
        moving = (name for name in self.rigs if self.trials(name).rig.motion == motion)
        return next(moving, None)

    def lack(self, motion: Motion) -> str:
        """Return why there is no rig that moves so, a sentence."""
        kinds = [rig for rig in all_rigs().values() if rig.motion == motion]
        without = [rig for rig in kinds if rig.name in self.left_out]
        if without:
            return f"The {' and the '.join(rig.words.rig for rig in without)} was left out."
        return f"The recording has no {' or '.join(rig.words.rig for rig in kinds)}."


@dataclass(frozen=True)
class Claim:
    """A statement of the paper.

    Parameters
    ----------
    name : str
        Its id.
    place : int
        In the order of the report.
    statement : str
        What is claimed.
    paper : str
        What the paper states, and where.
    judge : callable
        (claim, case) to a finding.
    motion : {"accelerated", "steady"} or None
        How the trials that it is about move; it takes the first rig whose trials do.
        None where it needs no data.
    beside : {"accelerated", "steady"} or None
        How the trials of a second rig move, with which the first is studied together.
    rivals : tuple of Hypothesis
        What it is compared with; of the paper's law where it is named, else as it is.
    levels : mapping of str to int
        How many different values a column of the trials must have for the rivals to
        differ from the claim; ``tension`` counts sums of the two masses.
    by_size : bool
        Whether each pulley size is also compared alone.
    about_these_data : bool
        Whether these data could speak for or against it; else it rests on the paper's
        numbers or on priors.
    """

    name: str
    place: int
    statement: str
    paper: str
    judge: Callable[["Claim", "Case"], Finding]
    motion: Motion | None = None
    beside: Motion | None = None
    rivals: tuple[Hypothesis, ...] = ()
    levels: Mapping[str, int] = field(default_factory=dict)
    by_size: bool = True
    about_these_data: bool = True

    def rig(self, entered: Entered) -> str:
        """Return the name of the data that the claim is judged on, where it is testable."""
        needed = (motion for motion in (self.motion, self.beside) if motion is not None)
        return "+".join(str(entered.first(motion)) for motion in needed)

    def against(self, entered: Entered) -> tuple[Hypothesis, ...]:
        """Return the rivals; those that add to the law add to the one that is claimed."""
        return tuple(
            replace(one, law=entered.law) if one.law == PAPER else one for one in self.rivals
        )

    def untestable(self, entered: Entered) -> str:
        """Return what the data lack to compare the claim with its rivals, or nothing."""
        for motion in (self.motion, self.beside):
            if motion is not None and entered.first(motion) is None:
                return entered.lack(motion)
        if self.motion is None:
            return ""
        if self.beside is not None:
            shared = self.rig(entered) in entered.data
            return "" if shared else "The two boards have no pulley size in common."
        trials = entered.trials(self.rig(entered))
        for name, least in self.levels.items():
            if (found := trials.levels(name)) < least:
                return f"The {WORDS[name]} takes {found} of at least {least} values."
        for effect in dict.fromkeys(name for one in self.rivals for name, _ in one.effects):
            if (missing := trials.supports(all_effects()[effect])) is not None:
                return missing.reason
        return ""

    def tasks(self, entered: Entered) -> list[Task]:
        """Return what must be studied, of the data that there are."""
        if self.motion is None or self.untestable(entered):
            return []
        rig = self.rig(entered)
        names = [rig]
        if self.by_size:
            names += [name for name in entered.data if name.startswith(f"{rig}/")]
        return [
            Task(name, one) for name in names for one in (entered.baseline, *self.against(entered))
        ]


@dataclass(frozen=True)
class Case:
    """What claims are judged on.

    Parameters
    ----------
    recording : Recording
        As read.
    analysis : Analysis
        Rules, priors and seed.
    entered : Entered
        The data.
    studied : mapping of Task to Studied
        Of every task of every claim.
    posterior : mapping of str to mapping of str to ndarray
        Draws of the law by rig and parameter, where a fit of that rig alone has them
        already.
    """

    recording: Recording
    analysis: Analysis
    entered: Entered
    studied: Mapping[Task, Studied]
    posterior: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)

    def baseline(self, rig: str) -> Mapping[str, Array]:
        """Return draws of the law by parameter, given one rig's data; empty without any."""
        return self.posterior.get(rig) or self.studied[Task(rig, self.entered.baseline)].theta

    def undrawn(self, rig: str) -> Finding | None:
        """Return the finding where the law has no draws given one rig's data."""
        if self.baseline(rig):
            return None
        why = self.studied[Task(rig, self.entered.baseline)].why
        return Finding("undecided", f"The posterior could not be drawn: {why}.")
