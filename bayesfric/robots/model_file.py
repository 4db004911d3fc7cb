"""A URDF or MJCF file, read within bounds: nothing of it is executed, nothing outside its folder.

MuJoCo's own parser compiles the model. Meshes that are only looked at are dropped before; a mesh
counts only where MJCF takes a link's mass from it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np

from bayesfric.errors import Fault, InputError, needs_extra, one_of
from bayesfric.files import file_bytes, xml_root
from bayesfric.robots.simplifying import drop_for_others, simplify_mjcf, simplify_urdf

LARGEST_FILE = 4_194_304  # bytes of the model, and of each file that it includes
LARGEST_MESHES = 67_108_864  # bytes of all meshes together
DEEPEST_INCLUDE = 8
REFUSED = {
    "plugin": "no plugin: nothing of a model is executed",
    "extension": "no extension: nothing of a model is executed",
    "composite": "links that are written out, not generated",
    "replicate": "links that are written out, not generated",
    "flexcomp": "rigid links",
    "flex": "rigid links",
}
SET_ASIDE = (
    *("dof_damping", "dof_dampingpoly", "dof_frictionloss", "dof_armature"),
    *("jnt_stiffness", "jnt_stiffnesspoly", "body_gravcomp"),
)
"""What a compiled model has beside rigid bodies; polynomials since MuJoCo 3.5.

A gravity compensation is a program's, whose force is in the log with that of the drive.
"""
HEAVIEST_KG = 1e4
"""Of one link: more is a mistake of units."""


@dataclass(frozen=True)
class JointSettings:
    """Values of one joint in MuJoCo, SI units; set aside in the rigid-body model.

    Parameters
    ----------
    frictionloss, armature : float
        Coulomb friction and the rotor's inertia.
    damping : tuple of float
        Factors of speed, its square and its cube.
    stiffness, spring_rest : float
        Of a spring, and where it is at rest [rad or m].
    """

    frictionloss: float
    armature: float
    damping: tuple[float, float, float] = (0.0, 0.0, 0.0)
    stiffness: float = 0.0
    spring_rest: float = 0.0


@dataclass(frozen=True)
class Robot:
    """A compiled model and which of its joints were logged.

    Parameters
    ----------
    compiled : mujoco.MjModel
        Damping, friction, armature and springs of all joints set to zero, and what compensates
        gravity.
    joints : tuple of str
        Names in the log, in order.
    places : tuple of int
        Joint of the model that each is.
    held : tuple of str
        Joints of the model that are not in the log: they stay at their reference position.
    settings : tuple of JointSettings
        Of each logged joint, as the user's simulator has them.
    """

    compiled: Any
    joints: tuple[str, ...]
    places: tuple[int, ...]
    held: tuple[str, ...]
    settings: tuple[JointSettings, ...]


def read_robot(
    folder: Path, model: str, joints: Mapping[str, str], gravity_m_s2: float | None = None
) -> Robot:
    """Read a robot's model.

    Parameters
    ----------
    folder : Path
        The recording's folder; nothing outside it is opened.
    model : str
        File in it, ``.urdf`` or ``.xml``.
    joints : mapping of str to str
        Joint in the log to its name in the model.
    gravity_m_s2 : float or None
        Local gravity, along −z, of a URDF that states none (in ``mujoco/option``); None is 9.81.

    Raises
    ------
    InputError
        The file, an element of it or a joint's name cannot be used.
    """
    root = _parsed(folder, model, model)
    urdf = root.tag == "robot"
    if not urdf and root.tag != "mujoco":
        expected = "a URDF model (<robot>) or an MJCF model (<mujoco>)"
        raise InputError([Fault(model, expected, value=f"<{root.tag}>")])
    if urdf:
        simplify_urdf(model, root, joints.values())
        assets: dict[str, bytes] = {}
    else:
        root = _with_includes(folder, model, root)
        simplify_mjcf(model, root, joints.values())
        assets = dict(_meshes(folder, model, root))
    compiled = _compiled(model, root, assets)
    if _without_gravity(compiled):
        compiled.opt.gravity[:] = 0.0
    elif urdf and gravity_m_s2 is not None and not _states_gravity(root):
        compiled.opt.gravity[:] = 0.0, 0.0, -gravity_m_s2
    return _with_joints(model, compiled, joints)


def robot_of_bytes(
    model: str,
    content: bytes,
    joints: Mapping[str, str],
    gravity_m_s2: float | None = None,
    files: Mapping[str, bytes] | None = None,
) -> Robot:
    """Read a robot's model from the bytes of its file and of those that it needs.

    Parameters
    ----------
    model : str
        Path of the file.
    content : bytes
        The file.
    joints, gravity_m_s2
        As of :func:`read_robot`.
    files : mapping of str to bytes, or None
        By path, what it includes or takes masses from; None is nothing.

    Raises
    ------
    InputError
        An element of it or a joint's name cannot be used, or it needs a further file.
    """
    with TemporaryDirectory() as name:
        for file, its_content in {model: content, **(files or {})}.items():
            path = _inside(Path(name), model, file)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(its_content)
        return read_robot(Path(name), model, joints, gravity_m_s2)


def _inside(folder: Path, model: str, name: str) -> Path:
    """Return the path of a file of the folder.

    Raises
    ------
    InputError
        It lies outside.
    """
    path = (folder / name).resolve()
    if not path.is_relative_to(folder.resolve()):
        raise InputError([Fault(model, "a file inside the folder of the recording", value=name)])
    return path


def _parsed(folder: Path, model: str, name: str) -> ET.Element:
    data = file_bytes(_inside(folder, model, name), name, LARGEST_FILE)
    root = xml_root(data, name)
    drop_for_others(root)
    for element in root.iter():
        if element.tag in REFUSED:
            raise InputError([Fault(name, REFUSED[element.tag], value=f"<{element.tag}>")])
    return root


def _with_includes(folder: Path, model: str, root: ET.Element, depth: int = 0) -> ET.Element:
    """Return MJCF with the elements of the files that it includes in place of the includes."""
    if depth > DEEPEST_INCLUDE:
        expected = f"files that include each other at most {DEEPEST_INCLUDE} deep"
        raise InputError([Fault(model, expected)])
    for parent in list(root.iter()):
        for place, child in reversed(list(enumerate(parent))):
            if child.tag != "include":
                continue
            beside = str(Path(model).parent / child.get("file", ""))
            included = _parsed(folder, model, beside)
            whole = _with_includes(folder, model, included, depth + 1)
            parent[place : place + 1] = list(whole)
    return root


def _meshes(folder: Path, model: str, root: ET.Element) -> Iterator[tuple[str, bytes]]:
    """Yield the meshes of the shapes that are left, by name; drop the others."""
    used = {geom.get("mesh") for geom in root.iter("geom")} - {None}
    below = ""
    for compiler in root.iter("compiler"):
        below = compiler.get("meshdir", compiler.get("assetdir", below))
    left = LARGEST_MESHES
    for asset in root.iter("asset"):
        for mesh in list(asset.findall("mesh")):
            file = mesh.get("file")
            if mesh.get("name", Path(file or "").stem) not in used:
                asset.remove(mesh)
            elif file is not None:
                name = str(Path(below) / file)
                path = _inside(folder, model, str(Path(model).parent / name))
                data = file_bytes(path, name, left)
                left -= len(data)
                yield name, data


def _compiled(model: str, root: ET.Element, assets: Mapping[str, bytes]) -> Any:
    with needs_extra("mujoco", "the extra that reads robots", "rig.robot"):
        import mujoco
    text = ET.tostring(root, encoding="unicode")
    try:
        compiled = mujoco.MjModel.from_xml_string(text, dict(assets))
    except ValueError as error:
        why = " ".join(str(error).split())
        raise InputError([Fault(model, f"a model that MuJoCo compiles ({why})")]) from error
    faults = []
    # A frame that is fixed to a link, as of a tool, needs no mass: the link has it.
    together = np.bincount(compiled.body_weldid, compiled.body_mass, compiled.nbody)
    for body in range(1, compiled.nbody):
        name, mass = compiled.body(body).name or f"body {body}", float(compiled.body_mass[body])
        if compiled.body_weldid[body] == body and together[body] <= 0:
            faults.append(Fault(model, "a link that moves to have a mass", column=name, value="0"))
        if mass > HEAVIEST_KG:
            expected = f"a mass in kg, at most {HEAVIEST_KG:g} (grams?)"
            faults.append(Fault(model, expected, column=name, value=f"{mass:g}"))
    if faults:
        raise InputError(faults)
    return compiled


def _without_gravity(compiled: Any) -> bool:
    """Return whether a flag of the model switches gravity off."""
    import mujoco

    return bool(compiled.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY)


def _states_gravity(root: ET.Element) -> bool:
    return any("gravity" in option.attrib for option in root.iter("option"))


def _with_joints(model: str, compiled: Any, joints: Mapping[str, str]) -> Robot:
    names = [compiled.joint(place).name for place in range(compiled.njnt)]
    turning_or_sliding = {2, 3}  # mjJNT_SLIDE, mjJNT_HINGE
    faults = [
        Fault("datapackage.json", one_of(names, name), column=f"rig.robot.joints.{log}", value=name)
        for log, name in joints.items()
        if name not in names
    ]
    doubled = [name for name in set(joints.values()) if list(joints.values()).count(name) > 1]
    faults += [
        Fault("datapackage.json", "each joint once", column="rig.robot.joints", value=name)
        for name in sorted(doubled)
    ]
    faults += [
        Fault(model, "hinges and slides on a fixed base", column=names[place], value="free or ball")
        for place in range(compiled.njnt)
        if int(compiled.jnt_type[place]) not in turning_or_sliding
    ]
    if faults:
        raise InputError(faults)
    places = tuple(names.index(name) for name in joints.values())
    dofs = [int(compiled.jnt_dofadr[place]) for place in places]
    settings = tuple(
        _settings(compiled, place, dof) for place, dof in zip(places, dofs, strict=True)
    )
    for array in SET_ASIDE:
        if hasattr(compiled, array):
            getattr(compiled, array)[:] = 0.0
    held = tuple(name for place, name in enumerate(names) if place not in places)
    return Robot(compiled, tuple(joints), places, held, settings)


def _settings(compiled: Any, place: int, dof: int) -> JointSettings:
    drag = compiled.dof_dampingpoly[dof] if hasattr(compiled, "dof_dampingpoly") else (0.0, 0.0)
    return JointSettings(
        frictionloss=float(compiled.dof_frictionloss[dof]),
        armature=float(compiled.dof_armature[dof]),
        damping=(float(np.ravel(compiled.dof_damping[dof])[0]), float(drag[0]), float(drag[1])),
        stiffness=float(np.ravel(compiled.jnt_stiffness[place])[0]),
        spring_rest=float(compiled.qpos_spring[compiled.jnt_qposadr[place]]),
    )
