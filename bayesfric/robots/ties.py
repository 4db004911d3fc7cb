"""Joints that something of a model moves with others: equalities of MJCF, mimics of URDF."""

from collections.abc import Collection, Iterator
from xml.etree.ElementTree import Element

from bayesfric.errors import Fault, InputError


def refuse_ties(model: str, root: Element, logged: Collection[str]) -> None:
    """Refuse a model in which a joint that was logged is tied to others.

    A tie pulls at its joints with a force that no log has.

    Parameters
    ----------
    model : str
        Its file.
    root : Element
        Of URDF, or of MJCF with what it includes.
    logged : collection of str
        Names in the model.

    Raises
    ------
    InputError
        A logged joint is tied.
    """
    ties = _mimics(root) if root.tag == "robot" else _equalities(root)
    faults = [
        Fault(
            model,
            f"no logged joint among joints that move by themselves ({', '.join(own)} of the log "
            "is in it: leave it out of rig.robot.joints, or the tie out of the model)",
            value=f"<{tag}>",
        )
        for tag, joints in ties
        if (own := sorted(set(logged) & joints))
    ]
    if faults:
        raise InputError(faults)


def _mimics(root: Element) -> Iterator[tuple[str, set[str]]]:
    for joint in root.findall("joint"):
        for mimic in joint.findall("mimic"):
            yield "mimic", {joint.get("name", ""), mimic.get("joint", "")}


def _equalities(root: Element) -> Iterator[tuple[str, set[str]]]:
    """Yield the kind of each equality that is active, and the joints that it ties."""
    above = {child: parent for parent in root.iter() for child in parent}
    for equality in root.findall("equality"):
        for tie in equality:
            if tie.get("active") != "false":
                yield tie.tag, _tied(root, above, tie)


def _tied(root: Element, above: dict[Element, Element], tie: Element) -> set[str]:
    ends = [tie.get(f"{tie.tag}{end}") for end in (1, 2)]
    if tie.tag == "joint":
        return {name for name in ends if name is not None}
    if tie.tag == "tendon":
        tendons = [tendon for room in root.findall("tendon") for tendon in room]
        return set().union(
            *(_of_tendon(root, above, tendon) for tendon in tendons if tendon.get("name") in ends)
        )
    kind = "site" if tie.get("site1") is not None else "body"
    return _between(root, above, kind, [tie.get(f"{kind}{end}") for end in (1, 2)])


def _of_tendon(root: Element, above: dict[Element, Element], tendon: Element) -> set[str]:
    """Return the joints that a tendon goes over: named ones, or those between its sites."""
    named = {part.get("joint", "") for part in tendon if part.tag == "joint"}
    sites = [part.get("site") for part in tendon if part.tag == "site"]
    return named | _between(root, above, "site", sites)


def _between(
    root: Element, above: dict[Element, Element], kind: str, names: Collection[str | None]
) -> set[str]:
    """Return the joints that move some, and not all, of bodies or sites; None is the world."""
    elements = {element.get("name"): element for element in root.iter(kind)}
    chains = [_moving(above, elements.get(name)) for name in names]
    everywhere: set[str] = set.intersection(*chains) if chains else set()
    return set().union(*chains) - everywhere


def _moving(above: dict[Element, Element], element: Element | None) -> set[str]:
    """Return the joints between the world and an element."""
    joints: set[str] = set()
    while element is not None:
        joints |= {joint.get("name", "") for joint in element.findall("joint")}
        element = above.get(element)
    return joints
