"""What an element of MJCF has from its class of defaults, where it does not say it itself."""

from collections.abc import Iterator

from bayesfric.robots.xml_text import Element

MAIN = "main"
"""Class of what says none; the outermost ``default`` is it."""


def with_default(root: Element, element: Element, attribute: str) -> str | None:
    """Return an attribute of an element, its own or of its class; None where neither says it.

    Parameters
    ----------
    root : Element
        Of the file; classes of files that it includes are not seen.
    element : Element
        In a body.
    attribute : str
        Its name.
    """
    if attribute in element.attributes:
        return element.attributes[attribute]
    below = list(_chain(root, element))
    of_children = [parent.attributes.get("childclass") for parent in reversed(below)]
    said = [element.attributes.get("class"), *of_children]
    own_class = next((name for name in said if name is not None), MAIN)
    values: dict[str, str | None] = {MAIN: None}
    for default in root.children:
        if default.tag == "default":
            _collect(default, MAIN, element.tag, attribute, values)
    return values.get(own_class)


def _collect(
    default: Element, name: str, tag: str, attribute: str, values: dict[str, str | None]
) -> None:
    """Add what a class and those in it say, which have from it what they do not say."""
    own = default.child(tag)
    if own is not None and attribute in own.attributes:
        values[name] = own.attributes[attribute]
    values.setdefault(default.attributes.get("class", name), values[name])
    for inner in default.children:
        if inner.tag == "default":
            inner_name = inner.attributes.get("class", "")
            values[inner_name] = values[name]
            _collect(inner, inner_name, tag, attribute, values)


def _chain(parent: Element, element: Element) -> Iterator[Element]:
    """Yield the elements that an element is in, from the root inwards; nothing elsewhere."""
    for child in parent.children:
        if child is element:
            yield parent
            return
        inner = list(_chain(child, element))
        if inner:
            yield parent
            yield from inner
            return
