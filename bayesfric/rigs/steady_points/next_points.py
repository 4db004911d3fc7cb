"""Points that a bench could measure next: conditions within what was recorded."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd

from bayesfric.observation.coefficients import law_of_rows
from bayesfric.observation.feasible import every_condition, levels_of
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import FrictionLaw
from bayesfric.rigs.base import CONDITION
from bayesfric.rigs.steady_points.bench import Bench

LEVELS = 5  # of a column
MOST_POINTS = 3000  # points; beyond, of each column its ends and its middle
FEW_LEVELS = 3


def lay_out(
    bench: Bench, law: FrictionLaw, laws: Mapping[str, Coefficients]
) -> tuple[Bench, tuple[str, ...]]:
    """Return a point at every feasible condition, each on an assembly of its own.

    Parameters
    ----------
    bench : Bench
        What was recorded.
    law : FrictionLaw
        The friction law, which says what is read.
    laws : mapping of str to Coefficients
        Of each pulley size.

    Returns
    -------
    bench : Bench
        The points.
    settings : tuple of str
        Columns that make a condition, beside pulleys and tension.
    """
    table = bench.table
    settings = tuple(
        name
        for name in ("velocity_m_s", *bench.covariates)
        if name in bench.given and (table[name] != table[name].iloc[0]).any()
    )

    def levels(own: pd.DataFrame, most: int) -> list[pd.DataFrame]:
        return [levels_of(own[name].astype(np.float64), most) for name in (*CONDITION, *settings)]

    points = every_condition(table, partial(levels, most=LEVELS))
    if len(points) > MOST_POINTS:
        points = every_condition(table, partial(levels, most=FEW_LEVELS))
    for name in ("velocity_m_s", *bench.covariates):
        if name in bench.given and name not in settings:
            points[name] = table[name].iloc[0]
    coefficients = law_of_rows(laws, points["pulley_size"])
    where = (points[name].to_numpy(dtype=np.float64) for name in CONDITION)
    points["friction_n"] = law.at_tension(coefficients, *where)
    if "friction_sd_n" in bench.given:
        points["friction_sd_n"] = table["friction_sd_n"].median()
    return replace(bench, table=points), settings
