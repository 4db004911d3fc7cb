"""What the priors alone imply of friction, beside the posterior and the measurements."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr

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
    """Return the friction of each condition by prior and posterior draws.

    Parameters
    ----------
    conditions : DataFrame
        A row each: ``pulley_size``, ``n_pulleys``, ``wrap_angle_deg``, ``tension_n``, the
        nominal tension at which friction was measured, and ``friction_n``.
    resting : Resting or None
        What holds the same conditions at rest; None where the rig moves whatever friction is.
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
    sizes = [str(size) for size in dict.fromkeys(conditions["pulley_size"])]
    count, quantiles = len(conditions), len(PRIOR_QUANTILES)
    variables: dict[str, object] = {
        name: ("condition", conditions[name].to_numpy())
        for name in ("pulley_size", "n_pulleys", "wrap_angle_deg", "tension_n")
    }
    variables["measured_n"] = ("condition", conditions["friction_n"].to_numpy())
    variables["measured_range_n"] = (("pulley", "end"), np.empty((len(sizes), 2)))
    if resting is not None:
        variables["drive_n"] = ("condition", resting.drive_n)
    by_condition = {name: np.empty((count, quantiles)) for name in ("prior", "posterior")}
    pooled = {name: np.empty((len(sizes), quantiles)) for name in by_condition}
    stuck = {name: np.zeros(len(sizes)) for name in by_condition}
    somewhere = {name: np.zeros(len(sizes)) for name in by_condition}
    negative, extremes = np.empty(len(sizes)), np.empty((len(sizes), 2))
    for place, size in enumerate(sizes):
        at_size = np.flatnonzero(conditions["pulley_size"].to_numpy() == size)
        rows = conditions.iloc[at_size]
        n, wrap, tension, measured = (
            rows[name].to_numpy(dtype=np.float64)
            for name in ("n_pulleys", "wrap_angle_deg", "tension_n", "friction_n")
        )
        extremes[place] = measured.min(), measured.max()
        for name, draws in (("prior", prior), ("posterior", posterior)):
            law = Coefficients(*(np.asarray(c)[:, None] for c in law_of(draws, size)))
            friction = baseline.at_tension(law, n, wrap, tension)
            by_condition[name][at_size] = np.quantile(friction, PRIOR_QUANTILES, axis=0).T
            pooled[name][place] = np.quantile(friction, PRIOR_QUANTILES)
            if name == "prior":
                negative[place] = (friction < 0).mean()
            if resting is not None:
                # At rest both sides hang still: the tension is higher than in motion.
                holds = baseline.at_tension(law, n, wrap, resting.tension_n[at_size])
                rests = holds >= resting.drive_n[at_size]
                stuck[name][place] = rests.mean()
                somewhere[name][place] = rests.any(axis=1).mean()
    variables["measured_range_n"] = (("pulley", "end"), extremes)
    variables["prior_negative"] = ("pulley", negative)
    for name in by_condition:
        variables[f"{name}_n"] = (("condition", "level"), by_condition[name])
        variables[f"{name}_pooled_n"] = (("pulley", "level"), pooled[name])
        if resting is not None:
            variables[f"{name}_stuck"] = ("pulley", stuck[name])
            variables[f"{name}_stuck_somewhere"] = ("pulley", somewhere[name])
    return xr.Dataset(variables, coords={"pulley": sizes, "level": list(PRIOR_QUANTILES)})
