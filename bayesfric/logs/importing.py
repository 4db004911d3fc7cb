"""A log to a recording: clocks aligned, runs cut, and what is late said and left in."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags
from bayesfric.errors import Fault, InputError
from bayesfric.logs.clock import DECIMALS
from bayesfric.logs.delay import Delay, delay_between
from bayesfric.logs.mapping import Run, read_mapping
from bayesfric.logs.ordering import Series, gaps_of
from bayesfric.logs.reading import bag_signals, csv_signals, is_bag
from bayesfric.recording.tables import Axis, Recording, RigConstants

__all__ = ["Imported", "import_log"]


@dataclass(frozen=True)
class Imported:
    """A recording and what a reader should know of how it came about.

    Parameters
    ----------
    recording : Recording
        Of one joint.
    delay : Delay or None
        Of the measured force behind the command; None where only one of them is there.
    notes : tuple of str
        Sentences.
    """

    recording: Recording
    delay: Delay | None
    notes: tuple[str, ...]


def import_log(
    log: Path, joint: str, *, mapping: Path | None = None, name: str = "imported"
) -> Imported:
    """Return a log's joint as a recording.

    Parameters
    ----------
    log : Path
        A CSV file, a ROS 2 bag's folder or an MCAP file.
    joint : str
        Which one.
    mapping : Path or None
        A ``mapping.toml``; compulsory for CSV. Of a bag only its runs count.
    name : str
        Of the recording.

    Raises
    ------
    InputError
        The log or the mapping cannot be used: where and why.
    """
    if not log.exists():
        raise InputError([Fault(str(log), "a log: a CSV file, an .mcap file or a bag's folder")])
    told = None if mapping is None else read_mapping(mapping)
    if is_bag(log):
        found, rotary, kind = bag_signals(log, joint), True, "measured"
        if "measured_force" in found.series:
            kind = "commanded"
    elif told is None:
        raise InputError([Fault("--map", f"a mapping file: which columns of {log.name} are what")])
    else:
        found, rotary, kind = csv_signals(log, told, joint), told.rotary, told.force.kind
    signals = found.series
    runs, samples, notes = _cut(log.name, signals, () if told is None else told.runs)
    delay = None
    if "measured_force" in signals:
        delay = delay_between(signals["force"], signals["measured_force"])
    done = [*found.notes, *notes]
    notes = [*done, _said(delay, signals)]
    constants = RigConstants(
        rotary=rotary,
        force_is=kind,
        encoder_resolution=None if told is None else told.encoder_resolution,
        moving_mass_kg=None if told is None else told.moving_mass,
    )
    recording = Recording(
        name=name,
        title=f"Joint {joint} of {log.name}",
        rig=constants,
        axis=Axis(runs, samples),
        metadata={
            "sources": [{"title": f"Imported from {log.name}. {' '.join(notes)}"}],
            **({"import_notes": done} if done else {}),
        },
    )
    return Imported(recording, delay, tuple(notes))


def _said(delay: Delay | None, signals: dict[str, Series]) -> str:
    if delay is None and "measured_force" in signals:
        return "How late the force is cannot be estimated: command or measurement does not vary."
    if delay is None:
        return (
            "How late the force is cannot be estimated: the log has it once, and not as a command "
            "and as a measurement."
        )
    return (
        f"The measured force comes {1e3 * delay.seconds:.2f} ± {1e3 * delay.error_s:.2f} ms after "
        "the command; it is left in."
    )


def _unsaid(time_s: Array, force: Series) -> Flags:
    """Return where no force was logged for some intervals, (N,): it is not bridged."""
    begin, end = gaps_of(force)
    if not begin.size:
        return np.zeros(time_s.size, dtype=np.bool_)
    gap = np.searchsorted(begin, time_s, side="left") - 1
    inside: Flags = (gap >= 0) & (time_s < end[gap])
    return inside


def _counted(samples: int) -> str:
    return "1 sample" if samples == 1 else f"{samples:,} samples"


def _cut(
    name: str, signals: dict[str, Series], wanted: tuple[Run, ...]
) -> tuple[pd.DataFrame, pd.DataFrame, list[str]]:
    """Return runs and samples at the times of the positions, the force in between."""
    position, force = signals["position"], signals["force"]
    begin = max(position.time_s[:1].max(initial=-np.inf), force.time_s[:1].max(initial=-np.inf))
    end = min(position.time_s[-1:].min(initial=np.inf), force.time_s[-1:].min(initial=np.inf))
    if not begin < end:
        expected = "position and force that are logged at the same time"
        raise InputError([Fault(name, expected)])
    first = position.time_s[0]
    unsaid = _unsaid(position.time_s, force)
    pieces = wanted or (Run(name="whole", from_s=begin - first, to_s=end - first),)
    rows: list[dict[str, Any]] = []
    samples, faults = [], []
    for order, run in enumerate(pieces, start=1):
        low, high = max(first + run.from_s, begin), min(first + run.to_s, end)
        inside = (position.time_s >= low) & (position.time_s <= high) & ~unsaid
        if inside.sum() < 2:
            faults.append(Fault(name, "samples in the run", column=f"runs.{run.name}"))
            continue
        row = {"run": run.name, "order": order, **(run.model_extra or {})}
        rows.append(row | ({} if run.role is None else {"role": run.role}))
        time = position.time_s[inside]
        samples.append(
            pd.DataFrame(
                {
                    "run": run.name,
                    "time_s": (time - first).round(DECIMALS),
                    "position_m": position.value[inside].round(DECIMALS),
                    "force_n": np.interp(time, force.time_s, force.value).round(DECIMALS),
                }
            )
        )
    if faults:
        raise InputError(faults)
    notes = []
    if unsaid.any():
        notes.append(f"{_counted(int(unsaid.sum()))} in which no force was logged left out.")
    if not np.array_equal(position.time_s, force.time_s):
        notes.append("Force is a straight line between its samples, at the times of the positions.")
    return pd.DataFrame(rows), pd.concat(samples, ignore_index=True), notes
