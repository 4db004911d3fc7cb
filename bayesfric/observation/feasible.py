"""Conditions that could be measured next: all combinations of recorded levels.

:mod:`bayesfric.planning` and :mod:`bayesfric.diagnosis.next_experiment` evaluate further trials at
these conditions. A rig defines which columns make its conditions.
"""

import re
from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

from bayesfric.arrays import evenly

UNIT = re.compile("_(deg|kg|n_m|n|m_s|m|rad_s|s|rad|hz)$")
PRINTED = {"n": "N", "n_m": "N·m", "m_s": "m/s", "rad_s": "rad/s", "hz": "Hz"}


def name_and_unit(name: str) -> tuple[str, str]:
    """Return the name of a setting without its unit, and the unit, such as velocity and m/s."""
    unit = UNIT.search(name)
    return (name[: unit.start()], PRINTED.get(unit[1], unit[1])) if unit else (name, "")


def levels_of(column: "pd.Series[float]", most: int | None = None) -> pd.DataFrame:
    """Return recorded values of a column, ascending, as a table."""
    values = np.unique(column.to_numpy())
    return pd.DataFrame({column.name: values[evenly(values.size, most or values.size)]})


def every_condition(
    measured: pd.DataFrame, levels: Callable[[pd.DataFrame], Sequence[pd.DataFrame]]
) -> pd.DataFrame:
    """Return all combinations of the levels of each pulley size.

    Parameters
    ----------
    measured : DataFrame
        The recorded trials.
    levels : callable
        Function of the trials of one size that returns a table of levels for each setting.

    Returns
    -------
    DataFrame
        One row for each condition, as a trial on its own assembly.
    """
    laid = []
    for size, own in measured.groupby("pulley_size", sort=False):
        cells = pd.DataFrame({"pulley_size": [size]})
        for level in levels(own):
            cells = cells.merge(level, how="cross")
        laid.append(cells)
    return numbered(pd.concat(laid, ignore_index=True))


def numbered(conditions: pd.DataFrame) -> pd.DataFrame:
    """Return conditions as trials, each on its own assembly."""
    names = [f"t{place:04d}" for place in range(len(conditions))]
    return conditions.reset_index(drop=True).assign(trial=names, setup=names)
