"""The paper's slopes in tension, number of pulleys and wrap angle, measured and predicted.

Measured slopes are those of :mod:`.estimator`. The prediction of each is the result of the same
steps on replicates of the recording from the posterior predictive. A replicate has new assemblies,
and the trials of an assembly shift together.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from bayesfric.arrays import Array
from bayesfric.observation.exact import ExactLikelihood
from bayesfric.paper import table1
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG, Coefficients
from bayesfric.physics.gravity import nominal_tension
from bayesfric.physics.laws import FrictionLaw
from bayesfric.rigs.bands import bands
from bayesfric.rigs.gravity_board.estimator import (
    LEAST_TENSION_RATIO,
    CellLine,
    PaperEstimate,
    SizeEstimate,
    is_upright,
    least_squares_lines,
)
from bayesfric.rigs.gravity_board.likelihood import GravityModel
from bayesfric.schemas.base import QUANTILES

GRID = 13
LEVELS = 3  # number of tensions at which friction is shown against the wrap angle


@dataclass(frozen=True)
class _Cell:
    """A line of friction against tension, as measured and in W replicates of the recording."""

    size: str
    line: CellLine
    tension: tuple[float, float]  # least and largest of its trials
    slope_again: Array  # (W,)
    intercept_again: Array  # (W,)

    def friction(self, tension: float) -> float:
        """Return the friction of the measured line at a tension [N]."""
        assert self.line.slope.value is not None and self.line.intercept_n is not None
        return self.line.slope.value * tension + self.line.intercept_n

    def friction_again(self, tension: float) -> Array:
        """Return the friction of the replicates' lines at a tension, shape (W,) [N]."""
        return self.slope_again * tension + self.intercept_again


def paper_slopes(
    likelihood: ExactLikelihood,
    model: GravityModel,
    estimate: PaperEstimate,
    named: dict[str, Array],
    baseline: FrictionLaw,
    rng: np.random.Generator,
) -> dict[str, xr.Dataset]:
    """Return the slopes of the paper's Figs 12 to 16.

    Parameters
    ----------
    likelihood : ExactLikelihood
        Likelihood of the fit.
    model : GravityModel
        Model of the fit.
    estimate : PaperEstimate
        The paper's estimate from the trials of the fit.
    named : dict of str to ndarray, shape (W,)
        Posterior draws of each parameter.
    baseline : FrictionLaw
        Friction law of the fit.
    rng : Generator
        Source of randomness for replicates of the recording.

    Returns
    -------
    dict of str to Dataset
        ``tension_lines``: slope and intercept of friction against tension for each (size, n, θ),
        and those of the law at 85° against n. ``wrap_lines``: friction against the wrap angle at
        three tensions for each (size, n) with two or more angles, its slope, and the slope of
        the law against n and against tension. A dataset is empty if the recording does not
        have the necessary conditions.
    """
    # NaN for trials without an estimate of friction, which are in no line
    measured = np.array([trial.tension_n for trial in estimate.trials], dtype=np.float64)
    deviation = likelihood.draw_scatter(named, rng, together=True)
    friction = likelihood.draw_observed(named, deviation, rng)
    condition = model.condition
    tension = nominal_tension(
        condition, (condition.drive_force_n - friction) / condition.total_mass_kg
    )
    in_order = sorted(estimate.sizes, key=lambda size: model.sizes.index(size.pulley_size))
    cells = [
        _again(size, line, model, measured, tension, friction)
        for size in in_order
        for line in size.cells
        if line.slope.value is not None
    ]
    if not cells:
        return {"tension_lines": xr.Dataset(), "wrap_lines": xr.Dataset()}
    fits = [trial.r_squared for trial in estimate.trials if trial.r_squared is not None]
    lines = _tension_lines(cells, named, baseline)
    return {
        "tension_lines": lines.assign(least_trial_r_squared=min(fits, default=np.nan)),
        "wrap_lines": _wrap_lines(cells, named, baseline),
    }


def _again(
    size: SizeEstimate,
    line: CellLine,
    model: GravityModel,
    measured: Array,
    tension: Array,
    friction: Array,
) -> _Cell:
    table = model.trials
    chosen = np.flatnonzero(
        np.isfinite(measured)
        & (table["pulley_size"] == size.pulley_size)
        & (table["n_pulleys"] == line.n_pulleys)
        & (table["wrap_angle_deg"] == line.wrap_angle_deg)
    )
    slope, intercept = least_squares_lines(tension[:, chosen], friction[:, chosen])
    ends = (float(measured[chosen].min()), float(measured[chosen].max()))
    return _Cell(size.pulley_size, line, ends, slope, intercept)


def _draws(named: dict[str, Array], size: str) -> Coefficients:
    """Return the draws of a size's coefficients, shape (W, 1), for a curve along the last axis."""
    return Coefficients(*(named[f"{c}[{size}]"][:, None] for c in Coefficients._fields))


def _sizes(cells: Sequence[_Cell]) -> list[str]:
    return list(dict.fromkeys(cell.size for cell in cells))


def _tension_lines(
    cells: Sequence[_Cell], named: dict[str, Array], baseline: FrictionLaw
) -> xr.Dataset:
    sizes = _sizes(cells)
    count = np.linspace(0.0, max(cell.line.n_pulleys for cell in cells), GRID)
    wrap = REFERENCE_WRAP_ANGLE_DEG
    # Both laws are linear in tension, so two tensions determine slope and intercept.
    at_none = np.stack([baseline.at_tension(_draws(named, s), count, wrap, 0.0) for s in sizes], 1)
    at_one = np.stack([baseline.at_tension(_draws(named, s), count, wrap, 1.0) for s in sizes], 1)
    paper = np.array(
        [
            [table1()[s].c1.value, table1()[s].c2.value] if s in table1() else [np.nan, np.nan]
            for s in sizes
        ]
    )
    r_squared = [cell.line.slope.r_squared for cell in cells]
    defined = [value for value in r_squared if value is not None]
    law = ("pulley", "n", "quantile")
    return xr.Dataset(
        {
            "pulley_size": ("cell", [cell.size for cell in cells]),
            "n_pulleys": ("cell", [cell.line.n_pulleys for cell in cells]),
            "wrap_angle_deg": ("cell", [cell.line.wrap_angle_deg for cell in cells]),
            "upright": ("cell", [is_upright(cell.line.wrap_angle_deg) for cell in cells]),
            "trials": ("cell", [cell.line.trials for cell in cells]),
            "slope": ("cell", [cell.line.slope.value for cell in cells]),
            "intercept_n": ("cell", [cell.line.intercept_n for cell in cells]),
            "r_squared": ("cell", np.array(r_squared, dtype=np.float64)),
            "least_r_squared": min(defined, default=np.nan),
            "slope_again": (
                ("cell", "quantile"),
                np.stack([bands(cell.slope_again) for cell in cells]),
            ),
            "intercept_again_n": (
                ("cell", "quantile"),
                np.stack([bands(cell.intercept_again) for cell in cells]),
            ),
            "slope_law": (law, bands(at_one - at_none)),
            "intercept_law_n": (law, bands(at_none)),
            "slope_paper": (("pulley", "n"), paper[:, :1] * count),
            "intercept_paper_n": (("pulley", "n"), paper[:, 1:] * count),
        },
        coords={"pulley": sizes, "n": count, "quantile": list(QUANTILES)},
    )


def _wrap_lines(
    cells: Sequence[_Cell], named: dict[str, Array], baseline: FrictionLaw
) -> xr.Dataset:
    """Return friction against the wrap angle for each (size, n) with two or more angles."""
    groups: dict[tuple[str, int], list[_Cell]] = {}
    for cell in cells:
        groups.setdefault((cell.size, cell.line.n_pulleys), []).append(cell)
    groups = {key: group for key, group in groups.items() if len(group) > 1}
    inside = [cell.tension for group in groups.values() for cell in group]
    low, high = max((t[0] for t in inside), default=0.0), min((t[1] for t in inside), default=0.0)
    if high <= LEAST_TENSION_RATIO * low:
        return xr.Dataset()
    # Tensions within the range of every line, so that no line is extrapolated.
    levels = np.linspace(low, high, LEVELS)
    lines = [(size, n, level) for size, n in groups for level in levels]
    width = max(len(group) for group in groups.values())
    angle = np.full((len(lines), width), np.nan)
    friction, slope = angle.copy(), np.empty(len(lines))
    again = np.full((len(lines), width, len(QUANTILES)), np.nan)
    slope_again = np.empty((len(lines), len(QUANTILES)))
    all_angles = sorted({cell.line.wrap_angle_deg for group in groups.values() for cell in group})
    grid = np.linspace(all_angles[0], all_angles[-1], GRID)
    law = np.empty((len(lines), GRID, len(QUANTILES)))
    for place, (size, n, level) in enumerate(lines):
        group = groups[size, n]
        filled = slice(len(group))
        angle[place, filled] = [cell.line.wrap_angle_deg for cell in group]
        friction[place, filled] = [cell.friction(level) for cell in group]
        new = np.stack([cell.friction_again(level) for cell in group], axis=1)
        again[place, filled] = bands(new)
        slope[place] = least_squares_lines(angle[place, filled], friction[place, filled])[0]
        slope_again[place] = bands(least_squares_lines(angle[place, filled], new)[0])
        law[place] = bands(baseline.at_tension(_draws(named, size), n, grid, level))
    table = xr.Dataset(
        {
            "pulley_size": ("line", [size for size, _, _ in lines]),
            "n_pulleys": ("line", [n for _, n, _ in lines]),
            "tension_n": ("line", [level for _, _, level in lines]),
            "wrap_angle_deg": (("line", "angle"), angle),
            "friction_n": (("line", "angle"), friction),
            "friction_again_n": (("line", "angle", "quantile"), again),
            "law_n": (("line", "grid", "quantile"), law),
            "law_angle_deg": ("grid", grid),
            "slope_n_per_deg": ("line", slope),
            "slope_again_n_per_deg": (("line", "quantile"), slope_again),
        },
        coords={"level": levels, "quantile": list(QUANTILES)},
    )
    ends = all_angles[0], all_angles[-1]
    slopes = _law_slopes(list(groups), levels, high, ends, named, baseline)
    return table.merge(slopes, join="exact", compat="no_conflicts")


def _law_slopes(
    groups: Sequence[tuple[str, int]],
    levels: Array,
    high: float,
    ends: tuple[float, float],
    named: dict[str, Array],
    baseline: FrictionLaw,
) -> xr.Dataset:
    """Return the law's slope between two wrap angles, against n and against tension.

    Parameters
    ----------
    groups : sequence of (str, int)
        Measured pulley sizes and numbers of pulleys.
    levels : ndarray
        Tensions of the curves against n [N].
    high : float
        Largest tension of the curves against tension [N].
    ends : (float, float)
        The two wrap angles [deg].
    named : dict of str to ndarray, shape (W,)
        Posterior draws of each parameter.
    baseline : FrictionLaw
        The friction law.
    """
    sizes = list(dict.fromkeys(size for size, _ in groups))
    counts = sorted({n for _, n in groups})
    n_grid, tension_grid = np.linspace(0.0, counts[-1], GRID), np.linspace(0.0, high, GRID)

    def law_slope(size: str, n: Array | float, tension: Array | float) -> Array:
        least, most = (baseline.at_tension(_draws(named, size), n, end, tension) for end in ends)
        return bands((most - least) / (ends[1] - ends[0]))

    return xr.Dataset(
        {
            "law_against_n": (
                ("pulley", "level", "n", "quantile"),
                np.stack([[law_slope(s, n_grid, t) for t in levels] for s in sizes]),
            ),
            "law_against_tension": (
                ("pulley", "count", "tension", "quantile"),
                np.stack([[law_slope(s, float(n), tension_grid) for n in counts] for s in sizes]),
            ),
        },
        coords={
            "pulley": sizes,
            "level": levels,
            "count": counts,
            "n": n_grid,
            "tension": tension_grid,
            "quantile": list(QUANTILES),
        },
    )
