"""Displacements as multiples of the Hall spacing."""

import numpy as np
import numpy.typing as npt
import pandas as pd

DISPLACEMENT_TOLERANCE_M = 1e-6


def spacing_counts(
    displacement_m: npt.NDArray[np.float64], spacing_m: float
) -> npt.NDArray[np.float64]:
    """Count the Hall spacings in each displacement, to the nearest integer."""
    counts: npt.NDArray[np.float64] = np.rint(displacement_m / spacing_m) + 0.0  # no minus zero
    return counts


def printed_tolerance(cells: pd.Series, spacing_m: float) -> float:
    """Return how far a printed displacement may be from a multiple of the spacing [m].

    1 µm, or half a unit of the last printed digit if that is more. It is never so large that
    the multiple becomes ambiguous.
    """
    digits = max(decimals_of(cell) for cell in cells.unique())
    half_unit = 0.51 * 10.0 ** -min(max(digits, 0), 300)
    return min(max(DISPLACEMENT_TOLERANCE_M, half_unit), spacing_m / 4)


def decimals_of(cell: str) -> int:
    """Return the decimal places of a printed number; 0 for anything else."""
    digits, _, exponent = cell.lower().partition("e")
    shift = exponent.removeprefix("+").removeprefix("-")
    if exponent and not (shift.isascii() and shift.isdigit() and len(shift) < 5):
        return 0
    return len(digits.partition(".")[2]) - int(exponent or 0)
