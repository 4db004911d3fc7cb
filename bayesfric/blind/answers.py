"""The answer to a user's recording: the effects that really act."""

from pathlib import Path
from typing import Any

from pydantic import ConfigDict, Field, ValidationError

from bayesfric.effects import all_effects
from bayesfric.errors import Fault, InputError
from bayesfric.files import file_bytes
from bayesfric.schemas.base import Number, Record

AXES = (
    "velocity",
    "tension",
    "wrap_angle",
    "n_pulleys",
    "displacement",
    "order",
    "acceleration",
    "drive_end",
    "trial_in_setup",
    "rig",
)
"""Axes along which a remainder can be found."""


class WithheldEffect(Record):
    """One effect that acts.

    Fields
    ------
    name: Name of an effect of bayesfric, or of the user's own.
    strength: Strength; 1 is 10 % of friction, rms.
    form: Functional form, in words.
    own: Whether the form is that of bayesfric's effect.
    parameters: True parameters of an effect of bayesfric with its own form. Their intervals are
        checked if `form` is the law that the diagnosis reports.
    axes: Axes along which an effect that bayesfric does not have acts; required for such an effect.
    """

    name: str = Field(min_length=1)
    strength: Number = Field(1.0, gt=0)
    form: str = ""
    own: bool = False
    parameters: dict[str, Number] = Field({})
    axes: tuple[str, ...] = ()


class Answer(Record):
    """The content of ``--answer FILE``: ``{"withheld": []}`` if no effect acts.

    Fields
    ------
    withheld: Every effect that acts.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    withheld: tuple[WithheldEffect, ...]


def read_answer(path: Path) -> dict[str, Any]:
    """Read an answer.

    Parameters
    ----------
    path : Path
        A JSON file.

    Returns
    -------
    dict
        The truth, as an engine states it.

    Raises
    ------
    InputError
        With every fault of the file.
    """
    try:
        answer = Answer.model_validate_json(file_bytes(path))
    except ValidationError as error:
        raise InputError(
            [
                Fault(
                    path.name,
                    f"an answer as {{'withheld': [{{'name': …}}]}} ({fault['msg']})",
                    column=".".join(str(part) for part in fault["loc"]) or None,
                )
                for fault in error.errors()
            ]
        ) from error
    faults = []
    effects = all_effects()
    for place, withheld in enumerate(answer.withheld):
        key = f"withheld.{place}.axes"
        if withheld.name not in effects and not withheld.axes:
            expected = (
                f"the axes along which {withheld.name!r} shows, since it is none of the effects "
                f"that are examined ({', '.join(effects)})"
            )
            faults.append(Fault(path.name, expected, column=key))
        faults += [
            Fault(path.name, f"one of {', '.join(AXES)}", column=key, value=axis)
            for axis in withheld.axes
            if axis not in AXES
        ]
    names = [withheld.name for withheld in answer.withheld]
    faults += [
        Fault(path.name, "each effect once", column="withheld", value=name)
        for name in sorted(set(names))
        if names.count(name) > 1
    ]
    if faults:
        raise InputError(faults)
    truth: dict[str, Any] = answer.model_dump(mode="json")
    return truth
