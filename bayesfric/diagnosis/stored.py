"""Figures and curves of the gap, in the form that is stored."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from bayesfric.arrays import Array
from bayesfric.diagnosis.arms import Arms
from bayesfric.diagnosis.held_out import IN_NONE, HeldOut, Squares, gap_row
from bayesfric.diagnosis.refitted import RefittedLaw
from bayesfric.diagnosis.residuals import AXES, Residuals
from bayesfric.diagnosis.systematic import SMALLEST, Posterior, left_of, shrink_of
from bayesfric.diagnosis_rules import RULES
from bayesfric.probabilities import two_digits
from bayesfric.schemas.base import Interval
from bayesfric.schemas.gap import Gap, GapRow
from bayesfric.stored_names import RESIDUALS, variable_of

NO_EVENTS, NONE_OUT = "no trial has enough events", "no data could be held out"
NO_CAUSE = "no cause is named, so no effect was added"
NO_PHASES = "the phase at which the cause begins differs from trial to trial, unpredictably"
NO_GAP = "once the law is recalibrated, the cause leaves no gap to remove"
NO_SHIPPED = "no shipped values were given, and none are published"
PLACES = ("velocity", "tension", "wrap_angle", "n_pulleys", "displacement", "order")
OF_SOME = ("acceleration", "trial_in_setup", "drive_end", "direction", "travel_since_reversal")
"""Further places, which stand there if some window has one."""


def gap_of(
    held_out: HeldOut,
    posterior: Posterior,
    residuals: Residuals,
    arms: Arms,
    practical: float,
    rng: np.random.Generator,
    unit: str,
) -> tuple[Gap, Array | None]:
    """Return the figures of the gap, and draws of the part of its square that causes leave.

    The draws are None if nothing can shrink, or if what is left is not certainly of practical
    size.

    Parameters
    ----------
    held_out : HeldOut
        Residuals on held-out data.
    posterior : Posterior
        Draws of the systematic gap.
    residuals : Residuals
        Windows of the model of these draws.
    arms : Arms
        The law without and with the causes.
    practical : float
        Practical share of friction.
    rng : Generator
        Source of randomness for the bootstrap.
    unit : str
        Unit of a force.
    """
    why = _why_no_shrink(arms)
    any_out = bool(np.any(held_out.fold != IN_NONE))
    rows, inside, trajectory = _rows_of(held_out, why, rng)
    friction, open2, shrink, rest = residuals.friction_rms, posterior.gap**2, None, None
    if why is None:
        open2 = _left_open(held_out, posterior, residuals)
        shrink, rest = _shrink_of_model(held_out, posterior, residuals, arms, practical)
        why = NO_GAP if shrink is None else None
    open2 = open2 - posterior.hidden2  # windows average over forces that turn with the pulleys
    left2 = float(held_out.rows[0][1].after.sum())
    unnoticed2 = (practical * friction / 2) ** 2
    disagrees = floor_disagrees(left2, held_out.by_chance, open2, unnoticed2, unit)
    gap = Gap(
        **rows[0].model_dump(exclude={"name", "below_floor"}),
        unit=unit,
        shrink_of_model=shrink,
        shrink_of_model_why=why,
        systematic=Interval.of_draws(posterior.gap),
        probability_above_practical=float(np.mean(posterior.gap >= practical * friction)),
        floor_agrees=disagrees is None,
        floor_disagreement=disagrees,
        held_out_excess=excess_of(left2, held_out.by_chance, open2),
        friction_rms=friction,
        held_out=tuple(rows if any_out else rows[1:]),
        in_sample=inside,
        trajectory=trajectory,
        trajectory_why=None if trajectory is not None else NO_EVENTS if any_out else NONE_OUT,
    )
    return gap, rest


def _why_no_shrink(arms: Arms) -> str | None:
    """Return why no cause can shrink the gap; None if one can."""
    if arms.causes.laws:
        return None
    return NO_PHASES if arms.causes.phases else NO_CAUSE


def _rows_of(
    held_out: HeldOut, no_shrink: str | None, rng: np.random.Generator
) -> tuple[list[GapRow], GapRow, GapRow | None]:
    """Return the rows of held-out data, of the fitted data, and of trajectories."""

    def row(name: str, squares: Squares) -> GapRow:
        return gap_row(name, squares, no_shrink=no_shrink, shipped_why=NO_SHIPPED, rng=rng)

    rows = [row(name, squares) for name, squares in held_out.rows]
    inside = row("in sample", held_out.in_sample)
    trajectory = held_out.trajectory
    if trajectory is None or not np.any(held_out.fold != IN_NONE):
        return rows, inside, None
    return rows, inside, row("free-running, folds over assemblies", trajectory)


def _left_open(held_out: HeldOut, posterior: Posterior, residuals: Residuals) -> Array:
    """Return draws of the squared gap that the causes leave at the amplitudes that fit best."""
    _, before, after = held_out.inside
    return left_of(residuals, posterior, residuals.without_law(before - after))


def _shrink_of_model(
    held_out: HeldOut, posterior: Posterior, residuals: Residuals, arms: Arms, practical: float
) -> tuple[Interval | None, Array | None]:
    """Return the part of the squared gap that causes remove, and draws of the rest.

    The part is None without a gap; the rest is None unless certainly of practical size.
    """
    friction = residuals.friction_rms
    own = residuals.without_law(arms.of_causes(held_out.residuals))
    draws = shrink_of(residuals, posterior, own)
    if draws is None or np.median(posterior.gap) < practical * friction / 2:
        return None, None
    kept: Array = np.clip(1 - draws, 0.0, 2.0)
    felt = np.sqrt(kept) * posterior.gap[posterior.gap > SMALLEST * friction] / friction
    is_surely_left = np.quantile(felt, 0.05) >= practical
    return Interval.of_draws(np.maximum(draws, -1.0)), kept if is_surely_left else None


def floor_disagrees(
    left2: float, by_chance: Array, open2: Array, unnoticed2: float = 0.0, unit: str = "N"
) -> str | None:
    """Return a text if held-out data and the model contradict each other; else None.

    Parameters
    ----------
    left2 : float
        Mean square of the held-out residual with the causes [N²].
    by_chance : ndarray, shape (B,)
        Draws of `left2` for a correct law [N²].
    open2 : ndarray, shape (S,)
        Draws of the squared systematic gap that the causes leave [N²].
    unnoticed2 : float
        A negligible squared force [N²]; if both are smaller, they agree.
    unit : str
        Unit of a force.
    """
    expected2 = np.add.outer(by_chance, open2)
    less = float(np.mean(expected2 < left2))
    typical2 = max(float(np.median(expected2)), 0.0)
    if RULES.like_scatter <= less <= 1 - RULES.like_scatter or max(left2, typical2) < unnoticed2:
        return None
    left, expected = np.sqrt([max(left2, 0.0), typical2])
    more_or_less = "less" if less < RULES.like_scatter else "more"
    return (
        f"on data that the fit has not seen the law is off by {two_digits(left)} {unit} rms, "
        f"{more_or_less} than the {two_digits(expected)} {unit} rms that scatter and the remaining "
        "gap together would make"
    )


def excess_of(left2: float, by_chance: Array, open2: Array) -> float:
    """Return the rms of the held-out residual beyond chance [N]; 0 if chance explains it.

    Parameters
    ----------
    left2, by_chance, open2
        As of :func:`floor_disagrees`.
    """
    expected2 = np.add.outer(by_chance, open2)
    if float(np.mean(expected2 < left2)) <= 1 - RULES.like_scatter:
        return 0.0
    return float(np.sqrt(left2 - np.median(expected2)))


def curves_of(held_out: HeldOut, amplitudes: Mapping[str, Array], law: RefittedLaw) -> xr.DataTree:
    """Return the content of ``diagnosis.nc``."""
    residuals = held_out.residuals
    measured = residuals.friction_n + residuals.residual_n
    groups = {
        "residuals": xr.Dataset(
            {
                "rig": ("row", np.array(residuals.rig_names)[residuals.rig]),
                "trial": ("row", np.array(residuals.names)[residuals.trial]),
                "friction_n": ("row", residuals.friction_n),
                "measured_n": ("row", measured),
                "calibrated_n": ("row", measured - held_out.inside[1]),
                "diagnosed_n": ("row", measured - held_out.inside[2]),
                "residual_n": ("row", held_out.before),
                "residual_after_n": ("row", held_out.after),
                "noise_sd_n": ("row", np.sqrt(residuals.variance)),
                **{
                    variable_of(name, RESIDUALS): ("row", values)
                    for name, values in residuals.covariates.items()
                    if name in PLACES
                    or name not in AXES
                    or (name in OF_SOME and np.isfinite(values).any())
                },
            }
        )
    }
    if held_out.examples:
        runs = [run for _, run in held_out.examples]
        longest = max(run.time_s.size for run in runs)

        def padded(values: list[Array]) -> Array:
            table = np.full((len(values), longest), np.nan)
            for row, row_values in enumerate(values):
                table[row, : row_values.size] = row_values
            return table

        curves = {
            "time_s": [run.time_s for run in runs],
            "measured_m": [run.measured_m for run in runs],
            "before_m": [run.simulated_m[1] for run in runs],
            "after_m": [run.simulated_m[2] for run in runs],
        }
        groups["trajectories"] = xr.Dataset(
            {name: (("example", "event"), padded(values)) for name, values in curves.items()},
            coords={"trial": ("example", [name for name, _ in held_out.examples])},
        )
    if amplitudes:
        longest = max(values.size for values in amplitudes.values())
        table = np.stack([np.resize(values, longest) for values in amplitudes.values()])
        groups["amplitudes"] = xr.Dataset(
            {"amplitude": (("cause", "draw"), table)}, coords={"cause": list(amplitudes)}
        )
    groups["law"] = law.dataset()
    return xr.DataTree.from_dict(groups)
