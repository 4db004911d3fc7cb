"""Which runs of an axis enter, whole or in parts, and their rows."""

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
from bayesfric.rigs.single_axis.even_log import EvenLog, clipped, spikes
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
    with_lever,
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

SIZE = "axis"  # in the place of a pulley size
SHOWS_PLACE = 4
"""From so many turns on what goes with the place is examined, for it is told from time."""
NO_CABLE: dict[str, Any] = {"pulley_size": SIZE, "n_pulleys": 1, "wrap_angle_deg": 85.0}


class Entering(NamedTuple):
    """What of a log enters: fields of :class:`bayesfric.rigs.single_axis.trials.AxisRuns`."""

    table: pd.DataFrame
    readings: Readings
    measures: Measures
    still: tuple[str, ...]
    interval_s: float
    simulated: SimulatedBaseline | None
    turns: int
    machine: Machine
    late_s: float
    dither: Dither
    servo: Servo | None
    constants: RigConstants
    spikes: float
    clipped: float
    lever_n: float
    stamps_sd_s: float


class _Logs(NamedTuple):
    """Runs on an even grid: where their parts begin, their rows in the tables, and still ones."""

    logs: Sequence[EvenLog]
    starts: list[Whole]
    rows: list[dict[str, Any]]
    runs: list[Mapping[str, object]]
    still: list[str]


def _interval_s(logs: Sequence[EvenLog]) -> float:
    """Return the time between two samples of a log that is like most."""
    return float(np.median([log.interval_s for log in logs]))


def _on_time(logs: Sequence[EvenLog], constants: RigConstants, servo: Servo | None) -> OnTime:
    """Return logs whose force stands where it acts; a servo's log has its delay in it already."""
    if servo is not None:
        return OnTime(tuple(logs))
    margin = AXIS_RULES.early * margin_s(_interval_s(logs))
    return on_time(logs, constants.encoder_resolution, margin)


def entering(
    axis: Axis, constants: RigConstants, simulator: SimulatorCalls | None = None
) -> Entering | Unsupported:
    """Return the runs in which the axis moves, cut in parts where they are few, or why none enters.

    Parameters
    ----------
    axis : Axis
        The tables.
    constants : RigConstants
        The machine.
    simulator : SimulatorCalls or None
        A user's, whose force is looked for beside the rows.
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
    chosen, still = _by_setup(readings, table)
    return Entering(
        table.iloc[chosen].reset_index(drop=True),
        readings.of(chosen),
        measures,
        (*recorded.still, *still),
        _interval_s(recorded.logs),
        beside,
        turns,
        machine,
        clocked.late_s,
        dither,
        servo,
        constants,
        *_faults_of_force(recorded.logs, constants, servo),
        lever_n,
        max(log.stamps_sd_s for log in recorded.logs),
    )


def _of_servo(readings: Readings, servo: Servo) -> Readings:
    """Return rows beside which the delay and the stiffness of a servo's loop are open."""
    return with_open_stiffness(with_open_delay(readings, servo), servo)


def _table_of(rows: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return the table of trials; where assemblies are few, each trial stands for one."""
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
    """Return the measures of all runs; payloads of a servo tell what it pulls."""
    measures = measures_of(readings, logs, constants, limit)
    if servo is None or not readings.beside.shape[1]:
        return measures
    return replace(measures, pull=max(measures.pull, pull_beside_payloads(readings)))


def _with_carried(
    readings: Readings, table: pd.DataFrame, measures: Measures, columns: Sequence[str]
) -> Measures:
    """Return measures that know what the gear carries, by columns of the runs that vary."""
    inside = measures.limit.within(readings)
    return replace(measures, carried=carried_by(readings, inside, table, columns))


def _faults_of_force(
    logs: Sequence[EvenLog], constants: RigConstants, servo: Servo | None
) -> tuple[float, float]:
    """Return the spikes of a measured force, and the largest share of a log that is clipped."""
    peaks = max(spikes(log.force) for log in logs) if constants.force_is in SENSED else 0.0
    if constants.force_is == "commanded" or servo is not None:
        return peaks, 0.0
    return peaks, max(float(clipped(log.force).mean()) for log in logs)


def _by_setup(readings: Readings, table: pd.DataFrame) -> tuple[Whole, list[str]]:
    """Return the places of runs that have windows, by assembly, and the names of the others."""
    moving = np.unique(readings.trial)
    still = [str(run) for run in table["trial"][~table.index.isin(moving)]]
    return moving[np.argsort(pd.factorize(table["setup"])[0][moving], kind="stable")], still


def _with_lever(
    readings: Readings, measures: Measures, lever_n: float
) -> tuple[Readings, Measures]:
    """Return rows beside which a weight may pull, and measures that know of it."""
    if not lever_n:
        return readings, measures
    assert measures.carried is not None
    carried = measures.carried.beside_more(LEVER)
    return with_lever(readings, lever_n), replace(measures, carried=carried)


def _may_have_weight(machine: Machine, logs: Sequence[EvenLog]) -> bool:
    """Return whether a weight may pull with the angle that nothing in the rows stands for."""
    has_model = machine.bodies is not None or any(log.known_force is not None for log in logs)
    weighs = machine.constants.rotary and machine.constants.gravity_m_s2 > 0
    return weighs and not has_model and not machine.others_move


def _even_logs(axis: Axis, constants: RigConstants, machine: Machine | None) -> _Logs | Unsupported:
    """Return the runs in which the axis moves, or why none tells anything.

    What the machine's other joints pull with stands beside the logs, unless it is None.
    """
    parts = max(1, -(-AXIS_RULES.few_runs // len(axis.runs)))
    by_run = dict(iter(axis.samples.groupby("run", sort=False)))
    moved = _Logs(logs := [], [], [], [], [])
    for _, run in axis.runs.iterrows():
        log = log_of(by_run[run["run"]], constants)
        if log is not None and machine is not None:
            log = machine.around(log, run["run"])
        if log is None:
            moved.still.append(str(run["run"]))
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
    """Return windows within what the drive gives, of logs without what shakes the axis.

    What shakes is looked for only where `calm` is asked for.
    """
    resolution, clips = constants.encoder_resolution, constants.force_is not in SENSED
    declared = constants.force_limit_n
    limited = within_limit(logs, starts, resolution, clips=clips, declared=declared)
    if limited is None or not calm:
        return logs, limited, Dither()
    mass = rough_law_of(limited[0], limited[1].within(limited[0])).mass
    marked, dither = steady(logs, mass, limited[0].half_s, resolution)
    if not dither.left_out:
        return list(marked), limited, dither
    calmer = within_limit(marked, starts, resolution, clips=clips, declared=declared)
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
    """Return a user's simulator as it stands beside the windows, None without, and the windows.

    It is called, or the log has what it said; `fits` are the trials that fit its parameters.
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
    """Return how often the axis is seen to turn, within runs."""
    run = pd.factorize(runs)[0][readings.trial]
    return int(np.sum((np.diff(readings.way) != 0) & (np.diff(run) == 0)))
