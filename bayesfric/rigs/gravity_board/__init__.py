"""The gravity board, an Atwood machine over n pulleys (paper Sec. III.B)."""
