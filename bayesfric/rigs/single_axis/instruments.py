"""Instrumental variables for a joint in a control loop, and their comparison with least squares.

Errors of an encoder are in the regressors, and a disturbance inside the loop is in the force and, a
little later, in the motion. Both bias least squares. An instrument is correlated with the motion
but not with these errors. It is the reference path if that was logged, and otherwise the motion in
the two preceding windows, which is independent of later errors.

Both estimates are compared by the test of Durbin, Wu and Hausman: if least squares are unbiased,
the residuals of acceleration and speed after regression on the instruments explain no more of the
force.

References
----------
A. Janot, P.-O. Vandanjon, M. Gautier, "A generic instrumental variable approach for industrial
robot identification", IEEE Transactions on Control Systems Technology 22 (1), 2014.
J. A. Hausman, "Specification tests in econometrics", Econometrica 46 (6), 1978.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from bayesfric.arrays import Array, Whole
from bayesfric.inference.clustered import clustered_covariance, summed_by_group
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.weak_form import TestFunction
from bayesfric.schemas.instrument import Instrument, InstrumentNumber

BEFORE = 2  # windows, whose motion tells that of the present one
MOVED = 2  # regressors that are the motion's: acceleration and speed
ALIKE = 1e-4  # of a column, that those before it leave, below which it is one of them
UNITS = {"inertia": "kg", "viscous": "N s/m", "coulomb": "N"}
NAMES = tuple(UNITS)  # of the first columns


class Estimate(NamedTuple):
    """A number with its standard error."""

    value: float
    error: float

    def over(self, ratio: float) -> "Estimate":
        """Return the number over a ratio, with its error."""
        return Estimate(self.value / ratio, self.error / abs(ratio))


class Compared(NamedTuple):
    """Least squares with instruments and without.

    Parameters
    ----------
    kind : str
        ``"reference"`` or ``"earlier motion"``.
    statistic, p_value : float
        Of Durbin, Wu and Hausman.
    strength : float
        The smaller F statistic of the instruments, for acceleration beside speed and for speed
        beside acceleration.
    instrumental, ordinary : dict of str to Estimate
        Inertia, viscous and Coulomb friction.
    rows : int
        That both are of.
    effects : dict of str to (Estimate, Estimate)
        Amplitudes of effects that act, with instruments and without; of those alone that are a
        number of the law, or that the columns before them do not make.
    agreement : float
        p-value that instruments contradict each other by chance alone; 1 where there are no more
        of them than regressors.
    """

    kind: Literal["reference", "earlier motion"]
    statistic: float
    p_value: float
    strength: float
    instrumental: dict[str, Estimate]
    ordinary: dict[str, Estimate]
    rows: int
    effects: dict[str, tuple[Estimate, Estimate]]
    agreement: float = 1.0

    @property
    def alarms(self) -> bool:
        """Whether least squares are off by more than chance, and by what matters."""
        if (
            self.p_value >= AXIS_RULES.instrument_differs
            or self.strength < AXIS_RULES.weak_instrument
            or self.agreement < AXIS_RULES.instrument_differs
        ):
            return False
        return any(
            _is_off(number, self.instrumental[name])
            for name, number in self.ordinary.items()
            if name != "viscous"
        )

    def stored(self, unit: Callable[[str], str], units: Mapping[str, str]) -> Instrument:
        """Return it as it is stored, its numbers in the axis' own units, `units` of effects."""
        numbers = {
            name: _stored(unit(UNITS[name]), self.instrumental[name], number)
            for name, number in self.ordinary.items()
        }
        effects = {
            name: _stored(units[name], instrumental, ordinary)
            for name, (instrumental, ordinary) in self.effects.items()
        }
        return Instrument(
            kind=self.kind,
            statistic=self.statistic,
            p_value=self.p_value,
            strength=self.strength,
            agreement=self.agreement,
            windows=self.rows,
            alarms=self.alarms,
            numbers=numbers,
            effects=effects,
        )


def _is_off(ordinary: Estimate, instrumental: Estimate) -> bool:
    """Return whether two estimates of a number differ by what matters, and by more than chance.

    The variance of their difference is that of their variances (Hausman, 1978).
    """
    apart = abs(instrumental.value - ordinary.value)
    chance = np.sqrt(max(instrumental.error**2 - ordinary.error**2, 0.0))
    matters = AXIS_RULES.instrument_matters * abs(ordinary.value)
    return bool(apart > max(matters, AXIS_RULES.instrument_errors * chance))


def _stored(unit: str, instrumental: Estimate, ordinary: Estimate) -> InstrumentNumber:
    return InstrumentNumber(
        unit=unit,
        ordinary=ordinary.value,
        ordinary_se=ordinary.error,
        instrumental=instrumental.value,
        instrumental_se=instrumental.error,
    )


def instruments_of(log: EvenLog, test: TestFunction, centres: NDArray[np.intp]) -> Array:
    """Return instruments for windows, nan where the log does not reach back so far.

    Parameters
    ----------
    log : EvenLog
        A run.
    test : TestFunction
        Of the windows.
    centres : ndarray of int, shape (W,)
        Their middles.

    Returns
    -------
    ndarray, shape (W, 4)
        Acceleration and speed of the reference and nothing more, or of the motion in two
        windows before.
    """
    reference = log.further.get("reference")
    instruments = np.full((centres.size, 2 * BEFORE), np.nan)
    if reference is not None:
        instruments[:, 0] = test.over(reference, test.curvature, centres)
        instruments[:, 1] = -test.over(reference, test.slope, centres)
        return instruments
    for before in range(BEFORE):
        middle = centres - (before + 1) * (2 * test.half + 1)
        inside = middle >= test.half
        instruments[inside, 2 * before] = test.over(log.position, test.curvature, middle[inside])
        instruments[inside, 2 * before + 1] = -test.over(log.position, test.slope, middle[inside])
    return instruments


def without_clock(nuisances: Array, acting: Mapping[str, Array]) -> Array:
    """Return the columns of nuisances, the clocks' own not where a cause is told by it.

    A drive that acts late does what clocks do that differ, and by more than they may.

    Parameters
    ----------
    nuisances : ndarray, shape (W, m)
        The clocks' column first.
    acting : mapping of str to ndarray, shape (W,)
        What each effect that acts adds.
    """
    clock = nuisances[:, 0]
    for column in acting.values():
        size = float(column @ column)
        rest = clock - column * (float(column @ clock) / size if size else 0.0)
        if np.linalg.norm(rest) < ALIKE * np.linalg.norm(clock):
            return nuisances[:, 1:]
    return nuisances


def compared(
    force: Array,
    columns: Array,
    instruments: Array,
    piece: Whole,
    acting: Sequence[str] = (),
) -> Compared | str:
    """Compare least squares with instruments and without; else say why that is not possible.

    Parameters
    ----------
    force : ndarray, shape (W,)
        Of rows, without what errors of the motion have no part in.
    columns : ndarray, shape (W, k)
        Acceleration, speed and 1, and what else acts.
    instruments : ndarray, shape (W, 4)
        Of :func:`instruments_of`, in the way's sense.
    piece : ndarray of int, shape (W,)
        Stretches of rows, ascending.
    acting : sequence of str
        Effects that the last columns are of.
    """
    kind: Literal["reference", "earlier motion"] = "earlier motion"
    if np.isnan(instruments[:, 2:]).all():
        kind = "reference"
    own = instruments[:, : 2 if kind == "reference" else 4]
    kept = np.isfinite(own).all(axis=1)
    force, columns, own = force[kept], columns[kept], own[kept]
    groups = np.unique(piece[kept], return_inverse=True)[1]
    pieces = int(groups.max()) + 1 if groups.size else 0
    chosen = _independent(columns)
    if pieces < AXIS_RULES.least_pieces or len(force) < AXIS_RULES.rows_a_number * len(chosen):
        return f"{len(force)} windows in {pieces} stretches are too few to tell"
    scaled, widths = _scaled(columns[:, chosen])
    own = _scaled(own)[0]
    moved, rest = scaled[:, :MOVED], scaled[:, MOVED:]
    excluded = np.column_stack([own, rest])
    fitted = excluded @ _least_squares(excluded, moved)
    strength = min(_strength(moved, fitted, own, rest, groups, place) for place in range(MOVED))
    left = moved - fitted
    statistic, p_value = 0.0, 1.0  # of instruments that leave nothing
    if np.linalg.norm(left) > ALIKE * np.linalg.norm(moved):
        statistic, p_value = _wald(force[:, None], left, scaled, groups)
    second = np.column_stack([fitted, rest])
    instrumental = _estimates(second, scaled, force, groups, widths)
    ordinary = _estimates(scaled, scaled, force, groups, widths)
    return Compared(
        kind,
        statistic,
        p_value,
        strength,
        dict(zip(NAMES, instrumental, strict=False)),
        dict(zip(NAMES, ordinary, strict=False)),
        len(force),
        {
            name: (instrumental[place].over(ratio), ordinary[place].over(ratio))
            for name, (place, ratio) in _places_of(acting, columns, chosen).items()
        },
        _agreement(own[:, MOVED:], second, scaled, force, groups),
    )


def _places_of(
    acting: Sequence[str], columns: Array, chosen: Sequence[int]
) -> dict[str, tuple[int, float]]:
    """Return the place of each effect among the chosen columns, and how many times it is that."""
    first = columns.shape[1] - len(acting)
    own = {
        acting[column - first]: (place, 1.0)
        for place, column in enumerate(chosen)
        if column >= first
    }
    return own | _of_the_law(columns, acting)


def _agreement(more: Array, second: Array, columns: Array, force: Array, groups: Whole) -> float:
    """Return the p-value that more instruments than regressors do not go with what is left.

    What the law lacks goes with the motion before, too: the instruments then contradict each
    other, and what they make of the law is as wrong.

    References
    ----------
    J. M. Wooldridge, "Score diagnostics for linear models estimated by two stage least squares"
    (1995), whose test of overidentifying restrictions bears errors that hang together.
    """
    count = more.shape[1]
    if not count:
        return 1.0
    left = force - columns @ _least_squares(second, force)
    beyond = (more - second @ _least_squares(second, more)) * left[:, None]
    sums = summed_by_group(beyond, groups)
    whole = sums.sum(axis=0)
    statistic = float(whole @ np.linalg.pinv(sums.T @ sums) @ whole)
    return float(scipy.special.chdtrc(count, statistic))


def _of_the_law(columns: Array, acting: Sequence[str]) -> dict[str, tuple[int, float]]:
    """Return which effects, the last columns, are numbers of the law, and how many times these.

    Beside a law without viscous friction the drag that acts is its column.
    """
    places: dict[str, tuple[int, float]] = {}
    for name, column in zip(acting, columns.T[columns.shape[1] - len(acting) :], strict=True):
        for place, own in enumerate(columns.T[: len(NAMES)]):
            size = float(own @ own)
            ratio = float(own @ column) / size if size else 0.0
            rest = float(np.linalg.norm(column - ratio * own))
            if ratio and rest <= ALIKE * float(np.linalg.norm(column)):
                places[name] = place, ratio
    return places


def _strength(
    moved: Array, fitted: Array, own: Array, rest: Array, groups: Whole, place: int
) -> float:
    """Return the F statistic of the instruments for one regressor beside the other.

    References
    ----------
    E. Sanderson, F. Windmeijer, "A weak instrument F-test in linear IV models with multiple
    endogenous variables", Journal of Econometrics 190 (2016).
    """
    other = MOVED - 1 - place
    numbers = _least_squares(np.column_stack([fitted[:, other], rest]), moved[:, place])
    left = moved[:, place] - np.column_stack([moved[:, other], rest]) @ numbers
    count, statistic = own.shape[1], _wald(left[:, None], own, rest, groups)[0]
    return float(statistic * count / (count - 1))


def _independent(columns: Array) -> list[int]:
    """Return places of columns that those before do not make; the law's own ones are first."""
    basis, kept = np.zeros((len(columns), 0)), []
    for place, column in enumerate(columns.T):
        rest = column - basis @ (basis.T @ column)
        rest = rest - basis @ (basis.T @ rest)
        size = float(np.linalg.norm(rest))
        if size > ALIKE * float(np.linalg.norm(column)) or place <= MOVED:
            kept.append(place)
            basis = np.column_stack([basis, rest / (size or 1.0)])
    return kept


def _scaled(columns: Array) -> tuple[Array, Array]:
    width = np.maximum(np.abs(columns).max(axis=0, initial=0.0), 1e-300)
    return columns / width, width


def _least_squares(columns: Array, goal: Array) -> Array:
    return np.asarray(np.linalg.lstsq(columns, goal, rcond=1e-10)[0], dtype=np.float64)


def _wald(goal: Array, asked: Array, beside: Array, groups: Whole) -> tuple[float, float]:
    """Return F that columns add nothing beside others, and its p-value; errors go by groups."""
    design = np.column_stack([asked, beside])
    numbers = _least_squares(design, goal[:, 0])
    covariance = _covariance(design, goal[:, 0] - design @ numbers, groups)
    count = asked.shape[1]
    own = numbers[:count]
    statistic = float(own @ np.linalg.pinv(covariance[:count, :count]) @ own) / count
    return statistic, float(scipy.special.fdtrc(count, groups.max(), statistic))


def _covariance(design: Array, rest: Array, groups: Whole) -> Array:
    """Return the covariance of least squares by groups, corrected for their number."""
    count = int(groups.max()) + 1
    inverse = np.asarray(np.linalg.pinv(design.T @ design, rcond=1e-12))
    return count / (count - 1) * clustered_covariance(design, rest, groups, inverse)


def _estimates(
    regressors: Array, columns: Array, force: Array, groups: Whole, widths: Array
) -> list[Estimate]:
    """Return each number of a fit with its error, in the columns' own units.

    Residuals are those of the columns, whichever regressors stand in their place.
    """
    numbers = _least_squares(regressors, force)
    error = np.sqrt(np.diag(_covariance(regressors, force - columns @ numbers, groups)))
    pairs = zip(numbers / widths, error / widths, strict=True)
    return [Estimate(float(number), float(own)) for number, own in pairs]
