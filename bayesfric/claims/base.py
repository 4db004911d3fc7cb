"""What a claim is, what it is judged on, and what is found."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from bayesfric.analysis import Analysis
from bayesfric.claims.studies import Studied, Task
from bayesfric.fitting.hypothesis import Hypothesis
from bayesfric.recording.tables import Recording
from bayesfric.rigs.data import Data

__all__ = ["BASELINE", "Case", "Claim", "Finding", "Verdict"]

Array = NDArray[np.float64]
Verdict = Literal["supported", "refuted", "undecided", "not-testable"]
Board = Literal["gravity", "motor"]
BASELINE = Hypothesis()
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
        In favour of the claim, against the average of its rivals.
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
    board : {"gravity", "motor"} or None
        Whose data it needs; None where it needs both or none.
    rivals : tuple of Hypothesis
        What it is compared with.
    levels : mapping of str to int
        How many different values a column of the trials must have for the rivals to
        differ from the claim; ``tension`` counts sums of the two masses.
    by_size : bool
        Whether each pulley size is also compared alone.
    """

    name: str
    place: int
    statement: str
    paper: str
    judge: Callable[["Claim", "Case"], Finding]
    board: Board | None = None
    rivals: tuple[Hypothesis, ...] = ()
    levels: Mapping[str, int] = field(default_factory=dict)
    by_size: bool = True

    def untestable(self, data: Mapping[str, Data]) -> str:
        """Return what the recording lacks to compare the claim with its rivals, or nothing."""
        if self.board is None:
            return ""
        if self.board not in data:
            return f"The recording has no {self.board} board."
        (trials,) = data[self.board].rigs
        for name, least in self.levels.items():
            if (found := trials.levels(name)) < least:
                return f"The {WORDS[name]} takes {found} of at least {least} values."
        return ""

    def tasks(self, data: Mapping[str, Data]) -> list[Task]:
        """Return what must be studied, of the data that there are."""
        if self.board is None or self.untestable(data):
            return []
        names: list[str] = [self.board]
        if self.by_size:
            names += [name for name in data if name.startswith(f"{self.board}/")]
        return [Task(name, one) for name in names for one in (BASELINE, *self.rivals)]


@dataclass(frozen=True)
class Case:
    """What claims are judged on.

    Parameters
    ----------
    recording : Recording
        As read.
    analysis : Analysis
        Rules, priors and seed.
    data : mapping of str to Data
        ``gravity`` and ``motor`` where they are there, and these of each size.
    studied : mapping of Task to Studied
        Of every task of every claim.
    posterior : mapping of str to ndarray, or None
        Draws of the law given the gravity board's data by parameter, where a fit has
        them already.
    """

    recording: Recording
    analysis: Analysis
    data: Mapping[str, Data]
    studied: Mapping[Task, Studied]
    posterior: Mapping[str, Array] | None = None

    def baseline(self, board: Board) -> Mapping[str, Array]:
        """Return draws of the law by parameter, given one board's data."""
        if board == "gravity" and self.posterior is not None:
            return self.posterior
        return self.studied[Task(board, BASELINE)].theta
