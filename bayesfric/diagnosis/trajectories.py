"""The gap in metres: free-running from the first five events to the end of travel."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bayesfric.diagnosis.residuals import local_numbers, numbers_of_laws
from bayesfric.diagnosis.shrink import Arms, GapFigures, Squares
from bayesfric.rigs.gravity_board.linear import GravityPart

__all__ = ["Example", "free_running"]

Array = NDArray[np.float64]
FIRST = 5  # events of a sensor that set the offset and the first speed
EXAMPLES = 3


@dataclass(frozen=True)
class Example:
    """A held-out trial at the drive sensor, or the load sensor where that is missing.

    Parameters
    ----------
    trial : str
        Its id.
    time_s, measured_m, before_m, after_m : ndarray
        Since the first event [s]; displacement measured and simulated [m].
    """

    trial: str
    time_s: Array
    measured_m: Array
    before_m: Array
    after_m: Array


def free_running(arms: Arms, figures: GapFigures) -> tuple[Squares, tuple[Example, ...]] | None:
    """Return squares of the deviation of each held-out trial [m²], and some examples.

    Parameters
    ----------
    arms : Arms
        Both models.
    figures : GapFigures
        Fitted without each fold; a trial's is that of its first window.

    Returns
    -------
    tuple or None
        None where no trial has events enough.
    """
    model, residuals, fold = arms.model, figures.residuals, figures.fold
    part, noise = model.gravity, model.noise(arms.psi)[0]
    if part is None or noise is None:
        return None
    first = np.unique(residuals.trial, return_index=True)[1]
    rows_of = list(part.rows.rows_of_trials())
    spread2 = noise.tau**2 + noise.omega**2
    trials, squares, left = [], [], {}
    for number in range(int(fold.max()) + 1):
        arm = _arms(arms, figures.numbers[number])
        for trial in np.flatnonzero(fold[first[: len(rows_of)]] == number):
            rows, numbers = rows_of[trial], arm[:, part.size[trial]]
            run = _Running.of(part, rows)
            if run is None:
                continue
            off = part.rows.residual[rows] - numbers @ part.columns[rows].T
            error = run.variance.mean()
            floor = spread2 * (run.deviation(part.scatter_column[rows]) ** 2).mean()
            mean = [(run.deviation(one) ** 2).mean() - error for one in off]
            trials.append(trial)
            squares.append([*mean, floor])
            left[trial] = off
    if not trials:
        return None
    condition = residuals.condition[first[np.array(trials)]]
    weight = 1 / np.bincount(condition)[condition] / np.unique(condition).size
    shipped, before, after, floor2 = np.array(squares).T * weight
    chosen = sorted(trials)[:: max(1, len(trials) // EXAMPLES)][:EXAMPLES]
    return (
        Squares(
            None if arms.shipped is None else shipped,
            before,
            after,
            floor2,
            residuals.setup[first[np.array(trials)]],
        ),
        tuple(_example(part, int(trial), rows_of[trial], left[trial]) for trial in chosen),
    )


def _arms(arms: Arms, numbers: tuple[Array, Array]) -> Array:
    """Return local numbers as shipped, before and after, shape (3, sizes, q)."""
    model, (plain, caused) = arms.model, numbers
    shipped = plain if arms.shipped is None else numbers_of_laws(model, arms.shipped, plain)
    return np.stack([local_numbers(model, one) for one in (shipped, plain, caused)])


@dataclass(frozen=True)
class _Running:
    """How rows of a trial deviate once its first events have set offset and speed."""

    rest: NDArray[np.bool_]
    carry: Array  # (rest, first): deviations of the first events carried on
    first: NDArray[np.bool_]
    variance: Array  # of the measurement error of each deviation, κ = 1

    @classmethod
    def of(cls, part: GravityPart, rows: slice) -> "_Running | None":
        nuisance = part.rows.events.regressors[:3, rows]
        first = np.zeros(nuisance.shape[1], dtype=bool)
        for sensor in nuisance[:2]:
            first[np.flatnonzero(sensor != 0)[:FIRST]] = True
        rest = ~first
        seen = (nuisance != 0).any(axis=1)
        if not rest.any() or not seen[2]:
            return None
        design = nuisance[seen].T
        variance = part.rows.variance[rows]
        carry = design[rest] @ np.linalg.pinv(design[first])
        return cls(rest, carry, first, variance[rest] + carry**2 @ variance[first])

    def deviation(self, values: Array) -> Array:
        """Return values of the rest, those of the first carried on taken off."""
        return np.asarray(values[self.rest] - self.carry @ values[self.first])


def _example(part: GravityPart, trial: int, rows: slice, off: Array) -> Example:
    events = part.rows.events
    sensors = events.regressors[:2, rows] != 0
    seen = sensors[0] if sensors[0].any() else sensors[1]
    run = _Running.of(part, rows)
    assert run is not None
    nuisance = events.regressors[:3, rows]
    design = nuisance[(nuisance != 0).any(axis=1)].T
    measured = events.displacement[rows]
    simulated = []
    for one in off[1:]:
        start = design @ (np.linalg.pinv(design[run.first]) @ one[run.first])
        simulated.append((measured - (one - start))[seen])
    tau = events.tau[rows][seen]
    return Example(
        str(part.rows.trials["trial"].iloc[trial]), tau - tau[0], measured[seen], *simulated
    )
