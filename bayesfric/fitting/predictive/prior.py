"""Friction implied by the priors alone, compared with the posterior and the measurements."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from bayesfric.arrays import Array
from bayesfric.observation.coefficients import law_of
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import FrictionLaw
from bayesfric.rigs.base import Resting

PRIOR_DRAWS = 4000
PRIOR_QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)


def friction_of_prior(
    conditions: pd.DataFrame,
    resting: Resting | None,
    prior: Mapping[str, Array],
    posterior: Mapping[str, Array],
    baseline: FrictionLaw,
) -> xr.Dataset:
    """Return the friction of each condition under prior and posterior draws.

    Parameters
    ----------
    conditions : DataFrame
        A row each: ``pulley_size``, ``n_pulleys``, ``wrap_angle_deg``, ``tension_n``, the
        nominal tension at which friction was measured, and ``friction_n``.
    resting : Resting or None
        The same conditions at rest; None if the rig moves for any friction.
    prior, posterior : mapping of str to ndarray, shape (W,)
        Draws by parameter.
    baseline : FrictionLaw
        The friction law.

    Returns
    -------
    Dataset
        By ``condition``: ``prior_n`` and ``posterior_n``, quantiles of the law's friction,
        ``measured_n``, and ``drive_n``, friction from which on the board would not move. By
        ``pulley``, over its conditions: ``prior_pooled_n``, ``posterior_pooled_n``,
        ``measured_range_n``; ``…_stuck``, the share of draws and conditions that would not
        move; ``…_stuck_somewhere``, of draws that leave some condition at rest;
        ``prior_negative``, the share of draws and conditions whose friction would push.
    """
    rows_of = {
        str(size): np.flatnonzero(conditions["pulley_size"].to_numpy() == size)
        for size in dict.fromkeys(conditions["pulley_size"])
    }
    measured = conditions["friction_n"].to_numpy()
    extremes = [[measured[rows].min(), measured[rows].max()] for rows in rows_of.values()]
    variables: dict[str, object] = {
        name: ("condition", conditions[name].to_numpy())
        for name in ("pulley_size", "n_pulleys", "wrap_angle_deg", "tension_n")
    }
    variables["measured_n"] = ("condition", measured)
    variables["measured_range_n"] = (("pulley", "end"), extremes)
    if resting is not None:
        variables["drive_n"] = ("condition", resting.drive_n)
    for name, draws in (("prior", prior), ("posterior", posterior)):
        implied = _implied(conditions, rows_of, resting, draws, baseline)
        if name == "posterior":
            del implied["negative"]  # the data exclude it
        variables |= {f"{name}_{quantity}": values for quantity, values in implied.items()}
    return xr.Dataset(variables, coords={"pulley": list(rows_of), "level": list(PRIOR_QUANTILES)})


def _implied(
    conditions: pd.DataFrame,
    rows_of: Mapping[str, NDArray[np.intp]],
    resting: Resting | None,
    draws: Mapping[str, Array],
    baseline: FrictionLaw,
) -> dict[str, object]:
    """Return the variables implied by draws, without ``prior_`` or ``posterior_``."""
    sizes, quantiles = len(rows_of), len(PRIOR_QUANTILES)
    by_condition, pooled = np.empty((len(conditions), quantiles)), np.empty((sizes, quantiles))
    negative, stuck, somewhere = np.empty(sizes), np.empty(sizes), np.empty(sizes)
    columns = ("n_pulleys", "wrap_angle_deg", "tension_n")
    for place, (size, rows) in enumerate(rows_of.items()):
        n, wrap, tension = conditions[[*columns]].to_numpy(dtype=np.float64)[rows].T
        law = Coefficients(*(np.asarray(c)[:, None] for c in law_of(draws, size)))
        friction = baseline.at_tension(law, n, wrap, tension)
        by_condition[rows] = np.quantile(friction, PRIOR_QUANTILES, axis=0).T
        pooled[place] = np.quantile(friction, PRIOR_QUANTILES)
        negative[place] = (friction < 0).mean()
        if resting is not None:
            # At rest both sides hang still: the tension is higher than in motion.
            friction_at_rest = baseline.at_tension(law, n, wrap, resting.tension_n[rows])
            rests = friction_at_rest >= resting.drive_n[rows]
            stuck[place] = rests.mean()
            somewhere[place] = rests.any(axis=1).mean()
    implied: dict[str, object] = {
        "n": (("condition", "level"), by_condition),
        "pooled_n": (("pulley", "level"), pooled),
        "negative": ("pulley", negative),
    }
    if resting is not None:
        implied |= {"stuck": ("pulley", stuck), "stuck_somewhere": ("pulley", somewhere)}
    return implied
