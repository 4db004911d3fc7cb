"""A model without what moves nothing: shapes that are only looked at, settings of other programs.

URDF's element ``mujoco`` keeps its ``compiler`` and ``option``, which say what MuJoCo makes of it.
"""

from collections.abc import Collection
from xml.etree.ElementTree import Element

from bayesfric.link_shapes import weightless_shapes
from bayesfric.robots.ties import refuse_ties

UNSEEN = {"texture", "material", "skin", "hfield", "visual", "keyframe", "sensor"}
"""Elements of MJCF that move nothing."""
LOOKS = ("material", "texture")
"""Attributes that name such an element."""
OF_OTHERS = {"gazebo", "transmission", "ros2_control"}
"""Elements of URDF for other programs."""
READ_BY_MUJOCO = {"compiler", "option"}


def drop_for_others(root: Element) -> None:
    """Drop from URDF what other programs read, their plugins among it.

    Parameters
    ----------
    root : Element
        Changed in place; MJCF stays as it is.
    """
    if root.tag == "robot":
        _remove(root, OF_OTHERS)


def simplify_urdf(model: str, root: Element, logged: Collection[str]) -> None:
    """Drop from URDF what moves nothing.

    Parameters
    ----------
    model : str
        Its file.
    root : Element
        Changed in place.
    logged : collection of str
        Joints that were logged, by their names in the model.

    Raises
    ------
    InputError
        A logged joint is tied to others.
    """
    refuse_ties(model, root, logged)
    for link in root.iter("link"):
        _remove(link, {"visual", "collision"})
    for joint in root.iter("joint"):
        _remove(joint, {"mimic"})
    for extension in root.findall("mujoco"):
        _remove(extension, {child.tag for child in extension} - READ_BY_MUJOCO)


def simplify_mjcf(model: str, root: Element, logged: Collection[str]) -> None:
    """Drop from MJCF what moves nothing, and meshes from which no link has its mass.

    Parameters
    ----------
    model, root, logged
        As of :func:`simplify_urdf`, with the elements of the files that it includes.

    Raises
    ------
    InputError
        A logged joint is tied to others.
    """
    refuse_ties(model, root, logged)
    for parent in list(root.iter()):
        for name in LOOKS:
            parent.attrib.pop(name, None)
        for child in [element for element in parent if element.tag in UNSEEN]:
            if not (child.tag == "visual" and parent.tag == "default"):
                parent.remove(child)
    for parent, shape in list(weightless_shapes([root])):
        parent.remove(shape)
    _remove(root, {"actuator", "contact", "tendon", "equality"})


def _remove(parent: Element, tags: Collection[str]) -> None:
    for child in [element for element in parent if element.tag in tags]:
        parent.remove(child)
