"""Checked cells → the frames of a recording: final types, defaults and order."""

import numpy as np
import pandas as pd

from bayesfric.recording.columns import GRAVITY_EVENTS, TableFormat
from bayesfric.recording.spacing import spacing_counts

SENSOR_ORDER = {"drive": 0, "load": 1}


def typed(frame: pd.DataFrame, table: TableFormat) -> pd.DataFrame:
    """Give the cells of a table without faults their final types: counts int64, words str."""
    types = {
        column.name: np.int64 if column.kind == "integer" else "str"
        for column in table.columns
        if column.kind != "number" and column.name in frame
    }
    words = {
        name: _as_words(frame[name])
        for name in types
        if isinstance(frame[name].dtype, pd.CategoricalDtype)
    }
    return frame.assign(**words).astype(types)


def _as_words(categories: pd.Series) -> pd.Series:
    """Return words that are categories as text; each word is made text once, not in each row."""
    words = categories.cat.categories.astype("str").array
    codes = categories.cat.codes.to_numpy()
    return pd.Series(words.take(codes, allow_fill=True), index=categories.index)


def with_setup(runs: pd.DataFrame) -> pd.DataFrame:
    """Fill in ``setup``, such as ``medium-9-85``, if the file has none."""
    if "setup" in runs:
        return runs
    setup = [
        f"{size}-{count}-{repr(angle).removesuffix('.0')}"
        for size, count, angle in zip(
            runs["pulley_size"], runs["n_pulleys"], runs["wrap_angle_deg"].tolist(), strict=True
        )
    ]
    place = 1 + ("order" in runs)  # behind the id and the order, as in the format
    filled = runs.copy()
    filled.insert(place, "setup", pd.Series(setup, index=runs.index, dtype="str"))
    return filled


def did_not_move(trials: pd.DataFrame) -> "pd.Series[bool]":
    """Return which trials are marked as not having moved, shape (N,)."""
    if "did_not_move" not in trials:
        return pd.Series(False, index=trials.index)
    return trials["did_not_move"] == "true"


def stands_in(names: pd.Series, rows: pd.Series) -> "pd.Series[bool]":
    """Return which names occur in a column of a longer table, in which names repeat.

    ``Series.isin`` would convert the whole column to Python strings: a second for a million rows.
    """
    return names.isin(rows.unique())


def no_events() -> pd.DataFrame:
    """Return an empty event table."""
    return pd.DataFrame(
        {
            column.name: pd.Series(dtype="float64" if column.is_numeric else "str")
            for column in GRAVITY_EVENTS.columns
        }
    )


def sorted_events(
    events: pd.DataFrame, trials: pd.DataFrame, spacing_m: float | None
) -> pd.DataFrame:
    """Events by trial, sensor and time, each on its exact multiple of the spacing [m].

    The files print rounded displacements. Since these are multiples of the spacing, the exact
    values are known.
    """
    if events.empty or spacing_m is None:
        return events
    trial, ids = pd.factorize(events["trial"])  # a million rows, and few words
    sensor, ends = pd.factorize(events["sensor"])
    place = pd.Index(trials["trial"]).get_indexer(ids)
    key = 2 * place[trial] + np.array([SENSOR_ORDER[end] for end in ends])[sensor]
    rows = np.argsort(key, kind="stable")  # times increase in the file already
    ordered = events.iloc[rows].reset_index(drop=True)
    exact = spacing_counts(ordered["displacement_m"].to_numpy(), spacing_m) * spacing_m
    return ordered.assign(displacement_m=exact)
