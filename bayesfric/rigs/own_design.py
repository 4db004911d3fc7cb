"""The design of a simulation of a rig that the paper's protocols do not contain."""

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
    """Simulated data of a rig.

    Parameters
    ----------
    tables : mapping of str to object
        Tables by their field of :class:`bayesfric.recording.tables.Recording`.
    trials : int
        Number of trials.
    stalled : tuple of str
        Trials that stalled with too few events to be recorded.
    """

    tables: Mapping[str, Any]
    trials: int
    stalled: tuple[str, ...] = ()


@dataclass(frozen=True)
class OwnDesign:
    """The design of a simulation of one rig, with a name like those of the paper's protocols.

    Parameters
    ----------
    name : str
        Name in ``bayesfric simulate --protocol``.
    title : str
        Title of the simulated recording.
    constants : RigConstants
        Constants of the rig.
    coefficients : mapping of str to Coefficients
        Default law of each size, if a truth contains no law of the rig's sizes.
    offers : frozenset of str
        Quantities that it offers to effects, see ``needs`` of
        :class:`bayesfric.effects.Effect`.
    change : callable
        Function of (effect, constants, truth) that returns a
        :data:`~bayesfric.rigs.changes.Change`, or None if the effect cannot act.
    simulate : callable
        Function of (constants, truth, seed) that returns the simulated data.
    """

    name: str
    title: str
    constants: RigConstants
    coefficients: Mapping[str, Coefficients]
    offers: frozenset[str]
    change: Callable[[Effect, RigConstants, Truth], Change | None]
    simulate: Callable[[RigConstants, Truth, int], Simulated]
