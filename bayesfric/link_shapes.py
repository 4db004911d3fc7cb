"""Shapes of an MJCF model from which no link has its mass: nothing needs their meshes."""

from collections.abc import Iterator, Sequence
from xml.etree.ElementTree import Element


def weightless_shapes(roots: Sequence[Element]) -> Iterator[tuple[Element, Element]]:
    """Yield the elements that hold a shape, and the shape, where it gives no link a mass.

    It is of the world, of a link that states its mass itself, or a height field.

    Parameters
    ----------
    roots : sequence of Element
        The model's, and those of files that it includes.
    """
    stated_mass_counts = not _masses_are_of_shapes(roots)
    for root in roots:
        yield from _weightless(root, False, stated_mass_counts)


def _masses_are_of_shapes(roots: Sequence[Element]) -> bool:
    """Return whether shapes overrule masses that links state: as compiled, the last one says."""
    said = [
        compiler.attrib["inertiafromgeom"]
        for root in roots
        for compiler in root.iter("compiler")
        if "inertiafromgeom" in compiler.attrib
    ]
    return said[-1:] == ["true"]


def _weightless(
    parent: Element, weightless: bool, stated_mass_counts: bool
) -> Iterator[tuple[Element, Element]]:
    if parent.tag == "worldbody":
        weightless = True
    elif parent.tag == "body":
        weightless = stated_mass_counts and _states_mass(parent)
    for child in parent:
        if child.tag == "geom" and (weightless or "hfield" in child.attrib):
            yield parent, child
        yield from _weightless(child, weightless, stated_mass_counts)


def _states_mass(body: Element) -> bool:
    """Return whether a link has an ``inertial``, be it in a frame."""
    return body.find("inertial") is not None or any(map(_states_mass, body.findall("frame")))
