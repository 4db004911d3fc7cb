"""Which trials of the gravity board enter a fit, by stated rules.

Rule `stalled`: by its pilot fit, the cable stops before it would have reached
the next event of the trial, or was slower than zero on the way. The trial leaves
the fit and is listed.
"""

from dataclasses import dataclass

import pandas as pd

from bayesfric.likelihood.hall_events import pilot_fits
from bayesfric.recording.tables import Gravity, Rig

__all__ = ["RULES", "Screened", "screen_trials"]

RULES = {
    "stalled": "the cable stops before the next event would have been reached",
}
"""Why a trial leaves the fit, rule to sentence."""


@dataclass(frozen=True)
class Screened:
    """The trials that enter, and the rest with the rule that excluded each.

    Parameters
    ----------
    gravity : Gravity
        Trials that enter, sorted by setup in order of appearance, and their events.
    excluded : dict of str to str
        Trial id to the name of a rule.
    """

    gravity: Gravity
    excluded: dict[str, str]


def screen_trials(gravity: Gravity, rig: Rig) -> Screened:
    """Apply the rules.

    Parameters
    ----------
    gravity : Gravity
        As recorded.
    rig : Rig
        For the spacing of events.

    Returns
    -------
    Screened
        What enters, and what does not.
    """
    assert rig.hall_spacing_m
    trials = gravity.trials
    pilot = pilot_fits(gravity.events, trials["trial"])
    next_speed2 = pilot.last_speed**2 + 2 * pilot.acceleration * rig.hall_spacing_m
    stalled = (next_speed2 <= 0) | (pilot.least_speed <= 0)
    excluded = dict.fromkeys(trials["trial"][stalled], "stalled")
    kept = trials[~stalled]
    by_setup = kept.iloc[pd.factorize(kept["setup"])[0].argsort(kind="stable")]
    events = gravity.events[gravity.events["trial"].isin(by_setup["trial"])]
    return Screened(Gravity(by_setup.reset_index(drop=True), events), excluded)
