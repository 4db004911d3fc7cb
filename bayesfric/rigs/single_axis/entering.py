"""Which runs of an axis enter, whole or in parts, and their rows."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bayesfric.errors import Fault, InputError
from bayesfric.recording.tables import Axis, RigConstants
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.single_axis.carried import carried_by
from bayesfric.rigs.single_axis.declared import MEASURED
from bayesfric.rigs.single_axis.dither import Dither, steady
from bayesfric.rigs.single_axis.enough import (
    too_few_windows,
    too_little_motion,
    too_short,
    without_force,
)
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.lengths import with_lengths
from bayesfric.rigs.single_axis.limit import within_limit
from bayesfric.rigs.single_axis.measures import Measures, measures_of
from bayesfric.rigs.single_axis.on_time import margin_s, on_time
from bayesfric.rigs.single_axis.other_joints import Machine, machine_of
from bayesfric.rigs.single_axis.readings import Readings, readings_of, rough_law_of
from bayesfric.rigs.single_axis.rows import varied_columns
from bayesfric.rigs.single_axis.servo import (
    Servo,
    servo_of,
    with_open_delay,
    with_open_stiffness,
)
from bayesfric.rigs.single_axis.simulated import SimulatedBaseline, fitting, linearised, log_of
from bayesfric.simulators import SimulatorCalls

SIZE = "axis"  # in the place of a pulley size
NO_CABLE: dict[str, Any] = {"pulley_size": SIZE, "n_pulleys": 1, "wrap_angle_deg": 85.0}
ENOUGH = 6  # trials, so that something can be held out; few runs are cut in parts
EARLY = 3.0  # times what two clocks may be off by, that a force may be early
SETUPS = 3  # assemblies from which on they are taken for what differs; fewer say nothing


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


def entering(
    axis: Axis, constants: RigConstants, simulator: SimulatorCalls | None = None
) -> Entering | Unsupported:
    """Return the runs in which the axis moves, cut in parts where they are few.

    Where they tell nothing, the rule that leaves them out is returned.

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
    parts = max(1, -(-ENOUGH // len(axis.runs)))
    recorded: list[EvenLog] = []
    starts, rows, runs = [], [], list[Mapping[str, object]]()
    by_run = dict(iter(axis.samples.groupby("run", sort=False)))
    still = []
    machine = machine_of(axis, constants)
    for _, run in axis.runs.iterrows():
        log = log_of(by_run[run["run"]], constants)
        if log is not None and simulator is None:
            log = machine.around(log, run["run"])
        if log is None:
            still.append(str(run["run"]))
            continue
        recorded.append(log)
        runs.append({str(name): value for name, value in run.items()})
        starts.append(np.arange(parts) * (log.time_s.size // parts))
        for part in range(parts):
            name = run["run"] if parts == 1 else f"{run['run']}/{part + 1}"
            rows.append({**run.to_dict(), "trial": str(name)})
    logs: Sequence[EvenLog] = recorded
    if not logs:
        return too_short([len(samples) for samples in by_run.values()])
    resolution = constants.encoder_resolution
    nothing = without_force(logs) or too_little_motion(logs, resolution)
    if nothing is not None:
        return nothing
    interval = float(np.median([log.interval_s for log in logs]))
    late_s = 0.0
    if servo is None:  # what a servo is late by is in its log already
        on_one_clock, late_s = on_time(logs, resolution, EARLY * margin_s(interval))
        logs = list(on_one_clock)
    clips = constants.force_is not in MEASURED
    limited = within_limit(logs, starts, resolution, clips=clips, declared=constants.force_limit_n)
    dither = Dither()
    if limited is not None and servo is None:
        mass = rough_law_of(limited[0], limited[1].within(limited[0])).mass
        calm, dither = steady(logs, mass, limited[0].half_s, resolution)
        logs = list(calm)
        if dither.left_out:
            limited = within_limit(
                logs, starts, resolution, clips=clips, declared=constants.force_limit_n
            )
    too_few = too_few_windows(None if limited is None else limited[0])
    if limited is None or too_few is not None:
        return too_few or Unsupported("no window in which the axis runs one way")
    readings, limit = limited
    if servo is not None:
        readings = with_open_stiffness(with_open_delay(readings), servo)
    table = pd.DataFrame(rows).assign(**NO_CABLE)
    measures, beside = measures_of(readings, logs, constants, limit), None
    turns = _turns(readings, table["run"])
    if simulator is not None:

        def again(logs_within: Sequence[EvenLog]) -> Readings:
            anew = readings_of(logs_within, starts, resolution)
            if anew is None:
                expected = "a simulator that follows the measured motion for some windows"
                raise InputError([Fault(simulator.name, expected)])
            return anew

        beside, readings = linearised(
            simulator, logs, runs, again, measures, readings.half_s, fitting(table)
        )
    elif readings.simulated.shape[1]:
        named = {"sim_force": "sim_force_n", "sim_position": "sim_position_m"}
        columns = [column for name, column in named.items() if name in logs[0].further]
        beside = SimulatedBaseline(" and ".join(columns))
    if "setup" not in table or table["setup"].nunique() < SETUPS:
        table["setup"] = table["trial"]
    inside = measures.limit.within(readings)
    carried = carried_by(readings, inside, table, varied_columns(axis.runs))
    measures = with_lengths(readings, table, replace(measures, carried=carried), constants)
    moving = np.unique(readings.trial)
    order = np.argsort(pd.factorize(table["setup"])[0][moving], kind="stable")
    chosen = moving[order]
    still += [str(run) for run in table["trial"][~table.index.isin(moving)]]
    table = table.iloc[chosen].reset_index(drop=True)
    return Entering(
        table,
        readings.of(chosen),
        measures,
        tuple(still),
        interval,
        beside,
        turns,
        machine,
        late_s,
        dither,
        servo,
        constants,
    )


def _turns(readings: Readings, runs: pd.Series) -> int:
    """Return how often the axis is seen to turn, within runs."""
    run = pd.factorize(runs)[0][readings.trial]
    return int(np.sum((np.diff(readings.way) != 0) & (np.diff(run) == 0)))
