"""The conditions in which the friction of a fit was measured, for whoever uses its draws."""

from collections.abc import Mapping

import numpy as np

from bayesfric.rigs.data import Data
from bayesfric.schemas import ParameterSummary

AXES = ("n_pulleys", "wrap_angle_deg")


def tested_conditions(
    data: Data, pulleys: Mapping[str, Mapping[str, ParameterSummary]]
) -> dict[str, list[float] | str]:
    """Return attributes of ``draws.nc`` that say where its coefficients come from.

    Parameters
    ----------
    data : Data
        The trials that entered.
    pulleys : mapping
        Size to coefficient to its summary, as in ``fit.json``.

    Returns
    -------
    dict
        ``tested.<size>.<axis>``: least and largest number of pulleys, wrap angle [deg] and,
        where a rig holds the cable at rest, nominal tension [N]; ``informed.<size>``: the
        coefficients that the recording informs, separated by spaces.
    """
    seen: dict[str, list[float]] = {}
    for trials in data.rigs:
        table = trials.table
        if not set(AXES) <= set(table.columns):
            continue
        resting = trials.resting(table)
        columns = {axis: table[axis].to_numpy(float) for axis in AXES}
        if resting is not None:
            columns["tension_n"] = np.asarray(resting.tension_n, dtype=np.float64)
        for size in sorted(set(table["pulley_size"])):
            at_size = (table["pulley_size"] == size).to_numpy()
            for axis, values in columns.items():
                seen.setdefault(f"tested.{size}.{axis}", []).extend(values[at_size])
    ranges: dict[str, list[float] | str] = {
        key: [float(min(values)), float(max(values))] for key, values in seen.items()
    }
    return ranges | {
        f"informed.{size}": " ".join(name for name, entry in entries.items() if entry.informed)
        for size, entries in pulleys.items()
    }
