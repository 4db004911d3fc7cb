"""Observed and predicted friction of the motor board's runs."""

import pandas as pd
import xarray as xr

from bayesfric.physics.motor import nominal_tension
from bayesfric.rigs.base import Predictive
from bayesfric.rigs.motor_board.likelihood import MotorModel
from bayesfric.rigs.residuals import beside_predicted


def runs(model: MotorModel, recorded: pd.DataFrame, view: Predictive) -> xr.Dataset:
    """Return observed friction, and predicted friction of a new run on a new assembly.

    Parameters
    ----------
    model : MotorModel
        Model of the fit.
    recorded : DataFrame
        All recorded runs, which give the order.
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
