"""The draws of a fit for an unmeasured machine, and the difference between rigs."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.special import ndtri

from bayesfric.arrays import Array
from bayesfric.chains import by_walker
from bayesfric.diagnosis.drawn_effect import DrawnEffect
from bayesfric.errors import Fault, InputError
from bayesfric.inference.diagnostics import mean_ess
from bayesfric.physics.friction import Coefficients
from bayesfric.results import read_json, read_tree, refuse_mixed
from bayesfric.schemas import ClaimsFile, FitFile
from bayesfric.schemas.base import RecordingId
from bayesfric.stored_names import name_of

MOST_DRAWS = 4000
DEFAULT_DISCREPANCY = 0.05
SCATTER_BETWEEN_BOARDS = (
    "the draws are of a board that was not measured: the scatter between boards is in them"
)


@dataclass(frozen=True)
class Posterior:
    """Draws of the friction law.

    Parameters
    ----------
    coefficients : mapping of str to Coefficients
        Coefficients by pulley size, arrays of shape (draws,).
    omega : mapping of str to ndarray, shape (draws,)
        Relative scatter of friction between assemblies, by pulley size.
    effective_draws : float
        Number of independent draws whose means would be as accurate.
    recording : RecordingId
        The data of the fit.
    analysis_sha256 : str
        SHA-256 of the settings of the fit.
    created : str or None
        Date of the fit.
    tested : mapping of str to mapping
        Least and largest value at which friction was measured, by size and axis; empty if the
        file does not say.
    informed : mapping of str to set of str
        Coefficients that the recording informs, by size; empty if the file does not say.
    acting : tuple of DrawnEffect
        Effects on friction beside the law; their draws match those of the law.
    refitted : bool
        Whether the law is that of a diagnosis, fitted together with the effects.
    omega_intercept : mapping of str to ndarray, shape (draws,)
        Relative scatter of c2 alone from assembly to assembly, by pulley size; empty if the fit
        has none.
    """

    coefficients: Mapping[str, Coefficients]
    omega: Mapping[str, Array]
    effective_draws: float
    recording: RecordingId
    analysis_sha256: str
    created: str | None
    tested: Mapping[str, Mapping[str, tuple[float, float]]] = field(default_factory=dict)
    informed: Mapping[str, frozenset[str]] = field(default_factory=dict)
    acting: tuple[DrawnEffect, ...] = ()
    refitted: bool = False
    omega_intercept: Mapping[str, Array] = field(default_factory=dict)

    @property
    def count(self) -> int:
        """Number of draws."""
        return int(np.size(next(iter(self.coefficients.values())).c1))


@dataclass(frozen=True)
class RigDiscrepancy:
    """The difference in friction between rigs.

    Parameters
    ----------
    sd : float
        Relative standard deviation.
    source : str
        Source of this value, in words.
    """

    sd: float
    source: str


def read_posterior(path: Path, tree: xr.DataTree | None = None) -> Posterior:
    """Read ``draws.nc``, thinned evenly to at most 4,000 draws.

    Parameters
    ----------
    path : Path
        The file that ``bayesfric fit`` wrote.
    tree : DataTree or None
        Its content, if already read.

    Raises
    ------
    InputError
        The file is missing, is not netCDF, or has no draws of c1, c2 and c3.
    """
    tree = read_tree(path) if tree is None else tree
    fit_beside(path)
    fault = Fault(path.name, "draws of a fit: c1, c2, c3 over chain, draw and pulley, and omega")
    if "posterior" not in tree.children:
        raise InputError([fault])
    table = by_walker(tree["posterior"].to_dataset())
    dimensions = {"chain", "draw", "pulley"}
    if not (set(Coefficients._fields) <= set(table.data_vars) and dimensions <= set(table.sizes)):
        raise InputError([fault])
    few = thinned(table)
    coefficients = coefficients_of(few)
    omega, omega_intercept = (
        _scatter(few, kind, coefficients) for kind in ("omega", "omega_intercept")
    )
    if set(omega) != set(coefficients):
        raise InputError([fault])
    values = [*omega.values(), *omega_intercept.values()]
    values += [np.asarray(c) for law in coefficients.values() for c in law]
    if not all(np.isfinite(part).all() for part in values):
        raise InputError([Fault(path.name, "draws that are finite numbers")])
    return Posterior(
        coefficients,
        omega,
        min(float(values[0].size), effective_draws(table)),
        **_origin(tree.attrs, path),
        tested=_tested(tree.attrs),
        informed={
            str(key).removeprefix("informed."): frozenset(str(value).split())
            for key, value in tree.attrs.items()
            if str(key).startswith("informed.")
        },
        omega_intercept=omega_intercept,
    )


def fit_beside(draws: Path) -> FitFile | None:
    """Return the fit of draws, if its file is beside them.

    Raises
    ------
    InputError
        It belongs to other draws.
    """
    path = draws.with_name("fit.json")
    if not path.is_file():
        return None
    fit = read_json(FitFile, path)
    refuse_mixed(fit, path)
    return fit


def _scatter(table: xr.Dataset, kind: str, sizes: Iterable[str]) -> dict[str, Array]:
    """Return a scatter of assemblies by pulley size; of the motor board if it is alone."""
    names = {name_of(name): name for name in map(str, table.data_vars)}
    motor_alone = not any(name.partition("[")[0] == "omega" for name in names)
    return {
        size: _flat(table, names[name], size)
        for size in sizes
        # that of one size, where there is one, replaces that of all
        for name in ((f"{kind}_motor",) if motor_alone else (kind, f"{kind}[{size}]"))
        if name in names
    }


def thinned(table: xr.Dataset) -> xr.Dataset:
    """Return evenly spaced draws of each chain, at most 4,000 in all."""
    stride = max(1, -(-table.sizes["chain"] * table.sizes["draw"] // MOST_DRAWS))
    return table.isel(draw=slice(None, None, stride))


def coefficients_of(table: xr.Dataset) -> dict[str, Coefficients]:
    """Return c1, c2 and c3 by pulley size, arrays of shape (draws,)."""
    return {
        size: Coefficients(*(_flat(table, name, size) for name in Coefficients._fields))
        for size in map(str, table["pulley"].to_numpy())
    }


def _origin(attributes: Mapping[Any, Any], path: Path) -> dict[str, Any]:
    """Return the fields that say where draws come from, of the attributes of their file."""
    recording = RecordingId(
        name=str(attributes.get("recording.name", path.name)),
        title=str(attributes.get("recording.title", "")),
        sha256=str(attributes.get("recording.sha256", "")),
        rig_sha256=str(attributes.get("recording.rig_sha256", "")),
    )
    return {
        "recording": recording,
        "analysis_sha256": str(attributes.get("analysis_sha256", "")),
        "created": str(attributes.get("created", "")) or None,
    }


def _flat(table: xr.Dataset, name: str, size: str) -> Array:
    column = table[name]
    column = column.sel(pulley=size) if "pulley" in column.dims else column
    return np.asarray(column.transpose("chain", "draw").to_numpy(), dtype=np.float64).ravel()


def _tested(attributes: Mapping[Any, Any]) -> dict[str, dict[str, tuple[float, float]]]:
    """Return the tested ranges by size and axis, from the attributes of ``draws.nc``."""
    ranges: dict[str, dict[str, tuple[float, float]]] = {}
    for key, value in attributes.items():
        head, _, rest = str(key).partition(".")
        if head == "tested":
            size, _, axis = rest.rpartition(".")
            low, high = (float(end) for end in np.asarray(value, dtype=np.float64))
            ranges.setdefault(size, {})[axis] = (low, high)
    return ranges


def effective_draws(table: xr.Dataset) -> float:
    """Return the smallest effective number of draws of any coefficient."""
    least = np.inf
    ensemble = table["ensemble"].to_numpy() if "ensemble" in table.coords else np.zeros(1)
    count = len(np.unique(ensemble))
    for name in Coefficients._fields:
        column = table[name].transpose("pulley", "chain", "draw").to_numpy()
        chains, steps = column.shape[1:]
        for draws in column:
            if steps < 20 or chains % count:
                least = min(least, draws.size)
                continue
            least = min(least, mean_ess(draws.reshape(count, -1, steps).transpose(0, 2, 1)))
    return float(least)


def rig_discrepancy(folder: Path) -> RigDiscrepancy:
    """Return the difference between rigs, from ``claims.json`` if it is beside the draws.

    The standard deviation is the rms of the difference between the boards' friction, over pulley
    sizes and over its posterior. So it includes the uncertainty of the difference.

    Parameters
    ----------
    folder : Path
        Folder of ``draws.nc``.

    Raises
    ------
    InputError
        ``claims.json`` is damaged.
    """
    if (folder / "claims.json").is_file():
        for claim in read_json(ClaimsFile, folder / "claims.json").claims:
            if claim.id == "rigs-agree" and "difference" in claim.figures:
                return RigDiscrepancy(
                    _rms_difference(claim.figures),
                    "rms difference between the boards, by rigs-agree in claims.json",
                )
    return RigDiscrepancy(
        DEFAULT_DISCREPANCY,
        "no comparison of two boards lies beside the draws; 5 % is assumed, as the paper's "
        "“within 5 % mostly, 10 % at most”",
    )


def _rms_difference(figures: Mapping[str, object]) -> float:
    """Return the rms of the boards' relative difference, from its quantiles by size."""
    low, middle, high = (
        np.array(list(by_size.values()))
        for name in ("difference_q05", "difference", "difference_q95")
        if isinstance(by_size := figures[name], dict)
    )
    return float(np.sqrt(np.mean(middle**2 + ((high - low) / (2 * ndtri(0.95))) ** 2)))


def read_draws(path: Path) -> tuple[Posterior, RigDiscrepancy]:
    """Read ``draws.nc`` of the fit of one board or of several, and the difference of a machine.

    After a fit of several boards, the machine of the loop is a further board of their population.
    Its coefficients are those of ``new_board`` in ``predictive.nc``. Its assemblies scatter as
    those of one of the boards, each with the same probability.

    Parameters
    ----------
    path : Path
        The file that ``bayesfric fit`` wrote; for several boards, with ``predictive.nc`` and
        ``boards/`` beside it.

    Raises
    ------
    InputError
        A file is missing or was not written by a fit.
    """
    tree = read_tree(path)
    population = tree.children.get("posterior")
    if population is None or "board" not in population.sizes:
        return read_posterior(path, tree), rig_discrepancy(path.parent)
    fit_beside(path)
    boards = [
        read_posterior(path.parent / "boards" / str(name) / "draws.nc")
        for name in population["board"].to_numpy()
    ]
    predictive = path.with_name("predictive.nc")
    new = read_tree(predictive).children.get("new_board")
    if new is None:
        raise InputError([Fault(str(predictive), "new_board, of a fit of several boards")])
    coefficients = coefficients_of(thinned(new.to_dataset()))
    count = int(np.size(next(iter(coefficients.values())).c1))
    posterior = replace(
        boards[0],
        coefficients=coefficients,
        omega=_taking_turns([board.omega for board in boards], count),
        omega_intercept=_taking_turns([board.omega_intercept for board in boards], count),
        effective_draws=min(float(count), effective_draws(population.to_dataset())),
        **_origin(tree.attrs, path),
        tested={
            size: _widest([board.tested.get(size, {}) for board in boards]) for size in coefficients
        },
        informed={
            size: frozenset().union(*(board.informed.get(size, frozenset()) for board in boards))
            for size in coefficients
        },
    )
    return posterior, RigDiscrepancy(0.0, SCATTER_BETWEEN_BOARDS)


def _taking_turns(boards: Sequence[Mapping[str, Array]], count: int) -> dict[str, Array]:
    """Return draws from the boards in turn, by pulley size, for the sizes that all of them have."""
    draw, by_size = np.arange(count), {}
    for size in boards[0]:
        if all(size in board for board in boards):
            least = min(board[size].size for board in boards)
            draws = np.stack([board[size][:least] for board in boards])
            by_size[size] = draws[draw % len(boards), draw // len(boards) % least]
    return by_size


def _widest(
    boards: Sequence[Mapping[str, tuple[float, float]]],
) -> dict[str, tuple[float, float]]:
    """Return, by axis, the range in which any board was tested."""
    axes = dict.fromkeys(axis for ranges in boards for axis in ranges)
    ends = {axis: [ranges[axis] for ranges in boards if axis in ranges] for axis in axes}
    return {axis: (min(a for a, _ in e), max(b for _, b in e)) for axis, e in ends.items()}
