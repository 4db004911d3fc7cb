"""The robot's model that a mapping names, for the recording."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from bayesfric.errors import Fault, InputError
from bayesfric.files import file_bytes
from bayesfric.logs.mapping import RobotModel
from bayesfric.recording.robot_file import (
    LARGEST_MODEL,
    faults_of_model,
    files_of_model,
    moving_joints,
)
from bayesfric.recording.tables import Robot


def robot_of(model: RobotModel, folder: Path, joints: Sequence[str | None]) -> Robot:
    """Return a model with its included files, and its names of the joints.

    Parameters
    ----------
    model : RobotModel
        The model, as in the mapping.
    folder : Path
        Folder of the mapping; nothing outside of it is opened.
    joints : sequence of str or None
        Imported joints; a joint that the mapping does not name keeps its name.

    Raises
    ------
    InputError
        The model cannot be read, or has no such joint.
    """

    def load(name: str) -> bytes:
        path = (folder / name).resolve()
        if not path.is_relative_to(folder.resolve()):
            expected = "a file in the folder of the mapping, or below it"
            raise InputError([Fault("the mapping", expected, column="robot.model", value=name)])
        return file_bytes(path, name, LARGEST_MODEL)

    places = {name: model.joints.get(name, name) for name in (joint or "joint" for joint in joints)}
    if list(joints) == [None] and len(model.joints) == 1:  # its name in the mapping does not matter
        places = dict(model.joints)
    robot = Robot(model.model, places, load(model.model))
    robot = replace(robot, files=files_of_model(robot, load))
    only = moving_joints(robot)
    if list(joints) == [None] and not model.joints and len(only) == 1:  # the only joint
        robot = replace(robot, joints=dict.fromkeys(places, only[0]))
    faults = faults_of_model(robot)
    if faults:
        raise InputError([_of_mapping(fault) for fault in faults])
    return robot


def _of_mapping(fault: Fault) -> Fault:
    """Return a fault of the joints at the key of the mapping that would correct it."""
    place = "rig.robot.joints."
    if fault.column is None or not fault.column.startswith(place):
        return fault
    joint = fault.column.removeprefix(place)
    expected = f'{fault.expected}: under [robot], joints = {{{joint} = "its name there"}}'
    return Fault("the mapping", expected, column=f"robot.joints.{joint}", value=fault.value)
