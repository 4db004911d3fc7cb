"""Trials that stray: one that lies far from the others of its own assembly.

A cable that caught for once, or a run that all but stalled, is no effect; left in, it
passes for scatter of all trials, and with that much scatter anything may be there.
"""

from collections.abc import Mapping

import numpy as np

from bayesfric.paper import table1
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.data import Data
from bayesfric.rigs.gravity_board.measured_motion import MeasuredMotion
from bayesfric.rigs.gravity_board.rows import GravityRows

__all__ = ["stray_trials"]

FEWEST = 3  # trials of an assembly that has a middle
FAR = 10.0  # times the usual distance, as a standard deviation
MAD = 1.4826  # standard deviation of a normal over its median absolute deviation


def stray_trials(
    data: Data, laws: Mapping[str, Coefficients], measured: MeasuredMotion | None
) -> tuple[str, ...]:
    """Return the trials whose friction is far from that of their assembly.

    Distances are relative deviations from the law less the assembly's median; the usual
    one is their median over all trials, which an effect widens and one trial does not.

    Parameters
    ----------
    data : Data
        Screened trials.
    laws : mapping of str to Coefficients
        The law fitted to them.
    measured : MeasuredMotion or None
        Of the trials; None where there are none.
    """
    if data.gravity is None or measured is None:
        return ()
    radii = dict.fromkeys(data.sizes, table1()["medium"].radius_m)
    rows = GravityRows(data.gravity, data.constants, laws, radii, measured)
    deviation = rows.relative_deviation()
    setup = rows.trials["setup"].to_numpy()
    distance = np.zeros_like(deviation)
    for one in dict.fromkeys(setup):
        own = setup == one
        if np.count_nonzero(own) >= FEWEST:
            distance[own] = np.abs(deviation[own] - np.median(deviation[own]))
    usual = MAD * float(np.median(distance[distance > 0])) if (distance > 0).any() else np.inf
    return tuple(str(trial) for trial in rows.trials["trial"][distance > FAR * usual])
