"""Radii of pulleys by size: the stated ones, otherwise those of the paper."""

from collections.abc import Sequence

from bayesfric.paper import table1
from bayesfric.recording.tables import RigConstants


def pulley_radii(sizes: Sequence[str], constants: RigConstants) -> dict[str, float]:
    """Return the pulley radius of each size; for an unknown size that of medium pulleys [m]."""
    paper_radii = {size: row.radius_m for size, row in table1().items()}
    radii = {}
    for size in sizes:
        pulley = constants.pulleys.get(size)
        stated = None if pulley is None else pulley.radius_m
        radii[size] = stated or paper_radii.get(size) or paper_radii["medium"]
    return radii
