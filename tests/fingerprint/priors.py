"""Log priors: of every family, and of the parameters of each rig at fixed points."""

import numpy as np
from fingerprint import access
from fingerprint.numbers import Number, closed, integrated
from fingerprint.points import points_of

FAMILIES = {
    "normal": {"mean": 0.3, "sd": 0.7},
    "half-normal": {"scale": 0.4},
    "log-normal": {"median": 0.2, "sd_log": 0.6},
    "uniform": {"low": -0.5, "high": 1.5},
    "student-t": {"degrees_of_freedom": 4.0, "location": 0.2, "scale": 0.5},
    "half-cauchy": {"scale": 0.3},
    "gamma": {"shape": 2.5, "scale": 0.2},
    "beta": {"a": 2.0, "b": 3.5, "high": 1.2},
    "truncated-normal": {"mean": 0.2, "sd": 0.4, "low": 0.0, "high": 1.0},
}
VALUES = (0.02, 0.1, 0.35, 0.8)
QUANTILES = (-3.0, -1.0, 0.0, 0.5, 2.0, 4.0)


def numbers() -> dict[str, Number]:
    """Return densities and quantiles of families, and log priors of the rigs."""
    rows = {}
    for family, values in FAMILIES.items():
        prior = access.prior(family, values)
        rows[f"{family}: density"] = closed(access.prior_density(prior, np.array(VALUES)))
        rows[f"{family}: quantile"] = closed(access.prior_quantile(prior, np.array(QUANTILES)))
        rows[f"{family}: normal in its place"] = integrated(access.prior_moments(prior))
        rows[f"{family}: normal score"] = closed(access.prior_score(prior, np.array(VALUES)))
    for rig in access.RIGS:
        model = access.model(rig)
        for name, point in points_of(rig).items():
            rows[f"{rig}: {name}"] = closed(access.log_prior(model, point))
    return rows
