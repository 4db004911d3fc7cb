"""Units of rotary machines, and of forces that are divided by the stiffness of a servo.

On a rotary machine radians, newton metres and kg m² replace metres, newtons and kg.
"""

import re

TURNED = {"N": "N·m", "m": "rad", "kg": "kg·m²"}
PER_STIFFNESS = " per K"
"""Suffix of the unit of a number that is divided by a servo's stiffness K [N/m, or N·m/rad]."""


def rotary_unit(unit: str) -> str:
    """Return the unit on a rotary machine of a quantity with this unit on a linear one."""
    return re.sub(r"[A-Za-z]+", lambda word: TURNED.get(word[0], word[0]), unit)


def over_stiffness(unit: str) -> str:
    """Return the unit of a quantity relative to a stiffness K; unchanged without a force."""
    above, _, below = unit.partition("/")
    if re.search(r"\b(N|kg)", above):
        return unit + PER_STIFFNESS
    return f"K{unit[1:]}" if re.search(r"\b(N|kg)", below) else unit


def is_relative(unit: str) -> bool:
    """Return whether a unit is that of a number divided by a servo's stiffness."""
    return unit.endswith(PER_STIFFNESS)


def turns(unit: str) -> bool:
    """Return whether a unit of force is that of a rotary machine."""
    return unit.removesuffix(PER_STIFFNESS) == TURNED["N"]
