"""What a fit predicts, laid out for the figures: curves, bands and trials.

Figures draw from these arrays and compute nothing.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from bayesfric.analysis import Analysis
from bayesfric.baseline import Baseline
from bayesfric.boards.gravity import Condition, Trajectory, nominal_tension
from bayesfric.boards.motor import nominal_tension as motor_tension
from bayesfric.diagnostics import rank_counts
from bayesfric.friction import Coefficients, coulomb_friction
from bayesfric.likelihood.gravity import GravityLikelihood
from bayesfric.likelihood.hall_events import pilot_fits
from bayesfric.likelihood.model import Model, RigLikelihood
from bayesfric.likelihood.motor import MotorLikelihood
from bayesfric.likelihood.screening import Screened
from bayesfric.paper import table1
from bayesfric.recording.tables import Gravity, Recording, Rig

__all__ = ["QUANTILES", "predict"]

Array = NDArray[np.float64]
QUANTILES = (0.05, 0.5, 0.95)
DRAWS = 1000  # enough for a 5 % quantile to a twentieth of an sd
RANK_BINS = 20
CURVE_POINTS = 41
SHOWN_TRIALS = 6


def predict(
    recording: Recording,
    screened: Screened | None,
    likelihoods: Mapping[str, RigLikelihood],
    model: Model,
    theta: Array,
    analysis: Analysis,
    baseline: Baseline,
) -> xr.DataTree:
    """Compute predictions from draws.

    Parameters
    ----------
    recording : Recording
        As read.
    screened : Screened or None
        The gravity trials that entered; None where that board did not.
    likelihoods : mapping of str to RigLikelihood
        Of the fit, by rig.
    model : Model
        Of the fit.
    theta : ndarray, shape (ensembles, draws, walkers, D)
        Posterior draws in the parameters' units.
    analysis : Analysis
        For the seed and the form of the scatter.
    baseline : Baseline
        The friction law of the fit.

    Returns
    -------
    DataTree
        ``coefficients``: quantiles, and their ratio to Table I for its sizes.
        ``ranks``: how the draws of each ensemble rank among all.
        Of the gravity board, ``trials``: friction observed, and predicted for a new
        trial on a new assembly; ``curves``: friction against tension at each (size,
        n, θ) cell, of the law and of Table I; ``trajectories``: a few trials,
        measured and predicted from their first speed alone. Of the motor board,
        ``runs``: friction observed, and predicted for a new run on a new assembly.
    """
    rng = np.random.default_rng(np.random.SeedSequence([analysis.seed, 1]))
    flat = theta.reshape(-1, theta.shape[-1])
    some = flat[np.linspace(0, len(flat) - 1, min(DRAWS, len(flat))).astype(int)]
    named = model.by_name(some)
    groups = {"coefficients": _coefficients(model, flat), "ranks": _ranks(model, theta)}
    for likelihood in likelihoods.values():
        factor = 1 + likelihood.draw_scatter(named, rng)
        if isinstance(likelihood, GravityLikelihood) and screened is not None:
            groups["trials"] = _trials(likelihood, named, factor)
            groups["curves"] = _curves(likelihood, named, baseline)
            groups["trajectories"] = _trajectories(
                likelihood, screened.gravity, recording.rig, named, factor, baseline
            )
        elif isinstance(likelihood, MotorLikelihood):
            groups["runs"] = _runs(likelihood, named, factor)
    return xr.DataTree.from_dict(groups)


def _bands(values: Array) -> Array:
    """Return quantiles over the first axis (draws), quantile last."""
    return np.moveaxis(np.quantile(values, QUANTILES, axis=0), 0, -1)


def _coefficients(model: Model, flat: Array) -> xr.Dataset:
    draws = model.by_name(flat)
    sizes = [size for size in table1() if f"c1[{size}]" in draws]
    names = Coefficients._fields
    levels = (0.05, 0.25, 0.5, 0.75, 0.95)
    paper = np.array([[getattr(table1()[size], name).value for name in names] for size in sizes])
    quantiles = np.array(
        [[np.quantile(draws[f"{name}[{size}]"], levels) for name in names] for size in sizes]
    )
    if not sizes:
        return xr.Dataset()
    dims = ("pulley", "coefficient")
    return xr.Dataset(
        {
            "paper": (dims, paper),
            "value": ((*dims, "level"), quantiles),
            "ratio": ((*dims, "level"), quantiles / paper[..., None]),
        },
        coords={"pulley": sizes, "coefficient": list(names), "level": list(levels)},
    )


def _ranks(model: Model, theta: Array) -> xr.Dataset:
    counts = np.stack(
        [rank_counts(theta[..., place], RANK_BINS) for place in range(theta.shape[-1])]
    )
    dims = ("parameter", "ensemble", "bin")
    return xr.Dataset(
        {"relative": (dims, counts / counts.mean(axis=-1, keepdims=True))},
        coords={"parameter": list(model.names)},
    )


def _trials(likelihood: GravityLikelihood, named: dict[str, Array], factor: Array) -> xr.Dataset:
    trials = likelihood.trials
    law = likelihood.law(named)
    middle = {name: np.median(values, keepdims=True) for name, values in named.items()}
    observed, variance, _ = (values[0] for values in likelihood.observed(middle))
    condition = likelihood.condition
    acceleration = (condition.drive_force_n - observed) / condition.total_mass_kg
    columns: dict[str, Any] = {
        name: ("trial", trials[name].to_numpy())
        for name in ("pulley_size", "setup", "n_pulleys", "wrap_angle_deg")
    }
    return xr.Dataset(
        columns
        | {
            "tension_n": ("trial", nominal_tension(condition, acceleration)),
            "acceleration_m_s2": ("trial", acceleration),
            "friction_n": ("trial", observed),
            "friction_sd_n": ("trial", np.sqrt(variance)),
            "law_n": (("trial", "quantile"), _bands(law)),
            "predicted_n": (("trial", "quantile"), _bands(law * factor)),
        },
        coords={"trial": trials["trial"].to_numpy(), "quantile": list(QUANTILES)},
    )


def _runs(likelihood: MotorLikelihood, named: dict[str, Array], factor: Array) -> xr.Dataset:
    runs, condition = likelihood.trials, likelihood.condition
    law = likelihood.law(named)
    middle = {name: np.median(values, keepdims=True) for name, values in named.items()}
    columns: dict[str, Any] = {
        name: ("run", runs[name].to_numpy())
        for name in (
            "pulley_size",
            "setup",
            "n_pulleys",
            "wrap_angle_deg",
            "hanging_mass_kg",
            "velocity_m_s",
        )
    }
    friction = likelihood.observed(middle)[0]
    return xr.Dataset(
        columns
        | {
            "tension_n": ("run", motor_tension(condition, friction)),
            "friction_n": ("run", friction),
            "law_n": (("run", "quantile"), _bands(law)),
            "predicted_n": (("run", "quantile"), _bands(law * factor)),
        },
        coords={"run": runs["trial"].to_numpy(), "quantile": list(QUANTILES)},
    )


def _curves(
    likelihood: GravityLikelihood, named: dict[str, Array], baseline: Baseline
) -> xr.Dataset:
    trials = likelihood.trials
    cells = trials[["pulley_size", "n_pulleys", "wrap_angle_deg"]].drop_duplicates()
    by_size = cells["pulley_size"].map(likelihood.sizes.index)
    cells = cells.assign(place=by_size).sort_values(["place", "wrap_angle_deg", "n_pulleys"])
    cells = cells.drop(columns="place")
    top = float(np.max(nominal_tension(likelihood.condition, 0.0)))
    tension = np.linspace(0.0, top, CURVE_POINTS)
    paper = np.full((len(cells), CURVE_POINTS), np.nan)
    law = np.empty((len(cells), CURVE_POINTS, len(QUANTILES)))
    for place, (size, n, wrap) in enumerate(cells.itertuples(index=False)):
        draws = Coefficients(*(named[f"{c}[{size}]"][:, None] for c in ("c1", "c2", "c3")))
        law[place] = _bands(baseline.at_tension(draws, n, wrap, tension))
        if size in table1():
            row = table1()[size]
            printed = Coefficients(row.c1.value, row.c2.value, row.c3.value)
            paper[place] = coulomb_friction(printed, n, wrap, tension)
    return xr.Dataset(
        {
            "law_n": (("curve", "tension_n", "quantile"), law),
            "paper_n": (("curve", "tension_n"), paper),
            "pulley_size": ("curve", cells["pulley_size"].to_numpy()),
            "n_pulleys": ("curve", cells["n_pulleys"].to_numpy()),
            "wrap_angle_deg": ("curve", cells["wrap_angle_deg"].to_numpy()),
        },
        coords={"tension_n": tension, "quantile": list(QUANTILES)},
    )


def _trajectories(
    likelihood: GravityLikelihood,
    gravity: Gravity,
    rig: Rig,
    named: dict[str, Array],
    factor: Array,
    baseline: Baseline,
) -> xr.Dataset:
    """Predict a few trials, free-running from the first event's speed."""
    trials = likelihood.trials
    with_events = np.flatnonzero(trials["trial"].isin(gravity.events["trial"]))
    if not with_events.size:
        return xr.Dataset()
    pilot = pilot_fits(gravity.events, trials["trial"].iloc[with_events])
    chosen = _typical(trials.iloc[with_events].reset_index(drop=True), pilot.acceleration)
    tables = []
    for fitted in chosen:
        place = with_events[fitted]
        row = trials.iloc[place]
        events = gravity.events[gravity.events["trial"] == row["trial"]]
        since_first = events["time_s"].to_numpy() - events["time_s"].min()
        of_sensor = (events["sensor"] == events["sensor"].iloc[0]).to_numpy()
        events, since_first = events[of_sensor], since_first[of_sensor]
        time = since_first - since_first[0]
        start_speed = pilot.first_speed[fitted] + pilot.acceleration[fitted] * since_first[0]
        condition = Condition(
            row["n_pulleys"],
            row["wrap_angle_deg"],
            row["mass_drive_kg"],
            row["mass_load_kg"],
            rig.gravity_m_s2,
        )
        law = Coefficients(*(named[f"{c}[{row['pulley_size']}]"] for c in Coefficients._fields))
        friction = factor[:, place] * baseline.gravity(law, condition)
        acceleration = (condition.drive_force_n - friction) / condition.total_mass_kg
        still = np.zeros_like(acceleration)[:, None]
        motion = Trajectory(acceleration[:, None], still, still + start_speed)
        tables.append(
            (row, time, events["displacement_m"].to_numpy(), _bands(motion.position(time)))
        )
    longest = max(len(time) for _, time, _, _ in tables)

    def padded(values: Array) -> Array:
        width = [(0, longest - len(values))] + [(0, 0)] * (values.ndim - 1)
        return np.pad(values, width, constant_values=np.nan)

    return xr.Dataset(
        {
            "time_s": (("shown", "event"), np.stack([padded(t) for _, t, _, _ in tables])),
            "travel_m": (("shown", "event"), np.stack([padded(x) for _, _, x, _ in tables])),
            "predicted_m": (
                ("shown", "event", "quantile"),
                np.stack([padded(p) for _, _, _, p in tables]),
            ),
            **{
                name: ("shown", np.array([row[name] for row, _, _, _ in tables]))
                for name in (
                    "pulley_size",
                    "n_pulleys",
                    "wrap_angle_deg",
                    "mass_drive_kg",
                    "mass_load_kg",
                )
            },
        },
        coords={
            "shown": [row["trial"] for row, _, _, _ in tables],
            "quantile": list(QUANTILES),
        },
    )


def _typical(trials: pd.DataFrame, acceleration: Array) -> list[int]:
    """Return a slow and a fast trial of each size, at most six in all."""
    chosen: list[int] = []
    for _, rows in trials.groupby("pulley_size", sort=False).groups.items():
        places = np.asarray(rows)[np.argsort(acceleration[rows], kind="stable")]
        for share in (0.1, 0.9):
            place = int(places[round(share * (len(places) - 1))])
            if place not in chosen:
                chosen.append(place)
    return sorted(chosen[:SHOWN_TRIALS])
