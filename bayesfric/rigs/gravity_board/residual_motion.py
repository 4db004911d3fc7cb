"""Residuals of the gravity board's trials: forces in windows, and simulated motion."""

from collections.abc import Callable, Iterator, Mapping

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
    solved_trials = []
    for trials, part in board.parts():
        solved = _windows_of_part(part, columns_of(part), travel_m, variance, noise["kappa"])
        solved_trials += [(trial + trials.start, *windows) for trial, *windows in solved]
    names = solved_trials[0][3]
    return Windows(
        row=np.concatenate([np.full(len(f[1]), f[0]) for f in solved_trials]),
        residual_n=np.concatenate([f[1][:, 0] for f in solved_trials]),
        columns=np.concatenate([f[1][:, 1:] for f in solved_trials]),
        covariance=tuple(f[2] for f in solved_trials),
        wander=tuple(f[4] for f in solved_trials),
        covariates={name: np.concatenate([f[3][name] for f in solved_trials]) for name in names},
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
    columns : ndarray, shape (E, q)
        Columns of the local numbers [m].
    random : ndarray, shape (E, R)
        Random columns [m].
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
        seen = (nuisance != 0).any(axis=1)
        if first.all() or not seen[2]:
            continue
        variance = noise["kappa"] * board.variance[rows]
        left = board.clock_residual[rows] - numbers[:, trial] @ columns[rows].T
        left = _on_one_clock(board, rows, left)
        design = nuisance[seen].T @ np.linalg.pinv(nuisance[seen].T[first])
        carry = design[~first]
        moved = random[rows][~first] - carry @ random[rows][first]
        floor = spread2[trial] * (moved[:, TRIAL] ** 2).mean()
        floor += (moved[:, WANDER] ** 2 @ wander).mean()
        error = variance[~first] + carry**2 @ variance[first]
        later = columns[rows][~first] - carry @ columns[rows][first]
        sensors = nuisance[:2] != 0
        shown = sensors[0] if sensors[0].any() else sensors[1]
        measured = board.events.displacement[rows]
        tau = board.events.tau[rows][shown]
        runs[trial] = Run(
            trial,
            left[:, ~first] - left[:, first] @ carry.T,
            float(error.mean()),
            float(floor),
            later.T @ later / len(later),
            tau - tau[0],
            measured[shown],
            (measured - (left - left[:, first] @ design.T))[:, shown],
        )
    return runs


def _on_one_clock(board: GravityRows, rows: slice, left: Array) -> Array:
    """Return residuals without the clock offset that is estimated from all rows of a trial.

    The estimate is the posterior mean, with unknown nuisances and an unknown parabola in time,
    which represents friction.

    Parameters
    ----------
    board : GravityRows
        Events.
    rows : slice
        The n rows of the trial.
    left : ndarray, shape (A, n)
        Residuals [m].
    """
    late = board.clock_column()[rows]
    if not late.any():
        return left
    nuisance, tau = board.events.nuisances(rows), board.events.tau[rows]
    white = 1 / np.sqrt(board.variance[rows])
    basis = np.linalg.qr((np.vstack([nuisance, tau**2]) * white).T)[0]
    shown = late * white - basis @ (basis.T @ (late * white))
    size = (left * white) @ shown / (shown @ shown + 1)  # its prior has unit variance
    return np.asarray(left - size[:, None] * late)


def _join(fine: int, coarse: int) -> Array:
    """Return which fine windows form each coarse window, shape (fine, coarse)."""
    group = np.arange(fine) * coarse // fine
    return np.asarray(group[:, None] == np.arange(coarse), dtype=np.float64)
