"""The first rows of a seed, of each rig's simulator, plain and with effects."""

import pandas as pd
from fingerprint import access
from fingerprint.numbers import Number, closed


def numbers() -> dict[str, Number]:
    """Return the columns of numbers of each table, their first and last rows."""
    rows = {}
    for name, table in access.simulated().items():
        middle = len(table) // 2
        some = pd.concat([table.iloc[:6], table.iloc[middle : middle + 6], table.iloc[-6:]])
        for column in some.select_dtypes("number"):
            rows[f"{name}: {column}"] = closed(some[column].to_numpy())
        rows[f"{name}: rows"] = closed(len(table))
    return rows
