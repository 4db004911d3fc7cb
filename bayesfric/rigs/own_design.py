"""What a rig that no protocol of the paper's lays out is simulated with."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from bayesfric.effects import Effect
from bayesfric.physics.friction import Coefficients
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.changes import Change
from bayesfric.rigs.truth import Truth


@dataclass(frozen=True)
class Simulated:
    """What a rig recorded.

    Parameters
    ----------
    tables : mapping of str to object
        Fields of :class:`bayesfric.recording.tables.Recording`.
    trials : int
        How many trials there are.
    stalled : tuple of str
        Trials that stalled and could not be written.
    """

    tables: Mapping[str, Any]
    trials: int
    stalled: tuple[str, ...] = ()


@dataclass(frozen=True)
class OwnDesign:
    """A design of a rig's own, by a name beside those of the paper's protocols.

    Parameters
    ----------
    name : str
        As ``bayesfric simulate --protocol`` has it.
    title : str
        What is simulated.
    constants : RigConstants
        Of the rig.
    coefficients : mapping of str to Coefficients
        The law of a truth that has none of the rig's sizes.
    offers : frozenset of str
        What effects may need of it.
    change : callable
        (effect, constants, truth) to what the effect changes relative to friction.
    simulate : callable
        (constants, truth, seed) to what is recorded.
    """

    name: str
    title: str
    constants: RigConstants
    coefficients: Mapping[str, Coefficients]
    offers: frozenset[str]
    change: Callable[[Effect, RigConstants, Truth], Change | None]
    simulate: Callable[[RigConstants, Truth, int], Simulated]
