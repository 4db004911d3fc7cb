"""``bayesfric export``: the calibrated, diagnosed numbers for your own simulator."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bayesfric.cli import options
from bayesfric.cli.exits import exit_status
from bayesfric.cli.locks import hold
from bayesfric.cli.printing import say
from bayesfric.errors import Fault, InputError, one_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from bayesfric.export.joints import ExportedJoint
    from bayesfric.schemas import DiagnosisFile

KINDS = ("json", "python", "mjcf", "urdf", "sdf", "isaaclab")
OF_MODELS = ("mjcf", "urdf", "sdf")
DRAWS = "joint-draws.csv"


@exit_status
def export(
    folder: Annotated[Path, typer.Argument(help="Folder with the results of diagnose or run.")],
    to: Annotated[
        str, typer.Option("--to", metavar=f"<{'|'.join(KINDS)}>", help="For which simulator.")
    ] = "json",
    into: Annotated[
        Path | None,
        options.path(
            "--into",
            "Your own MJCF, URDF or SDF. A copy is written in which the joints' fields are set.",
        ),
    ] = None,
    joint: Annotated[
        list[str] | None,
        options.worded(
            "--joint",
            "NAME",
            "LOG=MODEL: the joint's name in the model, if it differs from that in the log.",
        ),
    ] = None,
    draws: Annotated[
        int | None,
        options.whole(
            "--draws",
            1,
            f"Also write this many sets of joint parameters, for domain randomisation: {DRAWS}.",
        ),
    ] = None,
) -> None:
    """Write the numbers of a diagnosis for your simulator, or set them in a copy of your model.

    If the diagnosis names causes, the numbers are those of the law refitted with them. The number
    of digits follows from the error. Without --into, the command writes a model of one joint.

    Example: bayesfric export my-results --to mjcf --into robot.xml --draws 200
    """
    from bayesfric.export.joints import read_diagnosis, refuse_ratios

    if to not in KINDS:
        raise options.unusable(one_of(KINDS, to), "--to", to)
    if not folder.is_dir():
        raise InputError([Fault(str(folder), "a folder with results of the verbs")])
    if into is not None and to not in OF_MODELS:
        expected = f"--to with one of {', '.join(OF_MODELS)}, where --into is given"
        raise options.unusable(expected, "--to", to)
    with hold(folder, "export"):
        diagnosis = read_diagnosis(folder)
        if to != "json":
            refuse_ratios(diagnosis)
        if into is None and not (to == "isaaclab" or _of_joints(diagnosis, to)):
            _export_law(folder, to, draws, diagnosis)
        else:
            _export_joints(folder, to, into, joint or [], draws, diagnosis)


def _of_joints(diagnosis: "DiagnosisFile", to: str) -> bool:
    """Return whether a format is written joint by joint; the Python law of pulleys is another."""
    from bayesfric.physics.laws import OF_AXES

    return bool(diagnosis.joints) or (to == "python" and diagnosis.baseline in OF_AXES)


def _joints(folder: Path, diagnosis: "DiagnosisFile") -> "tuple[ExportedJoint, ...]":
    from bayesfric.export.joints import joints_of
    from bayesfric.results import read_beside

    return joints_of(diagnosis, read_beside(diagnosis, folder / "diagnosis.nc"))


def _export_law(folder: Path, to: str, draws: int | None, diagnosis: "DiagnosisFile") -> None:
    """Write a law, or a model of one joint alone."""
    from bayesfric.export import FORMATS, export_text, read_law
    from bayesfric.export.bodies import TEXTS
    from bayesfric.export.joint_friction import joint_friction

    law = read_law(folder)
    texts = {FORMATS[to][0]: export_text(law, to)}
    if draws is not None:
        texts |= _drawn(_joints(folder, diagnosis), draws, {})
    _write(folder, texts)
    say(law.said, err=True)
    if to in TEXTS:
        say(joint_friction(law).said, err=True)


def _export_joints(
    folder: Path,
    to: str,
    into: Path | None,
    named: "Sequence[str]",
    draws: int | None,
    diagnosis: "DiagnosisFile",
) -> None:
    """Write the numbers of joints, into a model where one is given."""
    from bayesfric.export.into import filled_model
    from bayesfric.export.of_joints import LOAD_FRICTION_FILE, TEXTS_OF_JOINTS, load_friction_text

    joints = _joints(folder, diagnosis)
    for warning in (joint.warning for joint in joints if joint.warning is not None):
        say(warning, err=True)
    if into is None:
        if to in OF_MODELS:
            expected = f"--into MODEL: your {to.upper()} file, since there are {len(joints)} joints"
            raise options.unusable(expected, "--to", to)
        file, text_of = TEXTS_OF_JOINTS[to]
        written = {file: text_of(joints, diagnosis.recording.name)}
        _write(folder, written | _drawn(joints, draws, {}))
        return
    if into.resolve() == (folder / into.name).resolve():
        expected = "a model outside of the folder of the results, which gets the copy"
        raise options.unusable(expected, "--into", str(into))
    filled = filled_model(into, to, joints, _names(joints, named))
    texts = {into.name: filled.content.decode("utf-8")}
    if to == "mjcf" and (text := load_friction_text(dict(zip(filled.places, joints, strict=True)))):
        texts[LOAD_FRICTION_FILE] = text
    placed = [replace(joint, in_model=at) for joint, at in zip(joints, filled.places, strict=True)]
    _write(folder, texts | _drawn(placed, draws, filled.links))
    for remark in filled.remarks:
        say(remark)


def _names(joints: "Sequence[ExportedJoint]", named: "Sequence[str]") -> dict[str, str]:
    """Return joint of the log to joint of the model, as --joint says it."""
    names = {}
    for text in named:
        log, equals, model = text.partition("=")
        if not equals and len(joints) == 1:
            log, model = joints[0].name, text
        elif not equals:
            expected = "LOG=MODEL, where there are several joints"
            raise options.unusable(expected, "--joint", text)
        names[log] = model
    return names


def _drawn(
    joints: "Sequence[ExportedJoint]", draws: int | None, links: "Mapping[str, float]"
) -> dict[str, str]:
    from bayesfric.export.of_joints import draws_table

    if draws is None:
        return {}
    text, below = draws_table(joints, draws, links)
    if below:
        say(f"{below} draws with a number below zero are left out of {DRAWS}", err=True)
    return {DRAWS: text}


def _write(folder: Path, texts: "Mapping[str, str]") -> None:
    from bayesfric.results import replace_outputs

    replace_outputs(folder, {file: text.encode() for file, text in texts.items()})
    for file in texts:
        say(f"{folder / file}")
