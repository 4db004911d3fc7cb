"""Writes the numbers of joints into a copy of the user's own model."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bayesfric.errors import Fault, InputError, one_of
from bayesfric.export.digits import by_error
from bayesfric.export.joints import ExportedJoint
from bayesfric.files import file_bytes
from bayesfric.probabilities import two_digits
from bayesfric.robots.link_inertia import link_inertia, settings_of
from bayesfric.robots.setting import JointValues, ModelText, model_text
from bayesfric.schemas.causes import INERTIAS
from bayesfric.schemas.diagnosis import Enter

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


LARGEST_FILE = 16_777_216  # largest model [bytes]
OF_ALL = {"coulomb", "coulomb-missing.force", "viscous", "torque-saturation.limit"}
WRITTEN = {
    "mjcf": {*OF_ALL, *INERTIAS, "air-drag.coefficient", "cubic-drag.coefficient", "delay.time"},
    "urdf": OF_ALL,
    "sdf": OF_ALL,
}
"""Numbers that are set, by format; others with a field are mentioned in remarks."""
STEP_S = 0.002  # default time step of MJCF


class FilledModel(NamedTuple):
    """A model with the numbers, and remarks for the user.

    Parameters
    ----------
    content : bytes
        Content of the file.
    remarks : tuple of str
        What was set, what was not and why, a line each.
    links : dict of str to float
        By joint in the log: the part of its inertia that the links of the model already have.
    places : tuple of str
        Names of the joints in the model, in the order of the joints.
    """

    content: bytes
    remarks: tuple[str, ...]
    links: dict[str, float]
    places: tuple[str, ...]


def filled_model(
    path: Path, to: str, joints: Sequence[ExportedJoint], named: Mapping[str, str]
) -> FilledModel:
    """Return a model with the numbers in the fields of its joints.

    Parameters
    ----------
    path : Path
        The model.
    to : str
        Its format: ``mjcf``, ``urdf`` or ``sdf``.
    joints : sequence of ExportedJoint
        The joints with their numbers.
    named : mapping of str to str
        Name in the model by joint in the log, as given by the user.

    Raises
    ------
    InputError
        The model has another format, lacks a joint, or has a sliding joint where that of the log
        turns.
    """
    model = model_text(file_bytes(path, path.name, LARGEST_FILE), path.name)
    if model.kind != to:
        expected = f"{model.kind}, which {model.name} is"
        raise InputError([Fault("command line", expected, column="--to", value=to)])
    places = _places(model, joints, named)
    values: dict[str, JointValues] = {}
    remarks: list[str] = []
    links: dict[str, float] = {}
    for exported in joints:
        place = places[exported.name]
        takes_inertia = model.kind == "mjcf" and exported.inertia is not None
        of_links = _links(path, place, exported, remarks) if takes_inertia else None
        own = own_numbers(path, model, place, of_links)
        joint = _identified(exported, own, place, remarks)
        wanted = named.get(joint.name) or joint.in_model or joint.name
        if wanted not in ("", place):
            remarks.append(f"{place}: taken for {wanted}, as the only joint of {model.name}")
        armature = None
        if of_links is not None:
            links[joint.name] = of_links
            if joint.inertia is not None:
                armature = _armature(joint, of_links, place, remarks)
        values[place] = _values(joint, model, place, armature, own, remarks)
        remarks += _left(joint, model, place)
    return FilledModel(model.with_values(values).content, tuple(remarks), links, tuple(values))


def _places(
    model: ModelText, joints: Sequence[ExportedJoint], named: Mapping[str, str]
) -> dict[str, str]:
    """Return the name of each joint in the model: as given, as recorded, or its own name."""
    unknown = sorted(set(named) - {joint.name for joint in joints})
    if unknown:
        expected = one_of([joint.name for joint in joints], unknown[0])
        raise InputError([Fault("command line", expected, column="--joint", value=unknown[0])])
    in_model = list(model.joints)
    places = {}
    for joint in joints:
        place = named.get(joint.name) or joint.in_model or joint.name
        if not place or (len(joints) == 1 and len(in_model) == 1 and not named):
            place = in_model[0] if len(in_model) == 1 else place
        if not place:
            expected = f"--joint NAME, of {', '.join(in_model)}"
            raise InputError([Fault(model.name, expected)])
        if model.turns(place) != joint.turns:
            ways = {True: "turns, in N·m and rad", False: "slides, in N and m"}
            expected = f"a joint that {ways[joint.turns]}, as the recording's does"
            instead = f"one that {ways[model.turns(place)]}"
            raise InputError([Fault(model.name, expected, column=place, value=instead)])
        places[joint.name] = place
    if len(set(places.values())) < len(places):
        expected = "each joint of the model once: give --joint LOG=MODEL"
        raise InputError([Fault(model.name, expected)])
    return places


def _identified(
    joint: ExportedJoint, owns: Mapping[str, float], place: str, remarks: list[str]
) -> ExportedJoint:
    """Return a joint without numbers that the data do not determine and the file may have right.

    Such a number is smaller than its error, and its interval contains the value of the file.
    """
    identified = {}
    for name, number in joint.numbers.items():
        value, own = number.value, owns.get(name)
        if own is not None and abs(value.mean) < value.sd and value.q05 <= own <= value.q95:
            low, high = (by_error(end, value.sd) for end in (value.q05, value.q95))
            remarks.append(
                f"{place}: {name} is left as it is ({own:.4g}): the data do not tell it "
                f"({low} to {high} {number.unit})"
            )
        else:
            identified[name] = number
    return replace(joint, numbers=identified)


def _links(path: Path, place: str, joint: ExportedJoint, remarks: list[str]) -> float | None:
    """Return the part of the estimated inertia that the links have; 0 if it excludes the links."""
    if joint.in_model is not None:
        return 0.0
    try:
        return link_inertia(path, place)
    except InputError as error:
        remarks.append(
            f"{place}: armature is left as it is, since the inertia that was found is that of "
            f"links and rotor, and what the links of the model have is not known: "
            f"{error.faults[0]}"
        )
        return None


def _armature(joint: ExportedJoint, links: float, place: str, remarks: list[str]) -> str:
    number = joint.numbers[joint.inertia or ""]
    whole, left = number.value, number.value.mean - links
    if links:
        remarks.append(
            f"{place}: {number.parameter} {by_error(whole.mean, whole.sd)} {number.unit} in all, "
            f"of which the links of the model have {links:.4g} at the reference position"
        )
    if left < 0:
        sure = whole.q95 < links
        remarks.append(
            f"{place}: the links of the model have more inertia than was found"
            f"{', beyond its error: their masses are too large' if sure else ''}; armature 0"
        )
        return "0"
    return by_error(left, whole.sd)


def _values(
    joint: ExportedJoint,
    model: ModelText,
    place: str,
    armature: str | None,
    own: Mapping[str, float],
    remarks: list[str],
) -> JointValues:
    def text(*names: str) -> str | None:
        number = next((joint.numbers[name] for name in names if name in joint.numbers), None)
        if number is None:
            return None
        if number.value.mean < 0:
            printed = by_error(number.value.mean, number.value.sd)
            remarks.append(f"{place}: {number.parameter} is below zero ({printed}): 0 is entered")
            return "0"
        return by_error(number.value.mean, number.value.sd)

    damping = text("viscous")
    if model.kind == "mjcf":
        terms = {name: text(name) for name in POWERS[1:]} | {POWERS[0]: damping}
        texts = {name: value for name, value in terms.items() if value is not None}
        damping = damping_terms(texts, own, place, remarks)
    delay = joint.numbers.get("delay.time")
    late = delay is not None and delay.value.mean > 0
    values = JointValues(
        frictionloss=text("coulomb", "coulomb-missing.force"),
        damping=damping,
        armature=armature,
        delay=text("delay.time") if late else None,
        samples=_samples(delay, model) if delay is not None and late else None,
        limit=text("torque-saturation.limit"),
    )
    said = {name: value for name, value in vars(values).items() if value is not None}
    remarks.append(f"{place}: {', '.join(f'{name} {value}' for name, value in said.items())}")
    return values


def _samples(delay: Enter, model: ModelText) -> str:
    """Return the number of commands that MuJoCo must keep for the delay."""
    option = model.root.child("option")
    step = STEP_S if option is None else float(option.attributes.get("timestep", STEP_S))
    return str(math.ceil(delay.value.mean / step) + 1)


def _left(joint: ExportedJoint, model: ModelText, place: str) -> list[str]:
    """Return the numbers for which the file has no field, and a delay without an actuator."""
    remarks = []
    simulator = {"mjcf": "mujoco", "urdf": "urdf", "sdf": "sdf"}[model.kind]
    for name, number in joint.numbers.items():
        if number.fields.get(simulator) is None and number.lost_without is not None:
            unit = "N·m" if joint.turns else "N"
            instead = f"; use {number.snippet}.py" if number.snippet is not None else ""
            remarks.append(
                f"{place}: no field for {name}: {two_digits(number.lost_without)} {unit} rms "
                "are lost"
                f"{instead}"
            )
    for name, number in joint.numbers.items():
        field = number.fields.get(simulator)
        if field is not None and name not in WRITTEN[model.kind]:
            printed = by_error(number.value.mean, number.value.sd)
            times = "" if field.factor == 1 else f" × {field.factor:.6g}"
            remarks.append(
                f"{place}: not set: {name} {printed} {number.unit}{times} ({field.field})"
            )
    late = "delay.time" in joint.numbers
    if late and model.kind == "mjcf" and not model.actuators(place):
        remarks.append(
            f"{place}: delay.time belongs to an actuator of the joint, and this file has none"
        )
    return remarks
