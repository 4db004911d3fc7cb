"""What a fit predicts of steady points."""

import pandas as pd
import xarray as xr

from bayesfric.rigs.base import CONDITION, Predictive
from bayesfric.rigs.residuals import beside_predicted
from bayesfric.rigs.steady_points.bench import Bench


def points_dataset(bench: Bench, recorded: pd.DataFrame, view: Predictive) -> xr.Dataset:
    """Return friction against the motion as measured, and as predicted for a new point.

    Parameters
    ----------
    bench : Bench
        The points of the fit.
    recorded : DataFrame
        All points as recorded, for their order.
    view : Predictive
        The fit.
    """
    table, law = bench.table, view.likelihood.law(view.named)  # type: ignore[attr-defined]
    # What nobody recorded is not shown: where there is no pulley, none is spoken of.
    shown = ("pulley_size", *CONDITION, "velocity_m_s", *bench.covariates)
    kept = ["setup", "friction_n", *(name for name in shown if name in bench.given)]
    observed = {name: table[name].to_numpy() for name in kept}
    return beside_predicted("point", table, observed, law, recorded, view)
