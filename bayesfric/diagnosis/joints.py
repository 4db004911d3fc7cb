"""Combines the diagnoses of all joints of a machine."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import xarray as xr

from bayesfric.diagnosis.diagnosed import Diagnosed
from bayesfric.diagnosis.other_joints import model_error_words
from bayesfric.errors import Fault, InputError
from bayesfric.recording.tables import Recording
from bayesfric.results import identified
from bayesfric.rigs.model_amounts import model_errors

ORDER = ("unknown", "unseparated", "named", "undecided", "no-gap")
"""Of verdicts: that of a machine is the first that any of its joints has."""
IN_WORDS = {
    "unknown": "a gap of unknown cause",
    "unseparated": "a gap with several possible causes",
    "named": "a gap with a named cause",
    "undecided": "an open question",
    "no-gap": "no gap",
}


def diagnose_joints(
    parted: Mapping[str, Recording],
    diagnosed: Callable[[Recording, Path | None], Diagnosed],
    checkpoint: Path | None,
) -> Diagnosed:
    """Diagnose each joint separately, and return one result for the machine.

    Parameters
    ----------
    parted : mapping of str to Recording
        Recordings by joint.
    diagnosed : callable
        Diagnoses one recording; its second argument is the folder of its checkpoint.
    checkpoint : Path or None
        Checkpoint folder of all joints.

    Raises
    ------
    InputError
        No joint can be diagnosed; the message contains the reason for each.
    """
    by_joint, left_out = _by_joint(parted, diagnosed, checkpoint)
    decides = min(by_joint, key=lambda joint: ORDER.index(by_joint[joint].summary.verdict))
    amounts = [result.amounts for result in by_joint.values() if result.amounts is not None]
    errors = model_errors(amounts)
    alike: dict[str, list[str]] = {}
    for joint, result in by_joint.items():
        alike.setdefault(result.summary.verdict, []).append(joint)
    words = "; ".join(
        f"{IN_WORDS[verdict]} at {_listed(names)}" for verdict, names in alike.items()
    )
    remarks = [
        f"{joint}: {line}" for joint, own in by_joint.items() for line in own.summary.attention
    ]
    first = by_joint[decides]
    said = first.own_sentence[:1].lower() + first.own_sentence[1:]
    summary = first.summary.model_copy(
        update={
            "joints": tuple(result.summary for result in by_joint.values()),
            "joints_why": None,
            "sentence": f"{words[:1].upper()}{words[1:]}. At {decides}: {said}"
            f"{model_error_words(errors)}",
            "attention": (*left_out, *remarks),
            "model_error": errors,
            "model_error_why": first.summary.model_error_why if not errors else None,
        }
    )
    curves = dict(first.curves.children)
    curves["joints"] = xr.DataTree.from_dict(
        {f"{place}": result.curves for place, result in enumerate(by_joint.values(), start=1)}
    )
    return replace(
        first,
        summary=identified(summary),
        curves=xr.DataTree(children=curves),
        seconds=sum(result.seconds for result in by_joint.values()),
    )


def _by_joint(
    parted: Mapping[str, Recording],
    diagnosed: Callable[[Recording, Path | None], Diagnosed],
    checkpoint: Path | None,
) -> tuple[dict[str, Diagnosed], list[str]]:
    """Return the diagnosis of each joint, and the reasons of joints without one."""
    by_joint: dict[str, Diagnosed] = {}
    faults: list[Fault] = []
    left_out: list[str] = []
    for place, (joint, recording) in enumerate(parted.items()):
        folder = None if checkpoint is None else checkpoint / f"joint-{place + 1}"
        try:
            by_joint[joint] = diagnosed(recording, folder)
        except InputError as error:
            faults += error.faults
            left_out.append(f"The joint {joint} is not diagnosed: {error.faults[-1]}")
    if not by_joint:
        raise InputError(faults)
    return by_joint, left_out


def _listed(names: Sequence[str]) -> str:
    """Return names with commas and an and."""
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))
