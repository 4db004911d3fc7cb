"""A user's own model with the fields of its joints set; all else of the file stays as it is."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from bayesfric.errors import Fault, InputError, one_of
from bayesfric.robots.mjcf_defaults import with_default
from bayesfric.robots.xml_text import (
    Edit,
    Element,
    edited,
    elements_of,
    inserted,
    with_attributes,
    with_text,
)

SDF_SPRING = {"spring_reference": "0", "spring_stiffness": "0"}
"""What SDFormat asks for wherever there is a ``dynamics``."""
KINDS = {"mujoco": "mjcf", "robot": "urdf", "sdf": "sdf"}
"""Formats by the element that a file begins with."""
TURNS = {
    "mjcf": {"hinge": True, "slide": False},
    "urdf": {"revolute": True, "continuous": True, "prismatic": False},
    "sdf": {"revolute": True, "continuous": True, "prismatic": False},
}


@dataclass(frozen=True)
class JointValues:
    """Texts of numbers to write, in SI units of the joint; None leaves what is there.

    Parameters
    ----------
    frictionloss : str or None
        Coulomb friction.
    damping : str or None
        Of MJCF up to three numbers: factors of speed, its square and its cube.
    armature : str or None
        Only MJCF has it.
    delay : str or None
        Of the joint's actuators in MJCF [s].
    samples : str or None
        Commands that such a delay keeps.
    limit : str or None
        Largest drive force or torque at the joint, behind any gear.
    """

    frictionloss: str | None = None
    damping: str | None = None
    armature: str | None = None
    delay: str | None = None
    samples: str | None = None
    limit: str | None = None


@dataclass(frozen=True)
class ModelText:
    """A model's file, and where its joints are.

    Parameters
    ----------
    name : str
        Of the file.
    content : bytes
        In UTF-8.
    kind : str
        ``mjcf``, ``urdf`` or ``sdf``.
    root : Element
        Of it.
    """

    name: str
    content: bytes
    kind: str
    root: Element

    @property
    def joints(self) -> dict[str, Element]:
        """Elements of the joints that move, by name."""
        every = self.root.walk(
            without=("default", "actuator", "tendon", "equality", "transmission")
        )
        moving = TURNS[self.kind]
        return {
            element.attributes["name"]: element
            for element in every
            if element.tag == "joint"
            and "name" in element.attributes
            and self._type(element) in moving
        }

    def turns(self, joint: str) -> bool:
        """Return whether a joint turns: its numbers are then N·m and radians."""
        return TURNS[self.kind][self._type(self.joint(joint))]

    def joint(self, name: str) -> Element:
        """Return a joint's element.

        Raises
        ------
        InputError
            The file has no joint of the name that moves.
        """
        joints = self.joints
        if name not in joints:
            included = [element.attributes.get("file", "") for element in self.root.walk()
                        if element.tag == "include"]  # fmt: skip
            where = f"; or give --into the file that has it: {', '.join(included)}"
            expected = f"{one_of(joints, name)}{where if included else ''}"
            raise InputError([Fault(self.name, expected, column="joint", value=name)])
        return joints[name]

    def actuators(self, joint: str) -> list[Element]:
        """Return the actuators of MJCF that drive a joint."""
        rooms = [element for element in self.root.children if element.tag == "actuator"]
        return [
            element
            for room in rooms
            for element in room.children
            if element.attributes.get("joint") == joint
        ]

    def written(self, joint: str) -> dict[str, str]:
        """Return damping and Coulomb friction as the file has them at a joint itself.

        Parameters
        ----------
        joint : str
            Its name in the file.

        Returns
        -------
        dict of str to str
            ``damping``, ``friction`` and ``armature``; without those that it does not say.
        """
        element = self.joint(joint)
        if self.kind == "mjcf":
            own = {
                name: element.attributes.get(field)
                for name, field in (
                    ("damping", "damping"),
                    ("friction", "frictionloss"),
                    ("armature", "armature"),
                )
            }
            return _said(**own)
        above: Element | None = element if self.kind == "urdf" else element.child("axis")
        dynamics = None if above is None else above.child("dynamics")
        if dynamics is None:
            return {}
        if self.kind == "urdf":
            own = {name: dynamics.attributes.get(name) for name in ("damping", "friction")}
        else:
            texts = {
                child.tag: self.content[child.opened : child.closed] for child in dynamics.children
            }
            own = {name: texts[name].decode() for name in ("damping", "friction") if name in texts}
        return _said(**own)

    def with_values(self, values: Mapping[str, JointValues]) -> "ModelText":
        """Return it with the fields of joints set.

        Parameters
        ----------
        values : mapping of str to JointValues
            By name of the joint in the file.

        Raises
        ------
        InputError
            The file has no such joint, or it has no axis in SDF.
        """
        edits = [
            edit for joint, own in values.items() for edit in self._edits(self.joint(joint), own)
        ]
        content = edited(self.content, edits)
        return replace(self, content=content, root=elements_of(content, self.name))

    def _type(self, joint: Element) -> str:
        if self.kind == "mjcf":
            return with_default(self.root, joint, "type") or "hinge"
        return joint.attributes.get("type", "")

    def _edits(self, joint: Element, values: JointValues) -> Iterator[Edit]:
        if self.kind == "mjcf":
            yield from self._of_mjcf(joint, values)
        elif self.kind == "urdf":
            yield from self._of_urdf(joint, values)
        else:
            yield from self._of_sdf(joint, values)

    def _of_mjcf(self, joint: Element, values: JointValues) -> Iterator[Edit]:
        own = _said(
            frictionloss=values.frictionloss, damping=values.damping, armature=values.armature
        )
        if values.limit is not None:  # at the joint: an actuator's own lies before its gear
            own |= {"actuatorfrcrange": f"-{values.limit} {values.limit}"}
            own |= {"actuatorfrclimited": "true"}
        yield with_attributes(self.content, joint, own)
        driving = _said(delay=values.delay, nsample=values.samples)
        for actuator in self.actuators(joint.attributes["name"]) if driving else ():
            yield with_attributes(self.content, actuator, driving)

    def _of_urdf(self, joint: Element, values: JointValues) -> Iterator[Edit]:
        own = _said(friction=values.frictionloss, damping=values.damping)
        dynamics, limit = joint.child("dynamics"), joint.child("limit")
        if dynamics is not None:
            yield with_attributes(self.content, dynamics, own)
        elif own:
            written = " ".join(f'{name}="{value}"' for name, value in own.items())
            indent = _indent(self.content, joint)
            yield inserted(self.content, joint, f"{indent}<dynamics {written}/>")
        if limit is not None and values.limit is not None:
            yield with_attributes(self.content, limit, {"effort": values.limit})

    def _of_sdf(self, joint: Element, values: JointValues) -> Iterator[Edit]:
        axis = joint.child("axis")
        if axis is None:
            name = joint.attributes["name"]
            raise InputError([Fault(self.name, "a joint with an <axis>", column=name)])
        own = _said(damping=values.damping, friction=values.frictionloss)
        dynamics, limit = axis.child("dynamics"), axis.child("limit")
        if dynamics is not None:
            yield from with_text(self.content, dynamics, own)
        elif own:
            fields = own | SDF_SPRING
            written = "".join(f"<{name}>{value}</{name}>" for name, value in fields.items())
            yield inserted(self.content, axis, f"<dynamics>{written}</dynamics>")
        if limit is not None and values.limit is not None:
            yield from with_text(self.content, limit, {"effort": values.limit})


def model_text(content: bytes, name: str) -> ModelText:
    """Return a model's file, its format told by the element that it begins with.

    Parameters
    ----------
    content : bytes
        Of the file.
    name : str
        Of the file, for faults.

    Raises
    ------
    InputError
        It is no XML, or no model.
    """
    root = elements_of(content, name)
    if root.tag not in KINDS:
        expected = "a model in MJCF (<mujoco>), URDF (<robot>) or SDF (<sdf>)"
        raise InputError([Fault(name, expected, value=f"<{root.tag}>")])
    return ModelText(name, content, KINDS[root.tag], root)


def _said(**values: str | None) -> dict[str, str]:
    return {name: value for name, value in values.items() if value is not None}


def _indent(content: bytes, parent: Element) -> str:
    """Return the line break and blanks that stand before the first thing in an element."""
    if not parent.children:
        return ""
    before = content[parent.opened : parent.children[0].start]
    return before.decode() if not before.strip() else ""
