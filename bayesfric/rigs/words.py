"""Names of a rig and its parts in sentences."""

from dataclasses import dataclass
from typing import Any, Literal

Regime = Literal["accelerated", "steady"]
"""Whether a trial gathers speed along a path, or is one measurement at one speed."""


@dataclass(frozen=True)
class Words:
    """Names of a rig and its parts in sentences.

    Parameters
    ----------
    rig : str
        As in ``gravity board``.
    trial, trials : str
        Singular and plural of its measurements.
    law : str
        What its law and its likelihood are, in sentences; nothing where they are the paper's.
    group, groups : str
        What trials of one value of ``setup`` are together, and several of these.
    regime : str
        How its trials move.
    paper : bool
        Whether it is one of the paper's own, which its protocols are for.
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
