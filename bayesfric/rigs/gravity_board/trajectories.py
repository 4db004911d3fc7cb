"""A few trials, predicted from their first speed alone."""

import numpy as np
import pandas as pd
import xarray as xr

from bayesfric.arrays import Array
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import Condition, Trajectory
from bayesfric.physics.laws import FrictionLaw
from bayesfric.recording.frames import stands_in
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.bands import QUANTILES, bands
from bayesfric.rigs.gravity_board.likelihood import GravityModel
from bayesfric.rigs.gravity_board.trial_motion import PilotFit, pilot_fits

SHOWN_TRIALS = 6


def trajectories(
    model: GravityModel,
    gravity: Gravity,
    rig: RigConstants,
    named: dict[str, Array],
    factor: Array,
    baseline: FrictionLaw,
) -> xr.Dataset:
    """Predict a few trials, free-running from the first event's speed."""
    trials = model.trials
    with_events = np.flatnonzero(stands_in(trials["trial"], gravity.events["trial"]))
    if not with_events.size:
        return xr.Dataset()
    pilot = pilot_fits(gravity.events, trials["trial"].iloc[with_events])
    chosen = _typical(trials.iloc[with_events].reset_index(drop=True), pilot.acceleration)
    predicted = [
        _predicted(
            model, gravity, rig, pilot, fitted, int(with_events[fitted]), named, factor, baseline
        )
        for fitted in chosen
    ]
    longest = max(len(time) for _, time, _, _ in predicted)

    def padded(values: Array) -> Array:
        width = [(0, longest - len(values))] + [(0, 0)] * (values.ndim - 1)
        return np.pad(values, width, constant_values=np.nan)

    return xr.Dataset(
        {
            "time_s": (("shown", "event"), np.stack([padded(t) for _, t, _, _ in predicted])),
            "travel_m": (("shown", "event"), np.stack([padded(x) for _, _, x, _ in predicted])),
            "predicted_m": (
                ("shown", "event", "quantile"),
                np.stack([padded(p) for _, _, _, p in predicted]),
            ),
            **{
                name: ("shown", np.array([row[name] for row, _, _, _ in predicted]))
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
            "shown": [row["trial"] for row, _, _, _ in predicted],
            "quantile": list(QUANTILES),
        },
    )


def _predicted(
    model: GravityModel,
    gravity: Gravity,
    rig: RigConstants,
    pilot: PilotFit,
    fitted: int,
    place: int,
    named: dict[str, Array],
    factor: Array,
    baseline: FrictionLaw,
) -> tuple[pd.Series, Array, Array, Array]:
    """Return a trial, the times and places of its first sensor's events, and those predicted.

    `fitted` is its place among the pilot's trials, and `place` among the model's.
    """
    row = model.trials.iloc[place]
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
    motion = Trajectory(acceleration[:, None], start_speed)
    return row, time, events["displacement_m"].to_numpy(), bands(motion.position(time))


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
