"""The values that the user's file already has for the numbers to be written."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from bayesfric.errors import InputError
from bayesfric.robots.link_inertia import settings_of
from bayesfric.robots.setting import ModelText
from bayesfric.schemas.causes import INERTIAS

POWERS = ("viscous", "air-drag.coefficient", "cubic-drag.coefficient")
"""Numbers that are terms of the damping polynomial of MJCF, in order."""


def own_numbers(path: Path, model: ModelText, place: str, links: float | None) -> dict[str, float]:
    """Return the numbers that a file has at a joint, by parameter; unknown ones are absent.

    Parameters
    ----------
    path : Path
        Path of the file.
    model : ModelText
        The file.
    place : str
        The joint's name in it.
    links : float or None
        The part of the estimated inertia that its links have; None if unknown.
    """
    written = {name: _numbers(text) for name, text in model.written(place).items()}
    own = dict(zip(POWERS, written.get("damping", ()), strict=False))
    own |= dict(zip(["coulomb"], written.get("friction", ()), strict=False))
    armature = written.get("armature", ())[:1]
    if model.kind == "mjcf":
        try:
            settings = settings_of(path, place)
        except InputError:  # for example a part of a model: only the joint itself is known
            pass
        else:
            own = dict(zip(POWERS, settings.damping, strict=True))
            own["coulomb"], armature = settings.frictionloss, (settings.armature,)
    else:  # in both formats an absent value is 0
        absent = {"damping": "viscous", "friction": "coulomb"}
        own |= {name: 0.0 for field, name in absent.items() if field not in written}
    if links is not None:
        own |= {name: links + value for name in INERTIAS for value in armature}
    return own


def _numbers(text: str) -> tuple[float, ...]:
    try:
        numbers = tuple(float(word) for word in text.split())
    except ValueError:  # for example a macro that is not expanded
        return ()
    return numbers if np.isfinite(numbers).all() else ()


def damping_terms(
    texts: Mapping[str, str], own: Mapping[str, float], place: str, remarks: list[str]
) -> str | None:
    """Return the damping of a joint of MJCF; None keeps that of the file.

    A factor of speed that was not estimated is that of the file. If a damping was estimated without
    drag terms, those of the file are removed, since the damping contains all friction at speed.

    Parameters
    ----------
    texts : mapping of str to str
        Estimated numbers as texts, by parameter.
    own : mapping of str to float
        As from :func:`own_numbers`.
    place : str
        The joint, for remarks.
    remarks : list of str
        Receives what is lost or kept, a line each.
    """
    if not any(name in texts for name in POWERS):
        return None
    terms = [texts.get(name, "0") for name in POWERS]
    if POWERS[0] not in texts:
        terms[0] = f"{own.get(POWERS[0], 0.0):.6g}"
        whose = "as this file has it" if POWERS[0] in own else "which nobody can tell of this file"
        remarks.append(f"{place}: viscous was not found: {terms[0]} is entered, {whose}")
    for name in POWERS[1:]:
        if name not in texts and own.get(name):
            remarks.append(
                f"{place}: {name} of this file, {own[name]:.6g}, is set to 0: the damping that was "
                "found is without it"
            )
    return " ".join(terms if any(name in texts for name in POWERS[1:]) else terms[:1])
