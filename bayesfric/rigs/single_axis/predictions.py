"""Estimated and predicted friction of the runs of an axis."""

import pandas as pd
import xarray as xr

from bayesfric.rigs.base import Predictive
from bayesfric.rigs.residuals import beside_predicted
from bayesfric.rigs.single_axis.likelihood import AxisModel


def runs(model: AxisModel, recorded: pd.DataFrame, view: Predictive) -> xr.Dataset:
    """Return estimated friction, and friction predicted for a new run on a new assembly.

    Parameters
    ----------
    model : AxisModel
        Likelihood of the fit.
    recorded : DataFrame
        Table of all recorded runs, which gives their order.
    view : Predictive
        The fit.
    """
    table, friction = model.trials, model.observed(view.medians)[0]
    observed = {"setup": table["setup"].to_numpy(), "friction_n": friction}
    return beside_predicted("run", table, observed, model.law(view.named), recorded, view)
