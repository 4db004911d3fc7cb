"""Whether a log of an axis contains enough information, and why some runs are not used."""

from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.errors import Fault
from bayesfric.recording.csv_text import LISTED, with_rest
from bayesfric.recording.tables import Axis, RigConstants
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.even_log import EvenLog, even_grid, position_noise, smooth_motion
from bayesfric.rigs.single_axis.readings import Readings
from bayesfric.rigs.single_axis.run_rows import SMOOTHED
from bayesfric.rigs.single_axis.windows import pass_s, position_sd, sticking_share, stretches_of

# Least samples of a pass: with fewer, few windows have a single direction.
AT_EASE = 4 * AXIS_RULES.narrowest_at_turns
SAME = 1e-6  # largest difference between positions and a copy of them, relative to the stroke
STICKS = 0.5  # share of rests followed by the same direction from which the axis sticks


def joints_that_lack(axis: Axis) -> dict[str, str]:
    """Return by run a joint with too few samples in it; such runs are not used."""
    counts = {joint: samples["run"].value_counts() for joint, samples in axis.others.items()}
    return {
        str(run): joint
        for run in axis.runs["run"]
        for joint, samples in counts.items()
        if samples.get(run, 0) < AXIS_RULES.least_samples
    }


def too_short(axis: Axis) -> Unsupported:
    """Return why no run is used: all have too few samples of this or of another joint."""
    least, longest = AXIS_RULES.least_samples, int(axis.samples["run"].value_counts().max())
    if longest < least:
        return Unsupported(f"a run takes {least} samples, and the longest has {longest}")
    run, joint = next(iter(joints_that_lack(axis).items()))
    return Unsupported(f"no run has {least} samples of every joint: {run} lacks those of {joint}")


def without_force(logs: Sequence[EvenLog]) -> Unsupported | None:
    """Return why runs without any force contain no information; None if some force acts."""
    if any(log.force.any() for log in logs):
        return None
    return Unsupported(
        "force_n is 0 in every row: without a drive force only ratios of mass, friction and "
        "gravity show, none of them in newtons"
    )


def without_a_difference(samples: pd.DataFrame) -> Unsupported | None:
    """Return a reason if a column is a copy of another; else None.

    Parameters
    ----------
    samples : DataFrame
        Samples of one joint in a recording.
    """
    if "known_force_n" in samples and "force_n" in samples:
        force, modelled = samples["force_n"].to_numpy(), samples["known_force_n"].to_numpy()
        if np.array_equal(force, modelled) and force.any():
            return Unsupported(
                "known_force_n is force_n in every row, so that nothing is left for friction: "
                "known_force_n must be the force of a rigid-body model for the motion"
            )
    if "command_m" in samples and "force_n" not in samples:
        position = samples["position_m"].to_numpy()
        apart = samples["command_m"].to_numpy() - position
        if np.ptp(apart) <= SAME * np.ptp(position) and np.ptp(position):
            return Unsupported(
                f"command_m is position_m, {apart[0]:.3g} apart in every row, so that no friction "
                "holds the axis back: command_m must be the command that was sent to the servo"
            )
    return None


def too_little_motion(logs: Sequence[EvenLog], resolution: float | None) -> Unsupported | None:
    """Return why runs have too little motion for windows; None if they have enough.

    Parameters
    ----------
    logs : sequence of EvenLog
        Runs.
    resolution : float or None
        Resolution of the encoder.
    """
    stroke = max(float(np.ptp(log.position)) for log in logs)
    if stroke == 0:
        return Unsupported("position_m never changes: friction shows while the axis moves")
    noise = position_sd(logs, resolution)
    one_way, interval = pass_s(logs, noise), max(log.interval_s for log in logs)
    if one_way == 0:
        return Unsupported(
            f"positions move by {stroke:.3g} in all, with errors of {noise:.3g}, so that it "
            "never shows which way the axis runs"
        )
    if one_way < AT_EASE * interval:
        seen = (
            f"it runs one way for some {one_way:.3g} s at a time, which has "
            f"{one_way / interval:.0f} samples, and {AT_EASE} are needed"
        )
        if sticking_share(logs, noise) > STICKS:
            return Unsupported(
                f"{seen}; between, it rests and goes on the same way, so that it sticks and slips: "
                "move faster, or in a stiffer loop, so that it keeps moving"
            )
        rate = np.ceil(AT_EASE / one_way)
        return Unsupported(f"{seen}: take {rate:.0f} samples a second, or move slower")
    return None


def refused_for_few_windows(readings: Readings | None) -> Unsupported | None:
    """Return why windows are too few for mass and friction; None if there are enough."""
    count = 0 if readings is None else round(min(readings.hop, 1.0) * readings.count)
    if count >= AXIS_RULES.least_windows:
        return None
    return Unsupported(
        f"{count} windows of {2 * AXIS_RULES.narrowest_at_turns + 1} samples or more in which the "
        f"axis runs one way, and {AXIS_RULES.least_windows} are needed: record it for longer"
    )


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
    return int(stretches_of(way)[0].max(initial=0))
