"""Effects as they act in a simulation: with the phases of each trial, and where."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.effects import ActsOn
from bayesfric.paper import table1
from bayesfric.recording.numbers import to_numbers_apart
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.truth import AppliedEffect, Truth


@dataclass(frozen=True)
class PhasedEffect:
    """An effect and the phases that nobody recorded.

    Parameters
    ----------
    applied : AppliedEffect
        With its numbers.
    phases : ndarray, shape (C, N) or (C, N, sensors), or None
        Factor of each component in each trial; None without components.
    """

    applied: AppliedEffect
    phases: Array | None = None

    def __call__(self, where: Any) -> Array:
        """Return what the law gives, its components summed, of shape (N, …)."""
        value = np.asarray(self.applied(where), dtype=np.float64)
        if self.phases is None:
            return value
        missing = tuple(range(self.phases.ndim, value.ndim))
        return np.asarray((np.expand_dims(self.phases, missing) * value).sum(axis=0))


def draw_phases(
    truth: Truth, rows: int, sensors: int, rng: np.random.Generator
) -> tuple[PhasedEffect, ...]:
    """Return the effects of `truth` with N(0, 1) drawn for each component and row.

    Parameters
    ----------
    truth : Truth
        Holds the effects.
    rows : int
        Trials or runs.
    sensors : int
        Each has phases of its own where an effect acts on readings.
    rng : Generator
        For this alone.
    """
    acting = []
    for applied in truth.effects:
        effect = applied.effect
        phases = (rows, sensors) if effect.acts_on == "reading" else (rows,)
        drawn = rng.standard_normal((effect.components, *phases)) if effect.components else None
        acting.append(PhasedEffect(applied, drawn))
    return tuple(acting)


def of_kind(acting: Sequence[PhasedEffect], kind: ActsOn) -> list[PhasedEffect]:
    """Return those that act on one thing."""
    return [effect for effect in acting if effect.applied.effect.acts_on == kind]


def total(acting: Sequence[PhasedEffect], where: Any) -> Any:
    """Return the sum of what effects of one kind give; 0 without any."""
    return sum((effect(where) for effect in acting), 0.0)


def surroundings(table: pd.DataFrame, rig: RigConstants) -> dict[str, Any]:
    """Return radius, place in the order, gravity and the like of trials or runs, fields of State.

    Radius, order and individual wrap angles are nan where nobody wrote them down.
    """
    radius = {size: row.radius_m for size, row in table1().items()}
    radius |= {size: own.radius_m for size, own in rig.pulleys.items() if own.radius_m}
    order = np.full(len(table), np.nan)
    if "order" in table:
        order = table["order"].to_numpy(dtype=np.float64)
    return {
        "drive_end": drive_end(table),
        "trial_in_setup": trial_in_setup(table),
        "wrap_spread_deg": wrap_spread(table),
        "radius_m": table["pulley_size"].map(radius).to_numpy(dtype=np.float64),
        "order": (order - order.min()) / max(np.ptp(order), 1.0),
        "gravity_m_s2": rig.gravity_m_s2,
    }


def drive_end(table: pd.DataFrame) -> Array:
    """Return which end carried the drive mass: −0.5 left, 0.5 right, 0 where nobody says."""
    if "drive_end" not in table:
        return np.zeros(len(table))
    return np.asarray(table["drive_end"].map({"left": -0.5, "right": 0.5}).fillna(0.0), dtype=float)


def trial_in_setup(table: pd.DataFrame) -> Array:
    """Return how many trials of the same assembly went before, 0 without an order."""
    if "order" not in table or "setup" not in table or table["order"].isna().any():
        return np.zeros(len(table))
    return np.asarray(table.groupby("setup")["order"].rank(), dtype=np.float64) - 1


def wrap_spread(table: pd.DataFrame) -> Array:
    """Return the standard deviation of the individual wrap angles of each row [deg]."""
    if "wrap_angles_deg" not in table:
        return np.full(len(table), np.nan)
    cells = table["wrap_angles_deg"]
    return np.array([to_numbers_apart(c).std() if isinstance(c, str) else np.nan for c in cells])
