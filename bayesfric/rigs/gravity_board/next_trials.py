"""Trials that the board could run next: conditions within what was recorded."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from bayesfric.observation.coefficients import law_of_rows
from bayesfric.observation.feasible import evenly, every_condition, levels_of
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import TRAVEL_M, coulomb_acceleration
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.trial_motion import trial_condition

PAIRS_OF_MASSES = 10  # of each size
MOVING_M_S2 = 0.1  # acceleration below which a trial might stall


def lay_out(
    measured: pd.DataFrame, rig: RigConstants, laws: Mapping[str, Coefficients]
) -> Gravity | None:
    """Return a trial at every feasible condition, its events on time by a law.

    Parameters
    ----------
    measured : DataFrame
        Trials that were recorded.
    rig : RigConstants
        The board.
    laws : mapping of str to Coefficients
        Of each pulley size.
    """

    def levels(own: pd.DataFrame) -> list[pd.DataFrame]:
        masses = own[["mass_drive_kg", "mass_load_kg"]].drop_duplicates()
        order = np.argsort((masses["mass_drive_kg"] - masses["mass_load_kg"]).to_numpy())
        pairs = masses.iloc[order[evenly(order.size, PAIRS_OF_MASSES)]]
        return [levels_of(own["n_pulleys"]), levels_of(own["wrap_angle_deg"]), pairs]

    trials = every_condition(measured, levels)
    return on_time(trials, rig, laws, ("drive",))


def on_time(
    trials: pd.DataFrame,
    rig: RigConstants,
    laws: Mapping[str, Coefficients],
    sensors: Sequence[str],
) -> Gravity | None:
    """Return those of some trials that move, with events on time by a law.

    Parameters
    ----------
    trials : DataFrame
        Conditions; measured columns are left alone.
    rig : RigConstants
        The board.
    laws : mapping of str to Coefficients
        Of each pulley size.
    sensors : sequence of str
        That see them.
    """
    law = law_of_rows(laws, trials["pulley_size"])
    rate = coulomb_acceleration(law, trial_condition(trials, rig))
    moving = rate > MOVING_M_S2
    trials = trials[moving].reset_index(drop=True)
    if trials.empty:
        return None
    spacing = rig.hall_spacing_m or 0.01
    place = np.arange(spacing / 2, rig.limits.get("travel_m", (0.0, TRAVEL_M))[1], spacing)
    time = np.sqrt(2 * place / rate[moving][:, None])
    events_of_sensor = {
        "trial": np.repeat(trials["trial"].to_numpy(), place.size),
        "displacement_m": np.tile(place - place[0], len(trials)),
        "time_s": time.ravel(),
    }
    events = pd.concat([pd.DataFrame({**events_of_sensor, "sensor": sensor}) for sensor in sensors])
    return Gravity(trials, events.reset_index(drop=True))
