"""Friction measured in steady motion by any method, with one reading for each point."""

from bayesfric.rigs.steady_points.kind import RIG

__all__ = ["RIG"]
