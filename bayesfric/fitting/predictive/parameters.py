"""Figures of the draws of each parameter: ratios to Table I, ranks, prior and posterior."""

import numpy as np
import xarray as xr

from bayesfric.arrays import Array
from bayesfric.inference.diagnostics import rank_counts
from bayesfric.inference.model import Model
from bayesfric.paper import table1
from bayesfric.physics.friction import Coefficients

RANK_BINS = 20
DENSITY_BINS = 40
LEFT_OUT = 5e-4  # share of the draws at either end that the histogram leaves out


def coefficients(model: Model, flat: Array) -> xr.Dataset:
    """Return quantiles of the coefficients, and their ratio to Table I for its sizes."""
    draws = model.by_name(flat)
    names = [c for c in Coefficients._fields if any(f"{c}[{size}]" in draws for size in table1())]
    sizes = [size for size in table1() if all(f"{c}[{size}]" in draws for c in names)]
    if not names or not sizes:
        return xr.Dataset()
    levels = (0.05, 0.25, 0.5, 0.75, 0.95)
    paper = np.array([[getattr(table1()[size], name).value for name in names] for size in sizes])
    quantiles = np.array(
        [[np.quantile(draws[f"{name}[{size}]"], levels) for name in names] for size in sizes]
    )
    dims = ("pulley", "coefficient")
    return xr.Dataset(
        {
            "paper": (dims, paper),
            "value": ((*dims, "level"), quantiles),
            "ratio": ((*dims, "level"), quantiles / paper[..., None]),
        },
        coords={"pulley": sizes, "coefficient": names, "level": list(levels)},
    )


def ranks(model: Model, theta: Array) -> xr.Dataset:
    """Return the ranks of each ensemble's draws among all draws."""
    counts = np.stack(
        [rank_counts(theta[..., place], RANK_BINS) for place in range(theta.shape[-1])]
    )
    dims = ("parameter", "ensemble", "bin")
    return xr.Dataset(
        {"relative": (dims, counts / counts.mean(axis=-1, keepdims=True))},
        coords={"parameter": list(model.names)},
    )


def densities(model: Model, flat: Array) -> xr.Dataset:
    """Return the prior and the posterior density of each parameter.

    The posterior is a histogram, because a smooth estimate would extend beyond the bound of a
    scale. The prior is exact, at the edges of the histogram.
    """
    edges, heights, priors = [], [], []
    for parameter, draws in zip(model.parameters, flat.T, strict=True):
        low, high = np.quantile(draws, (LEFT_OUT, 1 - LEFT_OUT))
        edge = np.linspace(low, high, DENSITY_BINS + 1)
        counts = np.histogram(draws, edge)[0]
        edges.append(edge)
        heights.append(counts / (len(draws) * np.diff(edge)))
        priors.append(parameter.density(edge))
    return xr.Dataset(
        {
            "value": (("parameter", "edge"), np.stack(edges)),
            "prior": (("parameter", "edge"), np.stack(priors)),
            "posterior": (("parameter", "bin"), np.stack(heights)),
            "unit": ("parameter", [parameter.unit for parameter in model.parameters]),
        },
        coords={"parameter": list(model.names)},
    )
