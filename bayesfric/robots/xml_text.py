"""Elements of an XML file with their places in its text, so that few bytes of it are changed.

Comments, order, indents and whatever a program of this package does not know stay as they are.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from xml.parsers import expat

from bayesfric.errors import Fault, InputError


@dataclass
class Element:
    """An element, and where it stands.

    Parameters
    ----------
    tag : str
        Its name.
    attributes : dict of str to str
        As written.
    start, opened : int
        Bytes at which its start tag begins, and ends.
    closed : int
        Byte at which its end tag begins; that of `opened` where it has none.
    children : list of Element
        Elements in it.
    """

    tag: str
    attributes: dict[str, str]
    start: int
    opened: int
    closed: int = 0
    children: list["Element"] = field(default_factory=list)

    @property
    def empty(self) -> bool:
        """Whether it is one tag, which ends with ``/>``."""
        return self.closed <= self.opened and not self.children

    def child(self, tag: str) -> "Element | None":
        """Return the first element in it of a name; None without one."""
        return next((child for child in self.children if child.tag == tag), None)

    def walk(self, *, without: Sequence[str] = ()) -> Iterator["Element"]:
        """Yield it and all elements in it, but those below elements of some names."""
        yield self
        for child in self.children:
            if child.tag not in without:
                yield from child.walk(without=without)


@dataclass(frozen=True)
class Edit:
    """Bytes that take the place of others."""

    start: int
    end: int
    text: bytes


def elements_of(content: bytes, name: str) -> Element:
    """Return the root element of a file.

    Parameters
    ----------
    content : bytes
        In UTF-8.
    name : str
        Of the file, for faults.

    Raises
    ------
    InputError
        It is no XML in UTF-8, or it declares entities.
    """
    if b"<!DOCTYPE" in content or b"<!ENTITY" in content:
        raise InputError([Fault(name, "XML without entities (<!DOCTYPE … >)")])
    parser = expat.ParserCreate()
    roots: list[Element] = []
    stack: list[Element] = []

    def begin(tag: str, attributes: dict[str, str]) -> None:
        start = parser.CurrentByteIndex
        element = Element(tag, attributes, start, _end_of_tag(content, start))
        (stack[-1].children if stack else roots).append(element)
        stack.append(element)

    def end(tag: str) -> None:
        del tag
        stack.pop().closed = parser.CurrentByteIndex

    parser.StartElementHandler, parser.EndElementHandler = begin, end
    try:
        content.decode("utf-8")
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError) as error:
        raise InputError([Fault(name, f"XML in UTF-8 that parses ({error})")]) from error
    (root,) = roots
    return root


def edited(content: bytes, edits: Sequence[Edit]) -> bytes:
    """Return a text with the edits made; none may overlap another."""
    for edit in sorted(edits, key=lambda edit: edit.start, reverse=True):
        content = content[: edit.start] + edit.text + content[edit.end :]
    return content


def with_attributes(content: bytes, element: Element, values: Mapping[str, str]) -> Edit:
    """Return the edit that gives an element some attributes; its others stay.

    Parameters
    ----------
    content : bytes
        The file.
    element : Element
        Of it.
    values : mapping of str to str
        By attribute; without characters that XML has for itself.
    """
    tag = content[element.start : element.opened]
    for name, value in values.items():
        pattern = rb"(?<=\s)" + re.escape(name.encode()) + rb"\s*=\s*(\"[^\"]*\"|'[^']*')"
        quoted = name.encode() + b'="' + value.encode() + b'"'
        there = re.search(pattern, tag)
        if there is not None:
            tag = tag[: there.start()] + quoted + tag[there.end() :]
        else:
            ending = b"/>" if tag.endswith(b"/>") else b">"
            tag = tag[: -len(ending)].rstrip() + b" " + quoted + ending
    return Edit(element.start, element.opened, tag)


def with_text(content: bytes, parent: Element, texts: Mapping[str, str]) -> list[Edit]:
    """Return the edits that give children of an element some texts; lacking ones are added.

    Parameters
    ----------
    content : bytes
        The file.
    parent : Element
        Of it.
    texts : mapping of str to str
        By the child's name.
    """
    edits, new = [], []
    for tag, text in texts.items():
        child = parent.child(tag)
        if child is None:
            new.append(f"<{tag}>{text}</{tag}>")
        elif child.empty:
            edits.append(Edit(child.start, child.opened, f"<{tag}>{text}</{tag}>".encode()))
        else:
            edits.append(Edit(child.opened, child.closed, text.encode()))
    if new:
        edits.append(inserted(content, parent, "".join(new)))
    return edits


def inserted(content: bytes, parent: Element, text: str) -> Edit:
    """Return the edit that puts text at the beginning of an element, which may be empty so far."""
    if parent.empty:
        tag = content[parent.start : parent.opened].removesuffix(b"/>").rstrip()
        whole = tag + b">" + text.encode() + f"</{parent.tag}>".encode()
        return Edit(parent.start, parent.opened, whole)
    return Edit(parent.opened, parent.opened, text.encode())


def _end_of_tag(content: bytes, start: int) -> int:
    """Return the byte after the ``>`` that ends a start tag; one in quotes ends none."""
    quote, at = b"", start
    while True:
        char = content[at : at + 1]
        at += 1
        if quote:
            quote = b"" if char == quote else quote
        elif char in (b'"', b"'"):
            quote = char
        elif char == b">":
            return at
