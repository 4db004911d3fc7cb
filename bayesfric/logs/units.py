"""Units of a log's columns, and their factors to the units of a recording."""

import math

SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
ROTARY = {
    "rad": 1.0,
    "mrad": 1e-3,
    "deg": 0.017453292519943295,
    "turn": 6.283185307179586,
    "tick": 1.0,  # by counts_per_turn, or a factor
}
"""Positions of a joint that turns, in rad."""
SLIDING = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6}
LENGTHS = {**SLIDING, **ROTARY}
SPEEDS = {
    "m/s": 1.0,
    "mm/s": 1e-3,
    "rad/s": 1.0,
    "deg/s": 0.017453292519943295,
    "turn/s": 6.283185307179586,
    "rpm": 2 * math.pi / 60,
}
TORQUES = {
    "N·m": 1.0,
    "Nm": 1.0,
    "N*m": 1.0,
    "N.m": 1.0,
    "mN·m": 1e-3,
    "mNm": 1e-3,
    "N·mm": 1e-3,
    "Nmm": 1e-3,
    "N·cm": 1e-2,
    "Ncm": 1e-2,
    "kN·m": 1e3,
    "kNm": 1e3,
    "kgf·cm": 0.0980665,
    "kgf·m": 9.80665,
}
STRAIGHT = {"N": 1.0, "mN": 1e-3, "kN": 1e3, "kgf": 9.80665}
ELECTRIC = {"A": 1.0, "mA": 1e-3, "V": 1.0, "mV": 1e-3, "share": 1.0, "%": 1e-2, "raw": 1.0}
"""Units instead of a force that need a factor: N·m (or N) for 1 A, 1 V, full PWM, 1 count."""
FORCES = {**TORQUES, **STRAIGHT, **ELECTRIC}
