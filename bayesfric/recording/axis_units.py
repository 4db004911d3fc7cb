"""What no driven axis does, and which mistake of unit it most likely is."""

import numpy as np
import pandas as pd

from bayesfric.errors import Fault
from bayesfric.recording.cells import Table
from bayesfric.recording.joint_rules import joint_of_run
from bayesfric.recording.tables import RigConstants

COARSEST_S = 1.0  # between samples: what a drive does in between is not to be seen
FARTHEST_M = 100.0  # of an axis that slides, unless its limits say more


def axis_in_other_units(samples: Table, rig: RigConstants) -> list[Fault]:
    """Return the faults of a log whose clock or travel are no axis'.

    Parameters
    ----------
    samples : Table
        ``axis_samples.csv``.
    rig : RigConstants
        ``limits.travel_m`` says how far it goes, ``rotary`` that it turns.
    """
    if not samples.has("run", "time_s", "position_m"):
        return []
    return _coarse(samples) + ([] if rig.rotary else _far(samples, rig))


def _of_one_joint(samples: Table) -> pd.Series:
    """Return the number of the run and joint of each sample."""
    keys = joint_of_run(samples)
    return samples.frame.groupby(keys, sort=False, observed=True).ngroup()


def _coarse(samples: Table) -> list[Fault]:
    group = _of_one_joint(samples)
    interval = samples.frame["time_s"].groupby(group).diff().groupby(group).transform("median")
    rows = np.flatnonzero(interval >= COARSEST_S)
    if not rows.size:
        return []
    expected = (
        f"a time in s, samples less than {COARSEST_S:g} s apart and not "
        f"{interval.iloc[rows[0]]:g} s (are they in milliseconds or microseconds? Friction at "
        "steady speed, however slow, belongs in steady_friction.csv)"
    )
    return samples.text.faults_at(rows[1:], "time_s", expected, most=1)


def _far(samples: Table, rig: RigConstants) -> list[Fault]:
    groups = samples.frame["position_m"].groupby(_of_one_joint(samples))
    travel = groups.transform("max") - groups.transform("min")
    most = max(FARTHEST_M, float(rig.limits.get("travel_m", [0.0, 0.0])[1]))
    rows = np.flatnonzero(travel > most)
    if not rows.size:
        return []
    expected = (
        f"a run that goes at most {most:g} m (rig.limits.travel_m), and not "
        f"{travel.iloc[rows[0]]:,.0f} m (is it in millimetres, or in degrees of an axis that "
        "turns? That is in rad, with rig.rotary)"
    )
    return samples.text.faults_at(rows, "position_m", expected, most=1)
