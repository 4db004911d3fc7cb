"""Shares of the systematic force: which part of its mean square each axis explains.

Each draw of the force is regressed on friction times smooth functions of the axes. For two axes
that describe the state of the machine, the regression also contains their product. Every regression
contains the refitted law, because the gap is what this law leaves.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.diagnosis.residuals import CATEGORIES, Residuals
from bayesfric.inference.shapley import Block, explained_by_subsets, shapley_values
from bayesfric.inference.smooths import BROAD, NARROW, Span, smooth_along

DRAWS = 300  # of the force; the error of a 5 % quantile of a share is 0.1 of its interval
PLAYERS = 12  # axes at most; if there are more, the weakest form one group
RIDGE = 1e-3  # of a smooth function's variance: shrinks what 1 % of the windows determine
PAIRED = 0.3  # sd of a product of two axes; that of a smooth function is 1
FINE_AT_FIRST = ("travel_since_reversal",)
"""Axes on a logarithmic scale."""
HISTORY = ("order", "time", "trial_in_setup")
"""Axes of the time of a trial: their functions are broad and enter no product."""
SEEN = 1e-3  # part of the largest function below which the law or other axes leave nothing
NOTHING = 1e-9  # rms relative to friction below which a force has no shares
FINE = 400  # with fewer windows only broad functions are used, since fine ones fit chance
GRID = 25  # positions along an axis
ROUNDING = 1e-9  # relative: a smaller variation, or a smaller share, is rounding error


@dataclass(frozen=True)
class AxisFunctions:
    """Functions of an axis, relative to friction.

    Parameters
    ----------
    name : str
        Name of the axis.
    is_known : ndarray of bool, shape (R,)
        Windows with a position on the axis.
    columns : ndarray, shape (R, k)
        At the windows; 0 without a position.
    grid : ndarray, shape (G,)
        Positions along the axis; for a category its values.
    on_grid : ndarray, shape (G, k)
        The functions at these positions.
    """

    name: str
    is_known: Flags
    columns: Array
    grid: Array
    on_grid: Array


@dataclass(frozen=True)
class Shares:
    """Draws of shares of the mean square of the systematic force, by axis, shape (S,).

    Parameters
    ----------
    share : dict of str to ndarray
        Shapley values; the shares and `unexplained` sum to 1.
    alone : dict of str to ndarray
        From a regression on functions of that axis alone.
    unexplained : ndarray
        The part that no axis explains.
    there : ndarray of bool
        Which draws have a force.
    """

    share: dict[str, Array]
    alone: dict[str, Array]
    unexplained: Array
    there: Flags


def functions_along(residuals: Residuals, name: str, length: float = BROAD) -> AxisFunctions | None:
    """Return functions along an axis, or None where it did not vary.

    Parameters
    ----------
    residuals : Residuals
        Windows of all rigs.
    name : str
        Name of a covariate of these windows.
    length : float
        Length scale of smooth functions, relative to the range of the covariate.
    """
    values = residuals.covariates[name]
    is_finite = np.isfinite(values)
    if (
        not is_finite.any()
        or np.ptp(values[is_finite]) <= ROUNDING * np.abs(values[is_finite]).max()
    ):
        return None
    if name in CATEGORIES:
        grid = np.unique(values[is_finite])
        columns = np.equal.outer(values, grid).astype(np.float64)
        return AxisFunctions(name, is_finite, columns, grid, np.eye(grid.size))
    span = replace(Span.of(values[is_finite]), logarithmic=name in FINE_AT_FIRST)
    smooth = smooth_along({name: span}, length=length)
    if smooth is None:  # it varies by less than the resolution of a span
        return None
    columns = np.where(
        is_finite, smooth.columns({name: np.where(is_finite, values, span.low)}), 0.0
    )
    grid = np.linspace(span.low, span.high, GRID)
    return AxisFunctions(name, is_finite, columns.T, grid, smooth.columns({name: grid}).T)


def shares_of(
    residuals: Residuals,
    force: Array,
    hidden2: Mapping[str, Array],
    waves: Sequence[tuple[frozenset[str], Array]] = (),
) -> Shares:
    """Return which part of a systematic force each axis explains.

    Parameters
    ----------
    residuals : Residuals
        Windows in which the force is known.
    force : ndarray, shape (R, S)
        Draws of the force after recalibration of the law [N].
    hidden2 : mapping of str to ndarray, shape (S,)
        Mean square of periodic forces with unrecorded phase, by their axis [N²].
    waves : sequence of (frozenset of str, ndarray of shape (R,))
        Periodic forces along a path, each with its axes [N]. They are finer than the smooth
        functions of these axes and are added to them.

    Returns
    -------
    Shares
        For evenly spaced draws. A draw without a force is unexplained.
    """
    taken = np.linspace(0, force.shape[1] - 1, min(DRAWS, force.shape[1])).astype(np.intp)
    response = np.sqrt(residuals.weight)[:, None] * force[:, taken]
    hidden2 = {name: values[taken] for name, values in hidden2.items()}
    total2 = (response**2).sum(axis=0) + sum(hidden2.values())
    there = total2 > (NOTHING * residuals.friction_rms) ** 2
    scale2 = np.where(there, total2, 1.0)
    fine = residuals.size.size >= FINE
    axes = [
        functions_along(residuals, name, NARROW if fine and name not in HISTORY else BROAD)
        for name in residuals.axes
    ]
    weighted = _weighted(residuals, [axis for axis in axes if axis is not None])
    alone = {
        name: explained_by_subsets([Block((0,), columns)], 1, response, RIDGE)[1]
        for name, columns in weighted.items()
    }
    share = _competing(residuals, weighted, alone, response, waves)
    for name, values in hidden2.items():
        share[name] = share.get(name, 0.0) + values
        alone[name] = alone.get(name, 0.0) + values

    def relative(values: Array) -> Array:
        return np.where(there & (values > ROUNDING * scale2), values / scale2, 0.0)

    share = {name: relative(values) for name, values in share.items()}
    alone = {name: relative(values) for name, values in alone.items()}
    explained = sum(share.values(), np.zeros(taken.size))
    over = np.maximum(explained, 1.0)  # by rounding
    return Shares(
        {name: values / over for name, values in share.items()},
        {name: np.minimum(values, 1.0) for name, values in alone.items()},
        1.0 - explained / over,
        there,
    )


def _weighted(residuals: Residuals, axes: Sequence[AxisFunctions]) -> dict[str, Array]:
    """Return weighted friction times each axis' functions, with the law projected out, (R, k)."""
    ready = {axis.name: _ready(residuals, axis.columns, axis.is_known) for axis in axes}
    if "setup" in ready:
        # Assemblies differ along all other axes too: only the rest belongs to the assembly.
        rest = [columns for name, columns in ready.items() if name != "setup"]
        ready["setup"] = _beyond(ready["setup"], rest)
    if "travel_since_reversal" in ready:
        # Within a stroke, direction and position determine the travel.
        state = [name for name in ("displacement", "direction") if name in ready]
        rest = [ready[name] for name in state]
        rest += [block.columns for block in _products(residuals, state)]
        ready["travel_since_reversal"] = _beyond(ready["travel_since_reversal"], rest)
    return ready


def _ready(residuals: Residuals, columns: Array, there: Flags) -> Array:
    """Centre functions where they are defined, weight them, and project the refitted law out."""
    weight = residuals.weight * residuals.friction_n**2
    mean = (weight * there) @ columns / (weight * there).sum()
    force = np.where(there[:, None], columns - mean, 0.0) * residuals.friction_n[:, None]
    left = residuals.without_law(force)
    return np.asarray(np.sqrt(residuals.weight / weight.sum())[:, None] * left)


def _beyond(columns: Array, others: Sequence[Array]) -> Array:
    """Return a basis of the part of functions that other functions leave."""
    if others:
        basis, size, _ = np.linalg.svd(np.concatenate(others, axis=1), full_matrices=False)
        basis = basis[:, size > SEEN * size[0]] if size[0] > 0 else basis[:, :0]
        columns = columns - basis @ (basis.T @ columns)
    basis, size, _ = np.linalg.svd(columns, full_matrices=False)
    kept = size > SEEN
    return np.asarray(basis[:, kept] * size[kept])


def _competing(
    residuals: Residuals,
    weighted: Mapping[str, Array],
    alone: Mapping[str, Array],
    response: Array,
    waves: Sequence[tuple[frozenset[str], Array]],
) -> dict[str, Array]:
    """Return the Shapley value of each axis, by name, (S,) [N²]."""
    order = sorted(weighted, key=lambda name: (-float(alone[name].mean()), name))
    single, together = order, []
    if len(order) > PLAYERS:
        single, together = order[: PLAYERS - 1], order[PLAYERS - 1 :]
    # Axes with many functions come first, while there are few subsets.
    single = sorted(single, key=lambda name: (-weighted[name].shape[1], name))
    blocks = [Block((place,), weighted[name]) for place, name in enumerate(single)]
    blocks += _products(residuals, single)
    blocks += _waves_along(residuals, waves, single)
    if together:
        rest = np.concatenate([weighted[name] for name in together], axis=1)
        blocks.append(Block((len(single),), rest))
    players = len(single) + bool(together)
    values = shapley_values(explained_by_subsets(blocks, players, response, RIDGE))
    explained = dict(zip(single, values, strict=False))
    if together:
        part = np.stack([alone[name] for name in together]) + np.finfo(np.float64).tiny
        explained |= dict(zip(together, values[-1] * part / part.sum(axis=0), strict=True))
    return explained


def _products(residuals: Residuals, names: Sequence[str]) -> list[Block]:
    """Return the product of each two axes that describe the machine's state."""
    state = {
        place: _standardised(residuals.covariates[name])
        for place, name in enumerate(names)
        if name not in HISTORY and name not in CATEGORIES
    }
    products = []
    for first, second in combinations(state, 2):
        product = PAIRED * state[first] * state[second]
        is_finite = np.isfinite(product)
        if is_finite.any():
            columns = np.where(is_finite, product, 0.0)[:, None]
            products.append(Block((first, second), _ready(residuals, columns, is_finite)))
    return products


def _waves_along(
    residuals: Residuals, waves: Sequence[tuple[frozenset[str], Array]], names: Sequence[str]
) -> list[Block]:
    """Return each wave, as a block of all its axes that vary."""
    blocks = []
    for axes, wave in waves:
        players = tuple(place for place, name in enumerate(names) if name in axes)
        column = np.sqrt(residuals.weight) * residuals.without_law(wave)
        size = np.sqrt(column @ column)
        if players and size > 0:
            blocks.append(Block(players, column[:, None] / size))
    return blocks


def _standardised(values: Array) -> Array:
    """Return values minus their mean, over their standard deviation; nan for missing values."""
    finite = values[np.isfinite(values)]
    return np.asarray((values - finite.mean()) / finite.std())
