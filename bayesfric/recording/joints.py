"""Splits a recording of several joints into one for each joint, with the other joints' motion."""

from dataclasses import replace

from bayesfric.recording.frames import stands_in
from bayesfric.recording.tables import Axis, Recording


def joints_of(axis: Axis | None) -> tuple[str, ...]:
    """Return the joints of a log in order of appearance; empty if none is named."""
    if axis is None or "joint" not in axis.samples:
        return ()
    return tuple(str(name) for name in axis.samples["joint"].unique())


def parted_by_joint(recording: Recording) -> dict[str, Recording]:
    """Return one recording for each joint, with the motion of all other joints.

    Parameters
    ----------
    recording : Recording
        The recording, as read.

    Returns
    -------
    dict of str to Recording
        By joint, in the order of the log; empty unless several joints are logged.
    """
    axis, names = recording.axis, joints_of(recording.axis)
    if axis is None or len(names) < 2:
        return {}
    by_name = {
        str(name): samples.reset_index(drop=True)
        for name, samples in axis.samples.groupby("joint", sort=False)
    }
    parted = {}
    for place, name in enumerate(names):
        runs = axis.runs[stands_in(axis.runs["run"], by_name[name]["run"])].reset_index(drop=True)
        others = {other: by_name[other] for other in names if other != name}
        own = Axis(runs, by_name[name], joint=name, others=others, place=place)
        parted[name] = replace(recording, axis=own)
    return parted
