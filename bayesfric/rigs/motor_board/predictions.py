"""Runs of the motor board."""

from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from bayesfric.physics.motor import nominal_tension
from bayesfric.rigs.bands import QUANTILES, bands
from bayesfric.rigs.base import Predictive
from bayesfric.rigs.motor_board.likelihood import MotorLikelihood
from bayesfric.rigs.residuals import check_residuals, measuring_order

__all__ = ["runs"]


def runs(likelihood: MotorLikelihood, recorded: pd.DataFrame, view: Predictive) -> xr.Dataset:
    """Return friction observed, and predicted for a new run on a new assembly.

    Parameters
    ----------
    likelihood : MotorLikelihood
        Of the fit.
    recorded : DataFrame
        All runs as recorded, for their order.
    view : Predictive
        The fit.
    """
    named = view.named
    table, condition = likelihood.trials, likelihood.condition
    law = likelihood.law(named)
    middle = {name: np.median(values, keepdims=True) for name, values in named.items()}
    columns: dict[str, Any] = {
        name: ("run", table[name].to_numpy())
        for name in (
            "pulley_size",
            "setup",
            "n_pulleys",
            "wrap_angle_deg",
            "hanging_mass_kg",
            "velocity_m_s",
        )
    }
    friction = likelihood.observed(middle)[0]
    return xr.Dataset(
        columns
        | {
            "tension_n": ("run", nominal_tension(condition, friction)),
            "friction_n": ("run", friction),
            "law_n": (("run", "quantile"), bands(law)),
            "predicted_n": (("run", "quantile"), bands(law * view.factor)),
            "order": ("run", measuring_order(recorded, table)),
            **check_residuals("run", view.remade, friction),
        },
        coords={"run": table["trial"].to_numpy(), "quantile": list(QUANTILES)},
    )
