"""Forces of recorded payloads on a joint.

On a rotary joint, a mass m at a distance l and an angle α adds m g l sin(q + α) + m l² q̈. On a
linear axis it adds m q̈ and the component of its weight along the axis. The mass is recorded in a
column of ``axis_runs.csv`` whose name ends in ``_kg``. The distance, the angle and the inclination
are unknown, so the forces have unknown amounts, and each run has a share of them by its payload.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from bayesfric.rigs.single_axis.coupling import Scales
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.paths import Path
from bayesfric.rigs.single_axis.weak_form import WeakForce

MASS = "_kg"  # ends the name of a column of masses


def payload_shares(runs: pd.DataFrame) -> Mapping[str, tuple[float, ...]]:
    """Return the payload of each run, from 0 for the smallest to 1 for the largest.

    Parameters
    ----------
    runs : DataFrame
        ``axis_runs.csv``.

    Returns
    -------
    mapping of str to tuple of float
        By the name of the run: a value for each column of masses that varied.
    """
    columns = [str(name) for name in runs if str(name).endswith(MASS)]
    values = runs[columns].to_numpy(dtype=np.float64)
    spread = np.ptp(values, axis=0) if len(runs) else np.zeros(len(columns))
    varied = spread > 0
    shares = (values[:, varied] - values[:, varied].min(axis=0, initial=np.inf)) / spread[varied]
    named = zip(runs["run"], shares, strict=True)
    return {str(run): tuple(map(float, own)) for run, own in named}


def payload_masses(runs: pd.DataFrame) -> Mapping[str, float]:
    """Return by how much the payload of each run exceeds the smallest payload, by name [kg].

    Empty unless exactly one column of masses varied: several masses may be at different distances.

    Parameters
    ----------
    runs : DataFrame
        ``axis_runs.csv``.
    """
    columns = [str(name) for name in runs if str(name).endswith(MASS)]
    varied = [name for name in columns if np.ptp(runs[name].to_numpy(dtype=np.float64)) > 0]
    if len(varied) != 1:
        return {}
    masses = runs[varied[0]].to_numpy(dtype=np.float64)
    return {
        str(run): float(mass - masses.min()) for run, mass in zip(runs["run"], masses, strict=True)
    }


def payload_forces(
    path: Path, log: EvenLog, shares: Sequence[float], scales: Scales, rotary: bool
) -> list[WeakForce]:
    """Return forces that payloads may add in a run, for amounts of 1.

    Parameters
    ----------
    path : Path
        The path of the joint.
    log : EvenLog
        The run.
    shares : sequence of float
        The run's payloads by :func:`payload_shares`.
    scales : Scales
        Scales of the recording.
    rotary : bool
        Whether the joint is rotary.
    """
    ones, nothing = np.ones(log.time_s.size), np.zeros(log.time_s.size)
    pulls = [np.sin(path.position), np.cos(path.position)] if rotary else [ones]
    inertia = scales.force / scales.acceleration * log.position
    forces = []
    for share in shares:
        forces += [WeakForce(share * scales.force * pull) for pull in pulls]
        forces.append(WeakForce(nothing, curvature=share * inertia))
    return forces
