"""The closed forms against the time-domain simulator, draw by draw."""

import numpy as np
from numpy.typing import NDArray

from bayesfric.margins.describing import formula_conditions, formula_threshold, steady_error
from bayesfric.margins.hunting import hunting_threshold, run_length
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.metrics import interval_of
from bayesfric.margins.simulating import simulate
from bayesfric.margins.thresholds import GAMMA_MAX
from bayesfric.schemas import Verification, VerifiedDraw

__all__ = ["TOLERANCE", "verify"]

Array = NDArray[np.float64]

TOLERANCE = 0.10
"""Relative difference of γ up to which formula and simulator agree."""


def verify(shaft: LoopAtShaft, count: int) -> Verification:
    """Simulate some draws and compare them with what the closed forms say.

    Compared are the γ at which the loop begins to hunt, and whether the loop without
    compensation comes to rest inside the band of the steady error.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop, all draws.
    count : int
        Draws to simulate, taken evenly.

    Returns
    -------
    Verification
        With each draw.
    """
    rows = np.unique(np.linspace(0, shaft.friction.size - 1, count).astype(np.intp))
    some = shaft.taken(rows)
    sampled = some.sampled()
    found = hunting_threshold(sampled, kick=some.kick, reference_speed=some.reference_speed).gamma
    if shaft.loop.compensation.signal in ("none", "reference"):
        inside = np.ones(rows.size, dtype=bool)
        predicted = np.full(rows.size, np.inf)
    else:
        inside, _ = formula_conditions(some)
        predicted = formula_threshold(some)
        predicted = np.where(predicted <= GAMMA_MAX, predicted, np.inf)
    agrees = _agree(predicted, found)
    free = some.sampled(gamma=np.zeros(rows.size))
    motion = simulate(free, kick=some.kick, duration=2 * run_length(free).duration)
    band = np.where(some.ki > 0, np.inf, steady_error(some)) + 2 * np.pi / some.counts
    within = np.abs(motion.final_error) <= band
    return Verification(
        draws=rows.size,
        tolerance=TOLERANCE,
        inside_conditions=int(inside.sum()),
        agreement=float(agrees[inside].mean()) if inside.any() else None,
        agreement_why=None if inside.any() else "no draw is inside the formula's conditions",
        steady_error_agreement=float(within.mean()),
        kick=interval_of(some.kick),
        reference_speed=interval_of(some.reference_speed),
        by_draw=tuple(
            VerifiedDraw(
                draw=int(row),
                inside_conditions=bool(inside[place]),
                predicted=_number(predicted[place]),
                simulated=_number(found[place]),
                agrees=bool(agrees[place]),
                stays_within=bool(within[place]),
            )
            for place, row in enumerate(rows)
        ),
    )


def _agree(predicted: Array, found: Array) -> NDArray[np.bool_]:
    none = np.isinf(predicted) & np.isinf(found)
    both = np.isfinite(predicted) & np.isfinite(found)
    apart = np.abs(np.where(both, found, 0.0) - np.where(both, predicted, 1.0))
    return np.asarray(none | (both & (apart <= TOLERANCE * np.where(both, predicted, 1.0))))


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
