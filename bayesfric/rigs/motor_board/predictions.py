"""Runs of the motor board."""

import pandas as pd
import xarray as xr

from bayesfric.physics.motor import nominal_tension
from bayesfric.rigs.base import Predictive
from bayesfric.rigs.motor_board.likelihood import MotorModel
from bayesfric.rigs.residuals import beside_predicted


def runs(model: MotorModel, recorded: pd.DataFrame, view: Predictive) -> xr.Dataset:
    """Return friction observed, and predicted for a new run on a new assembly.

    Parameters
    ----------
    model : MotorModel
        Of the fit.
    recorded : DataFrame
        All runs as recorded, for their order.
    view : Predictive
        The fit.
    """
    table = model.trials
    friction = model.observed(view.medians)[0]
    condition = ("pulley_size", "setup", "n_pulleys", "wrap_angle_deg")
    observed = {
        name: table[name].to_numpy() for name in (*condition, "hanging_mass_kg", "velocity_m_s")
    }
    observed["tension_n"] = nominal_tension(model.condition, friction)
    observed["friction_n"] = friction
    return beside_predicted("run", table, observed, model.law(view.named), recorded, view)
