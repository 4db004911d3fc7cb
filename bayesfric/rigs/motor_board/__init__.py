"""The motor board: constant speed, friction by current (paper Sec. III.A)."""

from bayesfric.rigs.motor_board.kind import RIG

__all__ = ["RIG"]
