"""What is true of every rig whose cable runs over pulleys: it is what all was argued for."""

from collections.abc import Mapping

from bayesfric.analysis import PriorOverrides
from bayesfric.effects import PULLEYS, Effect
from bayesfric.physics.laws import VISCOUS, Baseline
from bayesfric.rigs.base import OwnLaw, RigTrials, Unsupported
from bayesfric.rigs.coefficients import coefficient_name, coefficient_units
from bayesfric.simulators import SimulatorCalls

__all__ = ["PulleyTrials"]


class PulleyTrials:
    """Trials of a cable over pulleys, for which laws, priors and effects were argued."""

    @property
    def offers(self) -> frozenset[str]:
        """Pulleys, which most effects were described for."""
        return PULLEYS

    @property
    def has_pulleys(self) -> bool:
        """True."""
        return True

    def refuses(self, law: Baseline) -> Unsupported | None:
        """Return why not, of the one law that is an axis' own."""
        if law.name == VISCOUS:
            return Unsupported("Over pulleys viscous friction is an effect, which is diagnosed.")
        return None

    @property
    def unit(self) -> str:
        """Newton."""
        return "N"

    def law_numbers(self, size: str) -> tuple[tuple[str, str], ...]:
        """Return c1, c2 and c3 of a pulley size, with their units."""
        units = coefficient_units(self.unit)
        return tuple((coefficient_name(name, size), unit) for name, unit in units.items())

    @property
    def own_priors(self) -> Mapping[str, PriorOverrides]:
        """Return nothing: the defaults are argued for cables over pulleys."""
        return {}

    @property
    def own_law(self) -> OwnLaw | None:
        """None: the baseline is a law of the package."""
        return None

    def beside(self, simulator: SimulatorCalls) -> "RigTrials | Unsupported":
        """Decline: what a simulator says of a run is compared with a log."""
        return Unsupported(
            f"{simulator.name} predicts positions over time, which only a single axis logs"
        )

    def suited(self, effect: Effect) -> Effect:
        """Return the effect as it is: it was described for cables over pulleys."""
        return effect
