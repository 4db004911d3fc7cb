"""Data for figures of the gravity board: trials, friction against tension, and trajectories."""

import numpy as np
import pandas as pd
import xarray as xr

from bayesfric.arrays import Array
from bayesfric.physics.friction import Coefficients, coulomb_friction
from bayesfric.physics.gravity import Trajectory, nominal_tension
from bayesfric.physics.laws import FrictionLaw
from bayesfric.recording.frames import stands_in
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.bands import bands
from bayesfric.rigs.base import Predictive
from bayesfric.rigs.gravity_board.likelihood import GravityModel
from bayesfric.rigs.gravity_board.trial_motion import PilotFit, pilot_fits, trial_condition
from bayesfric.rigs.residuals import beside_predicted
from bayesfric.rigs.truth import table1_coefficients
from bayesfric.schemas.base import QUANTILES

SHOWN_TRIALS = 6  # largest number of trajectories
CURVE_POINTS = 41


def trials(model: GravityModel, recorded: pd.DataFrame, view: Predictive) -> xr.Dataset:
    """Return observed friction, and predicted friction of a new trial on a new assembly.

    Parameters
    ----------
    model : GravityModel
        Model of the fit.
    recorded : DataFrame
        All recorded trials, which give the order.
    view : Predictive
        The fit.
    """
    table = model.trials
    friction, variance, _ = (values[0] for values in model.observed(view.medians))
    condition = model.condition
    acceleration = (condition.drive_force_n - friction) / condition.total_mass_kg
    observed = {
        name: table[name].to_numpy()
        for name in ("pulley_size", "setup", "n_pulleys", "wrap_angle_deg")
    }
    observed["tension_n"] = nominal_tension(condition, acceleration)
    observed["acceleration_m_s2"] = acceleration
    observed["friction_n"] = friction
    observed["friction_sd_n"] = np.sqrt(variance)
    return beside_predicted("trial", table, observed, model.law(view.named), recorded, view)


def curves(model: GravityModel, named: dict[str, Array], baseline: FrictionLaw) -> xr.Dataset:
    """Return friction against tension for each (size, n, θ), by the law and by Table I."""
    trials = model.trials
    cells = trials[["pulley_size", "n_pulleys", "wrap_angle_deg"]].drop_duplicates()
    by_size = cells["pulley_size"].map(model.sizes.index)
    cells = cells.assign(place=by_size).sort_values(["place", "wrap_angle_deg", "n_pulleys"])
    cells = cells.drop(columns="place")
    top = float(np.max(nominal_tension(model.condition, 0.0)))
    tension = np.linspace(0.0, top, CURVE_POINTS)
    printed, paper = table1_coefficients(), np.full((len(cells), CURVE_POINTS), np.nan)
    law = np.empty((len(cells), CURVE_POINTS, len(QUANTILES)))
    for place, (size, n, wrap) in enumerate(cells.itertuples(index=False)):
        draws = Coefficients(*(named[f"{c}[{size}]"][:, None] for c in ("c1", "c2", "c3")))
        law[place] = bands(baseline.at_tension(draws, n, wrap, tension))
        if size in printed:
            paper[place] = coulomb_friction(printed[size], n, wrap, tension)
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


def trajectories(
    model: GravityModel,
    gravity: Gravity,
    rig: RigConstants,
    named: dict[str, Array],
    factor: Array,
    baseline: FrictionLaw,
) -> xr.Dataset:
    """Return predicted trajectories of a few trials, from the speed at their first event."""
    trials = model.trials
    with_events = np.flatnonzero(stands_in(trials["trial"], gravity.events["trial"]))
    if not with_events.size:
        return xr.Dataset()
    pilot = pilot_fits(gravity.events, trials["trial"].iloc[with_events])
    chosen = _slow_and_fast(trials.iloc[with_events].reset_index(drop=True), pilot.acceleration)
    predicted = [
        _predicted_trial(
            model, gravity, rig, pilot, fitted, int(with_events[fitted]), named, factor, baseline
        )
        for fitted in chosen
    ]
    # Trials with fewer events are padded with NaN.
    table = xr.concat(predicted, "shown", data_vars="all", join="outer")
    return table.drop_vars("event").assign_coords(quantile=list(QUANTILES))


def _predicted_trial(
    model: GravityModel,
    gravity: Gravity,
    rig: RigConstants,
    pilot: PilotFit,
    fitted: int,
    place: int,
    named: dict[str, Array],
    factor: Array,
    baseline: FrictionLaw,
) -> xr.Dataset:
    """Return a trial, times and displacements of one sensor's events, and predictions of these.

    `fitted` is the trial's index in the pilot fit, and `place` its index in the model.
    """
    row = model.trials.iloc[place]
    events = gravity.events[gravity.events["trial"] == row["trial"]]
    since_first = events["time_s"].to_numpy() - events["time_s"].min()
    of_sensor = (events["sensor"] == events["sensor"].iloc[0]).to_numpy()
    events, since_first = events[of_sensor], since_first[of_sensor]
    time = since_first - since_first[0]
    start_speed = pilot.first_speed[fitted] + pilot.acceleration[fitted] * since_first[0]
    condition = trial_condition(row, rig)
    law = Coefficients(*(named[f"{c}[{row['pulley_size']}]"] for c in Coefficients._fields))
    friction = factor[:, place] * baseline.gravity(law, condition)
    acceleration = (condition.drive_force_n - friction) / condition.total_mass_kg
    motion = Trajectory(acceleration[:, None], start_speed)
    columns = ("pulley_size", "n_pulleys", "wrap_angle_deg", "mass_drive_kg", "mass_load_kg")
    return xr.Dataset(
        {
            "time_s": ("event", time),
            "travel_m": ("event", events["displacement_m"].to_numpy()),
            "predicted_m": (("event", "quantile"), bands(motion.position(time))),
            **{name: row[name] for name in columns},
        },
        coords={"shown": row["trial"], "event": np.arange(time.size)},
    )


def _slow_and_fast(trials: pd.DataFrame, acceleration: Array) -> list[int]:
    """Return a slow and a fast trial of each size, at most :data:`SHOWN_TRIALS` in total."""
    chosen: list[int] = []
    for _, rows in trials.groupby("pulley_size", sort=False).groups.items():
        places = np.asarray(rows)[np.argsort(acceleration[rows], kind="stable")]
        for share in (0.1, 0.9):
            place = int(places[round(share * (len(places) - 1))])
            if place not in chosen:
                chosen.append(place)
    return sorted(chosen[:SHOWN_TRIALS])
