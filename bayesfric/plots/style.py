"""How every figure looks: sizes, colours, markers, and SVG of repeatable bytes.

No figure goes through pyplot, and no setting outlives the figure it was made for.
Three sizes of pulley are told apart by colour and marker together, so
that they stay apart in grey and for the colour-blind.
"""

import io
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal, TypeAlias

import matplotlib.style
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure, SubFigure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from bayesfric.plots.labels import columns_of
from bayesfric.plots.layout import Room

TEXT_WIDTH = 160.0
"""Width of the report's text in mm: a figure so wide is shown at its own size."""

COLORS = {
    "black": "#000000",
    "orange": "#e69f00",
    "sky": "#56b4e9",
    "green": "#009e73",
    "yellow": "#f0e442",
    "blue": "#0072b2",
    "vermilion": "#d55e00",
    "purple": "#cc79a7",
}
"""The palette of Okabe and Ito. Black is for what is not a pulley size: the data, the total."""

NEUTRAL = "#6b6b6b"
"""For reference lines and what stays in the background."""

LineStyle: TypeAlias = Literal["-", "--", "-.", ":"]
SHADES = tuple(COLORS[name] for name in ("blue", "vermilion", "green", "purple", "orange", "sky"))
PAPER_LINE: dict[str, Any] = {"color": COLORS["black"], "linewidth": 0.8, "linestyle": (0, (4, 4))}
"""Line of Table I, so that the law is seen between its dashes."""
NORMAL_90 = 1.6449
"""Half the width of a standard normal's 90 % interval."""
LINES: tuple[LineStyle, ...] = ("-", "--", "-.", ":")
MARKERS = "osD^vPX"
"""For what is told apart within one size: numbers of pulleys, tensions."""

_STYLE: dict[str, object] = {
    "font.family": "DejaVu Sans",  # comes with matplotlib, so it is the same everywhere
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.titley": 1.0,  # where no ticks stand above: it need not be looked for
    "axes.labelsize": 8.0,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "axes.unicode_minus": True,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e3e3e3",
    "grid.linewidth": 0.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.3,
    "lines.markersize": 4.0,
    "patch.linewidth": 0.6,
    "legend.frameon": False,
    "savefig.dpi": 200,  # of rasterised layers
    "svg.fonttype": "path",
    "svg.hashsalt": "bayesfric",
}


@dataclass(frozen=True)
class SizeStyle:
    """How one pulley size is drawn.

    Parameters
    ----------
    color, marker : str
        As matplotlib names them.
    """

    color: str
    marker: str


_SIZES = {
    "small": SizeStyle(COLORS["blue"], "o"),
    "medium": SizeStyle(COLORS["vermilion"], "s"),
    "large": SizeStyle(COLORS["green"], "^"),
}
# The numbers of colours and markers share no factor, so that 60 names differ.
_OTHER_COLORS = [COLORS[name] for name in ("purple", "orange", "sky", "blue", "vermilion")]
_OTHER_MARKERS = ["D", "v", "P", "X", "<", ">", "h", "*", "p", "d", "8", "H"]


def size_styles(names: Iterable[str]) -> dict[str, SizeStyle]:
    """Give each pulley size of a recording its colour and marker.

    Parameters
    ----------
    names : iterable of str
        All sizes of the recording, so that a size looks alike in every figure.

    Returns
    -------
    dict of str to SizeStyle
        In the order given. "small", "medium" and "large" always look the same;
        other names take theirs in alphabetical order, no two the same up to 60.
    """
    names = list(dict.fromkeys(names))
    others = sorted(name for name in names if name not in _SIZES)
    given = dict(_SIZES)
    for place, name in enumerate(others):
        given[name] = SizeStyle(
            _OTHER_COLORS[place % len(_OTHER_COLORS)],
            _OTHER_MARKERS[place % len(_OTHER_MARKERS)],
        )
    return {name: given[name] for name in names}


@contextmanager
def figure(
    width: float = TEXT_WIDTH, height: float = 80.0, *, room: bool = True
) -> Iterator[Figure]:
    """Make an empty figure, in the project's style within the ``with`` block.

    Parameters
    ----------
    width, height : float
        In mm.
    room : bool
        Whether panels leave room for their words; else whoever draws sees to it.

    Yields
    ------
    matplotlib.figure.Figure
        To be filled within the block (a ``return`` from within is fine).

    Raises
    ------
    ValueError
        If a side is not positive.
    """
    if not (width > 0 and height > 0):
        raise ValueError(f"figure: expected a width and height in mm, got {width} and {height}")
    with matplotlib.style.context(["default", _STYLE]):
        yield Figure(figsize=(width / 25.4, height / 25.4), layout=Room() if room else None)


def halves(whole: Figure, left: float, right: float) -> tuple[SubFigure, SubFigure]:
    """Part a figure into a left and a right one of these relative widths."""
    parts: Any = whole.subfigures(1, 2, width_ratios=(left, right))
    return parts[0], parts[1]


def key(
    parent: Figure | SubFigure,
    handles: Iterable[Artist],
    *,
    side: Literal["above", "below"] = "below",
    align: Literal["left", "center", "right"] = "center",
    **options: Any,
) -> Legend:
    """Explain what is drawn, above or below all panels.

    Parameters
    ----------
    parent : Figure or SubFigure
        Of :func:`figure`.
    handles : iterable of Artist
        With their labels.
    side, align : str
        Where it stands.
    **options
        Of ``Figure.legend``.
    """
    options["loc"] = f"{'lower' if side == 'below' else 'upper'} {align}"
    legend: Legend = parent.legend(handles=list(handles), **options)
    room = parent.get_layout_engine()
    if isinstance(room, Room):
        room.keep(parent, legend, side)
    return legend


def line_key(label: str, **look: Any) -> Artist:
    """Return a line or a marker of a key, with matplotlib's options of lines."""
    return Line2D([], [], label=label, **look)


def area_key(label: str, alpha: float | None = None, color: Any = NEUTRAL) -> Artist:
    """Return a band or a bar of a key."""
    return Patch(color=color, alpha=alpha, linewidth=0, label=label)


def name_rows(panel: Axes, names: Sequence[str], *, room: int = 0, size: float = 7.5) -> None:
    """Write names beside rows that are counted from the top; there is room for so many at least."""
    panel.set_yticks(range(len(names)), names, fontsize=size)
    panel.set_ylim(max(len(names), room) - 0.4, -0.6)
    panel.grid(visible=False, axis="y")


def point_key(label: str, color: str, marker: str, line: LineStyle, size: float) -> Artist:
    """Return a line with a white marker of a key."""
    style = {"linestyle": line, "linewidth": 0.9, "marker": marker, "markersize": size}
    return line_key(label, color=color, markerfacecolor="white", **style)


def hollow(color: str, size: float, **more: Any) -> dict[str, Any]:
    """Return matplotlib's options of markers that are white inside, `size` in points."""
    return {"color": "white", "markersize": size, "markeredgecolor": color, **more}


@contextmanager
def small_panels(
    count: int, beside: float, *, alike: bool = False
) -> Iterator[tuple[Figure, list[Axes]]]:
    """Yield a figure with a small panel for each of many parameters, in even rows.

    Parameters
    ----------
    count : int
        Panels.
    beside : float
        Height of what stands above and below all of them [mm].
    alike : bool
        Whether all have the same axes, whose ticks are then written at the edges alone.
    """
    columns = columns_of(count)
    rows = -(-count // columns)
    with figure(height=18.0 * rows + beside) as fig:
        panels = fig.subplots(rows, columns, sharex=alike, sharey=alike, squeeze=False).ravel()
        for place, panel in enumerate(panels):
            panel.set_visible(place < count)
            if alike:
                panel.tick_params(labelbottom=place + columns >= count)
        yield fig, list(panels[:count])


def svg_of(draw: Callable[..., Figure], *arguments: Any) -> Callable[[], bytes]:
    """Return what draws a figure of these arguments and writes it as SVG, here or elsewhere."""
    return partial(_drawn, draw, arguments)


def _drawn(draw: Callable[..., Figure], arguments: tuple[Any, ...]) -> bytes:
    return to_svg(draw(*arguments))


def to_svg(figure: Figure) -> bytes:
    """Write a figure as SVG: text as paths, no date, the same bytes for the same figure."""
    buffer = io.BytesIO()
    FigureCanvasSVG(figure)
    with matplotlib.style.context(["default", _STYLE]):
        if (room := figure.get_layout_engine()) is not None:
            # Laid out here: savefig would draw the whole figure once more to do so.
            room.execute(figure)
            figure.set_layout_engine(None)
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    # A clip path is named after its corners, whose last bit the layout's solver leaves to chance.
    names: dict[bytes, bytes] = {}

    def numbered(match: re.Match[bytes]) -> bytes:
        return match[1] + names.setdefault(match[2], b"clip%d" % len(names))

    return re.sub(rb'(url\(#|<clipPath id=")(p[0-9a-f]{10})', numbered, buffer.getvalue())
