"""What a payload that is written down adds to the force of a joint, in every run that carries it.

A mass m at a distance l and an angle α adds m g l sin(q + α) + m l² q̈, and on a slide its weight
along it and m q̈. Mass is in a column of ``axis_runs.csv`` whose name ends in ``_kg``; g l, α and
l² nobody knows, so that each run has its share of forces of unknown amounts.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from bayesfric.rigs.single_axis.coupling import Scales
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.paths import Path
from bayesfric.rigs.single_axis.weak_form import WeakForce

MASS = "_kg"  # at the end of a column's name


def payload_shares(runs: pd.DataFrame) -> Mapping[str, tuple[float, ...]]:
    """Return what each run carries beyond the least of all, as a share of the largest, by name.

    Parameters
    ----------
    runs : DataFrame
        ``axis_runs.csv``.

    Returns
    -------
    mapping of str to tuple of float
        A number for each column of masses that varied.
    """
    columns = [str(name) for name in runs if str(name).endswith(MASS)]
    values = runs[columns].to_numpy(dtype=np.float64)
    spread = np.ptp(values, axis=0) if len(runs) else np.zeros(len(columns))
    varied = spread > 0
    shares = (values[:, varied] - values[:, varied].min(axis=0, initial=np.inf)) / spread[varied]
    named = zip(runs["run"], shares, strict=True)
    return {str(run): tuple(map(float, own)) for run, own in named}


def payload_masses(runs: pd.DataFrame) -> Mapping[str, float]:
    """Return what each run carries beyond the least of all [kg], by name.

    Nothing where no column of masses varied, or several did: they may be at different places.

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
    """Return forces that payloads may add in a run, each of an unknown amount.

    Parameters
    ----------
    path : Path
        Of the joint.
    log : EvenLog
        The run.
    shares : sequence of float
        Of :func:`payload_shares`.
    scales : Scales
        Of the recording.
    rotary : bool
        Whether the joint turns.
    """
    ones, nothing = np.ones(log.time_s.size), np.zeros(log.time_s.size)
    pulls = [np.sin(path.position), np.cos(path.position)] if rotary else [ones]
    inertia = scales.force / scales.acceleration * log.position
    forces = []
    for share in shares:
        forces += [WeakForce(share * scales.force * pull) for pull in pulls]
        forces.append(WeakForce(nothing, curvature=share * inertia))
    return forces
