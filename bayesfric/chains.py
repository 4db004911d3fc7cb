"""Draws of ensembles as chains: in files an ensemble is one chain, its walkers one after another.

A walker is no chain: walkers of an ensemble depend on one another, and each has few draws. Nor
may draws of different walkers take turns, which would hide how each draw depends on the one
before. So a chain has first the steps of the first half of the run, walker by walker, then
those of the second half, walker by walker. Halves of a chain, which R-hat compares, are halves in
time, and neighbours, by which the effective sample size is estimated, are steps of one walker,
but where one walker ends and the next begins.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bayesfric.arrays import Array


def chain_order(walkers: int, steps: int) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Return the walker and the step of each draw of a chain, shape (walkers · steps,).

    Parameters
    ----------
    walkers : int
        Of an ensemble.
    steps : int
        Of each walker.
    """
    step, walker = np.divmod(np.arange(walkers * steps), walkers)
    later = np.arange(walkers * steps) >= walkers * steps // 2
    order = np.lexsort((step, walker, later))
    return walker[order], step[order]


def in_chains(values: Array, ensembles: int) -> Array:
    """Return draws by walker as one chain an ensemble.

    Parameters
    ----------
    values : ndarray, shape (ensembles · walkers, steps, …)
        Draws of each walker.
    ensembles : int
        How many there are.

    Returns
    -------
    ndarray, shape (ensembles, walkers · steps, …)
        In the order of :func:`chain_order`.
    """
    by_walker = values.reshape(ensembles, -1, *values.shape[1:])
    walker, step = chain_order(*by_walker.shape[1:3])
    return by_walker[:, walker, step]


def with_chains(draws: xr.Dataset, ensembles: int) -> xr.Dataset:
    """Return draws by walker as one chain an ensemble.

    Parameters
    ----------
    draws : Dataset
        Over ``chain`` (ensemble × walker), ``draw`` (step) and whatever else.
    ensembles : int
        How many there are.

    Returns
    -------
    Dataset
        Over ``chain`` (ensemble) and ``draw``, with the coordinates ``ensemble`` of each chain,
        and ``walker`` and ``step`` of each draw.
    """
    walker, step = chain_order(draws.sizes["chain"] // ensembles, draws.sizes["draw"])
    place = {
        "chain": np.arange(ensembles),
        "draw": np.arange(walker.size),
        "ensemble": ("chain", np.arange(ensembles)),
        "walker": ("draw", walker),
        "step": ("draw", step),
    }
    return _laid_out(draws, lambda values: in_chains(values, ensembles), place)


def by_walker(draws: xr.Dataset) -> xr.Dataset:
    """Return stored draws by walker again, as they were drawn.

    Parameters
    ----------
    draws : Dataset
        A group of ``draws.nc``.

    Returns
    -------
    Dataset
        Over ``chain`` (ensemble × walker) with the coordinate ``ensemble``, and ``draw`` (step).
        A group that does not say of which walker its draws are, as in files of earlier versions,
        and one that a user has cut are as they were.
    """
    if not {"ensemble", "walker", "step"} <= set(draws.coords):
        return draws
    walker, step = draws["walker"].to_numpy(), draws["step"].to_numpy()
    walkers, steps = np.unique(walker).size, np.unique(step).size
    if walkers * steps != walker.size:
        return draws
    order, ensemble = np.lexsort((step, walker)), draws["ensemble"].to_numpy()
    place = {
        "chain": np.arange(ensemble.size * walkers),
        "draw": np.arange(steps),
        "ensemble": ("chain", np.repeat(ensemble, walkers)),
    }

    def of_walkers(values: Array) -> Array:
        return values[:, order].reshape(-1, steps, *values.shape[2:])

    return _laid_out(draws.drop_vars(["walker", "step"]), of_walkers, place)


def _laid_out(
    draws: xr.Dataset, lay_out: Callable[[Array], Array], place: Mapping[str, Any]
) -> xr.Dataset:
    """Return the variables of draws laid out anew over ``chain`` and ``draw``, with coordinates."""
    variables = {}
    for name, variable in draws.data_vars.items():
        values = variable.transpose("chain", "draw", ...)
        variables[name] = (values.dims, lay_out(values.to_numpy()), variable.attrs)
    others = {
        name: coordinate
        for name, coordinate in draws.coords.items()
        if not {"chain", "draw"} & set(coordinate.dims)
    }
    return xr.Dataset(variables, coords=others | dict(place), attrs=draws.attrs)
