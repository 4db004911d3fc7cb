"""Residual forces of both boards in one table, and what a fit makes of them."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bayesfric.diagnosis.linear_model import Acting, LinearModel
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.gravity_board.linear import GravityPart
from bayesfric.rigs.gravity_board.rows import GravityRows
from bayesfric.rigs.layout import COEFFICIENTS
from bayesfric.rigs.motor_board.linear import MotorPart
from bayesfric.rigs.windows import Windows

__all__ = [
    "AXES",
    "Residuals",
    "fitted",
    "local_numbers",
    "numbers_of_laws",
    "recalibrated",
    "residuals_of",
]

Array = NDArray[np.float64]
AXES = {
    "velocity": "m/s",
    "tension": "N",
    "wrap_angle": "deg",
    "n_pulleys": "1",
    "displacement": "m",
    "acceleration": "m/s²",
    "order": "1",
    "pulley_size": "1",
    "rig": "1",
}
"""Covariates with their units; the last two are numbers of a category."""


@dataclass(frozen=True)
class Residuals:
    """Windows of both boards, gravity's first.

    Parameters
    ----------
    residual_n : ndarray, shape (R,)
        Measured less that of the reference law, against the motion [N].
    columns : ndarray, shape (R, q)
        What each local number adds [N].
    size : ndarray of int, shape (R,)
        Place of the pulley size.
    friction_n : ndarray, shape (R,)
        Of the reference law [N].
    variance : ndarray, shape (R,)
        Of the measurement [N²].
    spread : ndarray, shape (R,)
        Of friction from the law, relative: a trial's and an assembly's together.
    trial, setup, condition : ndarray of int, shape (R,)
        Numbers over both boards.
    covariance : tuple of ndarray
        Of the measurement error, trial by trial [N²].
    scatter : ndarray, shape (R, 2)
        Relative scatter of a trial and of an assembly.
    covariates : dict of str to ndarray, shape (R,)
        Of :data:`AXES`; nan where there is none.
    names : tuple of str
        Of the trials and runs.
    """

    residual_n: Array
    columns: Array
    size: NDArray[np.intp]
    friction_n: Array
    variance: Array
    trial: NDArray[np.intp]
    setup: NDArray[np.intp]
    condition: NDArray[np.intp]
    covariance: tuple[Array, ...]
    scatter: Array
    covariates: dict[str, Array]
    names: tuple[str, ...]

    @property
    def weight(self) -> Array:
        """Equal weight a condition, and a trial in it, adding up to 1; shape (R,)."""
        windows = np.bincount(self.trial)[self.trial]
        pairs = np.unique(np.stack([self.condition, self.trial]), axis=1)
        trials = np.bincount(pairs[0])[self.condition]
        return np.asarray(1 / (windows * trials * np.unique(self.condition).size))

    def left(self, model: LinearModel, numbers: Array) -> Array:
        """Return what numbers of the model leave of the residual, shape (R,) [N]."""
        local = local_numbers(model, numbers)
        return np.asarray(self.residual_n - (self.columns * local[self.size]).sum(axis=1))


def residuals_of(model: LinearModel, psi: Array) -> Residuals:
    """Return the residual forces of both boards.

    Parameters
    ----------
    model : LinearModel
        The boards.
    psi : ndarray
        Logarithms of the noise.
    """
    gravity, motor = model.noise(psi)
    boards: list[Residuals] = []
    if model.gravity is not None and gravity is not None:
        part, rows = model.gravity, model.gravity.rows
        windows = part.windows()
        masses = ["mass_drive_kg", "mass_load_kg"]
        # The noise of events by the first estimate of it, which no law's misfit inflates.
        boards.append(_of_board(part, rows, windows, masses, (gravity.tau, gravity.omega), 0))
    if model.motor is not None and motor is not None:
        board, windows = model.motor, model.motor.windows(motor)
        held = ["hanging_mass_kg"]
        boards.append(_of_board(board, board, windows, held, (motor.tau, motor.omega), 1))
    return boards[0] if len(boards) == 1 else _joined(*boards)


def _of_board(
    part: GravityPart | MotorPart,
    rows: GravityRows | MotorPart,
    windows: Windows,
    masses: list[str],
    scatter: tuple[float, float],
    rig: int,
) -> Residuals:
    table, row = rows.trials, windows.row
    keys = ["pulley_size", "n_pulleys", "wrap_angle_deg", *masses]
    condition = table.groupby(keys, sort=False).ngroup().to_numpy().astype(np.intp)
    covariates = dict(windows.covariates)
    covariates["acceleration"] = rows.acceleration[row]
    covariates["pulley_size"] = part.size[row].astype(np.float64)
    covariates["rig"] = np.full(row.size, float(rig))
    return Residuals(
        residual_n=windows.residual_n,
        columns=windows.columns,
        size=part.size[row],
        friction_n=rows.friction_n[row],
        variance=windows.variance,
        trial=row,
        setup=part.setup[row],
        condition=condition[row],
        covariance=windows.covariance,
        scatter=np.tile(np.array(scatter), (row.size, 1)),
        covariates={axis: covariates[axis] for axis in AXES},
        names=tuple(table["trial"]),
    )


def _joined(one: Residuals, other: Residuals) -> Residuals:
    """Return the residuals of both boards, trials and assemblies numbered on."""

    def both(name: str) -> Any:
        return np.concatenate([getattr(one, name), getattr(other, name)])

    def on(name: str) -> NDArray[np.intp]:
        first: NDArray[np.intp] = getattr(one, name)
        return np.concatenate([first, getattr(other, name) + first.max() + 1])

    return Residuals(
        both("residual_n"),
        both("columns"),
        both("size"),
        both("friction_n"),
        both("variance"),
        on("trial"),
        on("setup"),
        on("condition"),
        one.covariance + other.covariance,
        both("scatter"),
        {axis: np.concatenate([one.covariates[axis], other.covariates[axis]]) for axis in AXES},
        one.names + other.names,
    )


def fitted(
    model: LinearModel,
    psi: Array,
    acting: Acting,
    used: Mapping[str, NDArray[np.bool_]] | None = None,
) -> tuple[Array, Array]:
    """Fit a model.

    Parameters
    ----------
    model : LinearModel
        The boards.
    psi : ndarray
        Logarithms of the noise.
    acting : Acting
        Candidates that act.
    used : mapping of str to ndarray of bool, or None
        Trials and runs that enter.

    Returns
    -------
    mean : ndarray, shape (p,)
        Of every number of the model, 0 of a candidate that does not act.
    covariance : ndarray, shape (p, p)
        Likewise.
    """
    mean, sd = model.prior(acting.columns)
    found, covariance = model.information(psi, acting, used).posterior(mean, sd)
    count, acted = model.layout.own * len(model.layout.sizes), len(acting.columns)
    places = np.concatenate(
        [
            np.arange(count),
            count + np.array(acting.columns, dtype=np.intp),
            count + model.layout.candidates + np.arange(found.size - count - acted),
        ]
    )
    total = count + model.layout.candidates + model.layout.always().size
    whole, spread = np.zeros(total), np.zeros((total, total))
    whole[places], spread[np.ix_(places, places)] = found, covariance
    return whole, spread


def local_numbers(model: LinearModel, numbers: Array) -> Array:
    """Return the local numbers of each size, shape (sizes, q), from those of all."""
    sizes, own = len(model.layout.sizes), model.layout.own
    shared = np.tile(numbers[own * sizes :], (sizes, 1))
    return np.concatenate([numbers[: own * sizes].reshape(sizes, own), shared], axis=1)


def numbers_of_laws(model: LinearModel, laws: Mapping[str, Coefficients], numbers: Array) -> Array:
    """Return numbers with the coefficients of given laws and no effects."""
    found = np.zeros_like(numbers)
    own = model.layout.own
    for place, size in enumerate(model.layout.sizes):
        for column in range(COEFFICIENTS):
            moved = float(np.asarray(laws[size][column]) - np.asarray(model.laws[size][column]))
            found[place * own + column] = moved / model.scale(column)
    if model.layout.idle:
        found[-model.layout.idle :] = numbers[-model.layout.idle :]
    return found


def recalibrated(
    model: LinearModel, residuals: Residuals, rows: NDArray[np.bool_], numbers: Array
) -> Array:
    """Return numbers with the law that fits the forces of some windows best.

    Least squares with the weights of the gap, less where the measurement is poor, and the
    prior of the law: what a force that the law does not have does within a trial does not
    bend the law, as it would if events were taken to be as precise as they are.

    Parameters
    ----------
    model : LinearModel
        Without discrepancy.
    residuals : Residuals
        Of its windows.
    rows : ndarray of bool, shape (R,)
        Those that enter; without any the law is that of the prior.
    numbers : ndarray, shape (p,)
        Of every number of the model; the law's are left aside, the others held.
    """
    own, sizes = model.layout.own, len(model.layout.sizes)
    mean, sd = (values[: own * sizes] for values in model.prior(()))
    found = numbers.copy()
    found[: own * sizes] = mean
    if not rows.any():
        return found
    spread2 = residuals.friction_n**2 * (residuals.scatter**2).sum(axis=1)
    weight = residuals.weight * rows * spread2 / (spread2 + residuals.variance)
    design = np.zeros((rows.size, own * sizes))
    for size in range(sizes):
        mine = residuals.size == size
        design[mine, own * size : own * (size + 1)] = residuals.columns[mine, :own]
    design *= sd
    # An assembly's scatter enters once, however many windows there are of it.
    assemblies = np.unique(residuals.setup[rows]).size
    variance = (weight * (spread2 + residuals.variance)).sum()
    certainty = assemblies / variance * weight[:, None] * design
    precision = design.T @ certainty + np.eye(own * sizes)
    slope = certainty.T @ residuals.left(model, found)
    found[: own * sizes] += sd * np.linalg.solve(precision, slope)
    return found
