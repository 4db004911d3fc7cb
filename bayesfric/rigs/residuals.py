"""Residuals of trials from the posterior predictive of new trials."""

from collections.abc import Mapping
from statistics import NormalDist
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from bayesfric.arrays import Array, Whole
from bayesfric.rigs.bands import bands
from bayesfric.rigs.base import Predictive
from bayesfric.rigs.remaking import Remade
from bayesfric.schemas.base import QUANTILES

FALSE_ALARM = 0.05  # probability of an outlier in a recording that obeys the model


def beside_predicted(
    dimension: str,
    table: pd.DataFrame,
    observed: Mapping[str, Any],
    law: Array,
    recorded: pd.DataFrame,
    view: Predictive,
) -> xr.Dataset:
    """Return observed values of each trial with predictions of a new trial.

    Parameters
    ----------
    dimension : str
        Name of the dimension of trials.
    table : DataFrame
        One row for each trial.
    observed : mapping of str to array_like, each of N
        Conditions and measured values; ``friction_n`` is required [N].
    law : ndarray, shape (W, N)
        Friction of the law in each draw [N].
    recorded : DataFrame
        All recorded trials, which give the order.
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
    """Compare observed friction with that of new trials on new assemblies, with noise.

    Parameters
    ----------
    trial : str
        Name of the dimension of trials.
    remade : Remade
        New trials, and replicates of the whole recording.
    observed : ndarray, shape (N,)
        Measured friction [N].

    Returns
    -------
    dict
        Variables of a Dataset. ``z``: distance from the predicted median in standard
        deviations. The standard deviation follows from the width of the 90 % interval, because
        the heavy tails of Student-t scatter hardly change this width. ``outlier``: whether the
        distance exceeds ``z_limit``, which happens in one of twenty recordings that obey the
        model. ``covered_share``: share of trials inside their 90 % interval.
        ``covered_expected``: quantiles of this share in replicates of the recording, in which
        trials of an assembly shift together.
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
    """Return each trial's number in the recorded order, or otherwise its row in the file."""
    place = recorded["order"] if "order" in recorded else np.arange(1, len(recorded) + 1)
    by_trial = pd.Series(np.asarray(place), index=recorded["trial"])
    return by_trial.loc[table["trial"]].to_numpy(dtype=np.intp)
