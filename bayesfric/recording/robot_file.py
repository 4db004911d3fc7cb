"""The file of a robot's model: whether it can be read, and has the joints that are named."""

from collections.abc import Collection, Mapping
from xml.etree import ElementTree

from bayesfric.errors import Fault, near
from bayesfric.recording.package import PACKAGE_FILE
from bayesfric.recording.tables import Robot

__all__ = ["LARGEST_MODEL", "faults_of_joints", "faults_of_model"]

LARGEST_MODEL = 16 * 1024**2  # bytes; an arm with its meshes beside it has a few kilobytes
NAMED = 12  # joints that are listed


def faults_of_model(robot: Robot) -> list[Fault]:
    """Return what is wrong with a model and with the names that are looked for in it.

    Parameters
    ----------
    robot : Robot
        With the content of its file.
    """
    file, content = robot.model, robot.content
    if len(content) > LARGEST_MODEL:
        expected = f"a model of at most {LARGEST_MODEL:,} bytes"
        return [Fault(file, expected, value=f"{len(content):,} bytes")]
    if b"<!DOCTYPE" in content or b"<!ENTITY" in content:  # an entity may be endless
        return [Fault(file, "a model without a document type or entities of its own")]
    try:
        root = ElementTree.fromstring(content)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        return [Fault(file, f"XML that parses ({error})")]
    if root.tag not in ("robot", "mujoco"):
        expected = "URDF, whose first element is robot, or MJCF, whose first is mujoco"
        return [Fault(file, expected, row=1, value=root.tag)]
    if root.tag == "mujoco" and root.find(".//include") is not None:
        return []  # joints may be in files that it includes
    places = root.iter("joint") if root.tag == "mujoco" else iter(root.findall("joint"))
    names = [name for place in places if (name := place.get("name"))]
    return list(_unknown(robot.joints, names, file))


def _unknown(joints: Mapping[str, str], names: Collection[str], file: str) -> list[Fault]:
    listed = ", ".join(list(names)[:NAMED]) + (", …" if len(names) > NAMED else "")
    return [
        Fault(
            PACKAGE_FILE,
            f"a joint of {file} ({listed or 'it has none'}){near(name, names)}",
            column=f"rig.robot.joints.{joint}",
            value=name,
        )
        for joint, name in joints.items()
        if name not in names
    ]


def faults_of_joints(robot: Robot, joints: Collection[str] | None) -> list[Fault]:
    """Return what is wrong between a model and the joints of the table.

    Parameters
    ----------
    robot : Robot
        The model.
    joints : collection of str or None
        Of ``axis_samples.csv``; None where it has no such column, and so a single joint.
    """
    column = "rig.robot.joints"
    if joints is None:
        if len(robot.joints) == 1:
            return []
        expected = "one joint, since axis_samples.csv has no column joint"
        return [Fault(PACKAGE_FILE, expected, column=column, value=", ".join(robot.joints))]
    return [
        Fault(PACKAGE_FILE, "its name in the model, as of each joint", column=f"{column}.{joint}")
        for joint in joints
        if joint not in robot.joints
    ]
