"""What a report says, free of how it looks: one small tree of blocks and inlines.

Chapters build this tree from stored results; the Typst, HTML and Markdown
renderers show it. Text is data: nothing in a string is ever read as markup, in
any renderer. Where a text is wanted, a plain ``str``, a single inline or a
sequence of both will do.

The blocks before the first heading are the front matter: they stand on page one, between
the title and the table of contents where there is one.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from functools import cached_property
from typing import TYPE_CHECKING, Literal, TypeAlias

from bayesfric.report.quantities import MISSING
from bayesfric.report.words import Code as Code
from bayesfric.report.words import Emphasis as Emphasis
from bayesfric.report.words import Inline as Inline
from bayesfric.report.words import Math as Math
from bayesfric.report.words import Reference as Reference
from bayesfric.report.words import Strong as Strong
from bayesfric.report.words import Text as Text
from bayesfric.report.words import inlines as inlines
from bayesfric.report.words import prose as prose
from bayesfric.report.words import require, require_formula, require_text

if TYPE_CHECKING:
    from bayesfric.plots.live import Chart

LISTED = 2  # levels of the table of contents
SHORT = 12  # headings of a document that a reader leafs through


@dataclass(frozen=True)
class Heading:
    """A numbered heading of level 1 (chapter) to 3."""

    level: Literal[1, 2, 3]
    text: str
    label: str | None = None

    def __post_init__(self) -> None:
        require(self.level in (1, 2, 3), f"heading: expected a level of 1 to 3, got {self.level}")
        require_text(self.text, "heading")


@dataclass(frozen=True)
class Paragraph:
    """A paragraph of running text."""

    text: Text


@dataclass(frozen=True)
class BulletList:
    """A list of points without order."""

    items: Sequence[Text]


@dataclass(frozen=True)
class Notice:
    """A boxed remark that a hurried reader must not miss.

    Parameters
    ----------
    kind : {"attention", "good", "info"}
        Sets its colour, its sign and, unless a title is given, its first word.
    text : str, inline or sequence of inlines
    title : str, optional
        By default "Attention", "In order" or "Note".
    points : sequence of texts, optional
        A list that stands in the box, below its text.
    """

    kind: Literal["attention", "good", "info"]
    text: Text
    title: str = ""
    points: Sequence[Text] = ()

    def __post_init__(self) -> None:
        words = {"attention": "Attention", "good": "In order", "info": "Note"}
        require(self.kind in words, f"notice: expected one of {list(words)}, got {self.kind!r}")
        if not self.title:
            object.__setattr__(self, "title", words[self.kind])


@dataclass(frozen=True)
class Listing:
    """Lines shown as they are in a typewriter face: commands, a part of a file."""

    text: str


@dataclass(frozen=True)
class Equation:
    """A numbered formula on a line of its own.

    Parameters
    ----------
    source : str
        As in `Math`.
    label : str, optional
    """

    source: str
    label: str | None = None

    def __post_init__(self) -> None:
        require_formula(self.source)


@dataclass(frozen=True)
class Column:
    """One column of a table.

    Parameters
    ----------
    title : str, inline or sequence of inlines
    unit : str, optional
        Shown beneath the title, as written.
    align : {"left", "right", "center", "decimal"}
        "decimal" sets the decimal points of a column of numbers under each other.
    """

    title: Text
    unit: str = ""
    align: Literal["left", "right", "center", "decimal"] = "left"

    def __post_init__(self) -> None:
        alignments = ("left", "right", "center", "decimal")
        require(
            self.align in alignments, f"column: expected align in {alignments}, got {self.align!r}"
        )


def decimal_columns(*titles: str) -> tuple[Column, ...]:
    """Return columns of numbers whose decimal marks stand below one another."""
    return tuple(Column(title, align="decimal") for title in titles)


def right_columns(*titles: str) -> tuple[Column, ...]:
    """Return columns whose cells end at their right edge."""
    return tuple(Column(title, align="right") for title in titles)


@dataclass(frozen=True)
class Table:
    """A numbered table; its cells are formatted already.

    Parameters
    ----------
    caption : str, inline or sequence of inlines
    columns : sequence of Column or str
        A plain ``str`` is a title over a left-aligned column.
    rows : sequence of rows, each a cell a column
        The first cell of a row names it (screen readers announce it).
    label : str, optional
        What a `Reference` names it by.
    note : str, inline or sequence of inlines, optional
        Small print beneath the table.

    Raises
    ------
    ValueError
        If there is no column, or a row has more or fewer cells than columns.
    """

    caption: Text
    columns: Sequence[Column | str]
    rows: Sequence[Sequence[Text]]
    label: str | None = None
    note: Text = ""

    def __post_init__(self) -> None:
        require_text(self.caption, "table, caption")
        require(bool(self.columns), "table: expected a column")
        for number, row in enumerate(self.rows, start=1):
            require(
                not isinstance(row, str) and len(row) == len(self.columns),
                f"table, row {number}: expected {len(self.columns)} cells, got {row!r}",
            )

    def filled(self) -> "Table":
        """Return it without the columns in which no row says anything."""
        kept = [
            i
            for i in range(len(self.columns))
            if i == 0 or any(row[i] not in ("", MISSING) for row in self.rows)
        ]
        return replace(
            self,
            columns=[self.columns[i] for i in kept],
            rows=[[row[i] for i in kept] for row in self.rows],
        )

    @property
    def head(self) -> tuple[Column, ...]:
        """The columns, each as a Column."""
        return tuple(c if isinstance(c, Column) else Column(c) for c in self.columns)


@dataclass(frozen=True)
class Figure:
    """A numbered picture.

    Parameters
    ----------
    draw : callable
        () to its SVG, as from `bayesfric.plots.style.svg_of`: text as paths, nothing external.
    caption : str, inline or sequence of inlines
    alt : str
        What the picture shows, for people who do not see it.
    label : str, optional
        What a `Reference` names it by.
    width : float
        Share of the text width, over 0 to 1.
    charts : callable or None
        () to charts of the same numbers, for a reader who hovers and zooms.
    beside : bool
        Whether charts stand below the picture, which shows more than they do, and not in its
        place.
    floats : bool
        Whether it may stand at the head or foot of a page on paper, so that words go on.
    """

    draw: Callable[[], bytes]
    caption: Text
    alt: str
    label: str | None = None
    width: float = 1.0
    floats: bool = False
    charts: Callable[[], Sequence["Chart"]] | None = None
    beside: bool = False

    def __post_init__(self) -> None:
        require_text(self.caption, "figure, caption")
        require_text(self.alt, "figure, alt")
        require(0 < self.width <= 1, f"figure: expected a width in (0, 1], got {self.width}")

    @cached_property
    def svg(self) -> bytes:
        """The picture; drawn once, and only where a renderer shows it."""
        drawn = self.draw()
        require(b"<svg" in drawn, f"figure: expected SVG, got {drawn[:40]!r}")
        return drawn


def from_file(file: str, *words: Inline) -> list[Inline]:
    """Return a caption that ends with the stored file that its figure is drawn from."""
    *others, last = words
    return [*others, f"{last} From ", Code(file), "."]


Block: TypeAlias = Heading | Paragraph | BulletList | Notice | Listing | Equation | Table | Figure


@dataclass(frozen=True)
class Document:
    """A whole report.

    Parameters
    ----------
    title, subtitle : str
    blocks : sequence of Block
    date : datetime, optional
        Printed as a day, and set as the creation date; one without a time zone
        is taken as UTC.
    details : sequence of Block
        What follows on the HTML page alone. On paper nothing refers to it.

    Raises
    ------
    ValueError
        If two blocks have one label, a reference leads nowhere, or a heading
        skips a level.
    """

    title: str
    subtitle: str
    blocks: Sequence[Block]
    date: datetime | None = None
    details: Sequence[Block] = ()

    def __post_init__(self) -> None:
        require_text(self.title, "document, title")
        _check_labels(self.blocks)
        _check_labels(self.every_block)
        level = 0
        for block in self.every_block:
            if isinstance(block, Heading):
                # PDF/UA and screen readers need an outline without holes.
                require(
                    block.level <= level + 1,
                    f"heading {block.text!r}: expected a level of {level + 1} at most, "
                    f"got {block.level}",
                )
                level = block.level

    @property
    def every_block(self) -> tuple[Block, ...]:
        """What stands on paper, and then the details."""
        return (*self.blocks, *self.details)

    @property
    def listed(self) -> tuple[Heading, ...]:
        """Headings of the table of contents; none where the document is too short for one."""
        every = tuple(b for b in self.blocks if isinstance(b, Heading) and b.level <= LISTED)
        return every if len(every) > SHORT else ()


def _check_labels(blocks: Sequence[Block]) -> None:
    labels: set[str] = set()
    for block in blocks:
        label = getattr(block, "label", None)
        require(label not in labels, f"two blocks have the label {label!r}")
        if label is not None:
            labels.add(label)
    for block in blocks:
        for text in _texts(block):
            for inline in inlines(text):
                if isinstance(inline, Reference):
                    require(
                        inline.label in labels,
                        f"reference to {inline.label!r}: expected one of {sorted(labels)}",
                    )


def _texts(block: Block) -> Iterator[Text]:
    match block:
        case Paragraph():
            yield block.text
        case Notice():
            yield from (block.text, *block.points)
        case BulletList():
            yield from block.items
        case Figure():
            yield block.caption
        case Table():
            yield block.caption
            yield block.note
            for column in block.head:
                yield column.title
            for row in block.rows:
                yield from row
