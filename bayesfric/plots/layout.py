"""The layout of panels in a figure: as large as the labels around them permit.

Matplotlib's constrained layout asks each axis several times for its ticks before they are drawn,
which takes longer than drawing. This layout measures each tick label once and gives labels their
final positions.
"""

import io
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_svg import RendererSVG
from matplotlib.cbook import is_math_text
from matplotlib.figure import Figure, SubFigure
from matplotlib.font_manager import FontProperties
from matplotlib.gridspec import GridSpecBase
from matplotlib.layout_engine import LayoutEngine
from matplotlib.legend import Legend
from matplotlib.text import Text
from matplotlib.textpath import text_to_path
from matplotlib.ticker import NullFormatter
from matplotlib.transforms import Bbox, ScaledTranslation

POINTS = 72.0  # in an inch; all lengths here are points
ACROSS, UP = 5.0, 3.5  # free on each side of a panel with its words
OFFSET_PAD = 3.0  # between the words of ticks and their common factor
PASSES = 2  # which ticks there are depends on the room that they leave
FIRST = {"left": 30.0, "right": 5.0, "below": 25.0, "above": 15.0}  # before anything is measured
SIDES = tuple(FIRST)


@dataclass
class Words:
    """How far the words of an axis' ticks reach from it, and beyond its ends."""

    away: float = 0.0
    before: float = 0.0
    beyond: float = 0.0
    factor: float = 0.0


class Room(LayoutEngine):  # type: ignore[misc, unused-ignore]
    """A layout by what is written around panels, each word measured once."""

    _adjust_compatible = False
    _colorbar_gridspec = False

    def __init__(self) -> None:
        super().__init__()
        self._keys: list[tuple[Figure | SubFigure, Legend, str]] = []
        self._sizes: dict[tuple[str, float], tuple[float, float]] = {}

    def keep(self, parent: Figure | SubFigure, legend: Legend, side: str) -> None:
        """Leave room for a legend above or below the panels of a figure or a part of it."""
        self._keys.append((parent, legend, side))

    def execute(self, fig: Figure) -> None:
        """Give each panel its place."""
        before = fig.dpi
        fig.dpi = POINTS
        try:
            svg: Any = RendererSVG  # matplotlib's stubs leave its types out
            renderer: RendererBase = svg(*fig.bbox.size, io.StringIO(), image_dpi=POINTS)
            parts: list[Any] = list(fig.subfigs)
            for parent in (fig, *parts):
                self._arrange(parent, renderer)
        finally:
            fig.dpi = before

    def _arrange(self, parent: Figure | SubFigure, renderer: RendererBase) -> None:
        grids: dict[GridSpecBase, list[Axes]] = {}
        for axes in parent.axes:
            spec: Any = axes.get_subplotspec()
            if spec is not None and spec.get_gridspec().figure is parent and axes.get_visible():
                grids.setdefault(spec.get_gridspec(), []).append(axes)
        width, height = parent.bbox.size
        taken = self._taken(parent, renderer)
        for grid, panels in grids.items():
            # Panels that do not stand at the left end have few words there, mostly.
            needs = [dict(FIRST) for _ in panels]
            for turn in range(PASSES + 1):
                if turn:
                    needs = [self._needs(axes, renderer) for axes in panels]
                _place(parent, grid, panels, needs, taken)
        for side, text in _titles(parent):
            middle = (taken["left"] + width - taken["right"]) / 2
            if side == "left":
                text.set_position(
                    (ACROSS / 2 / width, (taken["below"] + height - taken["above"]) / 2 / height)
                )
            elif side == "below":
                extent = text.get_window_extent(renderer).height
                text.set_position((middle / width, (taken["below"] - extent) / height))
            else:
                extent = text.get_window_extent(renderer).height
                text.set_position((0.5, (height - taken["above"] + extent) / height))

    def _taken(self, parent: Figure | SubFigure, renderer: RendererBase) -> dict[str, float]:
        """Return what legends and words of the whole figure take on each side."""
        taken = dict.fromkeys(SIDES, 0.0)
        box = parent.bbox
        for owner, legend, side in self._keys:
            if owner is parent:
                legend_extent = legend.get_window_extent(renderer)
                reach = legend_extent.y1 - box.y0 if side == "below" else box.y1 - legend_extent.y0
                taken[side] = max(taken[side], reach)
        for side, text in _titles(parent):
            size = text.get_window_extent(renderer)
            pad, extent = (ACROSS / 2, size.width) if side == "left" else (UP, size.height)
            taken[side] += pad + extent
        return taken

    def _needs(self, axes: Axes, renderer: RendererBase) -> dict[str, float]:
        """Return what the words around a panel need, and put its labels beside those of ticks."""
        box = axes.bbox
        x = self._words(axes.xaxis, box.width, sideways=False)
        y = self._words(axes.yaxis, box.height, sideways=True)
        below, left = x.away, y.away
        if axes.get_xlabel():
            below += axes.xaxis.labelpad + axes.xaxis.label.get_window_extent(renderer).height
        if axes.get_ylabel():
            left += axes.yaxis.labelpad + axes.yaxis.label.get_window_extent(renderer).width
        above = max(y.beyond, y.factor)
        if axes.get_title():
            above = max(above, axes.title.get_window_extent(renderer).y1 - box.y1)
        needs = {
            "left": max(left, x.before),
            "right": x.beyond,
            "below": max(below, x.away + x.factor, y.before),
            "above": above,
            "x": x.away + axes.xaxis.labelpad,
            "y": y.away + axes.yaxis.labelpad,
        }
        for text in axes.texts:
            extent = text.get_window_extent(renderer)
            needs["left"] = max(needs["left"], box.x0 - extent.x0)
            needs["right"] = max(needs["right"], extent.x1 - box.x1)
            needs["above"] = max(needs["above"], extent.y1 - box.y1)
        return needs

    def _words(self, axis: Axis, length: float, *, sideways: bool) -> Words:
        """Measure what the ticks of an axis of this length say."""
        words = Words()
        low, high = axis.get_view_interval()
        ends = axis.get_transform().transform(np.array([low, high]))
        for locator, formatter, ticks in (
            (axis.get_major_locator(), axis.get_major_formatter(), axis.get_major_ticks),
            (axis.get_minor_locator(), axis.get_minor_formatter(), axis.get_minor_ticks),
        ):
            if isinstance(formatter, NullFormatter):
                continue
            places = np.asarray(locator(), dtype=np.float64)
            said = formatter.format_ticks(list(places))
            if not places.size:
                continue
            tick: Any = ticks(1)[0]
            words.away = max(words.away, tick.get_tick_padding())
            label = tick.label1
            if not label.get_visible():
                continue
            if formatter.get_offset():
                _, words.factor = self._size(formatter.get_offset(), label.get_fontproperties())
                words.factor += OFFSET_PAD
            at = (axis.get_transform().transform(places) - ends[0]) / (ends[1] - ends[0])
            angle = np.deg2rad(label.get_rotation())
            turned = np.abs([np.cos(angle), np.sin(angle)])
            pad = tick.get_tick_padding() + tick.get_pad()
            for place, word in zip(at, said, strict=True):
                if not (word and -1e-9 < place < 1 + 1e-9):
                    continue
                width, height = self._size(word, label.get_fontproperties())
                along = float(turned @ (width, height))
                across = float(turned @ (height, width))
                if sideways:
                    along, across = across, along
                words.away = max(words.away, pad + across)
                words.before = max(words.before, along / 2 - place * length)
                words.beyond = max(words.beyond, along / 2 - (1 - place) * length)
        return words

    def _size(self, word: str, font: FontProperties) -> tuple[float, float]:
        """Return width and height of a word, measured where it is new."""
        key = word, font.get_size_in_points()
        if key not in self._sizes:
            formula = is_math_text(word)
            sizes = [
                text_to_path.get_text_width_height_descent(
                    line if formula else line.replace(r"\$", "$"), font, ismath=formula
                )
                for line in word.split("\n")
            ]
            height = sum(max(h, key[1]) for _, h, _ in sizes)
            self._sizes[key] = max(w for w, _, _ in sizes), height
        return self._sizes[key]


def _titles(parent: Figure | SubFigure) -> Iterable[tuple[str, Text]]:
    """Yield the words of a whole figure with the sides on which they stand."""
    said = {
        "above": parent.get_suptitle(),
        "below": parent.get_supxlabel(),
        "left": parent.get_supylabel(),
    }
    for text in parent.texts:
        for side, words in said.items():
            if words and text.get_text() == words:
                yield side, text


def _place(
    parent: Figure | SubFigure,
    grid: GridSpecBase,
    panels: list[Axes],
    needs: list[dict[str, float]],
    taken: dict[str, float],
) -> None:
    """Give panels what is left of the figure, and labels one line a row or column."""
    size = parent.bbox.size
    rows, columns = grid.get_geometry()
    before, after = np.full(columns, ACROSS), np.full(columns, ACROSS)
    above, below = np.full(rows, UP), np.full(rows, UP)
    lines: dict[tuple[str, int], float] = {}
    for axes, need in zip(panels, needs, strict=True):
        spec: Any = axes.get_subplotspec()
        first, last = spec.colspan.start, spec.colspan.stop - 1
        top, bottom = spec.rowspan.start, spec.rowspan.stop - 1
        before[first] = max(before[first], ACROSS + need["left"])
        after[last] = max(after[last], ACROSS + need["right"])
        above[top] = max(above[top], UP + need["above"])
        below[bottom] = max(below[bottom], UP + need["below"])
        for name, place in (("x", bottom), ("y", first)):
            lines[name, place] = max(lines.get((name, place), 0.0), need.get(name, 0.0))
    across = size[0] - taken["left"] - taken["right"] - before.sum() - after.sum()
    up = size[1] - taken["above"] - taken["below"] - above.sum() - below.sum()
    across_ratios = np.asarray(grid.get_width_ratios(), dtype=np.float64)
    up_ratios = np.asarray(grid.get_height_ratios(), dtype=np.float64)
    wide = max(across, columns) * across_ratios / across_ratios.sum()
    tall = max(up, rows) * up_ratios / up_ratios.sum()
    starts = taken["left"] + before + np.concatenate([[0.0], (before + wide + after)[:-1].cumsum()])
    tops = size[1] - taken["above"] - above
    tops -= np.concatenate([[0.0], (above + tall + below)[:-1].cumsum()])
    for axes in panels:
        spec = axes.get_subplotspec()
        first, last = spec.colspan.start, spec.colspan.stop - 1
        top, bottom = spec.rowspan.start, spec.rowspan.stop - 1
        box = Bbox.from_extents(
            starts[first], tops[bottom] - tall[bottom], starts[last] + wide[last], tops[top]
        )
        axes.set_position(Bbox(box.get_points() / size))
        scale = parent.dpi_scale_trans
        down = ScaledTranslation(0.0, -lines["x", bottom] / POINTS, scale)
        aside = ScaledTranslation(-lines["y", first] / POINTS, 0.0, scale)
        axes.xaxis.set_label_coords(0.5, 0.0, axes.transAxes + down)
        axes.yaxis.set_label_coords(0.0, 0.5, axes.transAxes + aside)
