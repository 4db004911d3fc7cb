"""The radius of each size of pulleys, as it was stated or as the paper has it."""

from collections.abc import Sequence

from bayesfric.paper import table1
from bayesfric.recording.tables import RigConstants


def pulley_radii(sizes: Sequence[str], constants: RigConstants) -> dict[str, float]:
    """Return each size's pulley radius, of the medium size where nobody says [m]."""
    paper_radii = {size: row.radius_m for size, row in table1().items()}
    radii = {}
    for size in sizes:
        pulley = constants.pulleys.get(size)
        stated = None if pulley is None else pulley.radius_m
        radii[size] = stated or paper_radii.get(size) or paper_radii["medium"]
    return radii
