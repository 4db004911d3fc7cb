"""The law of a folder of results: coefficients, causes, and friction where it was measured."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from bayesfric.arrays import Array
from bayesfric.errors import Fault, InputError
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG, Coefficients
from bayesfric.results import fitted_coefficients, fitted_numbers, read_json, read_tree
from bayesfric.schemas import Cause, DiagnosisFile, FitFile
from bayesfric.stored_names import name_of

__all__ = ["StoredLaw", "read_law"]

MOST_DRAWS = 200
ABSENT = {
    "velocity": 0.0,
    "tension": 0.0,
    "n_pulleys": 1.0,
    "wrap_angle": REFERENCE_WRAP_ANGLE_DEG,
}


@dataclass(frozen=True)
class StoredLaw:
    """What is known of the friction of a recording.

    Parameters
    ----------
    name : str
        Of the recording.
    baseline : str
        The friction law.
    unit : str
        Of friction.
    coefficients : mapping of str to Coefficients
        Posterior means by pulley size; the size is empty where there is no pulley.
    draws : mapping of str to list of float
        Of each coefficient and of the scatter, in step; some of the posterior's.
    causes : tuple of Cause
        Effects that the diagnosis named.
    places : mapping of str to ndarray, shape (R,)
        ``velocity``, ``tension``, ``n_pulleys`` and ``wrap_angle`` where friction was measured;
        without those that the rig has not.
    friction : ndarray, shape (R,)
        By the law with the causes.
    noise : float
        Rms of what friction's scatter and the sensors leave around it.
    """

    name: str
    baseline: str
    unit: str
    coefficients: Mapping[str, Coefficients]
    draws: Mapping[str, list[float]]
    causes: tuple[Cause, ...]
    places: Mapping[str, Array]
    friction: Array
    noise: float

    @property
    def tested(self) -> dict[str, tuple[float, float]]:
        """The least and the largest value of each place that the rig has."""
        return {name: (float(at.min()), float(at.max())) for name, at in self.places.items()}

    def place(self, name: str) -> Array:
        """Return where friction was measured; of what the rig has not, what makes no difference."""
        found = self.places.get(name)
        return np.full(self.friction.size, ABSENT[name]) if found is None else np.nan_to_num(found)


def read_law(folder: Path) -> StoredLaw:
    """Read the law of a folder.

    Parameters
    ----------
    folder : Path
        With the results of ``fit`` and of ``diagnose``, of one recording and one law.

    Raises
    ------
    InputError
        A result is missing, or the two are of different recordings or laws.
    """
    missing = [
        Fault(file, f"it in {folder}: run `bayesfric {verb} RECORDING -o {folder}`")
        for file, verb in (("fit.json", "fit"), ("diagnosis.json", "diagnose"))
        if not (folder / file).is_file()
    ]
    if missing:
        raise InputError(missing)
    fit = read_json(FitFile, folder / "fit.json")
    found = read_json(DiagnosisFile, folder / "diagnosis.json")
    if (fit.recording.sha256, fit.baseline) != (found.recording.sha256, found.baseline):
        expected = "a diagnosis of the recording and with the law of fit.json"
        raise InputError([Fault("diagnosis.json", expected)])
    rows = read_tree(folder / "diagnosis.nc")["residuals"].to_dataset()
    if "diagnosed_n" not in rows:
        expected = f"friction by the causes: run `bayesfric diagnose RECORDING -o {folder}` again"
        raise InputError([Fault("diagnosis.nc", expected)])
    rows = rows.isel(row=rows["rig"].to_numpy() == fit.rigs[0])
    names = ("velocity", "tension", "n_pulleys", "wrap_angle")
    every = {name: np.asarray(rows[name].to_numpy(), dtype=np.float64) for name in names}
    places = {name: at for name, at in every.items() if np.isfinite(at).all()}
    friction = np.asarray(rows["diagnosed_n"].to_numpy(), dtype=np.float64)
    left = rows["measured_n"].to_numpy() - friction
    return StoredLaw(
        name=fit.recording.name,
        baseline=fit.baseline,
        unit=found.gap.unit,
        coefficients=_coefficients(folder, friction),
        draws=_some_draws(read_tree(folder / "draws.nc")["posterior"].to_dataset()),
        causes=found.causes,
        places=places,
        friction=friction,
        noise=float(np.sqrt((left**2).mean())),
    )


def _coefficients(folder: Path, friction: Array) -> dict[str, Coefficients]:
    """Return the law of each size; a law that has none of these numbers is a constant here.

    The factor by which the law is corrected then says how friction changes with speed.
    """
    found = fitted_coefficients(folder)
    if any(np.any(np.asarray(each)) for each in found.values()):
        return found
    constant = fitted_numbers(folder).get("coulomb", float(friction.mean()))
    return dict.fromkeys(found, Coefficients(0.0, constant, 0.0))


def _some_draws(posterior: xr.Dataset) -> dict[str, list[float]]:
    flat: dict[str, Array] = {}
    for name, variable in posterior.data_vars.items():
        if "pulley" in variable.dims:
            for size in posterior["pulley"].to_numpy():
                flat[f"{name}[{size}]"] = variable.sel(pulley=size).to_numpy().ravel()
        else:
            flat[name_of(str(name))] = variable.to_numpy().ravel()
    count = next(iter(flat.values())).size
    chosen = np.unique(np.linspace(0, count - 1, MOST_DRAWS).astype(int))
    return {name: values[chosen].tolist() for name, values in flat.items()}
