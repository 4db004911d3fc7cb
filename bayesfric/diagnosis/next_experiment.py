"""The trial that would tell apart what these data leave open.

Conditions that the rig can have, by what was recorded, are laid out as trials without
noise; the expected log Bayes factor of one trial is half the squared distance of what two
hypotheses predict, in units of the events' errors, friction's scatter and what is not
known of the law.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.diagnosis.linear_model import LinearModel
from bayesfric.diagnosis.weighing import weigh
from bayesfric.diagnosis.which import NONE, UNKNOWN
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import coulomb_acceleration
from bayesfric.recording.tables import Gravity
from bayesfric.rigs.gravity_board.likelihood import trial_condition
from bayesfric.rigs.gravity_board.measured_motion import measured_motion
from bayesfric.rigs.gravity_board.rows import GravityRows
from bayesfric.rigs.layout import COEFFICIENTS
from bayesfric.schemas import NextExperiment

__all__ = ["next_experiment"]

Array = NDArray[np.float64]
RIVAL = 0.05  # probability of a hypothesis that is still in question
RIVALS = 3
PAIRS_OF_MASSES = 10  # of each size
TRAVEL_M = 0.6  # where the rig does not say
MOVING_M_S2 = 0.1  # acceleration below which a trial might stall
TWO = float(np.log10(2))  # expected log10 Bayes factor below which a trial is not worth it
LN10 = float(np.log(10))


@dataclass(frozen=True)
class _Predicted:
    """What a hypothesis predicts of each row beyond the reference law, and what it leaves open.

    Parameters
    ----------
    name : str
    mean : ndarray, shape (E,)
        [m].
    spread : ndarray, shape (E, k)
        Columns of one standard deviation each [m].
    """

    name: str
    mean: Array
    spread: Array


def next_experiment(
    model: LinearModel, psi: Array, chances: Mapping[str, float]
) -> tuple[tuple[NextExperiment, ...], str | None]:
    """Propose a trial for each two hypotheses that are still in question.

    Parameters
    ----------
    model : LinearModel
        With the candidates of all hypotheses.
    psi : ndarray
        Logarithms of the noise.
    chances : mapping of str to float
        Posterior probabilities, the largest first.

    Returns
    -------
    proposals : tuple of NextExperiment
        The most telling first.
    why : str or None
        Why there is none.
    """
    open_ = [name for name, p in chances.items() if p >= RIVAL and name != UNKNOWN][:RIVALS]
    if len(open_) < 2:
        return (), "no two hypotheses are left to separate"
    if model.gravity is None:
        return (), "there is no gravity board to lay out trials on"
    rows = _laid_out(model)
    if rows is None:
        return (), "no condition of what was recorded would move the cable"
    predicted = [_predicted(model, rows, name, psi) for name in open_]
    noise = float(np.mean(model.gravity.rows.variance))
    found = []
    for one, other in combinations(predicted, 2):
        expected = _expected(model, rows, one, other, noise, psi)
        best = int(np.argmax(expected))
        if expected[best] > TWO:
            found.append(_proposal(rows, best, float(expected[best]), one.name, other.name))
    if not found:
        return (
            (),
            "one more trial within what was recorded tells them apart by less than two to one",
        )
    return tuple(sorted(found, key=lambda one: -one.log10_bayes_factor)), None


def _laid_out(model: LinearModel) -> GravityRows | None:
    """Return trials at every feasible condition, their events on time by the reference law."""
    assert model.gravity is not None
    known, rig = model.gravity.rows.trials, model.data.constants
    laid = []
    for size, own in known.groupby("pulley_size", sort=True):
        masses = own[["mass_drive_kg", "mass_load_kg"]].drop_duplicates()
        order = np.argsort((masses["mass_drive_kg"] - masses["mass_load_kg"]).to_numpy())
        chosen = np.unique(np.linspace(0, len(order) - 1, PAIRS_OF_MASSES).astype(int))
        pairs = masses.to_numpy()[order[chosen]]
        cells = product(np.unique(own["n_pulleys"]), np.unique(own["wrap_angle_deg"]), pairs)
        laid += [(size, n, wrap, *pair) for n, wrap, pair in cells]
    names = ["pulley_size", "n_pulleys", "wrap_angle_deg", "mass_drive_kg", "mass_load_kg"]
    trials = pd.DataFrame(laid, columns=names)
    trials.insert(0, "trial", [f"t{place:04d}" for place in range(len(trials))])
    trials["setup"] = trials["trial"]
    trials["drive_end"] = "left"
    rate = _accelerations(model, trials)
    trials = trials[rate > MOVING_M_S2].reset_index(drop=True)
    if trials.empty:
        return None
    spacing = rig.hall_spacing_m or 0.01
    place = np.arange(spacing / 2, rig.limits.get("travel_m", (0.0, TRAVEL_M))[1], spacing)
    time = np.sqrt(2 * place / rate[rate > MOVING_M_S2][:, None])
    events = pd.DataFrame(
        {
            "trial": np.repeat(trials["trial"].to_numpy(), place.size),
            "sensor": "drive",
            "displacement_m": np.tile(place - place[0], len(trials)),
            "time_s": time.ravel(),
        }
    )
    return _rows(model, Gravity(trials, events))


def _accelerations(model: LinearModel, trials: pd.DataFrame) -> Array:
    """Return the acceleration of each trial by the reference law, shape (N,) [m/s²]."""
    laws = [model.laws[size] for size in trials["pulley_size"]]
    law = Coefficients(*(np.array(column) for column in zip(*laws, strict=True)))
    return coulomb_acceleration(law, trial_condition(trials, model.data.constants))


def _rows(model: LinearModel, gravity: Gravity) -> GravityRows:
    rig = model.data.constants
    measured = measured_motion(gravity, rig)
    return GravityRows(gravity, rig, model.laws, model.radii, measured, model.released)


def _predicted(model: LinearModel, rows: GravityRows, name: str, psi: Array) -> _Predicted:
    names = () if name == NONE else tuple(name.split("+"))
    found = weigh(model, names, psi, climb=False)
    columns = found.best.columns
    mean, sd = model.prior(columns)
    centre, covariance = model.information(psi, found.best).posterior(mean, sd)
    places = model.places(columns)
    responses = [rows.candidate_columns(model.candidates[place])[:, 0] for place in columns]
    scales = [model.scale(model.layout.candidate(place)) for place in columns]
    total = np.zeros(rows.residual.size)
    spread = np.zeros((rows.residual.size, COEFFICIENTS + len(columns)))
    law = rows.coefficient_columns() * [model.scale(k) for k in range(COEFFICIENTS)]
    sizes = rows.trials["pulley_size"].to_numpy()[rows.events.trial]
    for number, size in enumerate(model.layout.sizes):
        mine = sizes == size
        own = number * model.layout.own + np.arange(COEFFICIENTS)
        kept = np.concatenate([own, places])
        one = np.column_stack([law, *(r * s for r, s in zip(responses, scales, strict=True))])
        root = np.linalg.cholesky(covariance[np.ix_(kept, kept)] + 1e-12 * np.eye(kept.size))
        total[mine] = one[mine] @ centre[kept]
        spread[mine] = one[mine] @ root
    return _Predicted(name, total, spread)


def _expected(
    model: LinearModel,
    rows: GravityRows,
    one: _Predicted,
    other: _Predicted,
    noise: float,
    psi: Array,
) -> Array:
    """Return the expected log10 Bayes factor of each trial, shape (N,)."""
    gravity, _ = model.noise(psi)
    assert gravity is not None
    scatter = rows.scatter_column() * np.hypot(gravity.tau, gravity.omega)
    apart = one.mean - other.mean
    unknown = np.column_stack([scatter, one.spread, other.spread])
    found = np.zeros(len(rows.trials))
    for trial, own in enumerate(rows.rows_of_trials()):
        nuisance = rows.events.regressors[:3, own]
        basis = np.linalg.qr(nuisance[(nuisance != 0).any(axis=1)].T)[0]
        stack = np.column_stack([apart[own], unknown[own]]) / np.sqrt(noise * gravity.kappa)
        stack -= basis @ (basis.T @ stack)
        y, u = stack[:, 0], stack[:, 1:]
        taken = u.T @ y
        square = y @ y - taken @ np.linalg.solve(np.eye(taken.size) + u.T @ u, taken)
        found[trial] = square / 2 / LN10
    return found


def _proposal(
    rows: GravityRows, trial: int, expected: float, one: str, other: str
) -> NextExperiment:
    row = rows.trials.iloc[trial]
    return NextExperiment(
        condition={
            "rig": "gravity",
            "pulley_size": str(row["pulley_size"]),
            "n_pulleys": int(row["n_pulleys"]),
            "wrap_angle_deg": float(row["wrap_angle_deg"]),
            "mass_drive_kg": float(row["mass_drive_kg"]),
            "mass_load_kg": float(row["mass_load_kg"]),
        },
        separates=(one, other),
        log10_bayes_factor=expected,
    )
