"""How far simulation and reality are apart, and how far that shrinks.

On data held out of the fit, every parameter refitted in both arms: residual forces in
windows, their sampling variance taken off, equal weight a condition. The floor is what
friction's own scatter leaves. Intervals come from drawing assemblies anew, and the
scatter's own uncertainty.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bayesfric.diagnosis.extrapolation import extrapolated
from bayesfric.diagnosis.linear_model import Acting, LinearModel
from bayesfric.diagnosis.residuals import (
    Residuals,
    fitted,
    numbers_of_laws,
    recalibrated,
    residuals_of,
)
from bayesfric.effects.candidates import goes_to_and_fro
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.layout import COEFFICIENTS
from bayesfric.schemas import GapRow, Interval

__all__ = [
    "Arms",
    "GapFigures",
    "Squares",
    "explained",
    "folds_of",
    "gap_row",
    "interval",
    "measure_gap",
    "systematic_gap",
]

Array = NDArray[np.float64]
FOLDS = 5
DRAWS = 400
SURE = 0.95  # probability that the gap before is above the floor


@dataclass(frozen=True)
class Arms:
    """The baseline, and the baseline with the causes, around the same reference law.

    Parameters
    ----------
    model : LinearModel
        Without discrepancy; its candidates are the causes, whose force scatters.
    known : LinearModel
        The same with discrepancy, from which the causes are known.
    psi : ndarray
        Logarithms of the noise.
    causes : Acting
        The causes.
    shipped : mapping of str to Coefficients, or None
        Published values of every size, if there are any.
    """

    model: LinearModel
    known: LinearModel
    psi: Array
    causes: Acting
    shipped: Mapping[str, Coefficients] | None

    def numbers(self, residuals: Residuals, out: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Return the numbers of the model before and after, fitted without some windows.

        The law is recalibrated in both alike; after, with the causes as they are known.

        Parameters
        ----------
        residuals : Residuals
            Of the model.
        out : ndarray of bool, shape (R,)
            Windows that are left out, with the trials and runs that they are of.
        """
        used = _used(self.model, residuals, out)
        before = self._refitted(Acting(), residuals, out, used)
        if not self.causes.columns:
            return before, before
        return before, self._refitted(self.causes, residuals, out, used)

    def _refitted(
        self,
        acting: Acting,
        residuals: Residuals,
        out: NDArray[np.bool_],
        used: Mapping[str, NDArray[np.bool_]],
    ) -> Array:
        layout = self.known.layout
        found, _ = fitted(self.known, self.psi, acting, used)
        start = layout.own * len(layout.sizes)
        law = np.zeros(COEFFICIENTS * len(layout.sizes))
        shared = found[start : start + layout.candidates], found[found.size - layout.idle :]
        return recalibrated(self.model, residuals, ~out, np.concatenate([law, *shared]))

    @property
    def predicted(self) -> bool:
        """Whether the causes act on what a new trial does, all of them."""
        effects = [self.model.candidates[place].effect for place in self.causes.columns]
        return not self.causes.phases and not any(goes_to_and_fro(effect) for effect in effects)


@dataclass(frozen=True)
class Squares:
    """Weighted squares of each window, sampling variance taken off, (R,) each.

    Parameters
    ----------
    as_shipped, before, after, floor : ndarray or None
        In the unit squared.
    setup : ndarray of int
        Assembly of each.
    """

    as_shipped: Array | None
    before: Array
    after: Array
    floor: Array
    setup: NDArray[np.intp]

    def of(self, rows: NDArray[np.bool_]) -> "Squares":
        """Return those of some rows."""
        shipped = None if self.as_shipped is None else self.as_shipped[rows]
        return Squares(
            shipped, self.before[rows], self.after[rows], self.floor[rows], self.setup[rows]
        )

    def over(self, weight: float) -> "Squares":
        """Return them for weights that add up to 1 again."""
        shipped = None if self.as_shipped is None else self.as_shipped / weight
        return Squares(
            shipped, self.before / weight, self.after / weight, self.floor / weight, self.setup
        )


@dataclass(frozen=True)
class GapFigures:
    """Residuals held out, in both arms.

    Parameters
    ----------
    residuals : Residuals
        Around the reference law.
    fold : ndarray of int, shape (R,)
        In which each window was held out.
    before, after : ndarray, shape (R,)
        Held-out residual force of each arm [N].
    held_out : tuple of (str, Squares)
        Of the folds, then of what was extrapolated to.
    in_sample : Squares
        Of the same with nothing held out.
    numbers : tuple of (ndarray, ndarray)
        Of the model before and after: fitted without each fold, then to all.
    """

    residuals: Residuals
    fold: NDArray[np.intp]
    before: Array
    after: Array
    held_out: tuple[tuple[str, Squares], ...]
    in_sample: Squares
    numbers: tuple[tuple[Array, Array], ...]

    def strengths(self, arms: Arms) -> dict[str, float]:
        """Return the rms force of each cause over rms friction, by name."""
        model, acting, found = arms.model, arms.causes, self.residuals
        weight = found.weight
        friction2 = (weight * found.friction_n**2).sum()
        numbers = self.numbers[-1][1]
        count = model.layout.own * len(model.layout.sizes)
        strengths = {}
        for place in acting.columns:
            force = found.columns[:, model.layout.candidate(place)] * numbers[count + place]
            share = np.sqrt((weight * force**2).sum() / friction2)
            strengths[model.candidates[place].effect.name] = float(share)
        for place in acting.phases:
            # Its force goes round: only its size is known, which is the amplitude itself.
            candidate = model.candidates[place]
            strengths[candidate.effect.name] = candidate.amplitude
        return strengths


def folds_of(setup: NDArray[np.intp], rng: np.random.Generator) -> NDArray[np.intp]:
    """Return the fold of each assembly's rows, shape of `setup`."""
    names = np.unique(setup)
    fold = np.empty(names.size, dtype=np.intp)
    fold[rng.permutation(names.size)] = np.arange(names.size) % min(FOLDS, names.size)
    return np.asarray(fold[np.searchsorted(names, setup)])


def measure_gap(arms: Arms, rng: np.random.Generator) -> GapFigures:
    """Refit both arms fold by fold and return what is left.

    Parameters
    ----------
    arms : Arms
        The two models.
    rng : Generator
        Assigns assemblies to folds.
    """
    residuals = residuals_of(arms.model, arms.psi)
    fold = folds_of(residuals.setup, rng)
    left = np.full((3, fold.size), np.nan)
    numbers = []
    for number in range(int(fold.max()) + 1):
        rows = fold == number
        numbers.append(arms.numbers(residuals, rows))
        left[:, rows] = _left(arms, residuals, numbers[-1])[:, rows]
    numbers.append(arms.numbers(residuals, np.zeros(fold.size, dtype=np.bool_)))
    held_out = [("folds over assemblies", squares_of(residuals, left))]
    for name, rows in extrapolated(residuals).items():
        one = _left(arms, residuals, arms.numbers(residuals, rows))
        squares = squares_of(residuals, one).of(rows)
        held_out.append((name, squares.over(float(residuals.weight[rows].sum()))))
    in_sample = squares_of(residuals, _left(arms, residuals, numbers[-1]))
    return GapFigures(residuals, fold, left[1], left[2], tuple(held_out), in_sample, tuple(numbers))


def _used(
    model: LinearModel, residuals: Residuals, out: NDArray[np.bool_]
) -> dict[str, NDArray[np.bool_]]:
    """Return which trials and runs stay where those of some windows are left out."""
    gone = np.zeros(len(residuals.names), dtype=bool)
    gone[residuals.trial[out]] = True
    trials = 0 if model.gravity is None else len(model.gravity.rows.trials)
    return {"gravity": ~gone[:trials], "motor": ~gone[trials:]}


def _left(arms: Arms, residuals: Residuals, numbers: tuple[Array, Array]) -> Array:
    """Return residuals as shipped, before and after, shape (3, R) [N]."""
    model = arms.model
    before, after = (residuals.left(model, one) for one in numbers)
    shipped = np.full(before.size, np.nan)
    if arms.shipped is not None:
        shipped = residuals.left(model, numbers_of_laws(model, arms.shipped, numbers[0]))
    return np.stack([shipped, before, after])


def squares_of(residuals: Residuals, left: Array) -> Squares:
    """Return weighted squares of windows, sampling variance taken off.

    Parameters
    ----------
    residuals : Residuals
        For weights, variance and scatter.
    left : ndarray, shape (3, R)
        Residual forces as shipped, before and after [N].
    """
    weight = residuals.weight
    floor = weight * residuals.friction_n**2 * (residuals.scatter**2).sum(axis=1)
    shipped, before, after = weight * (left**2 - residuals.variance)
    known = None if np.isnan(shipped).all() else shipped
    return Squares(known, before, after, floor, residuals.setup)


def gap_row(
    name: str,
    squares: Squares,
    *,
    no_shrink: str | None,
    shipped_why: str,
    rng: np.random.Generator,
) -> tuple[GapRow, Interval, Array]:
    """Return the four figures, the systematic gap, and its draws.

    Parameters
    ----------
    name : str
        What was held out.
    squares : Squares
        Of the windows.
    no_shrink : str or None
        Why nothing can shrink; None where it can.
    shipped_why : str
        Why nothing was shipped.
    rng : Generator
        For the bootstrap over assemblies.

    References
    ----------
    F. E. Satterthwaite, "An approximate distribution of estimates of variance
    components", Biometrics Bulletin 2 (1946): degrees of freedom of a sum of squares.
    """
    setups, inverse = np.unique(squares.setup, return_inverse=True)

    def sums(values: Array) -> Array:
        return np.asarray(np.bincount(inverse, values, setups.size), dtype=np.float64)

    count = rng.multinomial(setups.size, np.full(setups.size, 1 / setups.size), DRAWS)
    # What scatter left this time is not what it leaves on average: assemblies of much
    # friction make most of it, so that fewer alike would count (Satterthwaite).
    by_setup = sums(squares.floor)
    freedom = by_setup.sum() ** 2 / (by_setup**2).sum()
    floor2 = by_setup.sum() * rng.chisquare(freedom, DRAWS) / freedom

    def draws(values: Array) -> Array:
        return np.asarray(count @ sums(values))

    before2, after2 = draws(squares.before), draws(squares.after)
    gap2 = before2 - floor2
    systematic = np.sqrt(np.maximum(gap2, 0.0))
    shrink, why = None, no_shrink
    if why is None and np.mean(gap2 > 0) < SURE:
        why = f"the gap is above the floor with a probability of {np.mean(gap2 > 0):.2f} only"
    if why is None:
        ratio = (before2 - after2) / np.where(gap2 > 0, gap2, np.nan)
        centre = (squares.before.sum() - squares.after.sum()) / (
            squares.before.sum() - squares.floor.sum()
        )
        shrink = interval(ratio[np.isfinite(ratio)], middle=float(centre))
    shipped = None
    if squares.as_shipped is not None:
        shipped = interval(_root(draws(squares.as_shipped)))
    row = GapRow(
        name=name,
        as_shipped=shipped,
        as_shipped_why=None if shipped is not None else shipped_why,
        before=interval(_root(before2)),
        after=interval(_root(after2)),
        floor=interval(_root(floor2)),
        shrink=shrink,
        shrink_why=why,
    )
    return row, interval(systematic), systematic


def explained(squares: Squares, rng: np.random.Generator) -> Array:
    """Return draws of the rms of what the causes take away, √(before² − after²)₊.

    Both arms have the same scatter, so that this is known far better than the distance
    from a floor that has to be estimated.
    """
    setups, inverse = np.unique(squares.setup, return_inverse=True)
    taken = np.bincount(inverse, squares.before - squares.after, setups.size)
    count = rng.multinomial(setups.size, np.full(setups.size, 1 / setups.size), DRAWS)
    return _root(np.asarray(count @ taken, dtype=np.float64))


def systematic_gap(distance: Array, taken: Array, *, predicted: bool) -> Array:
    """Return the draws of the gap by which it is decided whether there is one.

    What the causes take away is known better than the distance from the floor. It is less
    than the gap where the causes are not predicted, and where they do not explain a gap
    that there surely is.

    Parameters
    ----------
    distance : ndarray
        Draws of the distance of the gap before from the floor, rms [N].
    taken : ndarray
        Draws of what the causes take away, rms [N].
    predicted : bool
        Whether all causes act on what a new trial does.
    """
    surely = np.mean(distance > 0) >= SURE
    if (predicted and not surely) or np.median(taken) > np.median(distance):
        return taken
    return distance


def _root(values: Array) -> Array:
    return np.sqrt(np.maximum(values, 0.0))


def interval(draws: Array, middle: float | None = None) -> Interval:
    """Return the five numbers of draws; with a middle, the draws are moved to it."""
    moved = draws if middle is None else draws - float(np.median(draws)) + middle
    low, half, high = (float(q) for q in np.quantile(moved, [0.05, 0.5, 0.95]))
    return Interval(mean=float(moved.mean()), sd=float(moved.std()), q05=low, q50=half, q95=high)
