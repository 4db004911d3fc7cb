"""Where the gap lies: the systematic residual force along each covariate.

The relative residual of each window is regressed on smooth functions of a covariate,
shared by all pulley sizes. A share is what such a smooth predicts of assemblies that
it was not fitted on; a p-value comes from recordings redrawn under the baseline with
its scatter of trials and assemblies, refitted, and is adjusted by the largest
statistic of all axes.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.diagnosis.chance import redrawn
from bayesfric.diagnosis.residuals import CATEGORIES, Residuals
from bayesfric.inference.smooths import Span, smooth_along
from bayesfric.rigs.layout import COEFFICIENTS
from bayesfric.schemas import Axis, Shape

__all__ = ["where_it_lies"]

DRAWS = 400
SCALE = 0.1  # prior sd of a smooth, as a share of friction
GRID = 25
ALIKE = 0.95  # canonical correlation of two axes' functions, from which on they are confounded
BAND = 0.95
ROUNDING = 1e-9  # of a covariate's size, which is no variation
NO_GAP = "a gap of practical size is less likely than not"
VISIBLE = 0.02  # of a function of an axis: less, and it does not vary here


@dataclass(frozen=True)
class _Design:
    """One axis: its functions at the windows, and on a grid."""

    name: str
    known: Flags  # (R,), where a window has such a place
    columns: Array  # (R, k)
    grid: Array  # (G,)
    on_grid: Array  # (G, k)


def where_it_lies(
    residuals: Residuals,
    before: Array,
    fold: Whole,
    gap2: float,
    rng: np.random.Generator,
) -> tuple[Axis, ...]:
    """Return every axis, the largest share first.

    Parameters
    ----------
    residuals : Residuals
        Of both boards.
    before : ndarray, shape (R,)
        Held-out residual force of the recalibrated baseline [N].
    fold : ndarray of int, shape (R,)
        In which each window was held out.
    gap2 : float
        Square of the systematic gap, of which shares are; 0 where there is none [N²].
    rng : Generator
        For the bootstrap.
    """
    every = residuals.axes
    designs = {name: design for name in every if (design := _design(name, residuals)) is not None}
    blind = [name for name in every if name not in designs]
    relative = before / residuals.friction_n
    noise = residuals.variance / residuals.friction_n**2
    spread2 = residuals.spread2
    precision = 1 / (noise + spread2)
    weight = residuals.weight * residuals.friction_n**2
    share, unique = _shares(designs, relative, fold, precision, weight, gap2)
    p_values, shapes = _tests(residuals, designs, relative, precision, rng)
    unit = float(np.sqrt(weight.sum()))
    axes = []
    for name, design in designs.items():
        found, band = shapes[name]
        axes.append(
            Axis(
                axis=name,
                unit=residuals.unit(name),
                blind=False,
                share=share.get(name),
                share_why=None if name in share else NO_GAP,
                unique_share=unique.get(name),
                unique_share_why=None if name in unique else NO_GAP,
                confounded_with=_confounded(design, designs, precision),
                p_value=p_values[name],
                shape=Shape(
                    grid=tuple(design.grid.tolist()),
                    gap_n=tuple((unit * found).tolist()),
                    low_n=tuple((unit * (found - band)).tolist()),
                    high_n=tuple((unit * (found + band)).tolist()),
                ),
            )
        )
    axes.sort(key=lambda axis: (-(axis.share or 0.0), axis.p_value, axis.axis))
    return (*axes, *(_blind(name, residuals.unit(name)) for name in blind))


def _blind(name: str, unit: str) -> Axis:
    why = "it did not vary in these data"
    return Axis(
        axis=name,
        unit=unit,
        blind=True,
        share=None,
        share_why=why,
        unique_share=None,
        unique_share_why=why,
        confounded_with=(),
        p_value=None,
        p_value_why=why,
        shape=None,
        shape_why=why,
    )


def _design(name: str, residuals: Residuals) -> _Design | None:
    values = residuals.covariates[name]
    known = np.isfinite(values)
    if not known.any() or np.ptp(values[known]) <= ROUNDING * np.abs(values[known]).max():
        return None
    if name in CATEGORIES:
        grid = np.unique(values[known])
        columns = np.equal.outer(values, grid).astype(np.float64)
        return _Design(name, known, columns, grid, np.eye(grid.size))
    span = Span.of(values[known])
    low, high = span.low, span.high
    smooth = smooth_along({name: span})
    assert smooth is not None
    columns = np.where(known, smooth.columns({name: np.where(known, values, low)}), 0.0)
    grid = np.linspace(low, high, GRID)
    return _Design(name, known, columns.T, grid, smooth.columns({name: grid}).T)


def _smoothing(columns: Array, precision: Array) -> Array:
    """Return what turns relative residuals into the numbers of a smooth, shape (k, R)."""
    weighted = columns.T * precision
    inner = weighted @ columns + np.eye(columns.shape[1]) / SCALE**2
    return np.asarray(np.linalg.solve(inner, weighted))


def _shares(
    designs: dict[str, _Design],
    relative: Array,
    fold: Whole,
    precision: Array,
    weight: Array,
    gap2: float,
) -> tuple[dict[str, float], dict[str, float]]:
    """Return the share and the unique share of each axis; none where there is no gap."""
    if gap2 <= 0:
        return {}, {}

    def explained(names: list[str]) -> float:
        if not names:
            return 0.0
        columns = np.concatenate([designs[name].columns for name in names], axis=1)
        predicted = np.empty_like(relative)
        for number in range(int(fold.max()) + 1):
            train = fold != number
            numbers = _smoothing(columns[train], precision[train]) @ relative[train]
            predicted[~train] = columns[~train] @ numbers
        left = (weight * (relative - predicted) ** 2).sum()
        return float(((weight * relative**2).sum() - left) / gap2)

    names = list(designs)
    whole = explained(names)
    share = {name: explained([name]) for name in names}
    unique = {name: whole - explained([n for n in names if n != name]) for name in names}
    return share, unique


def _tests(
    residuals: Residuals,
    designs: dict[str, _Design],
    relative: Array,
    precision: Array,
    rng: np.random.Generator,
) -> tuple[dict[str, float], dict[str, tuple[Array, Array]]]:
    """Return adjusted p-values, and each shape with the half width of its band."""
    if not designs:  # a single trial varies along no axis
        return {}, {}
    drawn = redrawn(residuals, DRAWS, rng) / residuals.friction_n[:, None]
    refit = _refitting(residuals, precision)
    drawn, observed = drawn - refit(drawn), relative - refit(relative[:, None])[:, 0]
    statistics, null, shapes, off = {}, {}, {}, {}
    for name, design in designs.items():
        smoothing = _smoothing(design.columns, precision)
        numbers, many = smoothing @ observed, smoothing @ drawn
        inner = design.columns.T @ (precision[:, None] * design.columns)
        squares = np.einsum("kb,kl,lb->b", many, inner, many)
        value = float(numbers @ inner @ numbers)
        statistics[name] = (value - squares.mean()) / squares.std()
        null[name] = (squares - squares.mean()) / squares.std()
        moved = design.on_grid @ many
        sd = moved.std(axis=1)
        off[name] = np.abs(moved / sd[:, None]).max(axis=0)
        shapes[name] = (design.on_grid @ numbers, sd)
    largest = np.max(list(null.values()), axis=0)
    # One width for all axes: a board without a gap leaves some band by chance one time in twenty.
    width = float(np.quantile(np.max(list(off.values()), axis=0), BAND))
    return {
        name: float((1 + np.count_nonzero(largest >= value)) / (1 + DRAWS))
        for name, value in statistics.items()
    }, {name: (found, width * sd) for name, (found, sd) in shapes.items()}


def _refitting(residuals: Residuals, precision: Array) -> Callable[[Array], Array]:
    """Return the projection on what the coefficients of each size can take up."""
    sizes = np.unique(residuals.size)
    columns = np.zeros((residuals.size.size, sizes.size * COEFFICIENTS))
    own = residuals.columns[:, :COEFFICIENTS] / residuals.friction_n[:, None]
    for place, size in enumerate(sizes):
        mine = residuals.size == size
        columns[mine, place * COEFFICIENTS : (place + 1) * COEFFICIENTS] = own[mine]
    basis = np.linalg.svd(np.sqrt(precision)[:, None] * columns, full_matrices=False)
    kept = basis[0][:, basis[1] > 1e-8 * basis[1][0]]
    root = np.sqrt(precision)[:, None]
    return lambda values: kept @ (kept.T @ (root * values)) / root


def _confounded(design: _Design, designs: dict[str, _Design], precision: Array) -> tuple[str, ...]:
    """Return the axes whose functions say almost the same at these windows."""
    alike = []
    for name, other in designs.items():
        if name == design.name:
            continue
        here = design.known & other.known
        mine, theirs = (_orthonormal(one.columns[here], precision[here]) for one in (design, other))
        cosines = np.linalg.svd(mine.T @ theirs, compute_uv=False)
        if cosines.size and cosines[0] > ALIKE:
            alike.append(name)
    return tuple(alike)


def _orthonormal(columns: Array, precision: Array) -> Array:
    """Return an orthonormal basis of the functions, their constant taken off."""
    root = np.sqrt(precision / precision.sum())
    centred = columns - (precision / precision.sum()) @ columns
    left, singular, _ = np.linalg.svd(root[:, None] * centred, full_matrices=False)
    return np.asarray(left[:, singular > VISIBLE * np.abs(columns).max()])
