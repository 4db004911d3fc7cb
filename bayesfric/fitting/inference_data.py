"""Draws of a fit in the format of ArviZ.

All groups except the prior contain the same draws. ``log_likelihood`` holds ``friction``, the
density of each trial given all others, and ``assembly``, that of each assembly given all
others: either can be left out. Neither adds up to the density of the whole, so a third,
``overlap``, holds what is missing: the group as a whole sums to the log likelihood, which is
what power-scaling (``psense``) makes of it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from bayesfric.arrays import Array
from bayesfric.fitting.predictive.coverage import CELL
from bayesfric.fitting.predictive.left_out import LeftOut
from bayesfric.inference.model import Model
from bayesfric.inference.priors import LOG_2PI
from bayesfric.observation.coefficients import sizes_of
from bayesfric.results import draws_tree
from bayesfric.stored_names import name_of

MOST_DRAWS = 4000
MOST_NUMBERS = 2_400_000  # draws times trials: a file of 15 to 20 MB
STEP = 2.0**-14  # of a trial's log density [nat]; what is left of its digits compresses
LEAST_OF_CHAIN = 4  # for ArviZ to compute anything
PRIOR_DRAWS = 1000
CONDITION = ("setup_of_trial", *CELL)


@dataclass(frozen=True)
class Stored:
    """Evenly spaced draws of each walker, which are stored and used for leave-one-out.

    Parameters
    ----------
    z, theta : ndarray, shape (chain, draw, D)
        In the sampling space, and in the parameters' units; chain = ensemble × walker.
    log_density : ndarray, shape (chain, draw)
        Log posterior density at `z`.
        ensembles : int
        Number of ensembles.
    """

    z: Array
    theta: Array
    log_density: Array
    ensembles: int

    @classmethod
    def of(cls, z: Array, theta: Array, log_density: Array, trials: int) -> "Stored":
        """Return at most 4,000 evenly spaced draws; fewer if the recording has very many trials.

        Parameters
        ----------
        z, theta : ndarray, shape (ensembles, draws, walkers, D)
            All draws.
        log_density : ndarray, shape (ensembles, draws, walkers)
            Of `z`.
        trials : int
            Number of trials of the recording.
        """
        ensembles, kept, walkers = log_density.shape
        chains = ensembles * walkers
        most = min(MOST_DRAWS, MOST_NUMBERS // trials) // chains
        stride = -(-kept // max(LEAST_OF_CHAIN, most))

        def by_chain(values: Array) -> Array:
            values = values[:, ::stride].swapaxes(1, 2)
            return values.reshape(chains, *values.shape[2:])

        return cls(by_chain(z), by_chain(theta), by_chain(log_density), ensembles)

    @property
    def flat(self) -> Array:
        """The draws of all chains in the sampling space, shape (chain · draw, D)."""
        return self.z.reshape(-1, self.z.shape[-1])


def draws_of_fit(
    model: Model,
    rigs: Mapping[str, Array],
    stored: Stored,
    left_out: Mapping[str, LeftOut],
    rng: np.random.Generator,
    attributes: Mapping[str, Any],
) -> xr.DataTree:
    """Return the content of ``draws.nc``.

    Parameters
    ----------
    model : Model
        The posterior.
    rigs : mapping of str to ndarray, shape (N,)
        Measured friction of the trials by rig [N]; with two rigs, ids begin with the rig's name.
    stored, left_out : Stored, and mapping of str to LeftOut
        The draws, and by rig their leave-one-out predictions with replicated trials.
    rng : Generator
        Source of randomness for the draws of the prior and the prior predictive.
    attributes : mapping
        Provenance.

    Returns
    -------
    DataTree
        ``posterior``, ``prior``, ``log_prior``: each parameter; coefficients of sizes over
        ``pulley``. ``observed_data``, ``posterior_predictive``, ``prior_predictive``: ``friction``
        over ``trial`` [N]. The posterior predictive is that of a replicate of one trial given all
        others; the prior predictive is that of the whole recording. ``log_likelihood``:
        see the module; ``assembly`` is over ``setup``. ``sample_stats``: ``lp``, the log posterior
        density up to a constant. ``constant_data``: the condition of each trial.
    """
    observed = np.concatenate(list(rigs.values()))
    before = model.draw_prior(PRIOR_DRAWS, rng)
    # The density is that in the sampling space, in which every prior is N(0, 1).
    whole = stored.log_density + 0.5 * (LOG_2PI + stored.z**2).sum(axis=-1)
    priors = model.log_priors(stored.theta)
    posterior = _variables(model, stored.theta)
    table, setups = _trials_and_setups(model, list(rigs))
    return draws_tree(
        {
            "posterior": posterior,
            "prior": _variables(model, before[None]),
            "posterior_predictive": {
                "friction": _made_again(observed, left_out, stored.log_density.shape)
            },
            "prior_predictive": {"friction": _predicted(model, before, rng)},
            "observed_data": {"friction": observed},
            "constant_data": {name: table[name].to_numpy() for name in CONDITION if name in table},
            "sample_stats": {"lp": whole + priors.sum(axis=-1)},
            "log_likelihood": _log_likelihood(left_out, whole),
            "log_prior": _variables(model, priors),
        },
        dims=_dims(posterior, table),
        coords=_coords(model, table, setups),
        ensembles=stored.ensembles,
        attributes=flat_attributes(attributes),
        units={p.name.partition("[")[0]: p.unit for p in model.parameters},
    )


def _coords(model: Model, table: pd.DataFrame, setups: list[str]) -> dict[str, Any]:
    """Return the names of pulley sizes, trials and assemblies."""
    sizes = sizes_of(model.names)
    by_size = {"pulley": list(sizes)} if sizes else {}
    return by_size | {"trial": table["trial"].to_numpy(), "setup": setups}


def _dims(posterior: Mapping[str, Array], table: pd.DataFrame) -> dict[str, list[str]]:
    """Return the dimensions of variables, in addition to chain and draw."""
    by_size = {name: ["pulley"] for name, values in posterior.items() if values.ndim == 3}
    by_trial = {name: ["trial"] for name in CONDITION if name in table}
    return by_size | {"friction": ["trial"], "assembly": ["setup"]} | by_trial


def _trials_and_setups(model: Model, rigs: Sequence[str]) -> tuple[pd.DataFrame, list[str]]:
    """Return the trials and assemblies of all rigs; with two, ids begin with the rig's name."""
    prefixes = [f"{name}/" if len(rigs) > 1 else "" for name in rigs]
    by_prefix = list(zip(prefixes, model.likelihoods, strict=True))
    table = pd.concat(
        likelihood.trials.assign(
            trial=prefix + likelihood.trials["trial"],
            setup_of_trial=prefix + likelihood.trials["setup"],
        )
        for prefix, likelihood in by_prefix
    )
    setups = [prefix + setup for prefix, likelihood in by_prefix for setup in likelihood.setups]
    return table, setups


def _log_likelihood(left_out: Mapping[str, LeftOut], whole: Array) -> dict[str, Array]:
    """Return the group ``log_likelihood``, whose variables add up to the log likelihood.

    Parameters
    ----------
    left_out : mapping of str to LeftOut
        Leave-one-out predictions by rig.
    whole : ndarray, shape (chain, draw)
        Log likelihood of all data.
    """
    trials = np.concatenate([left.trial_log_likelihood for left in left_out.values()], axis=-1)
    setups = np.concatenate([left.setup_log_likelihood for left in left_out.values()], axis=-1)
    trials = trials.reshape(*whole.shape, -1)
    trials /= STEP  # in place, here and below: no array of a fit is larger
    np.rint(trials, out=trials)
    trials *= STEP
    setups = setups.reshape(*whole.shape, -1)
    parts = trials.sum(axis=-1) + setups.sum(axis=-1)
    return {"friction": trials, "assembly": setups, "overlap": whole - parts}


def _made_again(
    observed: Array, left_out: Mapping[str, LeftOut], shape: tuple[int, ...]
) -> NDArray[np.float32]:
    """Return the friction of replicates of each trial given all others."""
    again = np.concatenate([left.more for left in left_out.values()], axis=-1)
    again += observed
    return _single(again, shape)


def _predicted(model: Model, prior: Array, rng: np.random.Generator) -> NDArray[np.float32]:
    """Return the prior predictive friction of the whole recording."""
    named = model.by_name(prior)
    anew = [
        likelihood.draw_observed(named, likelihood.draw_scatter(named, rng, together=True), rng)
        for likelihood in model.likelihoods
    ]
    return _single(np.concatenate(anew, axis=-1), (1, len(prior)))


def _single(values: Array, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Return predictions in single precision, which halves the file."""
    return values.reshape(*shape, -1).astype(np.float32)


def _variables(model: Model, values: Array) -> dict[str, Array]:
    """Gather ``c1[small]``, ``c1[medium]``, … of the last axis into ``c1`` over pulleys."""
    columns = dict(zip(model.names, np.moveaxis(values, -1, 0), strict=True))
    sizes = sizes_of(model.names)
    variables: dict[str, Array] = {}
    for name, column in columns.items():
        stem = name.partition("[")[0]
        everywhere = [f"{stem}[{size}]" for size in sizes]
        if sizes and set(everywhere) <= set(columns):
            variables[stem] = np.stack([columns[of_size] for of_size in everywhere], axis=-1)
        else:
            variables[name] = column
    return variables


def flat_attributes(attributes: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Flatten provenance for netCDF attributes: no mappings, and empty for null."""
    flat: dict[str, Any] = {}
    for key, value in attributes.items():
        if isinstance(value, Mapping):
            flat |= flat_attributes(value, f"{prefix}{key}.")
        elif not key.endswith("_why"):
            flat[f"{prefix}{key}"] = "" if value is None else value
    return flat


def write_csv(tree: xr.DataTree, path: Path) -> None:
    """Write the posterior as a table with one row for each draw."""
    posterior = tree["posterior"].to_dataset()
    posterior = posterior.stack(sample=("chain", "draw"))  # noqa: PD013 (not of pandas)
    columns = {}
    for name, variable in posterior.data_vars.items():
        further = [str(dim) for dim in variable.dims if dim != "sample"]
        labels = [posterior[dim].to_numpy() for dim in further]
        for label in product(*labels):
            called = f"{name}[{','.join(map(str, label))}]" if further else name_of(str(name))
            columns[called] = variable.sel(dict(zip(further, label, strict=True))).to_numpy()
    index = pd.MultiIndex.from_arrays(
        [posterior["chain"].to_numpy(), posterior["draw"].to_numpy()], names=["chain", "draw"]
    )
    pd.DataFrame(columns, index=index).to_csv(path, lineterminator="\n")
