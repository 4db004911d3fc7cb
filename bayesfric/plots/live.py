"""Charts that a reader can zoom and filter: the data of a figure, with a label for each point.

A chart is data alone. ``report/live.js`` draws it in a reader's browser, in the place of the
figure that is drawn from the same stored numbers.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bayesfric.arrays import Array
from bayesfric.plots.labels import rounded
from bayesfric.plots.rig_tables import RigTable
from bayesfric.plots.style import SizeStyle

DIGITS = 6  # significant, of a coordinate
MARKERS = {"o": "circle", "s": "square", "^": "triangle", "D": "diamond", "v": "inverted_triangle"}
"""Names of markers in the browser's library; others are circles there."""


@dataclass(frozen=True)
class Cloud:
    """Points of one kind, by which a reader filters: a pulley size, mostly.

    Parameters
    ----------
    name, color, marker : str
        The kind, and how its points look.
    x, y : ndarray, shape (N,)
    low, high : ndarray of shape (N,), or None
        Ends of an interval of x or, on a chart with rows, of x too; of y otherwise.
    said : sequence of sequence of str
        Of each point what is shown where it is pointed at, a word for each column of the chart.
    """

    name: str
    color: str
    marker: str
    x: Array
    y: Array
    low: Array | None = None
    high: Array | None = None
    said: Sequence[Sequence[str]] = ()


@dataclass(frozen=True)
class Curve:
    """A line of one kind; of no kind where its name is empty, so that no filter hides it.

    Parameters
    ----------
    name, color : str
    x, y : ndarray, shape (M,)
    dashed : bool
    """

    name: str
    color: str
    x: Array
    y: Array
    dashed: bool = False


@dataclass(frozen=True)
class Band:
    """A shaded region between two curves.

    Parameters
    ----------
    name, color : str
        As of a curve.
    x, low, high : ndarray, shape (M,)
    """

    name: str
    color: str
    x: Array
    low: Array
    high: Array


@dataclass(frozen=True)
class Chart:
    """One panel.

    Parameters
    ----------
    title, x_label, y_label : str
    columns : sequence of str
        What the words of each point say.
    rows : sequence of str
        Names of the rows y = 0, 1, … from the top; none where y is a number.
    clouds, curves, bands : sequences
    """

    title: str
    x_label: str
    y_label: str
    columns: Sequence[str] = ()
    rows: Sequence[str] = ()
    clouds: Sequence[Cloud] = ()
    curves: Sequence[Curve] = ()
    bands: Sequence[Band] = ()


def chart_data(chart: Chart) -> dict[str, Any]:
    """Return a chart as what JSON holds; the same for the same chart."""
    clouds = [
        replace(
            cloud,
            marker=MARKERS.get(cloud.marker, "circle"),
            said=tuple(zip(*cloud.said, strict=True)),
        )
        for cloud in chart.clouds
    ]
    data: dict[str, Any] = _as_json(replace(chart, clouds=clouds))
    return data


def _as_json(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return _numbers(value)
    if isinstance(value, Chart | Cloud | Curve | Band):
        return {name: _as_json(part) for name, part in vars(value).items()}
    return [_as_json(part) for part in value] if isinstance(value, list | tuple) else value


def _numbers(values: Array) -> list[float | None]:
    """Return numbers as JSON holds them, what is not finite as nothing."""
    return [
        float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None
        for value in np.asarray(values, dtype=float).tolist()
    ]


CONDITION = (
    ("pulley_size", "pulley", "{}"),
    ("n_pulleys", "pulleys", "{:g}"),
    ("wrap_angle_deg", "wrap angle", "{:g}°"),
    ("tension_n", "tension", "{:.3g} N"),
    ("velocity_m_s", "speed", "{:.3g} m/s"),
    ("hanging_mass_kg", "weight", "{:g} kg"),
    ("setup", "setup", "{}"),
)
"""Of a trial: column, what it is called, and how it is written."""


def trial_words(rig: RigTable, unit: str) -> tuple[list[str], list[list[str]]]:
    """Return what is shown of each trial: what it is, its condition, measured and predicted.

    Parameters
    ----------
    rig : RigTable
    unit : str
        Of friction.

    Returns
    -------
    columns : list of str
    words : list of lists of str
        A list a trial, a word for each column.
    """
    shown = [entry for entry in CONDITION if entry[0] in rig.table.data_vars]
    values = [rig.table[name].to_numpy() for name, _, _ in shown]
    columns = [rig.trial, *(called for _, called, _ in shown), "measured", "predicted, 90 %", "z"]
    words = []
    for place, name in enumerate(rig.table[rig.id].to_numpy()):
        low, _, high = sorted(abs(rig.table["predicted_n"].to_numpy()[place]))
        measured = abs(float(rig.table["friction_n"].to_numpy()[place]))
        words.append(
            [
                str(name),
                *(
                    text.format(column[place])
                    for (_, _, text), column in zip(shown, values, strict=True)
                ),
                f"{measured:.4g} {unit}",
                f"{rounded(low, low, high)} to {rounded(high, low, high)} {unit}",
                f"{float(rig.table['z'].to_numpy()[place]):.2f}",
            ]
        )
    return columns, words


def clouds_by_size(
    rig: RigTable,
    styles: dict[str, SizeStyle],
    x: Array,
    y: Array,
    words: Sequence[Sequence[str]],
    interval: tuple[Array, Array] | None = None,
) -> list[Cloud]:
    """Return the trials of a rig as a cloud for each pulley size.

    Parameters
    ----------
    rig : RigTable
    styles : dict of str to SizeStyle
        Sizes in the order in which a reader finds them.
    x, y : ndarray, shape (trial,)
    words : sequence of sequence of str
        As of :func:`trial_words`.
    interval : tuple of ndarray, shape (trial,), or None
        Ends of an interval of y.
    """
    sizes = np.array(rig.sizes)
    clouds = []
    for size, look in styles.items():
        places = np.flatnonzero(sizes == size)
        if not places.size:
            continue
        low, high = (None, None) if interval is None else (end[places] for end in interval)
        said = [words[place] for place in places.tolist()]
        clouds.append(Cloud(size, look.color, look.marker, x[places], y[places], low, high, said))
    return clouds
