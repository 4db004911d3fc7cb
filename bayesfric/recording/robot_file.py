"""Checks that the file of a robot's model can be read and has the named joints."""

import posixpath
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from xml.etree.ElementTree import Element

from bayesfric.errors import Fault, InputError, first_of, near
from bayesfric.files import xml_root
from bayesfric.link_shapes import weightless_shapes
from bayesfric.recording.package import fault_of_key
from bayesfric.recording.tables import Robot

LARGEST_MODEL = 16 * 1024**2  # bytes; the model of an arm, without meshes, has a few kilobytes
LARGEST_IN_ALL = 64 * 1024**2  # bytes of all files that a model needs
MOST_FILES = 200  # most files that a model may need
NAMED = 12  # most joints that are listed


def files_of_model(robot: Robot, load: Callable[[str], bytes]) -> dict[str, bytes]:
    """Return the files that a model includes, and the meshes that give links their mass.

    Parameters
    ----------
    robot : Robot
        The robot, with the content of its file.
    load : callable
        From a path in the folder of the recording to the bytes of that file.

    Raises
    ------
    InputError
        A file cannot be read or is outside the folder, or the files are too many or too large.
    """
    folder = posixpath.dirname(robot.model)
    files: dict[str, bytes] = {}
    roots = [_parsed(robot.content)]
    for root in roots:  # grows with the includes of each file
        if root is None or root.tag == "robot":
            continue
        for element in root.iter("include"):
            name = posixpath.normpath(posixpath.join(folder, element.get("file", "")))
            if name not in files and name != robot.model:
                _keep(files, name, load(name), robot.model)
                roots.append(_parsed(files[name]))
    for name in _meshes(folder, [root for root in roots if root is not None]):
        _keep(files, name, load(name), robot.model)
    return files


def _keep(files: dict[str, bytes], name: str, content: bytes, model: str) -> None:
    files[name] = content
    size = sum(map(len, files.values()))
    if size > LARGEST_IN_ALL or len(files) > MOST_FILES:
        expected = f"at most {MOST_FILES} files of {LARGEST_IN_ALL:,} bytes that it needs"
        raise InputError([Fault(model, expected, value=f"{len(files)} files, {size:,} bytes")])


def _parsed(content: bytes) -> Element | None:
    """Return the root element; None if the file is faulty, which is reported elsewhere."""
    try:
        return xml_root(content, "")
    except InputError:
        return None


def _meshes(folder: str, roots: Sequence[Element]) -> Iterator[str]:
    """Yield the paths of meshes of links that state no mass of their own."""
    below = ""
    for root in roots:
        for compiler in root.iter("compiler"):
            below = compiler.get("meshdir", compiler.get("assetdir", below))
    weightless = {shape for _, shape in weightless_shapes(roots)}
    shapes = {shape for root in roots for shape in root.iter("geom")}
    used = {shape.get("mesh") for shape in shapes - weightless}
    for root in roots:
        for mesh in root.iter("mesh"):
            file = mesh.get("file")
            stem = posixpath.splitext(posixpath.basename(file or ""))[0]
            if file is not None and mesh.get("name", stem) in used:
                yield posixpath.normpath(posixpath.join(folder, below, file))


def faults_of_model(robot: Robot) -> list[Fault]:
    """Return the faults of a model, and of the names that must be in it.

    Parameters
    ----------
    robot : Robot
        The robot, with the content of its file and of those that it includes.
    """
    file, content = robot.model, robot.content
    if len(content) > LARGEST_MODEL:
        expected = f"a model of at most {LARGEST_MODEL:,} bytes"
        return [Fault(file, expected, value=f"{len(content):,} bytes")]
    try:
        root = xml_root(content, file)
    except InputError as error:
        return list(error.faults)
    if root.tag not in ("robot", "mujoco"):
        expected = "URDF, whose first element is robot, or MJCF, whose first is mujoco"
        return [Fault(file, expected, row=1, value=root.tag)]
    names = [name for place in _joints(robot, root) if (name := place.get("name"))]
    return list(_unknown(robot.joints, names, file))


def moving_joints(robot: Robot) -> list[str]:
    """Return the names of the moving joints of a model; none if the file is no model."""
    root = _parsed(robot.content)
    places = [] if root is None else _joints(robot, root)
    return [
        name for place in places if (name := place.get("name")) and place.get("type") != "fixed"
    ]


def _joints(robot: Robot, root: Element) -> list[Element]:
    """Return the elements of the joints of a model, including those in included files."""
    if root.tag == "robot":
        return list(root.findall("joint"))
    included = [_parsed(content) for name, content in robot.files.items() if name.endswith(".xml")]
    return [joint for part in (root, *included) if part is not None for joint in part.iter("joint")]


def _unknown(joints: Mapping[str, str], names: Collection[str], file: str) -> list[Fault]:
    listed = first_of(names, NAMED) or "it has none"
    return [
        fault_of_key(
            f"rig.robot.joints.{joint}",
            f"a joint of {file} ({listed}){near(name, names)}",
            name,
        )
        for joint, name in joints.items()
        if name not in names
    ]


def faults_of_joints(robot: Robot, joints: Collection[str] | None) -> list[Fault]:
    """Return the joints of the table that the model lacks, and names that are missing.

    Parameters
    ----------
    robot : Robot
        The model.
    joints : collection of str or None
        Joints of ``axis_samples.csv``; None without such a column, which means a single joint.
    """
    column = "rig.robot.joints"
    if joints is None:
        if len(robot.joints) == 1:
            return []
        expected = "one joint, since axis_samples.csv has no column joint"
        return [fault_of_key(column, expected, ", ".join(robot.joints))]
    return [
        fault_of_key(f"{column}.{joint}", "this joint's name in the model")
        for joint in joints
        if joint not in robot.joints
    ]
