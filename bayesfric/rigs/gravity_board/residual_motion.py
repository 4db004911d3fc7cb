"""Residuals of the gravity board's trials: forces in windows, and simulated motion."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from bayesfric.arrays import Array
from bayesfric.inference.cosines import cosines
from bayesfric.observation.linear import Run, Windows
from bayesfric.rigs.gravity_board.linear_scatter import TRIAL, WANDER, WAVES, wander_weights
from bayesfric.rigs.gravity_board.rows import GravityRows

WINDOWS = 8  # windows of a trial's travel
EVENTS_A_WINDOW = 4  # least number of events in a window, of both sensors together
SENSOR_POWERS = (1, 2, 3)  # powers of the travel in the difference of the two sensors
FIRST = 5  # events of each sensor that determine offset and first speed of a simulated trial


def whitening(board: GravityRows, rows: slice) -> tuple[Array, Callable[[Array], Array]]:
    """Return 1/sd of the rows of a trial, and the projection orthogonal to their nuisances.

    Differences between the two sensors are nuisances, because a force moves both sensors alike.

    Parameters
    ----------
    board : GravityRows
        Events.
    rows : slice
        Rows of the trial.
    """
    white = 1 / np.sqrt(board.variance[rows])
    nuisance = board.events.nuisances(rows) * white
    sensors = board.events.of_sensors[:, rows]
    if (sensors.sum(axis=1) > EVENTS_A_WINDOW).all():
        travel = board.events.displacement[rows] / board.events.displacement[rows].max()
        halves = 0.5 * (sensors[1].astype(np.float64) - sensors[0]) * white
        late = board.clock_column()[None, rows] * white
        late = late[late.any(axis=1)]
        nuisance = np.vstack([nuisance, *(halves * travel**k for k in SENSOR_POWERS), late])
    basis = np.linalg.qr(nuisance.T)[0]
    return white, lambda values: np.asarray(values - basis @ (basis.T @ values))


def windows_of(
    board: GravityRows,
    columns_of: Callable[[GravityRows], Array],
    travel_m: float,
    noise: Mapping[str, float],
) -> Windows:
    """Return residual forces in windows of travel; trials with few events have fewer windows.

    Parameters
    ----------
    board : GravityRows
        E events.
    columns_of : callable
        Function of the rows of some trials that returns the columns of the local numbers, (e, q)
        [m].
    travel_m : float
        Longest travel of all trials [m].
    noise : mapping of str to float
        Noise parameters by name.
    """
    variance = wander_weights(noise["wander_length"], travel_m)[0] * noise["wander"] ** 2
    of_trials: list[tuple[Any, ...]] = []
    for trials, part in board.parts():
        windows = _windows_of_part(part, columns_of(part), travel_m, variance, noise["kappa"])
        of_trials += [(trial + trials.start, *rest) for trial, *rest in windows]
    trial, forces, covariance, covariates, wander = zip(*of_trials, strict=True)
    return Windows(
        row=np.repeat(trial, [len(force) for force in forces]),
        residual_n=np.concatenate([force[:, 0] for force in forces]),
        columns=np.concatenate([force[:, 1:] for force in forces]),
        covariance=covariance,
        wander=wander,
        covariates={
            name: np.concatenate([of_trial[name] for of_trial in covariates])
            for name in covariates[0]
        },
    )


def _windows_of_part(
    board: GravityRows, columns: Array, travel_m: float, variance: Array, kappa: float
) -> Iterator[tuple[int, Array, Array, dict[str, Array], Array]]:
    """Yield each trial's index, and its windows' forces, covariance, covariates and wander.

    The forces have a column of residuals, followed by a column for each local number.
    """
    newton, places = board.window_columns(WINDOWS)
    for trial, rows in enumerate(board.rows_of_trials()):
        enough = max(1, (rows.stop - rows.start) // EVENTS_A_WINDOW)
        joined = _join(WINDOWS, min(WINDOWS, enough))
        white, project = whitening(board, rows)
        design = project(white[:, None] * (newton[:, rows].T @ joined))
        # Least squares with the design, which is orthogonal to the nuisances.
        inverse = np.linalg.pinv(design, rcond=max(design.shape) * np.finfo(float).eps) * white
        solved = np.column_stack([inverse @ board.residual[rows], inverse @ columns[rows]])
        mean = joined / joined.sum(axis=0)
        where = {name: values[trial] @ mean for name, values in places.items()}
        travel = np.atleast_1d(where["displacement"]) / travel_m
        waves = cosines(travel, WAVES)
        wander = (waves.T * variance) @ waves
        covariance = np.asarray(np.linalg.pinv(design.T @ design) * kappa, np.float64)
        yield trial, solved, covariance, where, wander


def runs_of(
    board: GravityRows,
    columns: Array,
    random: Array,
    travel_m: float,
    scatter: Array,
    noise: Mapping[str, float],
    numbers: Array,
) -> dict[int, Run]:
    """Return simulated trials whose offset and speed come from their first events alone.

    Parameters
    ----------
    board, travel_m, noise
        As in :func:`windows_of`.
    columns, random : ndarray, shape (E, q) and (E, R)
        Columns of the local numbers, and random columns [m].
    scatter : ndarray, shape (N, 2)
        Relative variance of a trial's and of its assembly's friction.
    numbers : ndarray, shape (A, N, q)
        Local numbers of each arm, for each trial.
    """
    wander = noise["wander"] ** 2 * wander_weights(noise["wander_length"], travel_m)[0]
    spread2 = scatter.sum(axis=1)
    runs = {}
    for trial, rows in enumerate(board.rows_of_trials()):
        nuisance = board.events.regressors[:3, rows]
        first = np.zeros(nuisance.shape[1], dtype=bool)
        for sensor in nuisance[:2]:
            first[np.flatnonzero(sensor != 0)[:FIRST]] = True
        present = (nuisance != 0).any(axis=1)
        if first.all() or not present[2]:
            continue
        variance = noise["kappa"] * board.variance[rows]
        residual = board.clock_residual[rows] - numbers[:, trial] @ columns[rows].T
        residual = _on_one_clock(board, rows, residual)
        # From residuals of the first events to offsets and first speed, and so to all events.
        design = nuisance[present].T @ np.linalg.pinv(nuisance[present].T[first])
        to_later = design[~first]
        later_random = random[rows][~first] - to_later @ random[rows][first]
        floor = spread2[trial] * (later_random[:, TRIAL] ** 2).mean()
        floor += (later_random[:, WANDER] ** 2 @ wander).mean()
        error = variance[~first] + to_later**2 @ variance[first]
        later_columns = columns[rows][~first] - to_later @ columns[rows][first]
        sensors = nuisance[:2] != 0
        sensor = sensors[0] if sensors[0].any() else sensors[1]
        measured = board.events.displacement[rows]
        tau = board.events.tau[rows][sensor]
        runs[trial] = Run(
            trial,
            residual[:, ~first] - residual[:, first] @ to_later.T,
            float(error.mean()),
            float(floor),
            later_columns.T @ later_columns / len(later_columns),
            tau - tau[0],
            measured[sensor],
            (measured - (residual - residual[:, first] @ design.T))[:, sensor],
        )
    return runs


def _on_one_clock(board: GravityRows, rows: slice, residual: Array) -> Array:
    """Return residuals without the clock offset that is estimated from all rows of a trial.

    The estimate is the posterior mean, with unknown nuisances and an unknown parabola in time,
    which represents friction.

    Parameters
    ----------
    board : GravityRows
        Events.
    rows : slice
        The n rows of the trial.
    residual : ndarray, shape (A, n)
        Residuals [m].
    """
    late = board.clock_column()[rows]
    if not late.any():
        return residual
    nuisance, tau = board.events.nuisances(rows), board.events.tau[rows]
    white = 1 / np.sqrt(board.variance[rows])
    basis = np.linalg.qr((np.vstack([nuisance, tau**2]) * white).T)[0]
    column = late * white - basis @ (basis.T @ (late * white))
    offset = (residual * white) @ column / (column @ column + 1)  # its prior has unit variance
    return np.asarray(residual - offset[:, None] * late)


def _join(fine: int, coarse: int) -> Array:
    """Return which fine windows form each coarse window, shape (fine, coarse)."""
    group = np.arange(fine) * coarse // fine
    return np.asarray(group[:, None] == np.arange(coarse), dtype=np.float64)
