"""What a document tells, as plain text: a block a line, a row of a table a line."""

from bayesfric.report.content import inlines


def plain(text):
    """The words of a text, formulas as their source."""
    return "".join(
        inline
        if isinstance(inline, str)
        else getattr(inline, "text", getattr(inline, "source", ""))
        for inline in inlines(text)
    )


def told(document):
    lines = []
    for block in getattr(document, "every_block", document.blocks):
        parts = (getattr(block, name, "") for name in ("title", "text", "caption", "note", "alt"))
        lines += [plain(part) for part in parts if part]
        lines += [plain(item) for item in getattr(block, "items", ())]
        lines += [" | ".join(map(plain, row)) for row in getattr(block, "rows", ())]
    return "\n".join(lines)
