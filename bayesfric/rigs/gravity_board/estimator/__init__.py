"""The paper's own estimator: friction of each trial, then slopes, then slopes of slopes.

1. The friction fc of each trial by least squares on its motion, with eq. (4).
2. At each (size, n, θ) a straight line of fc against nominal tension, with its R².
3. At 85°, the slopes and the intercepts of these lines as proportional to n,
   eqs. (6) and (7): c1 and c2.
4. At each n, a straight line of the slopes against θ; its slopes as proportional
   to n, eqs. (9) to (11): c3.

It is printed beside the posterior.
"""

from dataclasses import dataclass

from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.estimator.slopes import (
    CellLine,
    SizeEstimate,
    Slope,
    WrapLine,
    is_upright,
    lines_of_sizes,
)
from bayesfric.rigs.gravity_board.estimator.trials import TrialFriction, trial_frictions

__all__ = [
    "CellLine",
    "PaperEstimate",
    "SizeEstimate",
    "Slope",
    "TrialFriction",
    "WrapLine",
    "estimate_as_the_paper",
    "is_upright",
    "lines_of_sizes",
    "trial_frictions",
]


@dataclass(frozen=True)
class PaperEstimate:
    """All steps.

    Parameters
    ----------
    trials : tuple of TrialFriction
        In the order of the recording.
    sizes : tuple of SizeEstimate
        In the order in which the sizes appear.
    """

    trials: tuple[TrialFriction, ...]
    sizes: tuple[SizeEstimate, ...]


def estimate_as_the_paper(gravity: Gravity, rig: RigConstants) -> PaperEstimate:
    """Run the paper's estimator on the trials of a gravity board, with eq. (4).

    Parameters
    ----------
    gravity : Gravity
        Trials that enter; stalled ones are the caller's to exclude.
    rig : RigConstants
        For gravity.

    Returns
    -------
    PaperEstimate
        Every step.
    """
    trials = trial_frictions(gravity, rig)
    return PaperEstimate(trials, lines_of_sizes(trials))
