"""Rules that involve more than one cell: masses, setups, event trains, two tables."""

from collections.abc import Mapping

import numpy as np
import pandas as pd

from bayesfric.errors import Fault, near
from bayesfric.recording.cells import Table
from bayesfric.recording.csv_text import LISTED, with_more, with_rest
from bayesfric.recording.frames import did_not_move, stands_in
from bayesfric.recording.joint_rules import faults_of_samples, joint_of_run, number_of_clock
from bayesfric.recording.numbers import to_numbers_apart
from bayesfric.recording.spacing import printed_tolerance, spacing_counts
from bayesfric.recording.steady_signs import SYSTEMATIC_SHARE, pushing
from bayesfric.recording.tables import RigConstants

MEAN_TOLERANCE_DEG = 0.5  # individual wrap angles may be printed in whole degrees
LARGEST_WRAP_DEG = 180.0

FEW = 3  # up to this many displacements off the spacing are reported one by one
MINIMUM_EVENTS = 5  # for each trial and sensor
SIGNED = ["friction_n", "velocity_m_s"]
CONDITION = ["pulley_size", "n_pulleys", "wrap_angle_deg"]


def check_across(
    tables: Mapping[str, Table], rig: RigConstants, unreadable: frozenset[str]
) -> list[Fault]:
    """Return the faults that show when rows or tables are compared with each other.

    Parameters
    ----------
    tables : mapping of str to Table
        Canonical file name to table; only those that could be parsed.
    rig : RigConstants
        The constants of the rig.
    unreadable : frozenset of str
        Tables that are listed but could not be parsed. Nothing is concluded from their
        possible content.
    """
    faults: list[Fault] = []
    trials, events = tables.get("gravity_trials.csv"), tables.get("gravity_events.csv")
    if trials:
        faults += _masses(trials) + _setups(trials) + _angles(trials)
        if "gravity_events.csv" not in unreadable:
            faults += _unmeasured(trials, events) + _moved_after_all(trials, events)
    if events:
        faults += _events(events, trials, rig)
    if trials and events:
        faults += _unknown(events, trials, "trial")
    if runs := tables.get("motor_runs.csv"):
        faults += _setups(runs)
    if points := tables.get("steady_friction.csv"):
        faults += _conventions(points)
    runs, samples = tables.get("axis_runs.csv"), tables.get("axis_samples.csv")
    if samples and samples.has("run"):
        faults += _not_increasing(samples, number_of_clock(samples), joint_of_run(samples))
    faults += faults_of_samples(tables, rig)
    if runs and samples:
        faults += _unknown(samples, runs, "run") + _runs_without_samples(runs, samples)
    return faults


def _masses(trials: Table) -> list[Fault]:
    if not trials.has("mass_drive_kg", "mass_load_kg"):
        return []
    wrong = trials.frame["mass_drive_kg"] <= trials.frame["mass_load_kg"]
    expected = "more than mass_load_kg of the same row"
    if wrong.sum() > 1 and wrong.all():
        expected += " (are the columns swapped?)"
        return trials.first_where(wrong, "mass_drive_kg", expected)
    return trials.faults_where(wrong, "mass_drive_kg", expected)


def _setups(table: Table) -> list[Fault]:
    if not table.has("setup", *CONDITION):
        return []
    complete = table.frame.dropna(subset=["setup", *CONDITION])
    first = complete.groupby("setup")[CONDITION].transform("first")
    differs = (complete[CONDITION] != first).any(axis=1)
    expected = "one pulley_size, n_pulleys and wrap_angle_deg for all rows of a setup"
    return table.faults_where(
        differs.reindex(table.frame.index, fill_value=False), "setup", expected
    )


def _unmeasured(trials: Table, events: Table | None) -> list[Fault]:
    if not trials.has("trial") or (events and not events.has("trial")):
        return []
    trial, text = trials.frame["trial"], trials.text.cells
    missing = trial.notna()
    if "acceleration_m_s2" in text:  # a written but wrong acceleration is already a fault
        missing &= text["acceleration_m_s2"] == ""
    if events:
        missing &= ~stands_in(trial, events.frame["trial"])
    expected = "events of this trial in gravity_events.csv, or its acceleration_m_s2"
    return trials.faults_where(
        missing & ~did_not_move(trials.frame), "trial", f"{expected}, or did_not_move true"
    )


def _moved_after_all(trials: Table, events: Table | None) -> list[Fault]:
    if not trials.has("trial", "did_not_move"):
        return []
    moved = pd.Series(False, index=trials.frame.index)
    if events and events.has("trial"):
        moved |= stands_in(trials.frame["trial"], events.frame["trial"])
    if trials.has("acceleration_m_s2"):
        moved |= trials.frame["acceleration_m_s2"].notna()
    expected = "nothing, or false: the trial has events or an acceleration"
    return trials.faults_where(did_not_move(trials.frame) & moved, "did_not_move", expected)


def _angles(trials: Table) -> list[Fault]:
    """Faults of individual wrap angles: one for each pulley, with the mean of `wrap_angle_deg`."""
    column = "wrap_angles_deg"
    if not trials.has(column, "n_pulleys", "wrap_angle_deg"):
        return []
    frame = trials.frame
    faults = []
    for row in np.flatnonzero(frame[column].notna()).tolist():
        count, mean = frame.loc[row, ["n_pulleys", "wrap_angle_deg"]]
        angles = to_numbers_apart(str(frame.loc[row, column]))
        inside = bool(((angles >= 0) & (angles <= LARGEST_WRAP_DEG)).all())
        if not inside:
            expected = f"numbers from 0 to {LARGEST_WRAP_DEG:g}, separated by blanks"
        elif angles.size != count:
            expected = f"as many angles as pulleys, {count:g}"
        elif not abs(angles.mean() - mean) <= MEAN_TOLERANCE_DEG:
            expected = f"a mean within {MEAN_TOLERANCE_DEG:g}° of wrap_angle_deg, {mean:g}"
        else:
            continue
        faults += trials.text.faults_at([row], column, expected)
    return with_rest(faults[:LISTED], len(faults[LISTED:]))


def _unknown(child: Table, parent: Table, key: str) -> list[Fault]:
    if not (child.has(key) and parent.has(key)):
        return []
    ids, there = child.frame[key], parent.frame[key].dropna()
    unknown = ids[~ids.isin(there) & ids.notna() & ~child.text.is_ragged].astype(str)
    expected = f"a {key} of {parent.text.file}"
    rows = unknown.value_counts()
    faults = []
    for position, name in unknown.drop_duplicates().head(LISTED).items():
        first = child.faults_where(ids.index == position, key, expected + near(name, there))
        faults += with_rest(first, int(rows[name]) - 1)
    return with_more(faults, len(unknown) - sum(1 + fault.like for fault in faults))


def _runs_without_samples(runs: Table, samples: Table) -> list[Fault]:
    if not (runs.has("run") and samples.has("run")):
        return []
    run = runs.frame["run"]
    missing = run.notna() & ~stands_in(run, samples.frame["run"])
    return runs.faults_where(missing, "run", f"samples of this run in {samples.text.file}")


def _events(events: Table, trials: Table | None, rig: RigConstants) -> list[Fault]:
    keys = ["trial", "sensor"]
    if not events.has(*keys):
        return []
    faults: list[Fault] = []
    frame = events.frame[keys]
    if trials is not None and trials.has("trial"):
        frame = frame.assign(trial=frame["trial"].where(frame["trial"].isin(trials.frame["trial"])))
    train = frame.groupby(keys, sort=False, observed=True).ngroup()
    train = train.where(frame.notna().all(axis=1))
    lost = _of_unknown_end(frame)
    size = train.groupby(train).transform("size") + lost
    few = ~train.duplicated() & train.notna() & (size < MINIMUM_EVENTS)
    positions = np.flatnonzero(few)
    for position in positions[:LISTED].tolist():
        trial, sensor = events.frame.loc[position, keys]
        expected = f"at least {MINIMUM_EVENTS} events of trial {trial!r} and sensor {sensor!r}"
        expected += f", there are {(train == train[position]).sum()}"
        faults += events.text.faults_at([position], "trial", expected)
    faults = with_rest(faults, len(positions) - len(faults))
    begins = train.notna() & ~train.duplicated() & (lost == 0) & ~few
    return (
        faults + _not_increasing(events, train, keys) + _displacements(events, train, begins, rig)
    )


def _of_unknown_end(events: pd.DataFrame) -> "pd.Series[int]":
    """Return, for each event, how many unreadable rows may belong to the same train."""
    trial, endless = events["trial"], events["sensor"].isna()
    of_any = int(trial.isna().sum())
    if not endless.any():
        return pd.Series(of_any, index=events.index)
    by_trial = trial[endless].value_counts()
    return trial.astype(object).map(by_trial).fillna(0).astype(int) + of_any


def _conventions(points: Table) -> list[Fault]:
    """Faults of points that contradict every convention for the sign of friction."""
    complete = points.frame.dropna(subset=[c for c in SIGNED if c in points.frame])
    if not points.has("friction_n") or complete.empty:
        return []
    push = pushing(complete)
    if push.mean() <= SYSTEMATIC_SHARE:
        return []
    expected = (
        "friction as its size, with the sign of velocity_m_s, or against it, in all rows alike: "
        f"{push.sum()} of {len(complete)} rows push; a weight or a bias is to be taken off first"
    )
    mask = pd.Series(push, index=complete.index).reindex(points.frame.index, fill_value=False)
    return points.first_where(mask, "friction_n", expected)


def _not_increasing(table: Table, group: pd.Series, keys: list[str]) -> list[Fault]:
    column = "time_s"
    if not table.has(column):
        return []
    values = table.frame[column]
    previous = values.groupby(group, sort=False).shift()
    expected = f"more than the {column} before it, within a {' and '.join(keys)}"
    return table.faults_where(values <= previous, column, expected)


def _displacements(
    events: Table, train: pd.Series, begins: pd.Series, rig: RigConstants
) -> list[Fault]:
    column = "displacement_m"
    if not events.has(column) or rig.hall_spacing_m is None:
        return []
    spacing, values = rig.hall_spacing_m, events.frame[column]
    counts = pd.Series(spacing_counts(values.to_numpy(), spacing), index=values.index)
    tolerance = printed_tolerance(events.text.cells[column], spacing)
    not_zero = begins & (values.abs() > tolerance)
    off = ~not_zero & ((counts * spacing - values).abs() > tolerance)
    previous = counts.groupby(train, sort=False).shift()
    back = ~off & (counts <= previous)
    expected = f"a multiple of rig.hall_spacing_m, {spacing:g} m"
    most = LISTED
    if off.sum() > FEW and off.sum() > SYSTEMATIC_SHARE * (values != 0).sum():
        expected, most = f"{expected} (is that the spacing of these events?)", 1
    return (
        events.faults_where(not_zero, column, "0 at the first event of a trial and sensor")
        + events.text.faults_at(np.flatnonzero(off), column, expected, most=most)
        + events.faults_where(
            back, column, "more than the displacement before it, within a trial and sensor"
        )
    )
