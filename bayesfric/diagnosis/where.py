"""Where the gap lies: which part of the systematic force each axis explains, and its curve.

Shares are computed from the posterior of the systematic force, averaged over hypotheses. A check
needs no hypothesis: held-out residuals are regressed on smooth functions of each covariate, which
all pulley sizes share. Recordings are drawn under the baseline, with its scatter of trials and
assemblies, and refitted. They give a p-value, adjusted by the largest statistic over all axes.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from bayesfric.arrays import Array
from bayesfric.diagnosis.chance import redrawn
from bayesfric.diagnosis.residuals import Residuals
from bayesfric.diagnosis.shares import AxisFunctions, Shares, functions_along, shares_of
from bayesfric.diagnosis.systematic import Posterior
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects import Effect
from bayesfric.observation.layout import COEFFICIENTS
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import Shape
from bayesfric.schemas.gap import Axis

DRAWS = 400
SCALE = 0.1  # prior standard deviation of a smooth function, relative to friction
BAND = 0.95
TINY = 1e-300  # avoids division by zero if a statistic is constant
VISIBLE = 0.02  # relative size below which a function does not vary in these windows
BLIND = "it did not vary in these data"
NO_PHASE = "its phase is not recorded"
NOT_APART = "no axis varied in these data"
TAKEN_UP = "a refitted law absorbs any force along the axes that varied"
NO_FORCE = "these data ask for no systematic force"


def where_it_lies(
    residuals: Residuals,
    before: Array,
    windows: Residuals,
    posterior: Posterior,
    effects: Mapping[str, Effect],
    rng: np.random.Generator,
) -> tuple[tuple[Axis, ...], Interval, str]:
    """Return every axis by its share, the unexplained share, and why that is all of the force.

    Parameters
    ----------
    residuals : Residuals
        Of all rigs, from the law alone.
    before : ndarray, shape (R,)
        Held-out residual force of the recalibrated baseline [N].
    windows : Residuals
        Windows in which the forces of the posterior are computed.
    posterior : Posterior
        Draws of the systematic force.
    effects : mapping of str to Effect
        Effects that were evaluated, by name.
    rng : Generator
        Source of randomness for the redrawn recordings.

    Returns
    -------
    tuple of Axis, Interval, str
        Axes that did not vary are last. The reason is empty unless all of the force is unexplained.
    """
    columns = (functions_along(residuals, name) for name in residuals.axes)
    designs = {axis.name: axis for axis in columns if axis is not None}
    hidden2 = _hidden2(windows, posterior, effects) if designs else {}
    waves = [(effects[name].axes, wave) for name, own in posterior.waves.items() for wave in own]
    shares = shares_of(windows, posterior.force, hidden2, waves)
    relative = before / residuals.friction_n
    precision = 1 / (residuals.variance / residuals.friction_n**2 + residuals.spread2)
    p_values, shapes = _tests(residuals, designs, relative, precision, rng)
    intervals = {name: Interval.of_draws(values) for name, values in shares.share.items()}
    order = sorted(intervals, key=lambda name: (-intervals[name].q50, -intervals[name].mean, name))
    first_leads = _leads([intervals[name] for name in order])
    axes = [
        Axis(
            axis=name,
            unit=residuals.unit(name),
            blind=False,
            share=intervals[name],
            alone=Interval.of_draws(shares.alone[name]),
            leads=first_leads and place == 0,
            confounded_with=_confounded(name, designs, precision),
            p_value=p_values.get(name),
            p_value_why=None if name in p_values else NO_PHASE,
            shape=shapes.get(name),
            shape_why=None if name in shapes else NO_PHASE,
        )
        for place, name in enumerate(order)
    ]
    blind = [_blind(name, residuals.unit(name)) for name in residuals.axes if name not in intervals]
    return (*axes, *blind), Interval.of_draws(shares.unexplained), _why_all(shares)


def _why_all(shares: Shares) -> str:
    """Return why no axis has a share; empty if an axis has one."""
    if not shares.share:
        return NOT_APART
    if not shares.there.any():
        return NO_FORCE
    return "" if shares.unexplained.min() < 1.0 else TAKEN_UP


def _leads(shares: Sequence[Interval]) -> bool:
    """Return whether the 5 % quantile of the first share is above the median of the next."""
    return bool(shares) and shares[0].q05 > (shares[1].q50 if len(shares) > 1 else 0.0)


def _hidden2(
    residuals: Residuals, posterior: Posterior, effects: Mapping[str, Effect]
) -> dict[str, Array]:
    """Return the mean square of periodic forces with unrecorded phase, by their axis."""
    hidden: dict[str, Array] = {}
    for name, strength in posterior.strengths.items():
        effect = effects[name]
        if not effect.components or effect.acts_on == "reading":
            continue
        for axis in sorted(effect.axes) or [name]:
            part = (strength * residuals.friction_rms) ** 2 / max(len(effect.axes), 1)
            hidden[axis] = hidden.get(axis, 0.0) + part
    return hidden


def _blind(name: str, unit: str) -> Axis:
    return Axis(
        axis=name,
        unit=unit,
        blind=True,
        share=None,
        share_why=BLIND,
        alone=None,
        alone_why=BLIND,
        leads=False,
        confounded_with=(),
        p_value=None,
        p_value_why=BLIND,
        shape=None,
        shape_why=BLIND,
    )


def _smoothing(columns: Array, precision: Array) -> Array:
    """Return the matrix from relative residuals to coefficients of a smooth function, (k, R)."""
    weighted = columns.T * precision
    inner = weighted @ columns + np.eye(columns.shape[1]) / SCALE**2
    return np.asarray(np.linalg.solve(inner, weighted))


def _tests(
    residuals: Residuals,
    designs: Mapping[str, AxisFunctions],
    relative: Array,
    precision: Array,
    rng: np.random.Generator,
) -> tuple[dict[str, float], dict[str, Shape]]:
    """Return adjusted p-values, and the curve of each axis with its band."""
    if not designs:  # a single trial varies along no axis
        return {}, {}
    drawn = redrawn(residuals, DRAWS, rng) / residuals.friction_n[:, None]
    refit, unit = _refitting(residuals, precision), residuals.friction_rms
    drawn, observed = drawn - refit(drawn), relative - refit(relative[:, None])[:, 0]
    statistics, null, curves, off = {}, {}, {}, {}
    for name, design in designs.items():
        smoothing = _smoothing(design.columns, precision)
        numbers, drawn_values = smoothing @ observed, smoothing @ drawn
        inner = design.columns.T @ (precision[:, None] * design.columns)
        squares = np.einsum("kb,kl,lb->b", drawn_values, inner, drawn_values)
        value = float(numbers @ inner @ numbers)
        sd2 = max(squares.std(), TINY)
        statistics[name] = (value - squares.mean()) / sd2
        null[name] = (squares - squares.mean()) / sd2
        moved = design.on_grid @ drawn_values
        sd = moved.std(axis=1)
        off[name] = np.abs(moved / np.maximum(sd, TINY)[:, None]).max(axis=0)
        curves[name] = (design.on_grid @ numbers, sd)
    largest = np.max(list(null.values()), axis=0)
    # One width for all axes: on a board without a gap some curve leaves its band with
    # probability 0.05.
    width = float(np.quantile(np.max(list(off.values()), axis=0), BAND))
    return {
        name: float((1 + np.count_nonzero(largest >= value)) / (1 + DRAWS))
        for name, value in statistics.items()
    }, {
        name: _shape(designs[name].grid, unit * middle, unit * width * sd)
        for name, (middle, sd) in curves.items()
    }


def _shape(grid: Array, middle: Array, half: Array) -> Shape:
    """Return a curve with a band [N]."""
    return Shape(
        grid=tuple(grid.tolist()),
        gap_n=tuple(middle.tolist()),
        low_n=tuple((middle - half).tolist()),
        high_n=tuple((middle + half).tolist()),
    )


def _refitting(residuals: Residuals, precision: Array) -> Callable[[Array], Array]:
    """Return the projection on what the coefficients of each size can explain."""
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


def _confounded(
    name: str, designs: Mapping[str, AxisFunctions], precision: Array
) -> tuple[str, ...]:
    """Return the axes whose functions are nearly the same in these windows."""
    alike = []
    for other in designs:
        if other == name or name not in designs:
            continue
        pair = [designs[name], designs[other]]
        both = pair[0].is_known & pair[1].is_known
        if not both.any():
            continue
        mine, theirs = (_orthonormal(axis.columns[both], precision[both]) for axis in pair)
        cosines = np.linalg.svd(mine.T @ theirs, compute_uv=False)
        if cosines.size and cosines[0] > RULES.axes_alike:
            alike.append(other)
    return tuple(alike)


def _orthonormal(columns: Array, precision: Array) -> Array:
    """Return an orthonormal basis of the functions without their constant."""
    root = np.sqrt(precision / precision.sum())
    centred = columns - (precision / precision.sum()) @ columns
    left, singular, _ = np.linalg.svd(root[:, None] * centred, full_matrices=False)
    return np.asarray(left[:, singular > VISIBLE * np.abs(columns).max()])
