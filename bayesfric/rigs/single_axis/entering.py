"""Which runs of an axis enter, whole or in parts, and their rows."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bayesfric.recording.tables import Axis, RigConstants
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.lengths import with_lengths
from bayesfric.rigs.single_axis.limit import within_limit
from bayesfric.rigs.single_axis.measures import Measures, measures_of
from bayesfric.rigs.single_axis.readings import Readings, readings_of
from bayesfric.rigs.single_axis.simulated import SimulatedBaseline, fitting, linearised, log_of
from bayesfric.simulators import SimulatorCalls

__all__ = ["NO_CABLE", "SIZE", "Entering", "entering"]

SIZE = "axis"  # in the place of a pulley size
NO_CABLE: dict[str, Any] = {"pulley_size": SIZE, "n_pulleys": 1, "wrap_angle_deg": 85.0}
ENOUGH = 6  # trials, so that something can be held out; few runs are cut in parts
SETUPS = 3  # assemblies from which on they are taken for what differs; fewer say nothing


class Entering(NamedTuple):
    """What of a log enters: fields of :class:`bayesfric.rigs.single_axis.trials.AxisRuns`."""

    table: pd.DataFrame
    readings: Readings
    measures: Measures
    still: tuple[str, ...]
    interval_s: float
    simulated: SimulatedBaseline | None


def entering(
    axis: Axis, constants: RigConstants, simulator: SimulatorCalls | None = None
) -> Entering | None:
    """Return the runs in which the axis moves, cut in parts where they are few; None without.

    Parameters
    ----------
    axis : Axis
        The tables.
    constants : RigConstants
        The machine.
    simulator : SimulatorCalls or None
        A user's, whose force is looked for beside the rows.
    """
    parts = max(1, -(-ENOUGH // len(axis.runs)))
    logs, starts, rows, runs = [], [], [], list[Mapping[str, object]]()
    by_run = dict(iter(axis.samples.groupby("run", sort=False)))
    still = []
    for _, run in axis.runs.iterrows():
        log = log_of(by_run[run["run"]], constants)
        if log is None:
            still.append(str(run["run"]))
            continue
        logs.append(log)
        runs.append({str(name): value for name, value in run.items()})
        starts.append(np.arange(parts) * (log.time_s.size // parts))
        for part in range(parts):
            name = run["run"] if parts == 1 else f"{run['run']}/{part + 1}"
            rows.append({**run.to_dict(), "trial": str(name)})
    measured = constants.force_is == "measured"
    resolution = constants.encoder_resolution
    found = within_limit(logs, starts, resolution, measured=measured) if logs else None
    if found is None:
        return None
    readings, limit = found
    table = pd.DataFrame(rows).assign(**NO_CABLE)
    measures, beside = measures_of(readings, logs, constants, limit), None
    if simulator is not None:

        def again(told: Sequence[EvenLog]) -> Readings:
            anew = readings_of(told, starts, constants.encoder_resolution)
            assert anew is not None
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
    measures = with_lengths(readings, table, measures, constants)
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
        float(np.median([log.interval_s for log in logs])),
        beside,
    )
