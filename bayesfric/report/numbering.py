"""The numbers of headings, figures, tables and equations, the same in every format."""

from dataclasses import dataclass

from bayesfric.report.content import Document, Equation, Figure, Heading, Table


@dataclass(frozen=True)
class Place:
    """What a numbered block is called.

    Parameters
    ----------
    kind : str
        "Section", "Figure", "Table" or "Equation".
    number : str
        For example ``2.1``.
    """

    kind: str
    number: str

    @property
    def name(self) -> str:
        """As a reference shows it: "Figure 3"."""
        return f"{self.kind} {self.number}"

    @property
    def anchor(self) -> str:
        """As a link names it: "figure-3"."""
        return f"{self.kind.lower()}-{self.number.replace('.', '-')}"


def number_blocks(document: Document) -> tuple[Place | None, ...]:
    """Return the place of each block of a document and its details, None where it has no number."""
    counts = {"Figure": 0, "Table": 0, "Equation": 0}
    section = [0, 0, 0]
    places: list[Place | None] = []
    for block in document.every_block:
        match block:
            case Heading(level):
                section[level - 1] += 1
                section[level:] = [0] * (3 - level)
                places.append(Place("Section", ".".join(map(str, section[:level]))))
            case Figure() | Table() | Equation():
                kind = type(block).__name__
                counts[kind] += 1
                places.append(Place(kind, str(counts[kind])))
            case _:
                places.append(None)
    return tuple(places)


def label_places(document: Document) -> dict[str, Place]:
    """Return the place of each label of a document."""
    return {
        block.label: place
        for block, place in zip(document.every_block, number_blocks(document), strict=True)
        if isinstance(block, Heading | Figure | Table | Equation)
        and block.label is not None
        and place is not None
    }
