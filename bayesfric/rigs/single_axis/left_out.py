"""Which runs of a log are not used, and by which rule, with its numbers."""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.errors import Fault
from bayesfric.recording.csv_text import LISTED, with_rest
from bayesfric.recording.tables import Axis, RigConstants
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.enough import joints_that_lack
from bayesfric.rigs.single_axis.even_log import EvenLog, even_grid, position_noise, smooth_motion
from bayesfric.rigs.single_axis.run_rows import SMOOTHED

SAMPLES = "axis_samples.csv"
WINDOW = 2 * AXIS_RULES.narrowest + 1  # samples of the narrowest window


def not_modelled(axis: Axis) -> list[Fault]:
    """Return contents of a log that no model describes and that would make the result wrong."""
    joints = axis.samples["joint"].unique() if "joint" in axis.samples else ()
    if len(joints) < 2:
        return []
    expected = (
        "the samples of one joint: unlike diagnose and fit, this command does not separate "
        "joints (keep the rows of one)"
    )
    return [Fault(SAMPLES, expected, column="joint", value=", ".join(joints))]


def left_out(axis: Axis, constants: RigConstants) -> list[Fault]:
    """Return why runs are not used: what they contain, and what a run needs.

    Parameters
    ----------
    axis : Axis
        The tables.
    constants : RigConstants
        The machine.
    """
    by_run = {str(run): of_run for run, of_run in axis.samples.groupby("run", sort=False)}
    reasons = list(_of_runs(by_run, axis.runs["run"].tolist(), constants.encoder_resolution))
    samples = f"{AXIS_RULES.least_samples} samples at least of joint"
    reasons += [
        Fault(
            SAMPLES,
            f"{samples} {joint} too, because it exerts forces on this joint",
            column=f"run {run}",
        )
        for run, joint in joints_that_lack(axis).items()
    ]
    return with_rest(reasons[:LISTED], len(reasons[LISTED:]))


def _of_runs(
    by_run: dict[str, pd.DataFrame], runs: list[str], resolution: float | None
) -> Iterator[Fault]:
    logs = {run: _log(by_run[run]) for run in runs}
    noises = [position_noise(log, resolution) for log in logs.values() if log is not None]
    noise = float(np.median(noises)) if noises else 0.0
    for run, log in logs.items():
        if log is None:
            expected = f"at least {AXIS_RULES.least_samples} samples in a run"
            value = f"{len(by_run[run])} samples"
        elif (stretch := _longest(log, noise)) == 0:
            expected = (
                "a run that moves by more than the error of its positions shows, which is "
                f"{noise:.2g}"
            )
            value = f"{np.ptp(log.position):.2g} from end to end"
        elif stretch < WINDOW:
            rate = WINDOW / (stretch * log.interval_s)
            expected = (
                f"{WINDOW} samples at least one way: here {rate:.3g} samples a second, and not "
                f"{1 / log.interval_s:.3g}, or a slower motion"
            )
            value = f"{stretch} samples from one reversal to the next, at the most"
        else:
            continue
        yield Fault(SAMPLES, expected, column=f"run {run}", value=value)


def _log(samples: pd.DataFrame) -> EvenLog | None:
    lead = "force_n" if "force_n" in samples else "command_m"
    columns: dict[str, Array] = {
        name: samples[column].to_numpy(dtype=np.float64)
        for name, column in (("position", "position_m"), ("force", lead))
    }
    return even_grid(samples["time_s"].to_numpy(dtype=np.float64), columns)


def _longest(log: EvenLog, noise: float) -> int:
    """Return the most consecutive samples with one known direction."""
    way = smooth_motion(log, SMOOTHED, noise)[2]
    edges = np.flatnonzero(np.diff(way, prepend=0.0, append=0.0))
    lengths = np.diff(edges)[way[edges[:-1]] != 0] if edges.size > 1 else np.zeros(0)
    return int(lengths.max(initial=0))
