"""Runs of an axis: friction as it was seen, and predicted."""

import pandas as pd
import xarray as xr

from bayesfric.rigs.base import Predictive
from bayesfric.rigs.residuals import beside_predicted
from bayesfric.rigs.single_axis.likelihood import AxisModel


def runs(model: AxisModel, recorded: pd.DataFrame, view: Predictive) -> xr.Dataset:
    """Return friction observed, and predicted for a new run on a new assembly.

    Parameters
    ----------
    model : AxisModel
        Of the fit.
    recorded : DataFrame
        All runs as recorded, for their order.
    view : Predictive
        The fit.
    """
    table, friction = model.trials, model.observed(view.medians)[0]
    observed = {"setup": table["setup"].to_numpy(), "friction_n": friction}
    return beside_predicted("run", table, observed, model.law(view.named), recorded, view)
