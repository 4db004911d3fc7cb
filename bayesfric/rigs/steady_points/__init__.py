"""Friction measured at steady motion, by whatever means: one reading a point."""

from bayesfric.rigs.steady_points.kind import RIG

__all__ = ["RIG"]
