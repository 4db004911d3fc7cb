"""Selects the runs of an axis that are used, cuts them into trials, and makes their windows."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bayesfric.arrays import Flags, Whole
from bayesfric.errors import Fault, InputError
from bayesfric.recording.held import SENSED
from bayesfric.recording.tables import Axis, RigConstants
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.carried import carried_by
from bayesfric.rigs.single_axis.dither import Dither, steady
from bayesfric.rigs.single_axis.enough import (
    refused_for_few_windows,
    too_little_motion,
    too_short,
    without_a_difference,
    without_force,
)
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.force_faults import clipped, spikes
from bayesfric.rigs.single_axis.lengths import with_lengths
from bayesfric.rigs.single_axis.limit import Limit, within_limit
from bayesfric.rigs.single_axis.measures import Measures, measures_of
from bayesfric.rigs.single_axis.on_time import OnTime, margin_s, on_time
from bayesfric.rigs.single_axis.other_joints import Machine, machine_of
from bayesfric.rigs.single_axis.readings import (
    LEVER,
    Readings,
    readings_of,
    rough_law_of,
)
from bayesfric.rigs.single_axis.rows import varied_columns
from bayesfric.rigs.single_axis.servo import (
    Servo,
    pull_beside_payloads,
    servo_of,
    with_open_delay,
    with_open_stiffness,
)
from bayesfric.rigs.single_axis.simulated import SimulatedBaseline, fitting, linearised, log_of
from bayesfric.simulators import SimulatorCalls

SIZE = "axis"  # stands in the column of pulley sizes
SHOWS_PLACE = 4
"""Number of reversals from which effects of the position are examined: with fewer, they cannot be
separated from changes in time."""
NO_CABLE: dict[str, Any] = {"pulley_size": SIZE, "n_pulleys": 1, "wrap_angle_deg": 85.0}


class _Logs(NamedTuple):
    """Runs on an even grid.

    Parameters
    ----------
    logs : sequence of EvenLog
        The runs in which the axis moves.
    starts : list of ndarray of int
        For each run, the samples at which its trials begin.
    rows : list of dict
        For each trial, its row of the table of trials.
    runs : list of mapping
        For each run, its row of ``axis_runs.csv``.
    """

    logs: Sequence[EvenLog]
    starts: list[Whole]
    rows: list[dict[str, Any]]
    runs: list[Mapping[str, object]]


def _interval_s(logs: Sequence[EvenLog]) -> float:
    """Return the median of the runs' sampling intervals [s]."""
    return float(np.median([log.interval_s for log in logs]))


def _on_time(logs: Sequence[EvenLog], constants: RigConstants, servo: Servo | None) -> OnTime:
    """Return logs whose force is shifted to the time at which it acts.

    The delay of a servo is estimated elsewhere, so its logs are not shifted.
    """
    if servo is not None:
        return OnTime(tuple(logs))
    margin = AXIS_RULES.early * margin_s(_interval_s(logs))
    return on_time(logs, constants.encoder_resolution, margin)


def entering(
    axis: Axis, constants: RigConstants, simulator: SimulatorCalls | None = None
) -> dict[str, Any] | Unsupported:
    """Return fields of :class:`~.trials.AxisRuns` for runs that move, or why none can be used.

    Parameters
    ----------
    axis : Axis
        The tables of the recording.
    constants : RigConstants
        The constants of the machine.
    simulator : SimulatorCalls or None
        A user's simulator, which gives a force for each window.
    """
    servo = servo_of(axis, constants)
    constants = constants if servo is None else servo.constants
    machine = machine_of(axis, constants)
    recorded = _even_logs(axis, constants, machine if simulator is None else None)
    if isinstance(recorded, Unsupported):
        return recorded
    clocked = _on_time(recorded.logs, constants, servo)
    if clocked.why_refused is not None:
        return Unsupported(clocked.why_refused)
    logs, limited, dither = _within_limit(
        clocked.logs, recorded.starts, constants, calm=servo is None
    )
    too_few = refused_for_few_windows(None if limited is None else limited[0])
    if too_few is not None:
        return too_few
    assert limited is not None
    readings = limited[0] if servo is None else _of_servo(limited[0], servo)
    table = _table_of(recorded.rows)
    measures = _measures_of(readings, logs, constants, limited[1], servo)
    turns = _turns(readings, table["run"])
    beside, readings = _beside_simulator(
        simulator, logs, recorded, readings, measures, fitting(table), constants.encoder_resolution
    )
    measures = _with_carried(readings, table, measures, varied_columns(axis.runs))
    measures = with_lengths(readings, table, measures, constants)
    is_free = turns < SHOWS_PLACE and servo is None and beside is None
    lever_n = measures.force if is_free and _may_have_weight(machine, logs) else 0.0
    readings, measures = _with_lever(readings, measures, lever_n)
    chosen = _by_setup(readings, table)
    return {
        "table": table.iloc[chosen].reset_index(drop=True),
        "readings": readings.of(chosen),
        "measures": measures,
        "interval_s": _interval_s(recorded.logs),
        "simulated": beside,
        "turns": turns,
        "machine": machine,
        "late_s": clocked.late_s,
        "dither": dither,
        "servo": servo,
        "constants": constants,
        **_faults_of_force(recorded.logs, constants, servo),
        "lever_n": lever_n,
        "stamps_sd_s": max(log.stamps_sd_s for log in recorded.logs),
    }


def _of_servo(readings: Readings, servo: Servo) -> Readings:
    """Return windows with additional columns for errors of a servo's delay and stiffness."""
    return with_open_stiffness(with_open_delay(readings, servo), servo)


def _table_of(rows: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return the table of trials; if there are few assemblies, each trial counts as one."""
    table = pd.DataFrame(rows).assign(**NO_CABLE)
    if "setup" not in table or table["setup"].nunique() < AXIS_RULES.least_setups:
        table["setup"] = table["trial"]
    return table


def _measures_of(
    readings: Readings,
    logs: Sequence[EvenLog],
    constants: RigConstants,
    limit: Limit,
    servo: Servo | None,
) -> Measures:
    """Return the measures of all runs; for a servo, payloads are fitted with the position force."""
    measures = measures_of(readings, logs, constants, limit)
    if servo is None or not readings.beside.shape[1]:
        return measures
    return replace(measures, pull=max(measures.pull, pull_beside_payloads(readings)))


def _with_carried(
    readings: Readings, table: pd.DataFrame, measures: Measures, columns: Sequence[str]
) -> Measures:
    """Return measures with the load of the gear, which may differ with columns of the runs."""
    inside = measures.limit.within(readings)
    return replace(measures, carried=carried_by(readings, inside, table, columns))


def _faults_of_force(
    logs: Sequence[EvenLog], constants: RigConstants, servo: Servo | None
) -> dict[str, float]:
    """Return the largest shares of a run's force readings that are spikes and that are clipped.

    Spikes are counted only in measured forces. Clipping is not counted in commands.
    """
    is_sensed = constants.force_is in SENSED
    is_commanded = constants.force_is == "commanded" or servo is not None
    return {
        "spikes": max(spikes(log.force) for log in logs) if is_sensed else 0.0,
        "clipped": 0.0 if is_commanded else max(float(clipped(log.force).mean()) for log in logs),
    }


def _by_setup(readings: Readings, table: pd.DataFrame) -> Whole:
    """Return indices of the trials that have windows, sorted by assembly."""
    moving = np.unique(readings.trial)
    return moving[np.argsort(pd.factorize(table["setup"])[0][moving], kind="stable")]


def _with_lever(
    readings: Readings, measures: Measures, lever_n: float
) -> tuple[Readings, Measures]:
    """Return windows and measures with the force of a weight on a lever, if there may be one.

    The load of the gear contains this force already.
    """
    if not lever_n:
        return readings, measures
    assert measures.carried is not None
    beside = np.column_stack([readings.beside, lever_n * readings.gravity_columns])
    others = np.append(measures.carried.others, np.zeros(len(LEVER)))
    carried = replace(measures.carried, others=others)
    return replace(readings, beside=beside), replace(measures, carried=carried)


def _may_have_weight(machine: Machine, logs: Sequence[EvenLog]) -> bool:
    """Return whether a weight may pull on the joint that no known force accounts for."""
    has_model = machine.bodies is not None or any(log.known_force is not None for log in logs)
    weighs = machine.constants.rotary and machine.constants.gravity_m_s2 > 0
    return weighs and not has_model and not machine.others_move


def _even_logs(axis: Axis, constants: RigConstants, machine: Machine | None) -> _Logs | Unsupported:
    """Return the runs in which the axis moves, or why none can be used.

    Forces of the machine's other joints are added to the logs, unless `machine` is None.
    """
    parts = max(1, -(-AXIS_RULES.few_runs // len(axis.runs)))
    by_run = dict(iter(axis.samples.groupby("run", sort=False)))
    moved = _Logs(logs := [], [], [], [])
    for _, run in axis.runs.iterrows():
        log = log_of(by_run[run["run"]], constants)
        if log is not None and machine is not None:
            log = machine.around(log, run["run"])
        if log is None:
            continue
        logs.append(log)
        moved.runs.append({str(name): value for name, value in run.items()})
        moved.starts.append(np.arange(parts) * (log.time_s.size // parts))
        for part in range(parts):
            name = run["run"] if parts == 1 else f"{run['run']}/{part + 1}"
            moved.rows.append({**moved.runs[-1], "trial": str(name)})
    if not logs:
        return too_short(axis)
    without = without_a_difference(axis.samples) or without_force(logs)
    return without or too_little_motion(logs, constants.encoder_resolution) or moved


def _within_limit(
    logs: Sequence[EvenLog], starts: Sequence[Whole], constants: RigConstants, *, calm: bool
) -> tuple[Sequence[EvenLog], tuple[Readings, Limit] | None, Dither]:
    """Return logs, windows and the drive's limit, with windows of dither left out if `calm`.

    The windows are None if there is none. Dither is searched for only if `calm` is true.
    """
    limited = within_limit(logs, starts, constants)
    if limited is None or not calm:
        return logs, limited, Dither()
    mass = rough_law_of(limited[0], limited[1].within(limited[0])).mass
    marked, dither = steady(logs, mass, limited[0].half_s, constants.encoder_resolution)
    if not dither.left_out:
        return list(marked), limited, dither
    calmer = within_limit(marked, starts, constants)
    if calmer is None or refused_for_few_windows(calmer[0]) is not None:
        return logs, limited, dither._replace(left_out=False)
    return list(marked), calmer, dither


def _beside_simulator(
    simulator: SimulatorCalls | None,
    logs: Sequence[EvenLog],
    recorded: _Logs,
    readings: Readings,
    measures: Measures,
    fits: Flags,
    resolution: float | None,
) -> tuple[SimulatedBaseline | None, Readings]:
    """Return a user's simulator, linear in its parameters, and windows with its force.

    The simulator is called. If there is none to call, its recorded force or path is used, if the
    log contains one; otherwise the first result is None. Its parameters are fitted to the trials
    `fits`.
    """
    if simulator is None:
        if not readings.simulated.shape[1]:
            return None, readings
        named = {"sim_force": "sim_force_n", "sim_position": "sim_position_m"}
        columns = [column for name, column in named.items() if name in logs[0].further]
        return SimulatedBaseline(" and ".join(columns)), readings

    def again(logs_within: Sequence[EvenLog]) -> Readings:
        anew = readings_of(logs_within, recorded.starts, resolution)
        if anew is None:
            expected = "a simulator that follows the measured motion for some windows"
            raise InputError([Fault(simulator.name, expected)])
        return anew

    return linearised(simulator, logs, recorded.runs, again, measures, readings.half_s, fits)


def _turns(readings: Readings, runs: pd.Series) -> int:
    """Return the number of reversals within runs."""
    run = pd.factorize(runs)[0][readings.trial]
    return int(np.sum((np.diff(readings.way) != 0) & (np.diff(run) == 0)))
