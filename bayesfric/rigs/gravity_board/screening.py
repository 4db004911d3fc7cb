"""Selection of the gravity board's trials for a fit, by stated rules.

Events are repaired first (:mod:`bayesfric.rigs.gravity_board.event_repair`). Then the rules of
:data:`RULES` are applied in their order, and a trial is excluded by the first rule that it breaks.
A trial with an acceleration and no events breaks none of them. Excluding trials with high friction
would bias friction. Therefore a trial that did not move is used as a bound, and a trial that stops
is used with its events up to the stop.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayesfric.recording.consistency import MINIMUM_EVENTS
from bayesfric.recording.frames import did_not_move, stands_in
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.event_repair import LARGEST_SHARE, repair_events
from bayesfric.rigs.gravity_board.sensor_agreement import (
    MATERIAL_SHARE,
    TAIL,
    SensorAgreement,
    sensor_agreement,
)
from bayesfric.rigs.gravity_board.sensor_clocks import (
    SensorClocks,
    on_one_clock,
    sensor_clocks,
)
from bayesfric.rigs.gravity_board.trial_motion import pilot_fits

RULES = {
    "unrepairable-events": (
        f"no sensor is left: of each, more than {LARGEST_SHARE:.0%} of the events were missed, "
        f"doubled or stray, fewer than {MINIMUM_EVENTS} remain, or no smooth motion fits them"
    ),
    "stalled": "a smooth motion through its events comes to a stop before the last of them",
    "size-at-rest": "it did not move, and neither did any other trial of its pulley size",
    "sensors-disagree": (
        "the two sensors' accelerations differ by more than noise explains in "
        f"{1 - TAIL:.2%} of trials, and their frictions by more than {MATERIAL_SHARE:.0%}"
    ),
}
"""Rules by which a trial is excluded from a fit, as sentences by name."""

SELECTS_ON = {
    "unrepairable-events": "the sensors, whatever the friction was",
    "stalled": "friction: trials with high friction are excluded, and the estimated friction is "
    "too low",
    "size-at-rest": "friction: nothing but a lower bound is known of this size",
    "sensors-disagree": "the sensors, and a cable that slips or stretches on one side",
}
"""Quantity on which each rule selects, which determines how the remaining trials are biased."""


@dataclass(frozen=True)
class Screened:
    """The trials that are used, and the excluded ones with their rules.

    Parameters
    ----------
    gravity : Gravity
        Trials that are used, sorted by assembly in order of appearance, and their repaired
        events. They include trials with only an acceleration.
    excluded : dict of str to str
        Name of the rule for each excluded trial.
    repaired : DataFrame
        One row for each trial and sensor whose events were repaired or dropped: `trial`,
        `sensor`, `missed`, `doubled`, `removed` and `used`; see
        :class:`bayesfric.rigs.gravity_board.event_repair.RepairedEvents`.
    agreement : SensorAgreement
        Agreement of the sensors of trials with two sensors, including excluded trials.
    clocks : SensorClocks
        Differences of the clocks of these sensors.
    stalled : tuple of str
        Trials that stop before the end of the travel, whether excluded or not.
    at_rest : DataFrame
        Trials that did not move and are used as bounds. They have a pulley size of which other
        trials are used, and not the role ``test``.
    """

    gravity: Gravity
    excluded: dict[str, str]
    repaired: pd.DataFrame
    agreement: SensorAgreement
    clocks: SensorClocks
    stalled: tuple[str, ...]
    at_rest: pd.DataFrame


def screen_trials(gravity: Gravity, rig: RigConstants, *, exclude: bool = True) -> Screened:
    """Repair the events and apply the rules.

    Parameters
    ----------
    gravity : Gravity
        Recorded trials and events; there may be no events.
    rig : RigConstants
        Constants of the board, such as the spacing of events.
    exclude : bool
        False ignores the rule ``sensors-disagree``. The other rules always apply, because a
        likelihood needs events, and a positive speed of the pilot fit at each event.

    Returns
    -------
    Screened
        Used and excluded trials.
    """
    at_rest = did_not_move(gravity.trials)
    still, trials = gravity.trials[at_rest], gravity.trials[~at_rest]
    events = gravity.events
    recorded = stands_in(trials["trial"], events["trial"])
    repaired = pd.DataFrame(columns=["trial", "sensor", "missed", "doubled", "removed", "used"])
    if recorded.any():
        assert rig.hall_spacing_m
        repair = repair_events(events, trials["trial"], spacing_m=rig.hall_spacing_m)
        events, repaired = repair.events, repair.repaired
    left = stands_in(trials["trial"], events["trial"])
    clocks = sensor_clocks(events, trials["trial"][left], rig)
    events = on_one_clock(events, clocks, rig)
    excluded = dict.fromkeys(trials["trial"][recorded & ~left], "unrepairable-events")
    stalled, stopped = _stalled(events, trials["trial"][left], rig)
    excluded |= dict.fromkeys(stopped, "stalled")
    agreement = sensor_agreement(events, trials[left], rig)
    if exclude:
        disagreeing = agreement.trials["trial"][agreement.trials["disagrees"].astype(bool)]
        excluded = dict.fromkeys(disagreeing, "sensors-disagree") | excluded
    kept = trials[~trials["trial"].isin(excluded)]
    bounding = still["pulley_size"].isin(kept["pulley_size"])
    excluded |= dict.fromkeys(still["trial"][~bounding], "size-at-rest")
    if "role" in still:
        bounding &= still["role"] != "test"
    recorded_ids = gravity.trials["trial"]
    in_order = {trial: excluded[trial] for trial in recorded_ids if trial in excluded}
    by_trial = kept.iloc[pd.factorize(kept["setup"])[0].argsort(kind="stable")]
    return Screened(
        Gravity(by_trial.reset_index(drop=True), events[events["trial"].isin(kept["trial"])]),
        in_order,
        repaired,
        agreement,
        clocks,
        tuple(stalled),
        still[bounding].reset_index(drop=True),
    )


def _stalled(
    events: pd.DataFrame, trial_ids: pd.Series, rig: RigConstants
) -> tuple[list[str], list[str]]:
    """Return the trials that stall, and those of them that stop before their last event."""
    if trial_ids.empty:
        return [], []
    assert rig.hall_spacing_m
    pilot = pilot_fits(events, trial_ids)
    next_speed2 = pilot.last_speed**2 + 2 * pilot.acceleration * rig.hall_spacing_m
    stopped = pilot.least_speed <= 0
    stalled = stopped | (next_speed2 <= 0)
    names = trial_ids.to_numpy()
    return names[stalled].tolist(), names[np.asarray(stopped)].tolist()
