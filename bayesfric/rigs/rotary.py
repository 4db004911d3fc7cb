"""Units of a machine that turns, and of forces that are told over a servo's stiffness.

A machine that turns has radians, newton metres and kg m² for metres, newtons and kg.
"""

import re

TURNED = {"N": "N·m", "m": "rad", "kg": "kg·m²"}
PER_STIFFNESS = " per K"
"""Behind a unit: of a number over the stiffness K [N/m, or N·m/rad] of a servo."""


def rotary_unit(unit: str) -> str:
    """Return the unit on a machine that turns of what has this unit on one that slides."""
    return re.sub(r"[A-Za-z]+", lambda word: TURNED.get(word[0], word[0]), unit)


def over_stiffness(unit: str) -> str:
    """Return the unit of what has this unit, over a stiffness K where it is one of forces."""
    above, _, below = unit.partition("/")
    if re.search(r"\b(N|kg)", above):
        return unit + PER_STIFFNESS
    return f"K{unit[1:]}" if re.search(r"\b(N|kg)", below) else unit


def is_relative(unit: str) -> bool:
    """Return whether a unit is one over a servo's stiffness."""
    return unit.endswith(PER_STIFFNESS)


def turns(unit: str) -> bool:
    """Return whether a unit of force is one of a machine that turns."""
    return unit.removesuffix(PER_STIFFNESS) == TURNED["N"]
