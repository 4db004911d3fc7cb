"""Tests whether neighbouring residual forces along an axis are correlated beyond scatter.

A force that resembles no effect, and that is too sharp or alternates too fast for smooth functions,
is absorbed by the noise as scatter. Scatter is independent of the order of windows. Such a force is
not: sorted along an axis, neighbours share it, and means over neighbours are large.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import hypot

import numpy as np

from bayesfric.arrays import Array, Whole
from bayesfric.diagnosis.chance import redrawn
from bayesfric.diagnosis.overruling import leaves_too_much
from bayesfric.diagnosis.residuals import CATEGORIES, Residuals
from bayesfric.diagnosis.systematic import Posterior
from bayesfric.diagnosis_rules import RULES
from bayesfric.probabilities import two_digits
from bayesfric.schemas.gap import Gap

SLOW = "slow_axis"
"""Level of friction's scatter in time within a run."""
MAPS = ("map_axis", "run_map_axis")
"""Levels of its scatter along the path: alike in every run, and of each run."""
TIME = "time"
"""The order in which windows were recorded, an axis that every recording has."""
DRAWS = 400
WIDTHS = (2, 3, 5, 8, 13, 21, 34, 55)  # neighbours over which means are taken
AT_ONCE = 64  # draws at the same time, to fit into the processor's cache
MOST_WAVES = 120  # largest number of waves in time over a recording
FEWEST = 4  # least number of separate means over all windows
TINY = 1e-300


@dataclass(frozen=True)
class SharedForce:
    """A force that neighbouring windows along an axis share.

    Parameters
    ----------
    axis : str
        The axis along which it is most significant.
    share : float
        Its rms, relative to friction.
    p_value : float
        Probability that scatter makes a statistic as large along any axis.
    """

    axis: str
    share: float
    p_value: float

    def words(self, size: str) -> str:
        """Return words for the force, given its size in words."""
        return (
            f"neighbouring residuals along {self.axis.replace('_', ' ')} share a force of "
            f"{size} (scatter alone makes as much with probability {self.p_value:.2g})"
        )


def differs_within_runs(noise: Mapping[str, float], practical: float) -> str | None:
    """Return a text if friction varies within runs by more than the practical share; else None.

    Scatter absorbs this variation, whatever causes it, so that no effect is found for it.

    Parameters
    ----------
    noise : mapping of str to float
        Noise parameters of the likeliest hypothesis, by name.
    practical : float
        Practical share of friction.
    """
    in_time = noise.get(SLOW, 0.0)
    along = hypot(*(noise.get(name, 0.0) for name in MAPS))
    share = hypot(in_time, along)
    if share < practical:
        return None
    how = "changes slowly in time" if in_time > along else "differs along the path"
    return f"friction {how} within a run, by {share:.1%} of itself rms"


def shared_by_neighbours(
    residuals: Residuals, left: Array, practical: float, rng: np.random.Generator
) -> SharedForce | None:
    """Return the force that neighbouring residuals share; None if scatter explains it.

    Each statistic (an axis and a width) is standardised by its distribution for redrawn and
    refitted residuals. The largest one is compared with the largest ones of these draws.

    Parameters
    ----------
    residuals : Residuals
        Windows, at the noise parameters of the likeliest hypothesis.
    left : ndarray, shape (R,)
        Their residual force, without the known systematic force [N].
    practical : float
        Practical share of friction; the shared force must be at least a fraction of it.
    rng : Generator
        Source of randomness.
    """
    both = np.column_stack([left, redrawn(residuals, DRAWS, rng)])
    both = residuals.without_law(both) / residuals.friction_rms
    if residuals.counts is not None:
        both = np.sqrt(residuals.counts)[:, None] * both
    rows = [
        (axis, square)
        for axis, order in _orders(residuals)
        for square in _of_neighbours(both, order)
    ]
    rows += [(TIME, square) for when in _times(residuals) for square in _of_waves(both, when)]
    if not rows:
        return None
    squares = np.array([square for _, square in rows])
    null = squares[:, 1:]
    excess = _standardised(squares)
    place = int(np.argmax(excess[:, 0]))
    as_far = np.count_nonzero(excess[:, 1:].max(axis=0) >= excess[place, 0])
    p_value = float((1 + as_far) / (1 + DRAWS))
    share = float(np.sqrt(max(squares[place, 0] - null[place].mean(), 0.0)))
    if p_value > RULES.like_scatter or share < RULES.order_matters * practical:
        return None
    return SharedForce(rows[place][0], share, p_value)


def unlike_scatter(
    gap: Gap,
    residuals: Residuals,
    left: Array,
    posterior: Posterior,
    practical: float,
    rng: np.random.Generator,
) -> str | None:
    """Return a text on a residual that scatter does not explain; None if it explains all.

    Nothing is reported if friction hardly exceeds the residual, because nobody could judge its
    size.

    Parameters
    ----------
    gap : Gap
        Contains the held-out residual beyond chance.
    residuals : Residuals
        Windows.
    left : ndarray, shape (R,)
        Residual force of the recalibrated law in these windows [N].
    posterior : Posterior
        Draws of the systematic force in these windows.
    practical : float
        Practical share of friction.
    rng : Generator
        Source of randomness.
    """
    if gap.before.q50 > RULES.order_of_friction * gap.friction_rms:
        return None
    if leaves_too_much(gap, practical):
        excess = f"{two_digits(gap.held_out_excess)} {gap.unit} rms"
        return f"after scatter is subtracted, an error of {excess} is left on held-out data"
    structured = shared_by_neighbours(
        residuals, left - posterior.force.mean(axis=1), practical, rng
    )
    if structured is None:
        return None
    size = f"{structured.share * gap.friction_rms:.3g} {gap.unit} rms"
    return structured.words(
        f"{size}, {structured.share:.1%} of friction," if gap.no_share is None else size
    )


def _orders(residuals: Residuals) -> Iterator[tuple[str, Whole]]:
    """Yield axes that are not categories, with the order of their windows."""
    recorded = np.arange(residuals.trial.size)
    for when in _times(residuals):
        yield TIME, np.argsort(when, kind="stable")
    for name in residuals.axes:
        values = residuals.covariates[name]
        finite = np.flatnonzero(np.isfinite(values))
        if name in CATEGORIES or np.unique(values[finite]).size < FEWEST:
            continue
        yield name, finite[np.lexsort((recorded[finite], values[finite]))]


def _standardised(squares: Array) -> Array:
    """Return mean squares in standard deviations of the redrawn ones, (rows, 1 + draws).

    Cube roots of sums of squares are nearly normal, even for few terms.

    References
    ----------
    E. B. Wilson, M. M. Hilferty, "The distribution of chi-square", PNAS 17 (1931).
    """
    roots = np.cbrt(squares)
    middle, spread = roots[:, 1:].mean(axis=1), roots[:, 1:].std(axis=1)
    return np.asarray((roots - middle[:, None]) / np.maximum(spread, TINY)[:, None])


def _times(residuals: Residuals) -> Iterator[Array]:
    """Yield the time of each window: the order in the recording, and its time within the run."""
    when = residuals.covariates["order"]
    recorded = np.arange(residuals.trial.size)
    order = np.lexsort((recorded, np.where(np.isfinite(when), when, 0.0)))
    yield np.asarray(np.argsort(order), dtype=np.float64)
    if residuals.time_s is not None and np.isfinite(residuals.time_s).all():
        yield residuals.time_s


def _of_neighbours(left: Array, order: Whole) -> Iterator[Array]:
    """Yield mean squares of means over neighbours, for each width, (1 + draws,)."""
    widths = [width for width in WIDTHS if width * FEWEST <= order.size]
    squares = np.empty((len(widths), left.shape[1]))
    for start in range(0, left.shape[1], AT_ONCE):
        some = slice(start, start + AT_ONCE)
        sums = np.zeros((order.size + 1, squares[:, some].shape[1]))
        np.cumsum(left[order, some], axis=0, out=sums[1:])
        for place, width in enumerate(widths):
            means = (sums[width:] - sums[:-width]) / width
            squares[place, some] = (means**2).mean(axis=0)
    yield from squares


def _of_waves(left: Array, when: Array) -> Iterator[Array]:
    """Yield mean squares of the fitted wave in time, for each frequency, (1 + draws,)."""
    span = float(np.ptp(when))
    if span == 0:
        return
    turns = 2 * np.pi * (when - when.min()) / span
    for waves in range(1, min(MOST_WAVES, len(left) // 3) + 1):
        pair = np.stack([np.cos(waves * turns), np.sin(waves * turns)])
        amplitudes = pair @ left * (2 / len(left))
        yield np.asarray((amplitudes**2).sum(axis=0) / 2)
