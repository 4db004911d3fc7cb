"""The motor board: constant speed, friction by current (paper Sec. III.A)."""
