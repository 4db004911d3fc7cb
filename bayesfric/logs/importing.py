"""Imports logs as a recording: clocks are aligned, runs are cut, and delays are reported."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from bayesfric.errors import Fault, InputError
from bayesfric.logs.agreeing import check_velocity
from bayesfric.logs.cutting import Window, cut, span_of
from bayesfric.logs.delay import Delay, delay_between
from bayesfric.logs.long_form import by_joint, mapping_by_joint
from bayesfric.logs.mapping import Mapping, Run
from bayesfric.logs.mapping_file import read_mapping
from bayesfric.logs.readers import read_log
from bayesfric.logs.robot import robot_of
from bayesfric.logs.signals import Signals, joints_of, signals_of, wanted_columns
from bayesfric.logs.table import Log
from bayesfric.recording.package import ForceIs
from bayesfric.recording.tables import Axis, Recording, RigConstants

MOST_RUNS = 10_000
PLACE = {"name", "file", "value", "from_s", "to_s"}
"""Keys of a run that say where it is; the others describe it."""


@dataclass(frozen=True)
class Imported:
    """A recording, with notes on its import.

    Parameters
    ----------
    recording : Recording
        The recording of one joint, or of all.
    delay : Delay or None
        Delay of the measured force behind the command, in the first run of the first joint; None
        unless both were logged.
    notes : tuple of str
        Notes, a sentence each.
    """

    recording: Recording
    delay: Delay | None
    notes: tuple[str, ...]


@dataclass(frozen=True)
class _Piece:
    """A log, or the rows of one run in it, with the name of the run."""

    log: Log
    name: str
    value: str | None = None


class _Cut(NamedTuple):
    """Samples of the runs of a piece, notes, and each joint's delay with its sentence."""

    samples: list[pd.DataFrame]
    notes: list[str]
    delays: list[tuple[Delay | None, str]]


def import_log(
    logs: Path | Sequence[Path],
    joint: str | None = None,
    *,
    mapping: Path | Mapping,
    name: str = "imported",
) -> Imported:
    """Return a joint of a log, or all of them, as a recording.

    Parameters
    ----------
    logs : Path or sequence of Path
        A file or a ROS 2 bag's folder; each of several logs is a run.
    joint : str or None
        Name of the joint, or ``all``; None if the mapping's columns belong to one joint.
    mapping : Path or Mapping
        The meaning of the columns.
    name : str
        Name of the recording.

    Raises
    ------
    InputError
        The log or the mapping cannot be used; with places and reasons.
    """
    paths = [logs] if isinstance(logs, Path) else list(logs)
    folder = (paths[0] if isinstance(mapping, Mapping) else mapping).parent
    if not isinstance(mapping, Mapping):
        mapping = read_mapping(mapping)
    pieces = _pieces(paths, mapping)
    apart = [replace(piece, log=by_joint(piece.log, mapping)) for piece in pieces]
    mapping = mapping_by_joint(mapping, pieces[0].log)
    joints = joints_of(apart[0].log, mapping, joint)
    runs_of_pieces = _runs_of(apart, mapping)
    cuts = [
        _cut_piece(piece, mapping, joints, runs)
        for piece, runs in zip(apart, runs_of_pieces, strict=True)
        if runs
    ]
    runs = _table_of([run for runs in runs_of_pieces for run in runs])
    samples = pd.concat([frame for piece in cuts for frame in piece.samples], ignore_index=True)
    done = list(dict.fromkeys(note for piece in cuts for note in piece.notes))
    delays = [of_joint for piece in cuts for of_joint in piece.delays]
    notes = [*done, *dict.fromkeys(sentence for _, sentence in delays)]
    delay = next((delay for delay, _ in delays if delay is not None), None)
    files = ", ".join(path.name for path in paths)
    whom = "Joints" if len(joints) > 1 else "Joint"
    names = ", ".join(label for label in joints if label is not None)
    recording = Recording(
        name=name,
        title=f"{whom} {names} of {files}" if names else f"Joint of {files}",
        rig=_constants(mapping, joints, folder),
        axis=Axis(runs, samples),
        metadata={
            "sources": [{"title": f"Imported from {files}. {' '.join(notes)}"}],
            **({"import_notes": done} if done else {}),
        },
    )
    return Imported(recording, delay, tuple(notes))


def _table_of(runs: list[Run]) -> pd.DataFrame:
    """Return the runs in their order, with what the mapping says of each."""
    return pd.DataFrame(
        {"run": run.name, "order": order, **run.model_dump(exclude=PLACE, exclude_none=True)}
        for order, run in enumerate(runs, start=1)
    )


def _constants(mapping: Mapping, joints: tuple[str | None, ...], folder: Path) -> RigConstants:
    if mapping.moving_mass is not None and len(joints) > 1:
        expected = f"the mass of one joint, and {len(joints)} are imported: leave it out for all"
        value = f"{mapping.moving_mass:g}"
        raise InputError([Fault("the mapping", expected, column="moving_mass", value=value)])
    return RigConstants(
        rotary=mapping.rotary,
        force_is=_force_is(mapping, joints),
        encoder_resolution=mapping.encoder_resolution,
        moving_mass_kg=mapping.moving_mass,
        other_joints=mapping.other_joints,
        robot=None if mapping.robot is None else robot_of(mapping.robot, folder, joints),
    )


def _force_is(mapping: Mapping, joints: tuple[str | None, ...]) -> ForceIs | None:
    """Return the kind of force, which must be the same for all joints of a recording."""
    forces = {joint: mapping.of_joint(joint).get("force") for joint in joints}
    of_joint = {joint: force.force_is for joint, force in forces.items() if force is not None}
    kinds = [kind for kind in dict.fromkeys(of_joint.values()) if kind is not None]
    if len(kinds) > 1:
        expected = "one force_is for all joints of a recording: import the others separately"
        value = ", ".join(f"{joint}: {kind}" for joint, kind in of_joint.items())
        raise InputError([Fault("the mapping", expected, column="force.force_is", value=value)])
    return kinds[0] if kinds else None


def _pieces(paths: list[Path], mapping: Mapping) -> list[_Piece]:
    """Return the logs, each divided at the runs that a column names."""
    stems = [path.name if path.is_dir() else path.stem for path in paths]
    pieces = []
    for path, stem in zip(paths, stems, strict=True):
        log = read_log(path, mapping.csv, wanted_columns(mapping))
        twice = stems.count(stem) > 1
        called = _id(f"{path.resolve().parent.name}-{stem}" if twice else stem)
        if mapping.run is None:
            pieces.append(_Piece(log, "whole" if len(paths) == 1 else called))
            continue
        prefix = "" if len(paths) == 1 else f"{called}-"
        parts = log.parted(mapping.run, MOST_RUNS, f"between 1 and {MOST_RUNS:,} runs")
        pieces += [_Piece(part, f"{prefix}{_id(value)}", value) for value, part in parts.items()]
    names = [piece.name for piece in pieces]
    double = next((name for name in names if names.count(name) > 1), None)
    if double is not None:
        raise InputError([Fault("LOG", "files of different names", value=double)])
    return pieces


def _id(text: str) -> str:
    """Return a name for a run that is also a valid file name: letters, digits and dots."""
    return re.sub(r"[^\w.]+", "-", text).strip("-.") or "run"


def _runs_of(pieces: list[_Piece], mapping: Mapping) -> list[list[Run]]:
    """Return the runs of each piece: those of the mapping that belong to it, or the whole piece."""
    if not mapping.runs:
        return [[Run(name=piece.name)] for piece in pieces]
    faults, of_piece = [], [list[Run]() for _ in pieces]
    for run in mapping.runs:
        value = None if run.value is None else str(run.value)
        places = [
            place
            for place, piece in enumerate(pieces)
            if run.file in (None, piece.log.name) and value in (None, piece.value)
        ]
        if len(places) != 1:
            files = ", ".join(dict.fromkeys(piece.log.name for piece in pieces))
            values = ", ".join(str(piece.value) for piece in pieces if piece.value is not None)
            expected = f"a file that is one of {files}" + (
                f", and a value that is one of {values}" if values else ""
            )
            faults.append(Fault("the mapping", expected, column=f"runs.{run.name}"))
            continue
        of_piece[places[0]].append(run)
    if faults:
        raise InputError(faults)
    return of_piece


def _cut_piece(
    piece: _Piece, mapping: Mapping, joints: tuple[str | None, ...], runs: list[Run]
) -> _Cut:
    name = piece.log.name
    of_joints = signals_of(piece.log, mapping, joints)
    spans = [span_of(name, signals.series) for signals in of_joints.values()]
    origin = min(signals.series["position"].time_s[0] for signals in of_joints.values())
    begin, end = min(first for first, _ in spans), max(last for _, last in spans)
    windows = [
        Window(
            run,
            begin if run.from_s is None else origin + run.from_s,
            end if run.to_s is None else origin + run.to_s,
        )
        for run in runs
    ]
    samples, delays, notes = [], [], {}
    for joint, signals in of_joints.items():
        check_velocity(name, joint, signals.series)
        frames, done = cut(name, signals.series, windows, origin)
        for frame in frames:
            if len(joints) > 1:
                frame.insert(2, "joint", joint)
        samples += frames
        notes[joint] = [*signals.notes, *done]
        delay, sentence = _delay(signals)
        whose = "" if len(joints) == 1 or delay is None else f"{joint}: "
        delays.append((delay, f"{whose}{sentence}"))
    order = {run.name: place for place, run in enumerate(runs)}
    samples.sort(key=lambda frame: order[str(frame["run"].iloc[0])])
    return _Cut(samples, _together(notes), delays)


def _together(notes: dict[str | None, list[str]]) -> list[str]:
    """Return notes on all joints once, and notes on single joints with the joint's name."""
    everywhere = set.intersection(*(set(of_joint) for of_joint in notes.values()))
    together = [note for of_joint in notes.values() for note in of_joint if note in everywhere]
    alone = [
        f"{joint}: {note}"
        for joint, of_joint in notes.items()
        for note in of_joint
        if note not in everywhere
    ]
    return [*dict.fromkeys(together), *alone]


def _delay(signals: Signals) -> tuple[Delay | None, str]:
    series = signals.series
    if "force" not in series:
        return None, "The log has no force: how late it is cannot be estimated."
    if "measured_force" not in series:
        return None, (
            "How late the force is cannot be estimated: the log has it once, and not as a command "
            "and as a measurement."
        )
    delay = delay_between(series["force"], series["measured_force"])
    if delay is None:
        return None, (
            "How late the force is cannot be estimated: command or measurement does not vary."
        )
    return delay, (
        f"The measured force comes {1e3 * delay.seconds:.2f} ± {1e3 * delay.error_s:.2f} ms after "
        "the command; it is left in."
    )
