"""The numbers of the law, with and without what acts beside it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from bayesfric.arrays import Array, Whole
from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.climbing import climb
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.overruling import leaves_too_much
from bayesfric.diagnosis.residuals import Residuals
from bayesfric.diagnosis.systematic import Posterior
from bayesfric.diagnosis_rules import RULES
from bayesfric.inference.truncated import normal_above, normal_cut_to
from bayesfric.schemas.base import NORMAL_REACH, Interval
from bayesfric.schemas.causes import LawNumber
from bayesfric.schemas.diagnosis import Gap

MASS, INERTIA, ARMATURE = "mass", "inertia", "armature"
"""What stands for the mass: of a joint its inertia; of one whose links have masses in a model of
the machine what is left beside these, the rotor as the gear reflects it."""
DEPENDENT = 1e-9  # of the largest singular value: below, columns of unit norm are one
BLOCKS = 10  # stretches of a log that are left out one after another
SLOWER = 4  # neighbouring windows that are taken together, to see what slow motion alone tells
ROWS_A_NUMBER = 3  # that slow motion must have, to be asked
SQUEEZED = 2.0  # standard deviations of a bound below the mean, within which it cuts much off
POSITIVE = frozenset({MASS, INERTIA, ARMATURE, "coulomb"})
FRICTION = frozenset({"coulomb", "viscous"})


@dataclass(frozen=True)
class RunScatter:
    """By how much friction differs from run to run.

    Parameters
    ----------
    share : float
        Standard deviation over runs, of friction.
    runs : int
        How many there are.
    """

    share: float
    runs: int

    def deviations(self, count: int, rng: np.random.Generator) -> Array:
        """Draw how far the mean of the machine is from that of these runs, of friction, (S,)."""
        drawn = rng.standard_t(self.runs - 1, count)
        return np.asarray(self.share / np.sqrt(self.runs) * drawn)


def scatter_of_runs(model: LinearModel, residuals: Residuals, left: Array) -> RunScatter | None:
    """Return by how much friction differs from run to run; None of pulleys, and of few runs.

    The law of a joint is to hold for runs to come, and not only for those that were recorded.

    Parameters
    ----------
    model : LinearModel
        In which the hypotheses were compared.
    residuals : Residuals
        Windows.
    left : ndarray, shape (R,)
        Force that the law leaves in them, with the causes [N].
    """
    table = model.rigs[0].rows.table
    if not model.data.rigs[0].along_path:
        return None
    runs, run_of_trial = np.unique(table["run"].to_numpy(dtype=np.str_), return_inverse=True)
    if runs.size < RULES.runs_of_scatter:
        return None
    own = residuals.trial < run_of_trial.size  # points of friction may stand behind the joint
    run = run_of_trial[residuals.trial[own]]
    friction, weight = residuals.friction_n[own], residuals.weight[own]
    along = np.bincount(run, weight * friction * left[own], runs.size)
    size = np.bincount(run, weight * friction**2, runs.size)
    there = size > 0
    deviation = along[there] / size[there]
    if deviation.size < RULES.runs_of_scatter:
        return None
    return RunScatter(float(np.std(deviation, ddof=1)), int(deviation.size))


def law_of_diagnosis(
    model: LinearModel,
    psi: Array,
    posterior: Posterior,
    residuals: Residuals,
    scatter: RunScatter | None,
    rng: np.random.Generator,
) -> dict[str, LawNumber]:
    """Return each number of the law that is not held and does anything here, by name.

    Parameters
    ----------
    model : LinearModel
        In which the hypotheses were compared.
    psi : ndarray
        Logarithms of the noise of the law alone, to begin with.
    posterior : Posterior
        Draws over all hypotheses.
    residuals : Residuals
        Windows, in which a number shows.
    scatter : RunScatter or None
        Of friction from run to run, an error of the law's friction.
    rng : Generator
        Source of randomness.
    """
    # Friction that scatters as that of some effect would take its place.
    has_model = ARMATURE in model.data.rigs[0].in_simulator
    called = {MASS: ARMATURE if has_model else INERTIA}
    untold = {name for rig in model.data.rigs for name in rig.untold}
    alone = model.around(model.laws, (), discrepancy=False, scattering=())
    at = climb(alone, psi, Acting())
    numbers = {}
    draws = posterior.law.coefficients
    deviation = np.zeros(len(draws)) if scatter is None else scatter.deviations(len(draws), rng)
    for place, size in enumerate(alone.layout.sizes):
        for column, (name, unit) in enumerate(alone.data.law_numbers(size)):
            shown = residuals.columns[residuals.size == place, column].any()
            if not (alone.free[place, column] and shown) or name in untold:
                continue
            number = place * alone.layout.own + column
            sd = float(np.sqrt(at.covariance[number, number])) * float(alone.scales[column])
            moved = float(at.mean[number]) * float(alone.scales[column])
            mean = float(np.asarray(alone.laws[size][column])) + moved
            least = float(alone.least(size, drawn=True)[column])
            numbers[called.get(name, name)] = LawNumber(
                unit=unit,
                before=Interval.of_normal(mean, sd)
                if mean - sd * NORMAL_REACH > least
                else _above(mean, sd, least),
                after=Interval.of_draws(
                    draws[:, place, column] * (1 + deviation * (name in FRICTION))
                ),
            )
    return numbers | _beside_the_law(alone, at, posterior)


def widened(law: Mapping[str, LawNumber], gap: Gap, practical: float) -> dict[str, LawNumber]:
    """Return the numbers of a joint's law with errors as large as held-out data show them to be.

    Where these leave more than scatter makes, by what counts, whatever makes that bends the
    numbers too: errors by scatter alone are too small by as much.

    Parameters
    ----------
    law : mapping of str to LawNumber
        With errors by scatter.
    gap : Gap
        Of data held out.
    practical : float
        Practical share of friction.

    References
    ----------
    R. T. Birge, "The calculation of errors by the method of least squares", Physical Review 40
    (1932).
    """
    if not leaves_too_much(gap, practical) or gap.floor.q50 <= 0:
        return dict(law)
    factor = float(np.hypot(1.0, gap.held_out_excess / gap.floor.q50))
    return {
        name: number.model_copy(
            update={
                "before": wider(number.before, factor, name),
                "after": wider(number.after, factor, name),
            }
        )
        for name, number in law.items()
    }


def held_by_blocks(
    law: Mapping[str, LawNumber], model: LinearModel, turns: bool
) -> dict[str, LawNumber]:
    """Return the numbers of a joint's law with errors no smaller than its parts differ by.

    A force that no effect explains, such as a push by hand, bends the numbers by more than any
    error of a row says: from stretch to stretch, or where a rotor shakes against its gear, from
    quick motion to slow. What pulls with the place is free here: in a free swing it takes the
    place of the inertia. Forces of unknown amounts, such as the errors of a robot's model, are as
    large as their priors let them be.

    Parameters
    ----------
    law : mapping of str to LawNumber
        With errors by the model.
    model : LinearModel
        In which the hypotheses were compared.
    turns : bool
        Whether the machine turns.
    """
    rows: Any = model.rigs[0].rows  # an axis': pulleys have no readings
    readings = rows.readings
    place = np.asarray(readings.position @ readings.weights)
    pulls = [np.sin(place), np.cos(place)] if turns else [place]
    own = np.asarray(rows.coefficient_columns())
    own = own[:, own.any(axis=0)]  # the law may lack some
    levers = [name for name in model.data.rigs[0].shared_numbers if name != "offset"]
    beside = readings.beside[:, : readings.beside.shape[1] - len(levers)]  # a lever pulls so too
    nuisances = [readings.way, *(readings.way * pull for pull in pulls), *beside.T]
    columns, force = np.column_stack([own, *nuisances]), np.asarray(rows.residual())
    turned = np.diff(readings.way, prepend=readings.way[0]) != 0
    stretch = np.cumsum(turned | (np.diff(readings.piece, prepend=readings.piece[0]) != 0))
    amounts = beside.shape[1]
    errors = np.hypot(
        block_errors(columns, force, amounts), errors_by_pace(columns, force, stretch, amounts)
    )
    names = [name for name, _ in model.data.law_numbers(next(iter(model.laws)))]
    by_name = dict(zip([*names, "offset", *levers], errors, strict=False))
    if MASS in by_name:
        by_name |= dict.fromkeys((INERTIA, ARMATURE), by_name[MASS])

    def wide(number: Interval, name: str) -> Interval:
        sd = number.sd
        if _is_squeezed(number, name):
            sd = normal_cut_to(number.mean, sd, 0.0)[1]
        factor = by_name.get(name, 0.0) / sd if sd > 0 else 1.0
        return wider(number, max(1.0, float(factor)), name)

    return {
        name: number.model_copy(
            update={"before": wide(number.before, name), "after": wide(number.after, name)}
        )
        for name, number in law.items()
    }


def block_errors(columns: Array, force: Array, amounts: int = 0) -> Array:
    """Return standard errors of least squares by a jackknife over stretches of rows, (k,).

    Parameters
    ----------
    columns : ndarray, shape (W, k)
        What each number adds to the rows, in their order in time.
    force : ndarray, shape (W,)
        Of the rows.
    amounts : int
        How many of the last numbers are amounts whose priors are N(0, 1).

    References
    ----------
    H. R. Künsch, "The jackknife and the bootstrap for general stationary observations", Annals
    of Statistics 17 (1989).
    """
    scaled, size, prior = _with_amounts(columns, force, amounts)
    stretches = np.array_split(np.arange(len(force)), BLOCKS)
    fits = [
        _least_squares(np.delete(scaled, rows, 0), np.delete(force, rows), prior)
        for rows in stretches
    ]
    deviation = np.sqrt((BLOCKS - 1) * np.var(np.stack(fits), axis=0))
    return np.asarray(deviation / size)


def errors_by_pace(columns: Array, force: Array, stretch: Whole, amounts: int = 0) -> Array:
    """Return by how much least squares of slow motion differ from those of all, (k,).

    Neighbouring windows together are one wide window, in which quick motion averages out.

    Parameters
    ----------
    columns, force, amounts : ndarray, ndarray and int
        As of :func:`block_errors`.
    stretch : ndarray of int, shape (W,)
        Number of the stretch of neighbours that run one way, ascending.
    """
    scaled, size, prior = _with_amounts(columns, force, amounts)
    start = np.flatnonzero(np.diff(stretch, prepend=-1))
    within = np.arange(stretch.size) - np.repeat(start, np.diff([*start, stretch.size]))
    together = np.cumsum(within % SLOWER == 0) - 1
    root = np.sqrt(np.bincount(together))
    if root.size < ROWS_A_NUMBER * size.size:
        return np.zeros(size.size)
    slow = np.stack([np.bincount(together, values) / root for values in (*scaled.T, force)])
    of_all = _least_squares(scaled, force, prior)
    return np.asarray(np.abs(_least_squares(slow[:-1].T, slow[-1], prior) - of_all) / size)


def _with_amounts(columns: Array, force: Array, amounts: int) -> tuple[Array, Array, Array]:
    """Return columns of unit norm, their norms, and the rows of the priors of the last amounts."""
    size = np.linalg.norm(columns, axis=0)
    size = np.where(size > 0, size, 1.0)
    scaled = columns / size
    left = force - scaled @ np.linalg.lstsq(scaled, force, rcond=None)[0]
    prior = np.sqrt(np.mean(left**2)) * np.diag(1 / size)
    return scaled, size, prior[size.size - amounts :]


def _least_squares(design: Array, goal: Array, prior: Array) -> Array:
    """Return least squares beside rows of a prior around zero."""
    rows, zeros = np.vstack([design, prior]), np.zeros(len(prior))
    return np.asarray(np.linalg.lstsq(rows, np.append(goal, zeros), rcond=DEPENDENT)[0])


def wider(interval: Interval, factor: float, name: str) -> Interval:
    """Return an interval that is a factor as wide, within what the number of a name can be.

    A number that is squeezed at its bound is as wide as the normal that the bound cuts off: data
    may have it far below.
    """
    if factor > 1 and _is_squeezed(interval, name):
        mean, sd = normal_cut_to(interval.mean, interval.sd, 0.0)
        return _above(mean, factor * sd, 0.0)
    low, high = (
        interval.q50 + factor * (end - interval.q50) for end in (interval.q05, interval.q95)
    )
    if name in POSITIVE:
        low = max(low, 0.0)
    return interval.model_copy(update={"sd": factor * interval.sd, "q05": low, "q95": high})


def _is_squeezed(interval: Interval, name: str) -> bool:
    return name in POSITIVE and interval.mean < SQUEEZED * interval.sd


def _beside_the_law(alone: LinearModel, at: At, posterior: Posterior) -> dict[str, LawNumber]:
    """Return the nuisances that a reader knows as numbers of the law, such as an offset."""
    by_name, start = {}, 0
    count = sum(alone.layout.nuisances)
    for rig, own in zip(alone.data.rigs, alone.layout.nuisances, strict=True):
        for name, (place, unit, of_one) in rig.shared_numbers.items():
            column = start + place
            number = at.mean.size - count + column
            scale = of_one * float(alone.scales[alone.layout.local - count + column])
            sd = float(np.sqrt(at.covariance[number, number]))
            by_name[name] = LawNumber(
                unit=unit,
                before=Interval.of_normal(float(at.mean[number]) * scale, sd * scale),
                after=Interval.of_draws(of_one * posterior.law.nuisances[:, column]),
            )
        start += own
    return by_name


def _above(mean: float, sd: float, least: float) -> Interval:
    """Return a number that a bound holds up, of which data alone may have some below it."""
    return Interval.of(*normal_above(mean, sd, least))
