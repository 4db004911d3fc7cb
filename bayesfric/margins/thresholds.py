"""The compensation gain at which each draw hunts: by formula inside its conditions, else simulated.

A compensator of the reference's velocity cannot make the loop hunt, since what it feeds
forward does not depend on the motion.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bayesfric.margins.describing import (
    formula_conditions,
    formula_threshold,
    natural_frequency,
    swing_amplitude,
)
from bayesfric.margins.hunting import hunting_threshold, settling_duration
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.sampled_loop import simulate

__all__ = ["GAMMA_MAX", "Hunting", "find_hunting"]

Array = NDArray[np.float64]

GAMMA_MAX = 3.0
"""The largest compensation gain that is looked at."""


@dataclass(frozen=True)
class Hunting:
    """Where the draws begin to hunt.

    Parameters
    ----------
    method : {"formula", "simulation", "none"}
        How that was found; "none": this compensator cannot make the loop hunt.
    rows : ndarray of int, shape (m,)
        Draws that were looked at.
    threshold : ndarray, shape (m,)
        The smallest γ that hunts; inf where none up to :data:`GAMMA_MAX` does.
    amplitude, frequency : ndarray, shape (m,)
        At the motor and at the loop's own γ [rad, Hz]; NaN where it does not hunt.
    note : str
        What the reader must know of it.
    """

    method: str
    rows: NDArray[np.intp]
    threshold: Array
    amplitude: Array
    frequency: Array
    note: str


def find_hunting(shaft: LoopAtShaft, most: int) -> Hunting:
    """Return from which compensation gain on each draw hunts.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop, all draws.
    most : int
        Draws that are simulated at most, taken evenly.

    Returns
    -------
    Hunting
        Of all draws by formula, or of some by simulation.
    """
    compensation = shaft.loop.compensation
    empty = np.empty(0)
    if compensation.signal in ("none", "reference"):
        why = {
            "none": "there is no compensation, so friction is all there",
            "reference": "the sign of the reference's velocity is feed-forward: it cannot "
            "limit-cycle, too much of it only biases",
        }[compensation.signal]
        return Hunting("none", np.empty(0, dtype=np.intp), empty, empty, empty, why)
    inside, broken = formula_conditions(shaft)
    if inside.all():
        threshold = formula_threshold(shaft)
        hunts = threshold <= shaft.gamma
        return Hunting(
            "formula",
            np.arange(inside.size),
            np.where(threshold <= GAMMA_MAX, threshold, np.inf),
            np.where(hunts, swing_amplitude(shaft), np.nan),
            np.where(hunts, natural_frequency(shaft) / (2 * np.pi), np.nan),
            "by γ* = (F/F̂)(1 + π ζ/2), inside its conditions in every draw",
        )
    rows = np.unique(np.linspace(0, inside.size - 1, most).astype(np.intp))
    some = shaft.taken(rows)
    sampled = some.sampled()
    threshold = hunting_threshold(
        sampled, kick=some.kick, reference_speed=some.reference_speed, maximum_gamma=GAMMA_MAX
    )
    motion = simulate(
        sampled,
        kick=some.kick,
        duration=settling_duration(sampled),
        reference_speed=some.reference_speed,
    )
    return Hunting(
        "simulation",
        rows,
        threshold,
        np.where(motion.hunts, motion.amplitude, np.nan),
        np.where(motion.hunts, motion.frequency, np.nan),
        f"simulated in {rows.size} draws, with a kick of {np.median(some.kick):.3g} rad at the "
        f"motor (median) and a reference of {np.median(some.reference_speed):.3g} rad/s; γ* does "
        f"not hold, as it needs that {'; '.join(broken)}",
    )
