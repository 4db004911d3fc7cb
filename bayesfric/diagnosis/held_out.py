"""The difference between simulation and measurement on data that the fit has not seen.

Every parameter is refitted without and with the causes (the two arms). The residual forces in
windows are squared, with equal weight for each condition. What chance makes of them, apart from the
scatter of friction, is subtracted: the sampling variance of windows, and the errors of the refitted
law, of the amplitudes of causes and of the parameters of the rigs. The floor is what the scatter of
friction leaves of a perfect law, from its posterior. Intervals come from a bootstrap over
assemblies.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.diagnosis.arms import Arms, Fitted
from bayesfric.diagnosis.chance import redrawn
from bayesfric.diagnosis.residuals import Residuals
from bayesfric.diagnosis_rules import RULES
from bayesfric.observation.linear import Run
from bayesfric.schemas.base import Interval
from bayesfric.schemas.gap import GapRow

FOLDS, IN_NONE = 5, -1
DRAWS = 400
EXAMPLES = 3


@dataclass(frozen=True)
class Squares:
    """Weighted squares minus what chance makes, except the scatter of friction, (R,) each.

    Parameters
    ----------
    as_shipped, before, after, floor : ndarray or None
        In squared units. For a correct law the expected sums of `before` and `after` equal that of
        `floor`.
    unit : ndarray of int
        Unit of the bootstrap, from :func:`units_of`.
    """

    as_shipped: Array | None
    before: Array
    after: Array
    floor: Array
    unit: Whole

    def by_unit(self, values: Array) -> Array:
        """Return the sums of values, (R,), over each unit."""
        _, inverse = np.unique(self.unit, return_inverse=True)
        return np.asarray(np.bincount(inverse, values), dtype=np.float64)

    def of(self, rows: Flags, weight: float) -> "Squares":
        """Return the squares of some rows, with weights that sum to 1 again."""
        shipped = None if self.as_shipped is None else self.as_shipped[rows] / weight
        before, after, floor = (
            squares[rows] / weight for squares in (self.before, self.after, self.floor)
        )
        return Squares(shipped, before, after, floor, self.unit[rows])


@dataclass(frozen=True)
class HeldOut:
    """Residuals held out, in both arms.

    Parameters
    ----------
    residuals : Residuals
        Residuals of the reference law.
    fold : ndarray of int, shape (R,)
        Fold in which each window was held out; :data:`IN_NONE` if its pulley size has no other
        data.
    before, after : ndarray, shape (R,)
        Held-out residual force of each arm [N].
    inside : ndarray, shape (3, R)
        Residual force as shipped, before and after with nothing held out [N].
    rows : tuple of (str, Squares)
        Of the folds, then of the extrapolations.
    in_sample : Squares
        Squares with nothing held out.
    trajectory : Squares or None
        In metres, from the first five events to the end of travel.
    examples : tuple of (str, Run)
        Free-running trials, with their ids.
    by_chance : ndarray, shape (B,)
        Draws of the mean square that a correct law would leave in the folds [N²].
    """

    residuals: Residuals
    fold: Whole
    before: Array
    after: Array
    inside: Array
    rows: tuple[tuple[str, Squares], ...]
    in_sample: Squares
    trajectory: Squares | None
    examples: tuple[tuple[str, Run], ...]
    by_chance: Array


def measure_gap(arms: Arms, residuals: Residuals, rng: np.random.Generator) -> HeldOut:
    """Refit both arms for each fold and return the residuals.

    Parameters
    ----------
    arms : Arms
        The law without and with the causes.
    residuals : Residuals
        Windows of `arms.plain`.
    rng : Generator
        Assigns assemblies to folds.
    """
    fold, beyond = folds_of(residuals, rng), extrapolated(residuals)
    outs = [fold == number for number in range(int(fold.max()) + 1)]
    beside = arms.with_discrepancy(residuals, [*outs, *beyond.values()])
    is_shipped = arms.shipped is not None

    def squares(arm: Sequence[Fitted]) -> tuple[Array, Squares]:
        left = np.stack([residuals.left(fitted.local) for fitted in arm])
        return left, _squares(
            residuals, left, [fitted.chance2 for fitted in arm], shipped=is_shipped
        )

    def fitted(out: Flags) -> tuple[Fitted, ...]:
        return arms.fitted(beside, residuals, out)

    def held(arms_of_fold: Sequence[Fitted], out: Flags) -> tuple[Fitted, ...]:
        """Return arms with the further force of the held-out windows alone: it is large."""
        return tuple(replace(arm, further=arm.further[out]) for arm in arms_of_fold)

    whole = fitted(np.zeros(fold.size, dtype=np.bool_))
    by_fold = [held(fitted(out), out) for out in outs]
    by_fold.append(held(whole, fold == IN_NONE))
    place = np.arange(fold.size)
    left, chance2 = np.empty((2, 3, fold.size))
    for arm in range(3):
        left[arm] = np.stack([residuals.left(arms_of_fold[arm].local) for arms_of_fold in by_fold])[
            fold, place
        ]
        chance2[arm] = np.stack([arms_of_fold[arm].chance2 for arms_of_fold in by_fold])[
            fold, place
        ]
    folds = [("folds over assemblies", _squares(residuals, left, chance2, shipped=is_shipped))]
    for name, rows in beyond.items():
        weight = float(residuals.weight[rows].sum())
        folds.append((name, squares(fitted(rows))[1].of(rows, weight)))
    every, inside = squares(whole)
    trajectory, examples = _free_running(arms, residuals, fold, by_fold)
    return HeldOut(
        residuals,
        fold,
        left[1],
        left[2],
        every,
        tuple(folds),
        inside,
        trajectory,
        examples,
        _by_chance(residuals, fold, [arms_of_fold[2] for arms_of_fold in by_fold], rng),
    )


def units_of(residuals: Residuals) -> Whole:
    """Return the unit of each window, (R,); a unit is held out and resampled as a whole.

    It is an assembly, or a trial if a pulley size has a single assembly.
    """
    units, size = residuals.setup.copy(), residuals.size
    for own in (size == place for place in np.unique(size)):
        if np.unique(units[own]).size == 1:
            units[own] = residuals.setup.max() + 1 + residuals.trial[own]
    return units


def folds_of(residuals: Residuals, rng: np.random.Generator) -> Whole:
    """Return the fold of each window, (R,), so that no fold has all windows of a pulley size.

    A size with a single trial is in no fold: its law would come from the prior alone.
    """
    units, size = units_of(residuals), residuals.size
    names, first, unit = np.unique(units, return_index=True, return_inverse=True)
    number = min(FOLDS, names.size)
    order = rng.permutation(names.size)
    fold = np.empty(names.size, dtype=np.intp)
    for dealt in (order, order[np.argsort(size[first[order]], kind="stable")]):
        fold[dealt] = np.arange(names.size) % number
        folds_of_size = [np.unique(fold[unit[size == place]]).size for place in np.unique(size)]
        if min(folds_of_size) > 1:
            break
    alone = np.unique(size)[np.array(folds_of_size) == 1]
    return np.where(np.isin(size, alone), IN_NONE, fold[unit])


def extrapolated(residuals: Residuals) -> dict[str, Flags]:
    """Return the windows at the upper end of each range of conditions, and those of each rig.

    Returns
    -------
    dict of str to ndarray of bool, shape (R,)
        Windows of whole trials, by name; without sets that would leave a pulley size without
        windows.
    """
    conditions: dict[str, Flags] = {}
    where = residuals.covariates
    tension, pulleys, wrap = (where[axis] for axis in ("tension", "n_pulleys", "wrap_angle"))
    running = np.isfinite(where["displacement"])
    if running.any():
        # Trials with the same masses differ in tension by their acceleration.
        low, high = tension[running].min(), tension[running].max()
        conditions["top tension"] = running & (tension > low + RULES.extrapolated * (high - low))
        # Means over a window are equal up to rounding.
        conditions["largest number of pulleys"] = np.isclose(pulleys, pulleys.max())
        conditions["extreme wrap angle"] = np.isclose(wrap, wrap.max())
    conditions["trials of the role test, from the others"] = residuals.shown
    if len(residuals.rig_names) > 1:
        for place, name in enumerate(residuals.rig_names):
            conditions[f"the {name} board, from the rest"] = residuals.rig == place
    sizes = [residuals.size == size for size in np.unique(residuals.size)]
    return {
        name: rows
        for name, rows in conditions.items()
        if rows.any() and all((~rows & mine).any() for mine in sizes)
    }


def _by_chance(
    residuals: Residuals,
    fold: Whole,
    after: Sequence[Fitted],
    rng: np.random.Generator,
) -> Array:
    """Draw the held-out mean square that chance makes with a correct law, (DRAWS,) [N²]."""
    drawn = redrawn(residuals, DRAWS, rng)
    scatter2 = residuals.friction_n**2 * residuals.spread2
    squares = np.zeros(DRAWS)
    for number, arm in zip([*range(len(after) - 1), IN_NONE], after, strict=True):
        rows = fold == number
        assert arm.refit is not None
        left = drawn[rows] - arm.refit.design[rows] @ (arm.refit.smoothing @ drawn)
        left += arm.further @ rng.standard_normal((arm.further.shape[1], DRAWS))
        expected = (scatter2 - arm.chance2)[rows, None]
        squares += residuals.weight[rows] @ (left**2 + expected)
    return squares


def _squares(
    residuals: Residuals, left: Array, chance2: Sequence[Array] | Array, *, shipped: bool
) -> Squares:
    scatter2 = residuals.friction_n**2 * residuals.spread2
    first, before, after = residuals.weight * (left**2 - np.asarray(chance2) + scatter2)
    floor = residuals.weight * scatter2
    return Squares(first if shipped else None, before, after, floor, units_of(residuals))


def _free_running(
    arms: Arms, residuals: Residuals, fold: Whole, by_fold: Sequence[Sequence[Fitted]]
) -> tuple[Squares | None, tuple[tuple[str, Run], ...]]:
    """Return the squared deviation of each held-out trial [m²], and some examples."""
    first = np.unique(residuals.trial, return_index=True)[1]
    noise, start = arms.plain.noise.named(arms.psi), 0
    numbers = np.stack([[arm.local for arm in arms_of_fold] for arms_of_fold in by_fold])
    runs: dict[int, Run] = {}
    squares: list[Array] = []
    for rig in arms.plain.rigs:
        count = len(rig.rows.table)
        mine = fold[first[start : start + count]]
        local = numbers[mine, :, rig.size].swapaxes(0, 1)
        for trial, run in rig.runs(noise, local).items():
            spread = [arm.spread[rig.size[trial]] for arm in by_fold[mine[trial]]]
            of_law = [float(np.einsum("pk,pq,qk", s, run.columns2, s)) for s in spread]
            squares.append((run.off**2).mean(axis=1) - run.error2 - np.array(of_law))
            runs[start + trial] = run
        start += count
    if not runs:
        return None, ()
    trials = np.array(list(runs))
    floor = np.array([run.floor2 for run in runs.values()])
    condition = residuals.condition[first[trials]]
    weight = 1 / np.bincount(condition)[condition] / np.unique(condition).size
    shipped, before, after = np.array(squares).T * weight
    chosen = trials[:: max(1, trials.size // EXAMPLES)][:EXAMPLES]
    return (
        Squares(
            None if arms.shipped is None else shipped,
            before,
            after,
            floor * weight,
            units_of(residuals)[first[trials]],
        ),
        tuple((residuals.names[trial], runs[int(trial)]) for trial in chosen),
    )


def gap_row(
    name: str,
    squares: Squares,
    *,
    no_shrink: str | None,
    shipped_why: str,
    rng: np.random.Generator,
) -> GapRow:
    """Return the stored figures of one set of held-out data.

    Parameters
    ----------
    name : str
        Name of the held-out set.
    squares : Squares
        Squares of its windows.
    no_shrink : str or None
        Why nothing can shrink; None if something can.
    shipped_why : str
        Why no figure as shipped exists.
    rng : Generator
        Source of randomness for the bootstrap over units.
    """
    units = np.unique(squares.unit).size
    count = rng.multinomial(units, np.full(units, 1 / units), DRAWS)
    floor2 = _floor_draws(squares, DRAWS, rng)

    def draws(values: Array) -> Array:
        return np.asarray(count @ squares.by_unit(values))

    before2, after2 = draws(squares.before), draws(squares.after)
    gap2 = before2 - floor2
    shrink, why = None, no_shrink
    if why is None and np.mean(gap2 > 0) < RULES.above_floor:
        why = (
            f"the probability that this error exceeds scatter alone is {np.mean(gap2 > 0):.2f}, "
            f"and {RULES.above_floor:g} is needed"
        )
    if why is None:
        ratio = (before2 - after2)[gap2 > 0] / gap2[gap2 > 0]
        if np.median(ratio) > RULES.most_shrink:
            why = "with the causes in the law, the error is smaller than scatter alone makes it"
        else:
            shrink = Interval.of_draws(np.minimum(ratio, RULES.most_shrink))
    shipped: Interval | None = None
    if squares.as_shipped is not None:
        shipped = Interval.of_draws(_root(draws(squares.as_shipped)))
    return GapRow(
        name=name,
        as_shipped=shipped,
        as_shipped_why=None if shipped is not None else shipped_why,
        before=Interval.of_draws(_root(before2)),
        after=Interval.of_draws(_root(after2)),
        floor=Interval.of_draws(_root(floor2)),
        below_floor=float(np.mean(gap2 <= 0)),
        shrink=shrink,
        shrink_why=why,
    )


def _floor_draws(squares: Squares, count: int, rng: np.random.Generator) -> Array:
    """Draw the expected mean square that scatter leaves of a perfect law, shape (count,).

    The observed mean square differs from its expectation. Assemblies with much friction dominate
    it, so the effective number of assemblies is smaller than their number.

    References
    ----------
    F. E. Satterthwaite, "An approximate distribution of estimates of variance
    components", Biometrics Bulletin 2 (1946): degrees of freedom of a sum of squares.
    """
    by_unit = squares.by_unit(squares.floor)
    freedom = by_unit.sum() ** 2 / max((by_unit**2).sum(), 1e-300)
    return np.asarray(by_unit.sum() * rng.chisquare(freedom, count) / freedom)


def _root(values: Array) -> Array:
    return np.sqrt(np.maximum(values, 0.0))
