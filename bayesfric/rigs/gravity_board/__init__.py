"""The gravity board, an Atwood machine over n pulleys (paper Sec. III.B)."""

from bayesfric.rigs.gravity_board.trials import RIG

__all__ = ["RIG"]
