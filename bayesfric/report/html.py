"""The content tree as one HTML file that needs no other file.

Its scripts, which sort tables and draw charts, are the template's and a library's: nothing of a
document is ever in them. Data of charts stand in the page as JSON.

Every piece of text goes through markupsafe's escaping; the frame and the style are
a Jinja template. Figures are images of their own, so that the identifiers inside
their SVG cannot meet.
"""

import base64
import re
from collections.abc import Mapping, Sequence
from importlib import resources

import jinja2
from jinja2.utils import htmlsafe_json_dumps
from markupsafe import Markup

from bayesfric.characters import legible
from bayesfric.plots.live import chart_data
from bayesfric.report import content
from bayesfric.report.formulas import FORMULAS
from bayesfric.report.live import live_scripts
from bayesfric.report.numbering import Place, label_places, number_blocks


def render_html(document: content.Document) -> str:
    """Write a document as a self-contained, accessible HTML page.

    Parameters
    ----------
    document : Document

    Returns
    -------
    str
        The same for the same document; to be stored as UTF-8.
    """
    places = number_blocks(document)
    labels = label_places(document)
    shown = [
        _block(block, place, labels)
        for block, place in zip(document.every_block, places, strict=True)
    ]
    listed = document.listed
    heads = (i for i, block in enumerate(document.blocks) if isinstance(block, content.Heading))
    first = next(heads, len(shown))
    live = any(isinstance(b, content.Figure) and b.charts is not None for b in document.every_block)
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    template = resources.files(__package__).joinpath("template.html").read_text(encoding="utf-8")
    return environment.from_string(template).render(
        title=legible(document.title),
        subtitle=legible(document.subtitle),
        day=document.date.date().isoformat() if document.date else "",
        scripts=[Markup(script) for script in (live_scripts() if live else ())],
        front=shown[:first],
        body=shown[first:],
        contents=[
            (block.level, place.anchor, place.number, legible(block.text))
            for block, place in zip(document.every_block, places, strict=True)
            if place is not None and isinstance(block, content.Heading) and block in listed
        ],
    )


def _block(block: content.Block, place: Place | None, labels: Mapping[str, Place]) -> Markup:
    match block:
        case content.Heading(level, words) if place is not None:
            # The document's title is the only h1.
            return Markup('<h{0} id="{1}"><span class="number">{2}</span> {3}</h{0}>').format(
                level + 1, place.anchor, place.number, legible(words)
            )
        case content.Paragraph(words):
            return Markup("<p>{}</p>").format(_text(words, labels))
        case content.BulletList(items):
            return _list(items, labels)
        case content.Notice(kind, words, title, points):
            return Markup(
                '<div class="notice {}" role="note"><p><strong>{}.</strong> {}</p>{}</div>'
            ).format(kind, legible(title), _text(words, labels), _list(points, labels))
        case content.Listing(words):
            # Focusable, since only then can the keyboard scroll it.
            return Markup('<pre tabindex="0"><code>{}</code></pre>').format(
                legible(words, lines=True)
            )
        case content.Equation(source) if place is not None:
            return Markup(
                '<div class="equation" id="{}">{} <span class="number">({})</span></div>'
            ).format(place.anchor, _formula(source, block=True), place.number)
        case content.Figure() if place is not None:
            data = base64.b64encode(block.svg).decode("ascii")
            return Markup(
                '<figure id="{}" tabindex="0">\n<img style="width: {:.4g}%" alt="{}" '
                'src="data:image/svg+xml;base64,{}">\n'
                "{}<figcaption><strong>{}.</strong> {}</figcaption>\n</figure>"
            ).format(
                place.anchor,
                100 * block.width,
                legible(block.alt),
                data,
                _charts(block),
                place.name,
                _text(block.caption, labels),
            )
        case content.Table() if place is not None:
            return _table(block, place, labels)
        case _:
            raise TypeError(f"not a block: {block!r}")


def _list(items: Sequence[content.Text], labels: Mapping[str, Place]) -> Markup:
    """Return a list of points; nothing where there are none."""
    points = Markup("\n").join(Markup("<li>{}</li>").format(_text(i, labels)) for i in items)
    return Markup("<ul>\n{}\n</ul>").format(points) if items else points


def _charts(figure: content.Figure) -> Markup:
    """Return the charts of a figure as data, which the page's script draws; nothing without any."""
    if figure.charts is None or not live_scripts():
        return Markup("")
    charts = [chart_data(chart) for chart in figure.charts()]
    held = htmlsafe_json_dumps(charts, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    kind = "charts beside" if figure.beside else "charts"
    return Markup('<script type="application/json" class="{}">{}</script>\n').format(kind, held)


def _table(table: content.Table, place: Place, labels: Mapping[str, Place]) -> Markup:
    heads, cells = [], []
    for i, column in enumerate(table.head):
        unit = Markup('<br><span class="unit">{}</span>').format(legible(column.unit))
        head = _text(column.title, labels)
        # A head without words is none: screen readers would announce an empty one.
        tag = Markup('<th scope="col" class="{}">{}{}</th>' if head else '<td class="{}">{}{}</td>')
        heads.append(tag.format(column.align, head, unit if column.unit else ""))
        tag = Markup('<th scope="row" class="{}">{}</th>' if i == 0 else '<td class="{}">{}</td>')
        values = [row[i] for row in table.rows]
        shown = (
            _decimals(values, labels)
            if column.align == "decimal" and values
            else [_text(value, labels) for value in values]
        )
        cells.append([tag.format(column.align, value) for value in shown])
    rows = [Markup("<tr>{}</tr>").format(Markup("").join(row)) for row in zip(*cells, strict=True)]
    note = Markup('\n<p class="note">{}</p>').format(_text(table.note, labels))
    return Markup(
        '<div class="table" id="{0}" role="region" aria-labelledby="{0}-caption" tabindex="0">\n'
        '<table>\n<caption id="{0}-caption"><span class="said"><strong>{1}.</strong> {2}</span>'
        "</caption>\n"
        "<thead>\n<tr>{3}</tr>\n</thead>\n<tbody>\n{4}\n</tbody>\n</table>{5}\n</div>"
    ).format(
        place.anchor,
        place.name,
        _text(table.caption, labels),
        Markup("").join(heads),
        Markup("\n").join(rows),
        note if table.note else "",
    )


def _decimals(values: Sequence[content.Text], labels: Mapping[str, Place]) -> list[Markup]:
    """Set decimal points under each other: the same room after the point in every cell."""
    parted = [_split(value) for value in values]
    # In widths of a digit; points, commas, blanks and brackets are narrower.
    room = max(sum(0.6 if c in ".,[]() \u202f" else 1 for c in tail) for _, tail in parted)
    return [
        Markup('{}<span class="tail" style="min-width: {:.3g}ch">{}</span>').format(
            legible(head), room, legible(tail)
        )
        if head
        else _text(value, labels)
        for value, (head, tail) in zip(values, parted, strict=True)
    ]


def _split(value: content.Text) -> tuple[str, str]:
    """Part a number before its decimal point; no head where there is no number."""
    match = re.match("[^0-9]*[0-9]+", value) if isinstance(value, str) else None
    if match is None:
        return "", ""
    return match[0], match.string[match.end() :]


def _text(text: content.Text, labels: Mapping[str, Place]) -> Markup:
    return Markup("").join(_inline(inline, labels) for inline in content.inlines(text))


def _inline(inline: content.Inline, labels: Mapping[str, Place]) -> Markup:
    match inline:
        case str():
            return Markup("{}").format(legible(inline))
        case content.Emphasis(text):
            return Markup("<em>{}</em>").format(legible(text))
        case content.Strong(text):
            return Markup("<strong>{}</strong>").format(legible(text))
        case content.Code(text):
            return Markup("<code>{}</code>").format(legible(text))
        case content.Math(source):
            return _formula(source)
        case content.Reference(label):
            return Markup('<a class="reference" href="#{}">{}</a>').format(
                labels[label].anchor, labels[label].name
            )


def _formula(source: str, block: bool = False) -> Markup:
    formula = FORMULAS[source]
    # A symbol alone may name a row, whose name assistive technology takes from the label.
    more = Markup(' display="block"' if block else ' aria-label="{}"').format(formula.spoken)
    return Markup('<math alttext="{}"{}>{}</math>').format(
        formula.spoken, more, Markup(formula.mathml)
    )
