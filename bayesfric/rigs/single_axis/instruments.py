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

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
import scipy
from numpy.typing import NDArray

from bayesfric.arrays import Array, Whole
from bayesfric.inference.clustered import clustered_covariance, summed_by_group
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.weak_form import TestFunction
from bayesfric.schemas.instrument import Instrument, InstrumentNumber

BEFORE = 2  # preceding windows whose motion is an instrument
MOVED = 2  # regressors with errors of the motion: acceleration and speed
ALIKE = 1e-4  # relative residual of a column below which earlier columns determine it
UNITS = {"inertia": "kg", "viscous": "N s/m", "coulomb": "N"}  # of the first columns


def _alarms(
    p_value: float, strength: float, agreement: float, numbers: Mapping[str, InstrumentNumber]
) -> bool:
    """Return whether the bias of least squares is significant and large enough to matter."""
    if (
        p_value >= AXIS_RULES.instrument_differs
        or strength < AXIS_RULES.weak_instrument
        or agreement < AXIS_RULES.instrument_differs
    ):
        return False
    return any(_is_off(number) for name, number in numbers.items() if name != "viscous")


def _is_off(number: InstrumentNumber) -> bool:
    """Return whether the difference of two estimates is significant and large enough to matter.

    The variance of their difference is the difference of their variances (Hausman, 1978).
    """
    apart = abs(number.instrumental - number.ordinary)
    chance = np.sqrt(max(number.instrumental_se**2 - number.ordinary_se**2, 0.0))
    matters = AXIS_RULES.instrument_matters * abs(number.ordinary)
    return bool(apart > max(matters, AXIS_RULES.instrument_errors * chance))


def instruments_of(log: EvenLog, test: TestFunction, centres: NDArray[np.intp]) -> Array:
    """Return the instruments of windows.

    Parameters
    ----------
    log : EvenLog
        A run.
    test : TestFunction
        Test function of the windows.
    centres : ndarray of int, shape (W,)
        Middle sample of each window.

    Returns
    -------
    ndarray, shape (W, 4)
        Acceleration and speed of the reference path and two columns of NaN; without a reference,
        acceleration and speed in the two preceding windows, NaN if the log begins later.
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
    """Return the columns of nuisances, without that of the clocks if an acting effect is the same.

    A delay of the drive has the same column as a difference of the clocks, but may be larger.

    Parameters
    ----------
    nuisances : ndarray, shape (W, m)
        Columns of the nuisances, that of the clocks first.
    acting : mapping of str to ndarray, shape (W,)
        Force of each acting effect in each window.
    """
    clock = nuisances[:, 0]
    for column in acting.values():
        size = float(column @ column)
        residual = clock - column * (float(column @ clock) / size if size else 0.0)
        if np.linalg.norm(residual) < ALIKE * np.linalg.norm(clock):
            return nuisances[:, 1:]
    return nuisances


def compared(
    force: Array,
    columns: Array,
    instruments: Array,
    piece: Whole,
    acting: Mapping[str, str] = MappingProxyType({}),
    units: Mapping[str, str] = UNITS,
) -> Instrument | str:
    """Compare least squares with and without instruments, or return why that is not possible.

    Parameters
    ----------
    force : ndarray, shape (W,)
        Force of the windows without the known force.
    columns : ndarray, shape (W, k)
        Acceleration, speed, 1, nuisances, and acting effects.
    instruments : ndarray, shape (W, 4)
        Instruments by :func:`instruments_of`, along the motion.
    piece : ndarray of int, shape (W,)
        Independent stretch of each window, ascending.
    acting, units : mapping of str to str
        By name, the units of the effects of the last columns, and of the law's numbers. Effects
        whose columns earlier ones determine are left out, unless proportional to one of the law.
    """
    is_reference = bool(np.isnan(instruments[:, 2:]).all())
    own = instruments[:, : 2 if is_reference else 4]
    kept = np.isfinite(own).all(axis=1)
    force, columns, own = force[kept], columns[kept], own[kept]
    groups = np.unique(piece[kept], return_inverse=True)[1]
    pieces = int(groups.max()) + 1 if groups.size else 0
    chosen = _independent(columns)
    if pieces < AXIS_RULES.least_pieces or len(force) < AXIS_RULES.rows_a_number * len(chosen):
        return f"{len(force)} windows in {pieces} stretches are too few"
    scaled, widths = _scaled(columns[:, chosen])
    own = _scaled(own)[0]
    moved, others = scaled[:, :MOVED], scaled[:, MOVED:]
    excluded = np.column_stack([own, others])
    fitted = excluded @ _least_squares(excluded, moved)
    strength = min(_strength(moved, fitted, own, others, groups, place) for place in range(MOVED))
    statistic, p_value = _differs(force, moved, fitted, scaled, groups)
    second = np.column_stack([fitted, others])
    estimates = np.stack(
        [_estimates(stage, scaled, force, groups, widths) for stage in (scaled, second)]
    )
    agreement = _agreement(own[:, MOVED:], second, scaled, force, groups)
    numbers = {name: _number(estimates, units[name], place) for place, name in enumerate(UNITS)}
    return Instrument(
        kind="reference" if is_reference else "earlier motion",
        statistic=statistic,
        p_value=p_value,
        strength=strength,
        agreement=agreement,
        windows=len(force),
        alarms=_alarms(p_value, strength, agreement, numbers),
        numbers=numbers,
        effects={
            name: _number(estimates, acting[name], *place)
            for name, place in _places_of(tuple(acting), columns, chosen).items()
        },
    )


def _number(estimates: Array, unit: str, place: int, ratio: float = 1.0) -> InstrumentNumber:
    """Return least-squares and instrumental estimates of a column over a ratio."""
    (ordinary, ordinary_se), (instrumental, instrumental_se) = estimates[:, :, place] / ratio
    return InstrumentNumber(
        unit=unit,
        ordinary=ordinary,
        ordinary_se=abs(ordinary_se),
        instrumental=instrumental,
        instrumental_se=abs(instrumental_se),
    )


def _places_of(
    acting: Sequence[str], columns: Array, chosen: Sequence[int]
) -> dict[str, tuple[int, float]]:
    """Return for each effect its index among the chosen columns, and its ratio to that column."""
    first = columns.shape[1] - len(acting)
    own = {
        acting[column - first]: (place, 1.0)
        for place, column in enumerate(chosen)
        if column >= first
    }
    return own | _of_the_law(columns, acting)


def _agreement(more: Array, second: Array, columns: Array, force: Array, groups: Whole) -> float:
    """Return the p-value of a test of overidentifying restrictions.

    If the law lacks a force, this force correlates with the earlier motion too. The instruments
    then contradict each other, and their estimate of the law is biased as well.

    References
    ----------
    J. M. Wooldridge, "Score diagnostics for linear models estimated by two stage least squares"
    (1995); the test is valid for correlated errors.
    """
    count = more.shape[1]
    if not count:
        return 1.0
    residual = force - columns @ _least_squares(second, force)
    beyond = (more - second @ _least_squares(second, more)) * residual[:, None]
    sums = summed_by_group(beyond, groups)
    whole = sums.sum(axis=0)
    statistic = float(whole @ np.linalg.pinv(sums.T @ sums) @ whole)
    return float(scipy.special.chdtrc(count, statistic))


def _of_the_law(columns: Array, acting: Sequence[str]) -> dict[str, tuple[int, float]]:
    """Return effects whose column is proportional to one of the law, with its index and the ratio.

    For example, the column of a viscous drag is that of the law's viscous friction.
    """
    places: dict[str, tuple[int, float]] = {}
    for name, column in zip(acting, columns.T[columns.shape[1] - len(acting) :], strict=True):
        for place, own in enumerate(columns.T[: len(UNITS)]):
            size = float(own @ own)
            ratio = float(own @ column) / size if size else 0.0
            residual = float(np.linalg.norm(column - ratio * own))
            if ratio and residual <= ALIKE * float(np.linalg.norm(column)):
                places[name] = place, ratio
    return places


def _strength(
    moved: Array, fitted: Array, own: Array, others: Array, groups: Whole, place: int
) -> float:
    """Return the conditional F statistic of the instruments for one of the two regressors.

    References
    ----------
    E. Sanderson, F. Windmeijer, "A weak instrument F-test in linear IV models with multiple
    endogenous variables", Journal of Econometrics 190 (2016).
    """
    other = MOVED - 1 - place
    numbers = _least_squares(np.column_stack([fitted[:, other], others]), moved[:, place])
    residual = moved[:, place] - np.column_stack([moved[:, other], others]) @ numbers
    count, statistic = own.shape[1], _wald(residual[:, None], own, others, groups)[0]
    return float(statistic * count / (count - 1))


def _independent(columns: Array) -> list[int]:
    """Return indices of columns that are no combination of earlier ones; the law's are all kept."""
    basis, kept = np.zeros((len(columns), 0)), []
    for place, column in enumerate(columns.T):
        residual = column - basis @ (basis.T @ column)
        residual = residual - basis @ (basis.T @ residual)
        size = float(np.linalg.norm(residual))
        if size > ALIKE * float(np.linalg.norm(column)) or place <= MOVED:
            kept.append(place)
            basis = np.column_stack([basis, residual / (size or 1.0)])
    return kept


def _scaled(columns: Array) -> tuple[Array, Array]:
    width = np.maximum(np.abs(columns).max(axis=0, initial=0.0), 1e-300)
    return columns / width, width


def _least_squares(columns: Array, goal: Array) -> Array:
    return np.asarray(np.linalg.lstsq(columns, goal, rcond=1e-10)[0], dtype=np.float64)


def _wald(goal: Array, asked: Array, beside: Array, groups: Whole) -> tuple[float, float]:
    """Return F and p-value of a test that columns `asked` add nothing to columns `beside`.

    Errors are clustered by group.
    """
    design = np.column_stack([asked, beside])
    numbers = _least_squares(design, goal[:, 0])
    covariance = _covariance(design, goal[:, 0] - design @ numbers, groups)
    count = asked.shape[1]
    own = numbers[:count]
    statistic = float(own @ np.linalg.pinv(covariance[:count, :count]) @ own) / count
    return statistic, float(scipy.special.fdtrc(count, groups.max(), statistic))


def _differs(
    force: Array, moved: Array, fitted: Array, scaled: Array, groups: Whole
) -> tuple[float, float]:
    """Return F and p-value of the Durbin-Wu-Hausman test of least squares."""
    residual = moved - fitted
    if np.linalg.norm(residual) <= ALIKE * np.linalg.norm(moved):
        return 0.0, 1.0  # the instruments explain the motion completely
    return _wald(force[:, None], residual, scaled, groups)


def _covariance(design: Array, residual: Array, groups: Whole) -> Array:
    """Return the clustered covariance of least squares, corrected for the number of groups."""
    count = int(groups.max()) + 1
    inverse = np.asarray(np.linalg.pinv(design.T @ design, rcond=1e-12))
    return count / (count - 1) * clustered_covariance(design, residual, groups, inverse)


def _estimates(
    regressors: Array, columns: Array, force: Array, groups: Whole, widths: Array
) -> Array:
    """Return coefficients of a fit and their standard errors, in the columns' own units, (2, k).

    Residuals are computed with the columns themselves, not with the regressors that replace them.
    """
    numbers = _least_squares(regressors, force)
    error = np.sqrt(np.diag(_covariance(regressors, force - columns @ numbers, groups)))
    return np.stack([numbers, error]) / widths
