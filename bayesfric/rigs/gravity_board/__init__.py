"""The gravity board, an Atwood machine over n pulleys (paper Sec. III.B)."""

from bayesfric.rigs.gravity_board.kind import RIG

__all__ = ["RIG"]
