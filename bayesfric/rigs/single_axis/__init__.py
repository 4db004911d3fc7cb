"""A single driven axis: force in, position out, acceleration never measured."""

from bayesfric.rigs.single_axis.kind import RIG

__all__ = ["RIG"]
