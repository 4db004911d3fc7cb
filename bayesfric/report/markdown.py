"""Page one of the content tree as GitHub-flavoured Markdown, without its figures."""

import re
from collections.abc import Mapping, Sequence

from bayesfric.characters import legible
from bayesfric.report.content import (
    Block,
    BulletList,
    Code,
    Document,
    Emphasis,
    Figure,
    Heading,
    Inline,
    Math,
    Notice,
    Paragraph,
    Reference,
    Strong,
    Table,
    Text,
    inlines,
)
from bayesfric.report.numbering import Place, label_places, number_blocks

_RULES = {"left": "---", "center": ":-:", "right": "--:", "decimal": "--:"}


def render_summary(document: Document) -> str:
    """Write page one as GitHub-flavoured Markdown: what fits a comment on a change of code.

    Parameters
    ----------
    document : Document

    Returns
    -------
    str
        What stands before the first heading, without its figures; the same for the same
        document. References name places of the whole report.
    """
    labels = label_places(document)
    parts = [f"# {_escape(document.title)}"]
    if document.subtitle:
        parts.append(_guard(_escape(document.subtitle)))
    if document.date:
        parts.append(document.date.date().isoformat())
    for block, place in zip(document.every_block, number_blocks(document), strict=True):
        if isinstance(block, Heading):
            break
        if not isinstance(block, Figure):
            parts.append(_block(block, place, labels))
    return "\n\n".join(parts) + "\n"


def _block(block: Block, place: Place | None, labels: Mapping[str, Place]) -> str:
    match block:
        case Paragraph(words):
            return _guard(_text(words, labels))
        case BulletList(items):
            return _list(items, labels)
        case Notice():
            said = f"> **{_escape(block.title)}.** {_text(block.text, labels)}"
            points = _list(block.points, labels).splitlines()
            return "\n> ".join([said, "", *points] if points else [said])
        case Table():
            return _table(block, place.name if place else "", labels)
        case _:
            raise TypeError(f"not a block of page one: {block!r}")


def _list(items: Sequence[Text], labels: Mapping[str, Place]) -> str:
    return "\n".join(f"- {_guard(_text(item, labels))}" for item in items)


def _table(table: Table, name: str, labels: Mapping[str, Place]) -> str:
    heads = [
        _text(column.title, labels, in_table=True)
        + (f" [{_escape(column.unit)}]" if column.unit else "")
        for column in table.head
    ]
    lines = [heads, [_RULES[column.align] for column in table.head]]
    lines += [[_text(cell, labels, in_table=True) for cell in row] for row in table.rows]
    parts = [
        f"**{name}.** {_text(table.caption, labels)}",
        "\n".join(f"| {' | '.join(line)} |" for line in lines),
    ]
    if table.note:
        parts.append(_guard(_text(table.note, labels)))
    return "\n\n".join(parts)


def _text(text: Text, labels: Mapping[str, Place], in_table: bool = False) -> str:
    return "".join(_inline(inline, labels, in_table) for inline in inlines(text))


def _inline(inline: Inline, labels: Mapping[str, Place], in_table: bool) -> str:
    match inline:
        case str():
            return _escape(inline)
        case Emphasis(text):
            return _marked("*", text)
        case Strong(text):
            return _marked("**", text)
        case Code(text):
            code = legible(text)
            fence = "`" * (1 + max((len(run) for run in re.findall("`+", code)), default=0))
            edge = " " if code.startswith("`") or code.endswith("`") else ""
            shown = f"{fence}{edge}{code}{edge}{fence}"
            # A cell ends at a pipe even within code.
            return shown.replace("|", "\\|") if in_table else shown
        case Math(source):
            return f"$`{source}`$"
        case Reference(label):
            return labels[label].name


def _escape(text: str) -> str:
    """Take its meaning from all that Markdown or HTML would read as markup.

    Code-hosting sites also link bare addresses, and notify whoever stands after an @: the
    first are escaped too; no escape hinders the second, and an invisible word joiner does.
    """
    shown = re.sub(r"[\\`*_{}\[\]<>#|~$&]|(?<=\w):(?=//)|(?<=\bwww)\.", r"\\\g<0>", legible(text))
    return re.sub(r"@(?=\w)", "@\u2060", shown)


def _marked(mark: str, text: str) -> str:
    """Mark words; a blank inside of the marks, at an end, would make them plain characters."""
    words = text.strip()
    before, _, after = text.partition(words)
    return f"{before}{mark}{_escape(words)}{mark}{after}" if words else text


def _guard(line: str) -> str:
    """Take its meaning from what makes a list or a rule, at the start of a line only."""
    line = re.sub(r"^([-+=])", r"\\\1", line.strip())
    return re.sub(r"^(\d+)([.)])", r"\1\\\2", line)
