"""What each pulley size brings to the linear model: priors, radius, unit of force."""

import numpy as np

from bayesfric.analysis import Analysis, Prior
from bayesfric.paper import table1
from bayesfric.rigs.data import Data
from bayesfric.rigs.gravity_board.rows import GravityRows
from bayesfric.rigs.motor_board.linear import MotorPart

__all__ = ["coefficient_prior", "pulley_radii", "rms_friction"]


def coefficient_prior(analysis: Analysis, name: str, size: str) -> Prior:
    """Return the prior of a coefficient of one size, which may have its own."""
    own = analysis.priors.pulleys.get(size)
    chosen: Prior | None = None if own is None else getattr(own, name)
    shared: Prior = getattr(analysis.priors, name)
    return shared if chosen is None else chosen


def pulley_radii(data: Data) -> dict[str, float]:
    """Return each size's pulley radius, of the medium size where nobody says [m]."""
    known = {size: row.radius_m for size, row in table1().items()}
    radii = {}
    for size in data.sizes:
        pulley = data.constants.pulleys.get(size)
        stated = None if pulley is None else pulley.radius_m
        radii[size] = stated or known.get(size) or known["medium"]
    return radii


def rms_friction(
    sizes: tuple[str, ...], rows: GravityRows | None, motor: MotorPart | None
) -> dict[str, float]:
    """Return the rms friction of each size by the reference law, on all boards [N]."""
    scale = {}
    for size in sizes:
        found = []
        for part in (rows, motor):
            if part is not None:
                found.append(part.friction_n[(part.trials["pulley_size"] == size).to_numpy()])
        scale[size] = float(np.sqrt(np.mean(np.concatenate(found) ** 2)))
    return scale
