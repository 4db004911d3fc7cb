"""Effects in a simulation: with the phases of each trial, and the state at which they act."""

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
    """An effect with the unrecorded phases of its trials.

    Parameters
    ----------
    applied : AppliedEffect
        The effect with values of its parameters.
    phases : ndarray, shape (C, N) or (C, N, sensors), or None
        Factor of each component in each trial; None if the effect has no components.
    """

    applied: AppliedEffect
    phases: Array | None = None

    def __call__(self, where: Any) -> Array:
        """Return the value of the effect's law at a state, summed over components, (N, …)."""
        value = np.asarray(self.applied(where), dtype=np.float64)
        if self.phases is None:
            return value
        missing = tuple(range(self.phases.ndim, value.ndim))
        return np.asarray((np.expand_dims(self.phases, missing) * value).sum(axis=0))


def draw_phases(
    truth: Truth, rows: int, sensors: int, rng: np.random.Generator
) -> tuple[PhasedEffect, ...]:
    """Return the effects of `truth` with phases, drawn from N(0, 1) for each component and row.

    Parameters
    ----------
    truth : Truth
        Contains the effects.
    rows : int
        Number of trials or runs.
    sensors : int
        Number of sensors. An effect on readings has phases of its own for each.
    rng : Generator
        Source of randomness for the phases alone.
    """
    acting = []
    for applied in truth.effects:
        effect = applied.effect
        phases = (rows, sensors) if effect.acts_on == "reading" else (rows,)
        drawn = rng.standard_normal((effect.components, *phases)) if effect.components else None
        acting.append(PhasedEffect(applied, drawn))
    return tuple(acting)


def of_kind(acting: Sequence[PhasedEffect], kind: ActsOn) -> list[PhasedEffect]:
    """Return the effects that act on a given quantity, such as ``friction`` or ``reading``."""
    return [effect for effect in acting if effect.applied.effect.acts_on == kind]


def total(acting: Sequence[PhasedEffect], where: Any) -> Any:
    """Return the sum of the values of effects at a state; 0 without effects."""
    return sum((effect(where) for effect in acting), 0.0)


def surroundings(table: pd.DataFrame, rig: RigConstants) -> dict[str, Any]:
    """Return the fields of State that trials or runs have as a whole, such as radius or order.

    Radius, order and the spread of wrap angles are NaN if they were not recorded.
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
    """Return the end that carried the drive mass: −0.5 left, 0.5 right, 0 if not recorded."""
    if "drive_end" not in table:
        return np.zeros(len(table))
    return np.asarray(table["drive_end"].map({"left": -0.5, "right": 0.5}).fillna(0.0), dtype=float)


def trial_in_setup(table: pd.DataFrame) -> Array:
    """Return the number of earlier trials of the same assembly; 0 if no order was recorded."""
    if "order" not in table or "setup" not in table or table["order"].isna().any():
        return np.zeros(len(table))
    return np.asarray(table.groupby("setup")["order"].rank(), dtype=np.float64) - 1


def wrap_spread(table: pd.DataFrame) -> Array:
    """Return the standard deviation of the individual wrap angles of each row [deg]."""
    if "wrap_angles_deg" not in table:
        return np.full(len(table), np.nan)
    cells = table["wrap_angles_deg"]
    return np.array([to_numbers_apart(c).std() if isinstance(c, str) else np.nan for c in cells])
