"""What a rig is called in sentences."""

from dataclasses import dataclass
from typing import Any, Literal

Regime = Literal["accelerated", "steady"]
"""Whether a trial gathers speed along a path, or is one measurement at one speed."""


@dataclass(frozen=True)
class Words:
    """What a rig and its parts are called in sentences.

    Parameters
    ----------
    rig : str
        As in ``gravity board``.
    trial, trials : str
        One of its measurements, and several.
    law : str
        What its law and its likelihood are, in sentences; nothing where they are the paper's.
    group, groups : str
        What trials of one value of ``setup`` are together, and several of these.
    regime : str
        How its trials move.
    paper : bool
        Whether it is one of the paper's own, which its protocols are for.
    thresholds : dataclass or None
        By which its log is read, where there are some;
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
