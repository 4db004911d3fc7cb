"""Small amounts of every effect, which reality has and nobody need name.

All models are wrong by a little: what is examined as a cause at its full size is there in
traces too. Together they make a force of the practical share of rms friction, or its
equivalent, beside the smooth forces of the discrepancy.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bayesfric.effects.candidates import Candidate, goes_to_and_fro
from bayesfric.rigs.gravity_board.rows import GravityRows
from bayesfric.rigs.motor_board.linear import MotorPart

__all__ = ["relative_rms", "small_amounts"]

Array = NDArray[np.float64]
SHAPES = np.array([-1.0, 0.0, 1.0])  # normal quantiles of the prior of a shape


def small_amounts(
    rows: GravityRows | None,
    motor: MotorPart | None,
    candidates: Sequence[Candidate],
    share: float,
) -> list[tuple[Candidate, float]]:
    """Return effects with the standard deviations of their amplitudes.

    Parameters
    ----------
    rows : GravityRows or None
    motor : MotorPart or None
        The boards.
    candidates : sequence of Candidate
        Of the effects that are examined, any number an effect.
    share : float
        Rms force of them all, as a share of friction.
    """
    effects = {
        candidate.effect.name: candidate.effect
        for candidate in candidates
        if not goes_to_and_fro(candidate.effect)
    }
    found: list[tuple[Candidate, float]] = []
    for effect in effects.values():
        nodes = SHAPES if effect.shape is not None else np.zeros(1)
        each = [Candidate(effect, law, float(node), 0.0) for law in effect.laws for node in nodes]
        part = share / np.sqrt(len(effects) * len(each))
        for candidate in each:
            size = relative_rms(rows, motor, candidate)
            if size > 0:
                found.append((candidate, part / size))
    return found


def relative_rms(rows: GravityRows | None, motor: MotorPart | None, candidate: Candidate) -> float:
    """Return the rms of what amplitude 1 does to friction, over the boards where it acts."""
    squares: list[Array] = []
    if rows is not None:
        force = rows.relative_force(candidate)
        squares.append((force**2).sum(axis=0).mean(axis=1))
    if motor is not None:
        squares.append(motor.relative_force(candidate) ** 2)
    acting = [one for one in squares if one.any()]
    return float(np.sqrt(np.concatenate(acting).mean())) if acting else 0.0
