"""What trials of a cable over pulleys offer to effects, for which all priors are argued."""

from collections.abc import Mapping

from bayesfric.analysis import PriorOverrides
from bayesfric.effects import PULLEYS, Effect

__all__ = ["PulleyTrials"]


class PulleyTrials:
    """Trials of a cable over pulleys; see :class:`bayesfric.rigs.base.RigTrials`."""

    @property
    def offers(self) -> frozenset[str]:
        """Pulleys."""
        return PULLEYS

    @property
    def own_priors(self) -> Mapping[str, PriorOverrides]:
        """None: those of the analysis are argued for it."""
        return {}

    def suited(self, effect: Effect) -> Effect:
        """Return the effect as it is."""
        return effect
