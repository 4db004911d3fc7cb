"""The motor board: friction from the motor current at constant speed (paper Sec. III.A)."""

from bayesfric.rigs.motor_board.kind import RIG

__all__ = ["RIG"]
