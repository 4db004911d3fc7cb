"""Diagnoses of all joints of a machine, as one."""

from collections.abc import Callable, Mapping
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


def diagnosed_together(
    parted: Mapping[str, Recording],
    diagnosed: Callable[[Recording, Path | None], Diagnosed],
    checkpoint: Path | None,
) -> Diagnosed:
    """Diagnose each joint by itself, and say what that makes of the machine.

    Parameters
    ----------
    parted : mapping of str to Recording
        By joint.
    diagnosed : callable
        Of one recording, and the folder that keeps what is weighed.
    checkpoint : Path or None
        That of all joints.

    Raises
    ------
    InputError
        No joint can be diagnosed: why, of each.
    """
    each: dict[str, Diagnosed] = {}
    faults: list[Fault] = []
    left_out: list[str] = []
    for place, (joint, recording) in enumerate(parted.items()):
        folder = None if checkpoint is None else checkpoint / f"joint-{place + 1}"
        try:
            each[joint] = diagnosed(recording, folder)
        except InputError as error:
            faults += error.faults
            left_out.append(f"The joint {joint} is not diagnosed: {error.faults[-1]}")
    if not each:
        raise InputError(faults)
    decides = min(each, key=lambda joint: ORDER.index(each[joint].summary.verdict))
    amounts = [result.amounts for result in each.values() if result.amounts is not None]
    errors = model_errors(amounts)
    words = "; ".join(f"{joint}: {one.summary.verdict}" for joint, one in each.items())
    first = each[decides]
    summary = first.summary.model_copy(
        update={
            "joints": tuple(one.summary for one in each.values()),
            "joints_why": None,
            "sentence": f"Of {len(each)} joints ({words}), {decides}: "
            f"{first.own_sentence}{model_error_words(errors)}",
            "attention": (
                *left_out,
                *(
                    f"{joint}: {line}"
                    for joint, one in each.items()
                    for line in one.summary.attention
                ),
            ),
            "model_error": errors,
            "model_error_why": first.summary.model_error_why if not errors else None,
        }
    )
    curves = dict(first.curves.children)
    curves["joints"] = xr.DataTree.from_dict(
        {f"{place}": one.curves for place, one in enumerate(each.values(), start=1)}
    )
    return replace(
        first,
        summary=identified(summary),
        curves=xr.DataTree(children=curves),
        seconds=sum(one.seconds for one in each.values()),
    )
