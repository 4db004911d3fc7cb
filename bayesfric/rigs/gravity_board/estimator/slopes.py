"""Steps 2 to 4 of the paper's estimator: slopes in tension, pulleys and wrap angle.

Nothing is weighted and nothing has an uncertainty. What the trials cannot tell is
None, with the reason.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bayesfric.arrays import Array
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG
from bayesfric.rigs.gravity_board.estimator.trials import TrialFriction

LEAST_TENSION_RATIO = 1.1  # largest over least tension of a line
LEAST_ANGLE_SPAN_DEG = 5.0
ANGLE_TOLERANCE_DEG = 0.5  # around 85°


class Slope(NamedTuple):
    """A slope with its R², or the reason why there is none.

    Parameters
    ----------
    value : float or None
        The slope; its unit is where it is used.
    r_squared : float or None
        1 − residual over total sum of squares around the mean; None where the points
        are no more than the numbers fitted. Below 0 a constant would fit better.
    reason : str or None
        Why there is no value.
    """

    value: float | None
    r_squared: float | None = None
    reason: str | None = None


@dataclass(frozen=True)
class CellLine:
    """Step 2: friction against tension at one (size, n, θ).

    Parameters
    ----------
    n_pulleys : int
        Number of pulleys.
    wrap_angle_deg : float
        Average individual wrap angle [deg].
    trials : int
        With a friction.
    slope : Slope
        dfc/dT [-].
    intercept_n : float or None
        fc at no tension [N].
    """

    n_pulleys: int
    wrap_angle_deg: float
    trials: int
    slope: Slope
    intercept_n: float | None


@dataclass(frozen=True)
class WrapLine:
    """Step 4 before n: the slopes of step 2 against θ at one (size, n).

    Parameters
    ----------
    n_pulleys : int
        Number of pulleys.
    slope : Slope
        d²fc/dT dθ [1/deg].
    """

    n_pulleys: int
    slope: Slope


@dataclass(frozen=True)
class SizeEstimate:
    """Coefficients of a pulley size, and the lines that they come from.

    Parameters
    ----------
    pulley_size : str
        As recorded.
    cells : tuple of CellLine
        By n and θ.
    wraps : tuple of WrapLine
        By n.
    c1, c2, c3 : Slope
        In 1, N and 1/deg.
    """

    pulley_size: str
    cells: tuple[CellLine, ...]
    wraps: tuple[WrapLine, ...]
    c1: Slope
    c2: Slope
    c3: Slope


def lines_of_sizes(trials: Sequence[TrialFriction]) -> tuple[SizeEstimate, ...]:
    """Return steps 2 to 4 for each pulley size.

    Parameters
    ----------
    trials : sequence of TrialFriction
        Step 1.

    Returns
    -------
    tuple of SizeEstimate
        In the order in which the sizes appear.
    """
    return tuple(
        _size(size, [trial for trial in trials if trial.pulley_size == size])
        for size in dict.fromkeys(trial.pulley_size for trial in trials)
    )


def is_upright(wrap_angle_deg: float) -> bool:
    """Return whether a wrap angle counts as the 85° at which c1 and c2 are read off."""
    return abs(wrap_angle_deg - REFERENCE_WRAP_ANGLE_DEG) <= ANGLE_TOLERANCE_DEG


def _size(size: str, trials: list[TrialFriction]) -> SizeEstimate:
    keys = sorted({(trial.n_pulleys, trial.wrap_angle_deg) for trial in trials})
    cells = tuple(
        _cell(*key, [trial for trial in trials if (trial.n_pulleys, trial.wrap_angle_deg) == key])
        for key in keys
    )
    lines = [cell for cell in cells if cell.slope.value is not None]
    upright = [cell for cell in lines if is_upright(cell.wrap_angle_deg)]
    wraps = tuple(
        WrapLine(n, _wrap_slope([cell for cell in lines if cell.n_pulleys == n]))
        for n in sorted({n for n, _ in keys})
    )
    none = "no line of friction against tension at 85°"
    count = [cell.n_pulleys for cell in upright]
    return SizeEstimate(
        pulley_size=size,
        cells=cells,
        wraps=wraps,
        c1=_proportional(count, [cell.slope.value for cell in upright], none),
        c2=_proportional(count, [cell.intercept_n for cell in upright], none),
        c3=_proportional(
            [wrap.n_pulleys for wrap in wraps],
            [wrap.slope.value for wrap in wraps],
            "no number of pulleys was measured at two wrap angles",
        ),
    )


def _cell(n_pulleys: int, wrap_angle_deg: float, trials: list[TrialFriction]) -> CellLine:
    points = np.array(
        [(trial.tension_n, trial.friction_n) for trial in trials if trial.friction_n is not None]
    ).reshape(-1, 2)
    tension, friction = points.T
    count = len(points)
    if count < 2 or tension.max() < LEAST_TENSION_RATIO * tension.min():
        reason = f"tensions of its {count} trials within {LEAST_TENSION_RATIO - 1:.0%}"
        return CellLine(n_pulleys, wrap_angle_deg, count, Slope(None, None, reason), None)
    slope, intercept = _line(tension, friction)
    return CellLine(n_pulleys, wrap_angle_deg, count, slope, intercept)


def _wrap_slope(cells: list[CellLine]) -> Slope:
    angles = np.array([cell.wrap_angle_deg for cell in cells])
    if angles.size < 2 or np.ptp(angles) < LEAST_ANGLE_SPAN_DEG:
        return Slope(None, None, f"wrap angles within {LEAST_ANGLE_SPAN_DEG:.0f}°")
    slopes = np.array([cell.slope.value for cell in cells], dtype=np.float64)
    return _line(angles, slopes)[0]


def _line(x: Array, y: Array) -> tuple[Slope, float]:
    """Return slope and intercept of the least-squares line."""
    apart = x - x.mean()
    slope = float(apart @ y / (apart @ apart))
    intercept = float(y.mean() - slope * x.mean())
    return Slope(slope, _r_squared(y, slope * x + intercept, fitted=2)), intercept


def _proportional(n_pulleys: Sequence[int], values: Sequence[float | None], none: str) -> Slope:
    """Return the slope of the least-squares line through the origin, over values there are."""
    there = [(n, value) for n, value in zip(n_pulleys, values, strict=True) if value is not None]
    if not there:
        return Slope(None, None, none)
    n, value = np.array(there, dtype=np.float64).T
    slope = float(n @ value / (n @ n))
    return Slope(slope, _r_squared(value, slope * n, fitted=1))


def _r_squared(y: Array, fit: Array, *, fitted: int) -> float | None:
    total = float(((y - y.mean()) ** 2).sum())
    if y.size <= fitted or total == 0:
        return None
    return 1 - float(((y - fit) ** 2).sum()) / total
