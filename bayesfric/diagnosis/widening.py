"""Widens intervals of a joint's law if parts of the log, or held-out data, disagree with them."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from bayesfric.arrays import Array, Whole
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.overruling import leaves_too_much
from bayesfric.diagnosis_rules import RULES
from bayesfric.inference.truncated import normal_above, normal_cut_to
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import LawNumber
from bayesfric.schemas.gap import Gap

MASS, INERTIA, ARMATURE = "mass", "inertia", "armature"
"""What stands for the mass: of a joint its inertia; of one whose links have masses in a model of
the machine what is left beside these, the rotor as the gear reflects it."""
DEPENDENT = 1e-9  # relative singular value below which columns count as dependent
BLOCKS = 10  # stretches of a log for the jackknife
TOGETHER = (2, 4, 8)  # neighbouring windows that are merged, to isolate slow motion
ROWS_A_NUMBER = 3  # least merged windows for each number of the law
SURELY_APART = 2.0  # standard errors; a larger difference of quick and slow motion counts
UNCHANGED = (1.0, 1.0)
SURELY_BELOW = 4.0  # standard deviations below zero at which a number is certainly negative
HARDLY = 0.05  # part of a number by which its interval may exceed zero
SQUEEZED = 2.0  # standard deviations between mean and bound below which truncation matters
BELOW_ZERO = (
    "The estimate of viscous friction is below 0, which is impossible: the law lacks a force that "
    "drives the joint, or a controller reacts to a disturbance. Use no number of the law from this "
    "log"
)
POSITIVE = frozenset({MASS, INERTIA, ARMATURE, "coulomb"})


Factors = Mapping[str, tuple[float, float]]
"""How many times wider numbers of a law are, by name: before and after."""


def widened(law: Mapping[str, LawNumber], factors: Factors) -> dict[str, LawNumber]:
    """Return the numbers of a joint's law with wider intervals.

    Parameters
    ----------
    law : mapping of str to LawNumber
        The law as fitted.
    factors : mapping of str to tuple of float
        Factors of the intervals without and with the causes, by number.
    """

    def wide(name: str, number: LawNumber) -> LawNumber:
        before, after = factors.get(name, UNCHANGED)
        return number.model_copy(
            update={
                "before": wider(number.before, before, name),
                "after": wider(number.after, after, name),
            }
        )

    return {name: wide(name, number) for name, number in law.items()}


def all_at_once(multiplied: Sequence[Factors], at_least: Factors) -> dict[str, tuple[float, float]]:
    """Return the product of factors for each number, raised to `at_least`."""
    names = {name for factors in (*multiplied, at_least) for name in factors}
    products = {
        name: np.prod([factors.get(name, UNCHANGED) for factors in multiplied], axis=0)
        for name in names
    }
    larger = {
        name: np.maximum(product, at_least.get(name, UNCHANGED))
        for name, product in products.items()
    }
    return {name: (float(before), float(after)) for name, (before, after) in larger.items()}


def by_held_out(law: Collection[str], gap: Gap, practical: float) -> Factors:
    """Return factors of the intervals of a joint's law, from its held-out residual.

    If the held-out residual exceeds scatter by a practical size, its unknown cause also biases
    the numbers. Errors from scatter alone are too small by the same factor.

    Parameters
    ----------
    law : collection of str
        Names of the numbers.
    gap : Gap
        The gap on held-out data.
    practical : float
        Practical share of friction.

    References
    ----------
    R. T. Birge, "The calculation of errors by the method of least squares", Physical Review 40
    (1932).
    """
    if not leaves_too_much(gap, practical) or gap.floor.q50 <= 0:
        return {}
    factor = float(np.hypot(1.0, gap.held_out_excess / gap.floor.q50))
    return dict.fromkeys(law, (factor, factor))


def by_sign(law: Mapping[str, LawNumber], speed: float) -> Factors:
    """Return factors of the intervals if viscous friction is certainly negative.

    Negative viscous friction is unphysical. It can come from a controller that reacts to
    disturbances, or from a force that the law lacks. All numbers are then assumed to be wrong by
    as many standard errors.

    Parameters
    ----------
    law : mapping of str to LawNumber
        The law as fitted.
    speed : float
        Mean speed of the rows [m/s or rad/s].
    """
    viscous = law.get("viscous")
    if viscous is None or not is_surely_below(viscous.after):
        return {}
    factor = abs(viscous.after.q50) / (viscous.after.q95 - viscous.after.q50)
    factors = dict.fromkeys(law, factor)
    coulomb = law.get("coulomb")
    if coulomb is not None and coulomb.after.sd > 0:
        bend = abs(viscous.after.mean) * speed
        factors["coulomb"] = max(1.0, bend / coulomb.after.sd)
    return {name: (1.0, factor) for name, factor in factors.items()}


def is_below_zero(law: Mapping[str, LawNumber]) -> bool:
    """Return whether the interval of viscous friction is below zero."""
    viscous = law.get("viscous")
    return (
        viscous is not None
        and viscous.after.q50 < 0
        and viscous.after.q95 < HARDLY * abs(viscous.after.q50)
    )


def is_surely_below(number: Interval) -> bool:
    """Return whether a number is below zero by many standard deviations."""
    return number.mean < -SURELY_BELOW * number.sd


def is_open(number: Interval) -> bool:
    """Return whether the 90 % interval of a number is wide relative to its median."""
    return number.q95 - number.q05 > RULES.number_open * abs(number.q50)


def by_parts(law: Mapping[str, LawNumber], model: LinearModel, turns: bool) -> Factors:
    """Return factors of the intervals of a joint's law, from differences between parts of a log.

    A force that no effect explains, such as a push by hand, biases the numbers by more than the
    errors of rows. The bias differs between stretches of a log or, if a rotor shakes against its
    gear, between quick and slow motion. Here a force that depends on position is fitted too, and
    all rows have the same weight. The change of a number by that is an error of it, for example
    in a free swing, where such a force replaces the inertia. Forces of unknown amounts, such as
    errors of a robot's model, have their priors.

    Parameters
    ----------
    law : mapping of str to LawNumber
        The law with errors from the model.
    model : LinearModel
        The model in which the hypotheses were compared.
    turns : bool
        Whether the machine turns.
    """
    rows: Any = model.rigs[0].rows  # of an axis; pulleys have no readings
    readings = rows.readings
    place = np.asarray(readings.position @ readings.weights)
    pulls = [np.sin(place), np.cos(place)] if turns else [place]
    own = np.asarray(rows.coefficient_columns())
    # The law may lack some numbers, and this motion may not show others.
    seen = np.asarray(np.any(own != 0, axis=0))
    own = own[:, seen]
    levers = [name for name in model.data.rigs[0].shared_numbers if name != "offset"]
    beside = readings.beside[:, : readings.beside.shape[1] - len(levers)]  # levers are fitted above
    nuisances = [readings.way, *(readings.way * pull for pull in pulls), *beside.T]
    columns, force = np.column_stack([own, *nuisances]), np.asarray(rows.residual())
    turned = np.diff(readings.way, prepend=readings.way[0]) != 0
    stretch = np.cumsum(turned | (np.diff(readings.piece, prepend=readings.piece[0]) != 0))
    amounts = beside.shape[1]
    errors = np.hypot(
        block_errors(columns, force, amounts), errors_by_pace(columns, force, stretch, amounts)
    )
    names = [name for name, _ in model.data.law_numbers(next(iter(model.laws)))]
    if len(names) == seen.size:  # else the names lack numbers that the law does not have
        names = [name for name, is_seen in zip(names, seen.tolist(), strict=True) if is_seen]
    by_name = dict(zip([*names, "offset", *levers], errors, strict=False))
    if MASS in by_name:
        by_name |= dict.fromkeys((INERTIA, ARMATURE), by_name[MASS])

    # The rows are residuals of the reference law.
    scaled, size, prior = _with_amounts(columns, force, amounts)
    freed = _least_squares(scaled, force, prior) / size
    reference = np.asarray(next(iter(model.laws.values())))[np.flatnonzero(seen)]
    unweighted = dict(zip(names, reference + freed[: reference.size], strict=False))
    if MASS in unweighted:
        unweighted |= dict.fromkeys((INERTIA, ARMATURE), unweighted[MASS])
    factors = {}
    for name, number in law.items():
        error = float(by_name.get(name, 0.0))
        bend = abs(unweighted.get(name, number.after.mean) - number.after.mean)
        is_bent = not levers and bend > SURELY_APART * error
        after = float(np.hypot(error, bend)) if is_bent else error
        factors[name] = _wider(number.before, name, error), _wider(number.after, name, after)
    return factors


def _wider(number: Interval, name: str, error: float) -> float:
    """Return the factor that raises the sd of a number to a given error."""
    sd = number.sd
    if _is_squeezed(number, name):
        sd = normal_cut_to(number.mean, sd)[1]
    return max(1.0, error / sd) if sd > 0 else 1.0


def block_errors(columns: Array, force: Array, amounts: int = 0) -> Array:
    """Return jackknife standard errors of least squares over stretches of rows, (k,).

    Parameters
    ----------
    columns : ndarray, shape (W, k)
        Force of each number in the rows, which are in order of time.
    force : ndarray, shape (W,)
        Force in the rows.
    amounts : int
        The last numbers, as many as this, are amounts with a prior N(0, 1).

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
    """Return the difference of least squares between slow motion and all motion, (k,).

    Neighbouring windows are merged to wide windows, in which quick motion averages out. The
    difference is 0 if chance explains it; else the variance by chance is subtracted.

    Parameters
    ----------
    columns, force, amounts : ndarray, ndarray and int
        As of :func:`block_errors`.
    stretch : ndarray of int, shape (W,)
        Index of the stretch of motion in one direction to which each row belongs, ascending.

    References
    ----------
    J. A. Hausman, "Specification tests in econometrics", Econometrica 46 (1978).
    """
    scaled, size, prior = _with_amounts(columns, force, amounts)
    start = np.flatnonzero(np.diff(stretch, prepend=-1))
    within = np.arange(stretch.size) - np.repeat(start, np.diff([*start, stretch.size]))
    of_all = _least_squares(scaled, force, prior)
    left = force - scaled @ of_all
    noise2 = float(left @ left) / max(force.size - size.size, 1)
    spread_of_all = _spread(scaled, prior)
    bends = [np.zeros(size.size)]
    for windows in TOGETHER:
        together = np.cumsum(within % windows == 0) - 1
        root = np.sqrt(np.bincount(together))
        slow = np.stack([np.bincount(together, values) / root for values in (*scaled.T, force)])
        if root.size < ROWS_A_NUMBER * size.size:
            continue
        design, goal = slow[:-1].T, slow[-1]
        apart = (_least_squares(design, goal, prior) - of_all) ** 2
        # The variance of a difference from an efficient estimate is the difference of variances.
        by_chance = noise2 * np.maximum(_spread(design, prior) - spread_of_all, 0.0)
        bends.append(np.where(apart > SURELY_APART**2 * by_chance, apart - by_chance, 0.0))
    return np.asarray(np.sqrt(np.max(bends, axis=0)) / size)


def _spread(design: Array, prior: Array) -> Array:
    """Return the variances of least squares with prior rows, for unit noise, (k,)."""
    rows = np.vstack([design, prior])
    return np.asarray(np.diag(np.linalg.pinv(rows.T @ rows)))


def _with_amounts(columns: Array, force: Array, amounts: int) -> tuple[Array, Array, Array]:
    """Return columns of unit norm, their norms, and prior rows for the last `amounts` numbers."""
    size = np.linalg.norm(columns, axis=0)
    size = np.where(size > 0, size, 1.0)
    scaled = columns / size
    left = force - scaled @ np.linalg.lstsq(scaled, force, rcond=None)[0]
    prior = np.sqrt(np.mean(left**2)) * np.diag(1 / size)
    return scaled, size, prior[size.size - amounts :]


def _least_squares(design: Array, goal: Array, prior: Array) -> Array:
    """Return least squares with prior rows around zero."""
    rows, zeros = np.vstack([design, prior]), np.zeros(len(prior))
    return np.asarray(np.linalg.lstsq(rows, np.append(goal, zeros), rcond=DEPENDENT)[0])


def wider(interval: Interval, factor: float, name: str) -> Interval:
    """Return an interval that is wider by a factor, within the bounds of the named number.

    For a number near its bound, the underlying normal is widened and truncated again.
    """
    if factor > 1 and _is_squeezed(interval, name):
        mean, sd = normal_cut_to(interval.mean, interval.sd)
        return open_below(above(mean, factor * sd, 0.0))
    low, high = (
        interval.q50 + factor * (end - interval.q50) for end in (interval.q05, interval.q95)
    )
    if name in POSITIVE:
        low = max(low, 0.0)
    return interval.model_copy(update={"sd": factor * interval.sd, "q05": low, "q95": high})


def open_below(number: Interval) -> Interval:
    """Return a positive number; its interval begins at zero if data do not exclude zero.

    Otherwise the 5 % quantile of a truncated normal would look like a lower limit.
    """
    return number.model_copy(update={"q05": 0.0}) if number.mean < SQUEEZED * number.sd else number


def _is_squeezed(interval: Interval, name: str) -> bool:
    return name in POSITIVE and interval.mean < SQUEEZED * interval.sd


def above(mean: float, sd: float, least: float) -> Interval:
    """Return the interval of a normal that is truncated at a lower bound."""
    return Interval.of(*normal_above(mean, sd, least))
