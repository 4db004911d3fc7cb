"""What warms up as points are taken, where nobody wrote a temperature down.

A machine that runs gets warm, fast at first, until it loses as much heat as friction makes. Point
by point that is what surfaces do that settle: without a temperature the two are one, and what is
said of one holds for the other.
"""

from dataclasses import replace

from bayesfric.effects import Effect, all_effects
from bayesfric.rigs.steady_points.bench import Bench

WARMTH = "warmth"  # what an effect of temperature needs
IN_ORDER = "wear-drift"  # the effect that goes by the order of the points


def warms_unseen(bench: Bench) -> bool:
    """Return whether grease may warm up of which nobody wrote a temperature down."""
    return not bench.has_pulleys and not any("temp" in name.lower() for name in bench.covariates)


def over_the_points(effect: Effect) -> Effect:
    """Return an effect of warmth by the order of the points, with a rate at which it dies out.

    Parameters
    ----------
    effect : Effect
        Which changes friction by a share of itself.
    """
    in_order = all_effects(None)[IN_ORDER]
    return replace(effect, laws=in_order.laws, shape=in_order.shape, edge=in_order.edge)
