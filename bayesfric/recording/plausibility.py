"""Checks for physically impossible values, with the most likely mistake of unit.

Each table gets one fault per mistake: if one row is in grams, all rows are.
"""

from collections.abc import Collection, Mapping

import numpy as np
import pandas as pd

from bayesfric.errors import Fault
from bayesfric.recording.cells import Table
from bayesfric.recording.energy import (
    drops_the_weight,
    gains_energy,
    motor_pull,
    pushes_a_cable,
    tears_a_cable,
)
from bayesfric.recording.joint_rules import number_of_clock
from bayesfric.recording.tables import RigConstants

COARSEST_S = 1.0  # largest sample interval: a longer one hides the motion in between
FARTHEST_M = 100.0  # longest travel of a sliding axis, unless its limits say more


CABLE_BEARS_N = 311.0  # strength of the paper's 0.61 mm 7×19 stainless cable
MOST_PULLEYS, LEAST_WRAP_DEG = 19, 45.0  # of the paper; to find exchanged columns
RADIANS_BELOW = 3.2  # wrap angles are tens of degrees: all below π means radians
MINUTE_S = 60.0
SLOWEST_M_S = 0.5 / MINUTE_S  # half a metre of travel takes seconds, not minutes
FASTEST_M_S = 50.0  # fastest cable on a bench
TRAIN = 20  # least number of events for an acceleration, so that odd intervals do not matter
STRAY = 3.0  # times g: tolerance for a missed or doubled event, which is no fault


def implausible(
    tables: Mapping[str, Table], rig: RigConstants, at_fault: Collection[str]
) -> list[Fault]:
    """Return the faults of numbers that no rig can produce.

    Parameters
    ----------
    tables : mapping of str to Table
        Canonical file name to table; only those that could be parsed.
    rig : RigConstants
        The constants of the rig; ``limits.tension_n`` is the strength of its cable.
    at_fault : collection of str
        Files with faults of another kind; their motions are not checked.
    """
    faults: list[Fault] = []
    for file in ("gravity_trials.csv", "motor_runs.csv", "steady_friction.csv"):
        if table := tables.get(file):
            faults += _radians(table) or _swapped(table)
    if trials := tables.get("gravity_trials.csv"):
        if trials.has("mass_drive_kg", "mass_load_kg"):
            mass = (trials.frame["mass_drive_kg"] + trials.frame["mass_load_kg"]) / 2
            faults += _overloaded(trials, "mass_drive_kg", mass * rig.gravity_m_s2, rig, "grams")
        faults += _faster_than_falling(trials, rig)
    events = tables.get("gravity_events.csv")
    if events and events.text.file not in at_fault:
        faults += _motions(events, trials, rig)
    if runs := tables.get("motor_runs.csv"):
        if runs.has("hanging_mass_kg"):
            faults += _pulls(runs, tables.get("motor_idle.csv"), rig)
        faults += _too_fast(runs)
    points = tables.get("steady_friction.csv")
    if points and not rig.rotary:
        # Without pulleys it may be a slide or a belt, whose strength is in its limits.
        on_pulleys = points.has("n_pulleys") or points.has("pulley_size")
        if points.has("tension_n") and (on_pulleys or "tension_n" in rig.limits):
            tension = points.frame["tension_n"]
            faults += _overloaded(points, "tension_n", tension, rig, "millinewtons or grams")
        if on_pulleys:
            faults += tears_a_cable(points)
        faults += _too_fast(points)
    samples = tables.get("axis_samples.csv")
    if samples and samples.text.file not in at_fault:
        faults += axis_in_other_units(samples, rig)
    return faults


def _radians(table: Table) -> list[Fault]:
    column = "wrap_angle_deg"
    if not table.has(column):
        return []
    angles = table.frame[column].dropna()
    if angles.empty or not 0 < angles.max() < RADIANS_BELOW:
        return []
    expected = f"wrap angles in degrees; all are below {RADIANS_BELOW:g} (are they in radians?)"
    return table.first_where(table.frame[column].notna(), column, expected)


def _swapped(table: Table) -> list[Fault]:
    """Return the fault of a table whose pulley counts and wrap angles are exchanged."""
    if not table.has("n_pulleys", "wrap_angle_deg"):
        return []
    numbers, angles = table.frame["n_pulleys"], table.frame["wrap_angle_deg"]
    if not (numbers.min() >= LEAST_WRAP_DEG and angles.max() <= MOST_PULLEYS):  # NaN: no entry
        return []
    expected = "a number of pulleys (are n_pulleys and wrap_angle_deg swapped?)"
    return table.first_where(table.frame["n_pulleys"].notna(), "n_pulleys", expected)


def _overloaded(
    table: Table, column: str, tension_n: pd.Series, rig: RigConstants, mistake: str
) -> list[Fault]:
    limit = rig.limits.get("tension_n")
    bears = float(limit[1]) if limit else CABLE_BEARS_N
    over = tension_n > bears
    if not over.any():
        return []
    tension = float(tension_n[over].iloc[0])
    expected = (
        f"a tension of at most {bears:g} N, what the cable bears (rig.limits.tension_n), "
        f"and not {tension:,.0f} N (are they {mistake}?)"
    )
    return table.first_where(over, column, expected)


def _faster_than_falling(trials: Table, rig: RigConstants) -> list[Fault]:
    column = "acceleration_m_s2"
    if not trials.has(column):
        return []
    expected = (
        f"less than g, {rig.gravity_m_s2:g} m/s²: no cable accelerates faster than its weights "
        "fall (is it in mm/s² or cm/s²?)"
    )
    falling = trials.frame[column].abs() >= rig.gravity_m_s2
    measured = trials.frame[column].dropna()
    return trials.first_where(falling, column, expected) or gains_energy(
        trials, measured, rig, column
    )


def _pulls(runs: Table, idle: Table | None, rig: RigConstants) -> list[Fault]:
    """Return the faults of weights beyond the cable's strength, and of impossible currents."""
    weight = runs.frame["hanging_mass_kg"] * rig.gravity_m_s2
    faults = _overloaded(runs, "hanging_mass_kg", weight, rig, "grams")
    pull = motor_pull(runs, idle, rig) if idle else None
    if faults or pull is None:
        return faults
    mistake = "in milliamperes, or is the torque constant in mN·m/A"
    return (
        _overloaded(runs, "current_a", (weight + pull) / 2, rig, mistake)
        or pushes_a_cable(runs, pull, weight)
        or drops_the_weight(runs, pull, weight)
    )


def _too_fast(table: Table) -> list[Fault]:
    column = "velocity_m_s"
    if not table.has(column):
        return []
    expected = f"a speed of at most {FASTEST_M_S:g} m/s (is it in mm/s?)"
    return table.first_where(table.frame[column].abs() > FASTEST_M_S, column, expected)


def _motions(events: Table, trials: Table | None, rig: RigConstants) -> list[Fault]:
    """Return faults of whole trains of events, from their first, middle and last event."""
    keys = ["trial", "sensor"]
    if rig.hall_spacing_m is None or not events.has(*keys, "displacement_m", "time_s"):
        return []
    whole = events.frame.dropna(subset=[*keys, "displacement_m", "time_s"])
    groups = whole.groupby(keys, sort=False)
    place = pd.DataFrame({"row": groups.cumcount(), "size": groups["time_s"].transform("size")})
    long_enough = place["size"] >= 3
    first, middle, last = (
        whole[long_enough & (place["row"] == row)].reset_index()
        for row in (0, place["size"] // 2, place["size"] - 1)
    )
    if first.empty:
        return []
    x, t = (
        [events_at[column].to_numpy() for events_at in (first, middle, last)]
        for column in ("displacement_m", "time_s")
    )
    speed = (x[2] - x[0]) / (t[2] - t[0])
    before, after = (x[1] - x[0]) / (t[1] - t[0]), (x[2] - x[1]) / (t[2] - t[1])
    acceleration = 2 * (after - before) / (t[2] - t[0])

    def at(wrong: np.ndarray, expected: str) -> list[Fault]:
        rows = first["index"].to_numpy()[wrong]
        return events.text.faults_at(rows, "time_s", expected, most=1)

    slow = (t[2] - t[0] > MINUTE_S) & (speed < SLOWEST_M_S)
    fast = np.abs(acceleration) > STRAY * rig.gravity_m_s2
    faults = at(
        slow,
        "times in s: this trial would take minutes for half a metre (are they in milliseconds "
        "or microseconds?)",
    ) + at(
        fast,
        "a motion that weights can drive: this trial would change its speed faster than a "
        f"weight falls, at {rig.gravity_m_s2:g} m/s² (are time and displacement in s and m?)",
    )
    if faults or trials is None or not trials.has("trial"):
        return faults
    long = place.loc[first["index"], "size"].to_numpy() >= TRAIN
    of_trial = pd.Series(acceleration[long], index=first["trial"][long]).groupby(level=0).median()
    of_row = trials.frame["trial"].map(of_trial).dropna() if not of_trial.empty else of_trial
    return gains_energy(trials, of_row, rig, "mass_drive_kg")


def axis_in_other_units(samples: Table, rig: RigConstants) -> list[Fault]:
    """Return the faults of a log whose clock or travel is impossible for an axis.

    Parameters
    ----------
    samples : Table
        ``axis_samples.csv``.
    rig : RigConstants
        ``limits.travel_m`` is its travel; ``rotary`` says that it turns.
    """
    if not samples.has("run", "time_s", "position_m"):
        return []
    return _coarse(samples) + ([] if rig.rotary else _far(samples, rig))


def _coarse(samples: Table) -> list[Fault]:
    group = number_of_clock(samples)
    interval = samples.frame["time_s"].groupby(group).diff().groupby(group).transform("median")
    rows = np.flatnonzero(interval >= COARSEST_S)
    if not rows.size:
        return []
    expected = (
        f"a time in s, samples less than {COARSEST_S:g} s apart and not "
        f"{interval.iloc[rows[0]]:g} s (are they in milliseconds or microseconds? Friction at "
        "steady speed, however slow, belongs in steady_friction.csv)"
    )
    return samples.text.faults_at(rows[1:], "time_s", expected, most=1)


def _far(samples: Table, rig: RigConstants) -> list[Fault]:
    groups = samples.frame["position_m"].groupby(number_of_clock(samples))
    travel = groups.transform("max") - groups.transform("min")
    most = max(FARTHEST_M, float(rig.limits.get("travel_m", [0.0, 0.0])[1]))
    rows = np.flatnonzero(travel > most)
    if not rows.size:
        return []
    expected = (
        f"a run that goes at most {most:g} m (rig.limits.travel_m), and not "
        f"{travel.iloc[rows[0]]:,.0f} m (is it in millimetres, or in degrees of an axis that "
        "turns? That is in rad, with rig.rotary)"
    )
    return samples.text.faults_at(rows, "position_m", expected, most=1)
