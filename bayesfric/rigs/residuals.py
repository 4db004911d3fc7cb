"""How far each trial lies from what a new trial is predicted to do."""

from collections.abc import Mapping
from statistics import NormalDist
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from bayesfric.arrays import Array, Whole
from bayesfric.rigs.bands import QUANTILES, bands
from bayesfric.rigs.base import Predictive
from bayesfric.rigs.remaking import Remade

FALSE_ALARM = 0.05  # chance that a recording that obeys the model has an outlier


def beside_predicted(
    dimension: str,
    table: pd.DataFrame,
    observed: Mapping[str, Any],
    law: Array,
    recorded: pd.DataFrame,
    view: Predictive,
) -> xr.Dataset:
    """Return what was observed of each trial beside what is predicted of a new one.

    Parameters
    ----------
    dimension : str
        What that of the trials is called.
    table : DataFrame
        One row a trial.
    observed : mapping of str to array_like, each of N
        Conditions and what was measured, ``friction_n`` among it [N].
    law : ndarray, shape (W, N)
        Friction by the law, draw by draw [N].
    recorded : DataFrame
        All trials as recorded, for their order.
    view : Predictive
        The fit.
    """
    columns: dict[str, Any] = {name: (dimension, values) for name, values in observed.items()}
    columns["law_n"] = ((dimension, "quantile"), bands(law))
    columns["predicted_n"] = ((dimension, "quantile"), bands(law * view.factor))
    columns["order"] = (dimension, measuring_order(recorded, table))
    columns |= check_residuals(dimension, view.remade, np.asarray(observed["friction_n"]))
    return xr.Dataset(columns, {dimension: table["trial"].to_numpy(), "quantile": list(QUANTILES)})


def check_residuals(trial: str, remade: Remade, observed: Array) -> dict[str, Any]:
    """Compare what was observed with new trials on new assemblies, noise included.

    Parameters
    ----------
    trial : str
        What the dimension of the trials is called.
    remade : Remade
        New trials, and whole recordings made again.
    observed : ndarray, shape (N,)
        Friction as measured [N].

    Returns
    -------
    dict
        Variables of a Dataset. ``z``: distance from the predicted median in standard
        deviations, taken from the width of the 90 % interval, which the heavy tails of
        Student-t scatter leave as it is. ``outlier``: beyond ``z_limit``, which one
        recording in twenty that obeys the model would pass somewhere. ``covered_share``:
        of trials inside their 90 % interval; ``covered_expected``: what that share would
        be if the recording were made again, whose assemblies shift trials together.
    """
    low, middle, high = bands(remade.apart).T
    lower, _, upper = (NormalDist().inv_cdf(level) for level in QUANTILES)
    z = (observed - middle) / ((high - low) / (upper - lower))
    limit = NormalDist().inv_cdf(1 - FALSE_ALARM / (2 * len(observed)))
    inside = ((low <= remade.together) & (remade.together <= high)).mean(axis=1)
    return {
        "z": (trial, z),
        "outlier": (trial, np.abs(z) > limit),
        "z_limit": limit,
        "covered_share": float(((low <= observed) & (observed <= high)).mean()),
        "covered_expected": ("quantile", bands(inside)),
    }


def measuring_order(recorded: pd.DataFrame, table: pd.DataFrame) -> Whole:
    """Return each trial's place in the order of measuring: as recorded, else of the file."""
    place = recorded["order"] if "order" in recorded else np.arange(1, len(recorded) + 1)
    by_trial = pd.Series(np.asarray(place), index=recorded["trial"])
    return by_trial.loc[table["trial"]].to_numpy(dtype=np.intp)
