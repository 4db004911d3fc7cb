"""What several verbs are asked for alike."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bayesfric.analysis import Analysis


@dataclass(frozen=True)
class Asked:
    """The options of a call that decide a result, and how much is printed.

    Parameters
    ----------
    analysis : Analysis
        Settings, with the seed.
    rigs : sequence of str or None
        Rigs whose data are used; None for the default of the verb.
    baseline : str
        Friction law.
    quiet, verbose : bool
        Print results only; print all results.
    """

    analysis: "Analysis"
    rigs: Sequence[str] | None = None
    baseline: str = "paper"
    quiet: bool = False
    verbose: bool = False
