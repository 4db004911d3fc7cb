"""The figures of the gap, as they are stored."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bayesfric.diagnosis.causes import CauseDraws
from bayesfric.diagnosis.shrink import Arms, GapFigures, Squares, explained, gap_row, systematic_gap
from bayesfric.diagnosis.trajectories import Example
from bayesfric.schemas import Gap

__all__ = ["curves_of", "gap_figures"]

Array = NDArray[np.float64]
NO_CAUSE = "no cause is named, so nothing was added that could shrink the gap"
NO_PHASES = "where in its round the cause begins differs from trial to trial, unpredictably"
NO_SHIPPED = "no published coefficients of these pulley sizes"
PLACES = ("velocity", "tension", "wrap_angle", "n_pulleys", "displacement", "order")


def gap_figures(
    figures: GapFigures,
    free: tuple[Squares, tuple[Example, ...]] | None,
    arms: Arms,
    causes: bool,
    rng: np.random.Generator,
) -> tuple[Gap, Array]:
    """Return the four figures in newtons and metres, and draws of the systematic gap [N].

    The draws are those of :func:`~bayesfric.diagnosis.shrink.systematic_gap`.

    Parameters
    ----------
    figures : GapFigures
        In newtons.
    free : tuple or None
        In metres.
    arms : Arms
        Both models.
    causes : bool
        Whether there are any.
    rng : Generator
        For the bootstrap.
    """
    no_shrink = None if arms.causes.columns else NO_PHASES if causes else NO_CAUSE
    rows = [
        gap_row(name, squares, no_shrink=no_shrink, shipped_why=NO_SHIPPED, rng=rng)
        for name, squares in figures.held_out
    ]
    (first, systematic, draws), *_ = rows
    if arms.causes.columns:
        taken = explained(figures.held_out[0][1], rng)
        draws = systematic_gap(draws, taken, predicted=arms.predicted)
    inside, _, _ = gap_row(
        "in sample", figures.in_sample, no_shrink=no_shrink, shipped_why=NO_SHIPPED, rng=rng
    )
    trajectory = None
    if free is not None:
        trajectory, _, _ = gap_row(
            "free-running, folds over assemblies",
            free[0],
            no_shrink=no_shrink,
            shipped_why=NO_SHIPPED,
            rng=rng,
        )
    residuals = figures.residuals
    friction = float(np.sqrt((residuals.weight * residuals.friction_n**2).sum()))
    gap = Gap(
        **first.model_dump(exclude={"name"}),
        systematic=systematic,
        friction_rms=friction,
        held_out=tuple(row for row, _, _ in rows),
        in_sample=inside,
        trajectory=trajectory,
        trajectory_why=None if trajectory is not None else "no trial has events enough",
    )
    return gap, draws


def curves_of(
    figures: GapFigures,
    free: tuple[Squares, tuple[Example, ...]] | None,
    draws: Mapping[str, CauseDraws],
) -> xr.DataTree:
    """Return what ``diagnosis.nc`` holds."""
    residuals = figures.residuals
    rig = np.where(residuals.covariates["rig"] == 0, "gravity", "motor")
    groups = {
        "residuals": xr.Dataset(
            {
                "rig": ("row", rig),
                "trial": ("row", np.array(residuals.names)[residuals.trial]),
                "friction_n": ("row", residuals.friction_n),
                "residual_n": ("row", figures.before),
                "residual_after_n": ("row", figures.after),
                "noise_sd_n": ("row", np.sqrt(residuals.variance)),
                **{name: ("row", residuals.covariates[name]) for name in PLACES},
            }
        )
    }
    if free is not None and free[1]:
        examples = free[1]
        longest = max(one.time_s.size for one in examples)

        def padded(name: str) -> Array:
            table = np.full((len(examples), longest), np.nan)
            for row, one in enumerate(examples):
                values = getattr(one, name)
                table[row, : values.size] = values
            return table

        names = ("time_s", "measured_m", "before_m", "after_m")
        groups["trajectories"] = xr.Dataset(
            {name: (("example", "event"), padded(name)) for name in names},
            coords={"trial": ("example", [one.trial for one in examples])},
        )
    if draws:
        groups["amplitudes"] = xr.Dataset(
            {"amplitude": (("cause", "draw"), np.stack([d.amplitude for d in draws.values()]))},
            coords={"cause": list(draws)},
        )
    return xr.DataTree.from_dict(groups)
