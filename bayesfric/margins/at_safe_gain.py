"""The specs of a loop once its compensation gain is lowered to the largest that is safe."""

from dataclasses import replace

import numpy as np

from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.loop_file import Spec
from bayesfric.margins.metric_definitions import missed_specs
from bayesfric.margins.metrics import linear_of
from bayesfric.margins.rows import metric_rows
from bayesfric.margins.terms import rounded_down
from bayesfric.margins.thresholds import Hunting
from bayesfric.schemas.margins import AtSafeGain


def at_safe_gain(
    shaft: LoopAtShaft, hunting: Hunting, safe: float | None, spec: Spec, draws: float
) -> AtSafeGain | None:
    """Judge a loop at the largest γ that is safe from hunting, rounded down as it is reported.

    Every spec except that of hunting has a closed form, so nothing is simulated again.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop, all draws.
    hunting : Hunting
        Thresholds of the draws.
    safe : float or None
        The largest safe γ; None if no gain is safe.
    spec : Spec
        Specs of the file.
    draws : float
        Number of independent draws that the values are worth, for the Monte Carlo error.

    Returns
    -------
    AtSafeGain or None
        None if the loop has no compensation, no gain is safe, or the gain of the file is safe.
    """
    feeds = shaft.loop.compensation.signal != "none"
    if not feeds or safe is None or safe >= float(np.median(shaft.gamma)):
        return None
    gamma = rounded_down(safe)
    lower = replace(shaft, gamma=np.full_like(shaft.gamma, gamma))
    hunts = hunting.threshold <= gamma
    linear = linear_of(lower, with_peaks=True)
    rows = metric_rows(lower, linear, replace(hunting, hunts=hunts[None]), draws)
    return AtSafeGain(
        gamma=gamma,
        missed_specs=missed_specs(rows, float(hunts.mean()), spec),
        metrics=tuple(row for row in rows if row.spec is not None and row.name != "gamma_hunting"),
    )
