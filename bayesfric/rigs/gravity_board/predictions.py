"""Trials of the gravity board, and friction against tension."""

import numpy as np
import pandas as pd
import xarray as xr

from bayesfric.arrays import Array
from bayesfric.physics.friction import Coefficients, coulomb_friction
from bayesfric.physics.gravity import nominal_tension
from bayesfric.physics.laws import FrictionLaw
from bayesfric.rigs.bands import QUANTILES, bands
from bayesfric.rigs.base import Predictive
from bayesfric.rigs.gravity_board.likelihood import GravityModel
from bayesfric.rigs.residuals import beside_predicted
from bayesfric.rigs.truth import table1_coefficients

CURVE_POINTS = 41


def trials(model: GravityModel, recorded: pd.DataFrame, view: Predictive) -> xr.Dataset:
    """Return friction observed, and predicted for a new trial on a new assembly.

    Parameters
    ----------
    model : GravityModel
        Of the fit.
    recorded : DataFrame
        All trials as recorded, for their order.
    view : Predictive
        The fit.
    """
    table, named = model.trials, view.named
    middle = {name: np.median(values, keepdims=True) for name, values in named.items()}
    friction, variance, _ = (values[0] for values in model.observed(middle))
    condition = model.condition
    acceleration = (condition.drive_force_n - friction) / condition.total_mass_kg
    observed = {
        name: table[name].to_numpy()
        for name in ("pulley_size", "setup", "n_pulleys", "wrap_angle_deg")
    }
    observed["tension_n"] = nominal_tension(condition, acceleration)
    observed["acceleration_m_s2"] = acceleration
    observed["friction_n"] = friction
    observed["friction_sd_n"] = np.sqrt(variance)
    return beside_predicted("trial", table, observed, model.law(named), recorded, view)


def curves(model: GravityModel, named: dict[str, Array], baseline: FrictionLaw) -> xr.Dataset:
    """Return friction against tension at each (size, n, θ) cell, of the law and of Table I."""
    trials = model.trials
    cells = trials[["pulley_size", "n_pulleys", "wrap_angle_deg"]].drop_duplicates()
    by_size = cells["pulley_size"].map(model.sizes.index)
    cells = cells.assign(place=by_size).sort_values(["place", "wrap_angle_deg", "n_pulleys"])
    cells = cells.drop(columns="place")
    top = float(np.max(nominal_tension(model.condition, 0.0)))
    tension = np.linspace(0.0, top, CURVE_POINTS)
    printed, paper = table1_coefficients(), np.full((len(cells), CURVE_POINTS), np.nan)
    law = np.empty((len(cells), CURVE_POINTS, len(QUANTILES)))
    for place, (size, n, wrap) in enumerate(cells.itertuples(index=False)):
        draws = Coefficients(*(named[f"{c}[{size}]"][:, None] for c in ("c1", "c2", "c3")))
        law[place] = bands(baseline.at_tension(draws, n, wrap, tension))
        if size in printed:
            paper[place] = coulomb_friction(printed[size], n, wrap, tension)
    return xr.Dataset(
        {
            "law_n": (("curve", "tension_n", "quantile"), law),
            "paper_n": (("curve", "tension_n"), paper),
            "pulley_size": ("curve", cells["pulley_size"].to_numpy()),
            "n_pulleys": ("curve", cells["n_pulleys"].to_numpy()),
            "wrap_angle_deg": ("curve", cells["wrap_angle_deg"].to_numpy()),
        },
        coords={"tension_n": tension, "quantile": list(QUANTILES)},
    )
