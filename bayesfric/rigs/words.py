"""Names of a rig and its parts in sentences."""

from dataclasses import dataclass
from typing import Any, Literal

Regime = Literal["accelerated", "steady"]
"""Whether a trial accelerates along a path, or is one measurement at constant speed."""


@dataclass(frozen=True)
class Words:
    """Names of a rig and its parts in sentences.

    Parameters
    ----------
    rig : str
        Name of the rig, such as ``gravity board``.
    trial, trials : str
        Name of its trials, singular and plural.
    law : str
        Sentences on its law and its likelihood; empty if they are those of the paper.
    group, groups : str
        Name of a group of trials with the same ``setup``, singular and plural.
    regime : str
        Motion of its trials.
    paper : bool
        Whether the rig is one of the paper's, which the protocols simulate.
    thresholds : dataclass or None
        Thresholds for reading its log, if there are any;
        :func:`bayesfric.rules.rules_of` lists them.
    """

    rig: str
    trial: str
    trials: str
    law: str = ""
    group: str = "assembly"
    groups: str = "assemblies"
    regime: Regime = "steady"
    paper: bool = False
    thresholds: Any = None
