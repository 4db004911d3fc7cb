"""The trials of all rigs that are analysed together."""

from dataclasses import dataclass

from bayesfric.rigs.base import RigTrials


@dataclass(frozen=True)
class Data:
    """Trials that are used in a fit, a comparison or a diagnosis.

    Parameters
    ----------
    rigs : tuple of RigTrials
        The trials of each rig, in the order of :func:`bayesfric.rigs.all_rigs`.
    """

    rigs: tuple[RigTrials, ...]

    @property
    def sizes(self) -> tuple[str, ...]:
        """Pulley sizes, in order of appearance."""
        return tuple(dict.fromkeys(size for rig in self.rigs for size in rig.table["pulley_size"]))

    @property
    def unit(self) -> str:
        """Unit of forces: that of the first rig."""
        return self.rigs[0].unit

    def law_numbers(self, size: str) -> tuple[tuple[str, str], ...]:
        """Return name and unit of each coefficient of a size, by the first rig that has it."""
        first = next(rig for rig in self.rigs if (rig.table["pulley_size"] == size).any())
        return first.law_numbers(size)

    def of_size(self, size: str) -> "Data":
        """Return the trials of one pulley size; a rig without any is left out."""
        chosen = (rig.select(rig.table["pulley_size"] == size) for rig in self.rigs)
        return Data(tuple(rig for rig in chosen if rig is not None))
