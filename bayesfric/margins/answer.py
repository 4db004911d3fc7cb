"""Which compensation gain to set."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bayesfric.margins.describing import necessary_gain
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.metrics import standard_error
from bayesfric.margins.thresholds import GAMMA_MAX, Hunting
from bayesfric.schemas import GammaProbability

__all__ = ["SafeGain", "largest_safe_gain", "limit_cycle_curve", "which_gain"]

Array = NDArray[np.float64]

STEP = 0.05
TOLERANCE = 0.01
"""A simulated threshold is at most this much too high."""


@dataclass(frozen=True)
class SafeGain:
    """The largest γ with P(limit cycle) within a bound.

    Parameters
    ----------
    gamma : float or None
        None where there is none.
    se : float or None
        Its Monte Carlo standard error.
    why : str or None
        Why there is none.
    """

    gamma: float | None
    se: float | None
    why: str | None


def limit_cycle_curve(hunting: Hunting, effective_draws: float) -> tuple[GammaProbability, ...]:
    """Return P(limit cycle) over γ from 0 to :data:`GAMMA_MAX`; empty where none can be."""
    if hunting.method == "none":
        return ()
    draws = min(effective_draws, float(hunting.threshold.size))
    curve = []
    for gamma in np.arange(0.0, GAMMA_MAX + STEP / 2, STEP):
        p = float((hunting.threshold <= gamma).mean())
        curve.append(GammaProbability(gamma=round(float(gamma), 4), p=p,
                                      mcse=standard_error(p, draws)))  # fmt: skip
    return tuple(curve)


def largest_safe_gain(hunting: Hunting, allowed: float, effective_draws: float) -> SafeGain:
    """Return the largest γ at which at most a share of the draws hunts.

    Parameters
    ----------
    hunting : Hunting
        Thresholds of the draws.
    allowed : float
        The share.
    effective_draws : float
        Independent draws behind them.
    """
    if hunting.method == "none":
        return SafeGain(None, None, hunting.note)
    ordered = np.sort(hunting.threshold)
    resolution = TOLERANCE if hunting.method == "simulation" else 1e-9
    count = ordered.size

    def at(share: float) -> float:
        """Return the γ just below which `share` of the draws hunt."""
        place = int(np.floor(share * count + 1e-9))
        most = float(ordered[place]) if place < count else np.inf
        return min(most - resolution, GAMMA_MAX)

    if at(allowed) <= 0.0:
        share = float((ordered <= 0).mean())
        return SafeGain(
            None, None, f"{share:.1%} of the draws hunt without any compensation, after the kick"
        )
    error = standard_error(allowed, min(effective_draws, float(count)))
    low, high = at(max(allowed - error, 0.0)), at(min(allowed + error, 1.0))
    return SafeGain(at(allowed), (high - low) / 2, None)


def which_gain(shaft: LoopAtShaft, hunting: Hunting, safe: SafeGain, allowed: float) -> str:
    """Return which compensation gain to set, in a sentence."""
    needed = necessary_gain(shaft)
    middle = float(np.median(needed))
    signal = shaft.loop.compensation.signal
    if signal == "none":
        return "There is no gain to set: the loop has no friction compensation."
    if signal == "reference":
        low = float(np.quantile(needed, allowed))
        return (
            f"No γ makes this loop hunt, since its compensator follows the reference; above "
            f"γ = {low:.2f} it over-compensates with a probability of more than {allowed:.0%}, "
            "which biases and no more."
        )
    if safe.gamma is None:
        return f"No γ is safe: {safe.why}."
    how = {"formula": "by formula", "simulation": "simulated"}[hunting.method]
    if safe.gamma >= GAMMA_MAX:
        return (
            f"No γ up to {GAMMA_MAX:g} makes this loop hunt with a probability of more than "
            f"{allowed:.0%} ({how}); above γ = {middle:.2f} (median) it over-compensates."
        )
    now = float((hunting.threshold <= shaft.gamma[hunting.rows]).mean())
    return (
        f"Set γ to {np.floor(100 * safe.gamma) / 100:.2f} at most: up to there the loop hunts with "
        f"a probability of {allowed:.0%} or less ({how}); at the γ = {np.median(shaft.gamma):.3g} "
        f"of the file that probability is {now:.2g}."
    )
