"""The trials of all rigs that are analysed together."""

from collections.abc import Mapping
from dataclasses import dataclass

from bayesfric.rigs.base import RigTrials


@dataclass(frozen=True)
class Data:
    """Trials that are used in a fit, a comparison or a diagnosis.

    Parameters
    ----------
    rigs : tuple of RigTrials
        Trials of each rig, in the order of :func:`bayesfric.rigs.all_rigs`.
    """

    rigs: tuple[RigTrials, ...]

    @property
    def sizes(self) -> tuple[str, ...]:
        """Pulley sizes, in order of appearance."""
        return tuple(dict.fromkeys(size for rig in self.rigs for size in rig.table["pulley_size"]))

    @property
    def unit(self) -> str:
        """Unit of forces on the first rig."""
        return self.rigs[0].unit

    @property
    def untold(self) -> Mapping[str, str]:
        """Coefficients that the data cannot determine, each with the reason."""
        return {name: reason for rig in self.rigs for name, reason in rig.untold.items()}

    def law_numbers(self, size: str) -> tuple[tuple[str, str], ...]:
        """Return name and unit of each coefficient of a size, from the first rig with this size."""
        first = next(rig for rig in self.rigs if (rig.table["pulley_size"] == size).any())
        return first.law_numbers(size)

    def of_size(self, size: str) -> "Data":
        """Return the trials of one pulley size; a rig without any is left out."""
        chosen = (rig.select(rig.table["pulley_size"] == size) for rig in self.rigs)
        return Data(tuple(rig for rig in chosen if rig is not None))
