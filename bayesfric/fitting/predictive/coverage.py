"""The share of trials inside their predictive intervals, by condition."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
import xarray as xr

from bayesfric.arrays import Array, Flags
from bayesfric.rigs.bands import bands
from bayesfric.rigs.remaking import Remade
from bayesfric.schemas.base import QUANTILES

LEVELS = (0.5, 0.9)
CELL = ("pulley_size", "n_pulleys", "wrap_angle_deg")


def coverage(
    table: pd.DataFrame,
    sizes: Sequence[str],
    loads: Sequence[str],
    remade: Remade,
    observed: Array,
) -> xr.Dataset:
    """Count the trials inside the central intervals of new trials on new assemblies.

    Parameters
    ----------
    table : DataFrame
        The N trials or runs.
    sizes : sequence of str
        Pulley sizes in the order of their conditions.
    loads : sequence of str
        Columns that define a condition, together with size, n and wrap angle.
    remade : Remade
        New trials, and replicates of the whole recording.
    observed : ndarray, shape (N,)
        Measured friction [N].

    Returns
    -------
    Dataset
        Over each ``condition`` (size, n, θ, loads), each ``cell`` (size, n, θ) and all:
        ``…_share``, the share of trials inside, by level; ``…_expected``, the 5, 50 and 95 %
        quantiles of that share in replicates; ``…_trials``, the number of trials.
    """
    inside, again = _inside(remade, observed)
    columns = [*CELL, *loads]
    ranked = table.assign(rank=table["pulley_size"].map(list(sizes).index))
    groups = {
        "condition": ranked.groupby(["rank", *columns[1:]]),
        "cell": ranked.groupby(["rank", *CELL[1:]]),
    }
    variables: dict[str, object] = {
        "all_share": ("level", inside.mean(axis=1)),
        "all_expected": (("level", "quantile"), bands(again.mean(axis=2).T)),
        "all_trials": len(table),
    }
    for of, group in groups.items():
        code = group.ngroup().to_numpy()
        member = (code[:, None] == np.arange(code.max() + 1)).astype(np.float64)  # (N, G)
        count = member.sum(axis=0)
        rows = table.iloc[member.argmax(axis=0)]
        shares = again @ member / count  # (level, W, G)
        variables[f"{of}_share"] = ((of, "level"), (inside @ member / count).T)
        variables[f"{of}_expected"] = (
            (of, "level", "quantile"),
            np.moveaxis(bands(np.moveaxis(shares, 1, 0)), 0, 1),
        )
        variables[f"{of}_trials"] = (of, count.astype(np.intp))
        for name in columns if of == "condition" else CELL:
            variables[f"{of}_{name}"] = (of, rows[name].to_numpy())
    return xr.Dataset(variables, coords={"level": list(LEVELS), "quantile": list(QUANTILES)})


def _inside(remade: Remade, observed: Array) -> tuple[Flags, Flags]:
    """Return which trials are inside, (level, N), and which replicates, (level, W, N)."""
    tails = np.array([(1 - level) / 2 for level in LEVELS])
    low = np.quantile(remade.apart, tails, axis=0)
    high = np.quantile(remade.apart, 1 - tails, axis=0)
    inside = (low <= observed) & (observed <= high)
    again = np.stack(
        [
            (bottom <= remade.together) & (remade.together <= top)
            for bottom, top in zip(low, high, strict=True)
        ]
    )
    return inside, again
