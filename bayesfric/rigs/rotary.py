"""Units of a machine that turns: radians, newton metres and kg m² for metres, newtons and kg."""

import re

TURNED = {"N": "N·m", "m": "rad", "kg": "kg·m²"}


def rotary_unit(unit: str) -> str:
    """Return the unit on a machine that turns of what has this unit on one that slides."""
    return re.sub(r"[A-Za-z]+", lambda word: TURNED.get(word[0], word[0]), unit)
