"""What is drawn for a new assembly: coefficients of the friction law and numbers of the loop.

The posterior of c1, c2, c3 says how well the law of the measured boards is known. A
machine that is built tomorrow scatters around that law as assemblies of the board did
(omega), and differs from it as one rig differs from another.
"""

import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from pydantic import BaseModel
from scipy.special import ndtri

from bayesfric.errors import Fault, InputError
from bayesfric.inference.diagnostics import mean_ess
from bayesfric.inference.priors import from_normal
from bayesfric.margins.loop_file import Loop
from bayesfric.margins.quantities import central, is_uncertain
from bayesfric.physics.friction import Coefficients
from bayesfric.results import read_json, read_tree, refuse_mixed
from bayesfric.schemas import ClaimsFile, FitFile, RecordingId

__all__ = [
    "Assembly",
    "Posterior",
    "RigDiscrepancy",
    "draw_assembly",
    "nominal_assembly",
    "read_posterior",
    "rig_discrepancy",
]

Array = NDArray[np.float64]

MOST_DRAWS = 4000
DEFAULT_DISCREPANCY = 0.05
COEFFICIENTS = "c1, c2, c3"
NEW_ASSEMBLY = "new assembly and rig"


@dataclass(frozen=True)
class Posterior:
    """Draws of the friction law.

    Parameters
    ----------
    coefficients : mapping of str to Coefficients
        By pulley size, arrays of shape (draws,).
    omega : mapping of str to ndarray, shape (draws,)
        Relative scatter of friction between assemblies, by pulley size.
    effective_draws : float
        Independent draws whose means would be as well known.
    recording : RecordingId
        The data behind them.
    analysis_sha256 : str
        The settings behind them.
    created : str or None
        Their date.
    tested : mapping of str to mapping
        Size to axis to the least and largest value at which friction was measured; empty
        where the draws do not say.
    informed : mapping of str to set of str
        Size to the coefficients that the recording informs, likewise.
    """

    coefficients: Mapping[str, Coefficients]
    omega: Mapping[str, Array]
    effective_draws: float
    recording: RecordingId
    analysis_sha256: str
    created: str | None
    tested: Mapping[str, Mapping[str, tuple[float, float]]] = field(default_factory=dict)
    informed: Mapping[str, frozenset[str]] = field(default_factory=dict)

    @property
    def count(self) -> int:
        """Number of draws."""
        return int(np.size(next(iter(self.coefficients.values())).c1))


@dataclass(frozen=True)
class RigDiscrepancy:
    """How far one rig's friction may be from another's.

    Parameters
    ----------
    sd : float
        Relative standard deviation.
    source : str
        Where that comes from, in words.
    """

    sd: float
    source: str


@dataclass(frozen=True)
class Assembly:
    """Everything that the margins depend on, a value a draw.

    Parameters
    ----------
    coefficients : mapping of str to Coefficients
        Of the law, by pulley size, shape (draws,).
    factor : tuple of ndarray
        What multiplies the friction of each run of the loop, shape (draws,).
    numbers : mapping of str to ndarray
        Dotted key of the loop file to values, shape (draws,).
    uncertain : tuple of str
        Which of these keys are distributions.
    """

    coefficients: Mapping[str, Coefficients]
    factor: tuple[Array, ...]
    numbers: Mapping[str, Array]
    uncertain: tuple[str, ...]

    @property
    def draws(self) -> int:
        """Number of draws."""
        return self.factor[0].size

    def __getitem__(self, key: str) -> Array:
        return self.numbers[key]

    @property
    def groups(self) -> tuple[str, ...]:
        """What can vary alone: the law, the assembly, and each uncertain number."""
        return (COEFFICIENTS, NEW_ASSEMBLY, *self.uncertain)

    def with_group(self, group: str, other: "Assembly") -> "Assembly":
        """Return this assembly with one group taken from another."""
        if group == COEFFICIENTS:
            return replace(self, coefficients=other.coefficients)
        if group == NEW_ASSEMBLY:
            return replace(self, factor=other.factor)
        return replace(self, numbers={**self.numbers, group: other.numbers[group]})

    def taken(self, rows: NDArray[np.intp]) -> "Assembly":
        """Return some of the draws."""
        return replace(
            self,
            coefficients={
                size: Coefficients(*(np.asarray(part)[rows] for part in one))
                for size, one in self.coefficients.items()
            },
            factor=tuple(part[rows] for part in self.factor),
            numbers={key: values[rows] for key, values in self.numbers.items()},
        )


def read_posterior(path: Path) -> Posterior:
    """Read ``draws.nc``, thinned evenly to at most 4,000 draws.

    Parameters
    ----------
    path : Path
        What ``bayesfric fit`` wrote.

    Raises
    ------
    InputError
        The file is missing, is not netCDF, or has no draws of c1, c2 and c3.
    """
    tree = read_tree(path)
    fit = path.with_name("fit.json")
    if fit.is_file():
        refuse_mixed(read_json(FitFile, fit), fit)
    fault = Fault(path.name, "draws of a fit: c1, c2, c3 over chain, draw and pulley, and omega")
    if "posterior" not in tree.children:
        raise InputError([fault])
    table = tree["posterior"].to_dataset()
    omegas = {name: name for name in map(str, table.data_vars) if name.partition("[")[0] == "omega"}
    dimensions = {"chain", "draw", "pulley"}
    if not ({"c1", "c2", "c3"} <= set(table.data_vars) and dimensions <= set(table.sizes)):
        raise InputError([fault])
    if not omegas and "omega_motor" in table.data_vars:
        omegas = {"omega": "omega_motor"}  # a fit of the motor board alone
    if not omegas:
        raise InputError([fault])
    stride = max(1, -(-table.sizes["chain"] * table.sizes["draw"] // MOST_DRAWS))
    thinned = table.isel(draw=slice(None, None, stride))

    def flat(name: str, size: str) -> Array:
        column = thinned[name]
        column = column.sel(pulley=size) if "pulley" in column.dims else column
        return np.asarray(column.transpose("chain", "draw").to_numpy(), dtype=np.float64).ravel()

    sizes = [str(size) for size in table["pulley"].to_numpy()]
    coefficients = {
        size: Coefficients(*(flat(name, size) for name in Coefficients._fields)) for size in sizes
    }
    own = {size: f"omega[{size}]" if f"omega[{size}]" in omegas else "omega" for size in sizes}
    omega = {size: flat(omegas.get(own[size], own[size]), size) for size in sizes}
    values = [*omega.values(), *(np.asarray(c) for one in coefficients.values() for c in one)]
    if not all(np.isfinite(one).all() for one in values):
        raise InputError([Fault(path.name, "draws that are finite numbers")])
    attributes = tree.attrs
    return Posterior(
        coefficients,
        omega,
        min(float(values[0].size), _effective(table)),
        RecordingId(
            name=str(attributes.get("recording.name", path.name)),
            title=str(attributes.get("recording.title", "")),
            sha256=str(attributes.get("recording.sha256", "")),
        ),
        str(attributes.get("analysis_sha256", "")),
        str(attributes.get("created", "")) or None,
        _tested(attributes),
        {
            str(key).removeprefix("informed."): frozenset(str(value).split())
            for key, value in attributes.items()
            if str(key).startswith("informed.")
        },
    )


def _tested(attributes: Mapping[Any, Any]) -> dict[str, dict[str, tuple[float, float]]]:
    """Return the tested ranges by size and axis, from the attributes of ``draws.nc``."""
    found: dict[str, dict[str, tuple[float, float]]] = {}
    for key, value in attributes.items():
        head, _, rest = str(key).partition(".")
        if head == "tested":
            size, _, axis = rest.rpartition(".")
            low, high = (float(one) for one in np.asarray(value, dtype=np.float64))
            found.setdefault(size, {})[axis] = (low, high)
    return found


def _effective(table: xr.Dataset) -> float:
    """Return the smallest effective number of draws of any coefficient."""
    least = np.inf
    ensemble = table["ensemble"].to_numpy() if "ensemble" in table.coords else np.zeros(1)
    count = len(np.unique(ensemble))
    for name in Coefficients._fields:
        column = table[name].transpose("pulley", "chain", "draw").to_numpy()
        chains, steps = column.shape[1:]
        for one in column:
            if steps < 20 or chains % count:
                least = min(least, one.size)
                continue
            least = min(least, mean_ess(one.reshape(count, -1, steps).transpose(0, 2, 1)))
    return float(least)


def rig_discrepancy(folder: Path) -> RigDiscrepancy:
    """Return how far rigs differ, from ``claims.json`` where that lies beside the draws.

    The standard deviation is the rms of the difference between the boards' friction, over
    pulley sizes and its posterior: boards that are alike by an uncertain calibration may
    still differ.

    Parameters
    ----------
    folder : Path
        Of ``draws.nc``.

    Raises
    ------
    InputError
        ``claims.json`` is there and damaged.
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
    """Return the rms of the boards' relative difference, by size given with its quantiles."""
    low, middle, high = (
        np.array(list(by_size.values()))
        for name in ("difference_q05", "difference", "difference_q95")
        if isinstance(by_size := figures[name], dict)
    )
    return float(np.sqrt(np.mean(middle**2 + ((high - low) / (2 * ndtri(0.95))) ** 2)))


def _quantities(loop: Loop) -> dict[str, object]:
    """Return every number of a loop file that may be uncertain, by its dotted key."""
    found: dict[str, object] = {"stiction_ratio": loop.stiction_ratio}
    sections: dict[str, BaseModel] = {
        name: getattr(loop, name)
        for name in ("joint", "drive", "cable", "controller", "compensation", "kick", "tool")
    }
    for place, run in enumerate(loop.runs):
        found[f"runs.{place}.tension_n"] = run.tension_n
    for name, section in sections.items():
        for key, value in section:
            number = isinstance(value, float | int) and not isinstance(value, bool)
            if number or is_uncertain(value):
                found[f"{name}.{key}"] = value
    return found


def draw_assembly(
    loop: Loop, posterior: Posterior, discrepancy: RigDiscrepancy, seed: int, stream: int = 0
) -> Assembly:
    """Draw new assemblies of a loop, one for each draw of the posterior.

    Parameters
    ----------
    loop : Loop
        Its uncertain numbers are drawn independently.
    posterior : Posterior
        In the order of the file for stream 0, shuffled for others.
    discrepancy : RigDiscrepancy
        Common to all runs of one machine; each run has an assembly factor of its own.
    seed : int
        Of the analysis.
    stream : int
        Number of the sample; different streams are independent.

    Raises
    ------
    InputError
        A pulley size of the loop is not in the draws.
    """
    sizes = set(posterior.coefficients)
    faults = [
        Fault(
            loop.name,
            f"a size of the draws: {', '.join(sorted(sizes))}",
            column=f"runs.{place}.pulley_size",
            value=run.pulley_size,
        )
        for place, run in enumerate(loop.runs)
        if run.pulley_size not in sizes
    ]
    if faults:
        raise InputError(faults)
    n = posterior.count

    def generator(key: str) -> np.random.Generator:
        # a stream of its own for each number, so that one more leaves the others alone
        name = f"{loop.name}/{key}"
        return np.random.default_rng([seed, 7, stream, zlib.crc32(name.encode())])

    order = generator("order").permutation(n) if stream else np.arange(n)
    coefficients = {
        size: Coefficients(*(np.asarray(part)[order] for part in one))
        for size, one in posterior.coefficients.items()
    }
    rig = discrepancy.sd * generator("rig").standard_normal(n)
    factor = tuple(
        1
        + posterior.omega[run.pulley_size][order]
        * generator(f"assembly.{place}").standard_normal(n)
        + rig
        for place, run in enumerate(loop.runs)
    )
    numbers, uncertain = {}, []
    for key, value in _quantities(loop).items():
        if is_uncertain(value):
            uncertain.append(key)
            numbers[key] = from_normal(value, generator(key).standard_normal(n))  # type: ignore[arg-type]
        else:
            numbers[key] = np.full(n, central(value))  # type: ignore[arg-type]
    return Assembly(coefficients, factor, numbers, tuple(uncertain))


def nominal_assembly(loop: Loop, posterior: Posterior) -> Assembly:
    """Return one draw: posterior means, no scatter, medians of the uncertain numbers."""
    return Assembly(
        {
            size: Coefficients(*(np.array([np.mean(np.asarray(part))]) for part in one))
            for size, one in posterior.coefficients.items()
        },
        tuple(np.ones(1) for _ in loop.runs),
        {key: np.array([central(value)]) for key, value in _quantities(loop).items()},  # type: ignore[arg-type]
        (),
    )
