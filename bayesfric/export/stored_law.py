"""The law of a folder of results: its numbers and draws, causes, and friction as measured."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bayesfric.arrays import Array, evenly
from bayesfric.chains import by_walker
from bayesfric.errors import Fault, InputError
from bayesfric.export.joints import ExportedJoint, joints_of, read_diagnosis
from bayesfric.observation.coefficients import NO_PULLEY, coefficient_name, law_of
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG, Coefficients
from bayesfric.physics.laws import OF_AXES
from bayesfric.results import read_beside, read_json, read_tree, refuse_mixed
from bayesfric.schemas import DiagnosisFile, FitFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import INERTIAS, Cause
from bayesfric.stored_names import by_parameter

MOST_DRAWS = 200


class Number(NamedTuple):
    """A number of the law, with its error and unit."""

    value: Interval
    unit: str


def law_said(fit: FitFile, diagnosis: DiagnosisFile) -> str:
    """Return a sentence that says to which law the numbers belong."""
    if not diagnosis.causes:
        return "Numbers of the law as it was fitted: diagnosis.json names no cause."
    names = ", ".join(cause.effect for cause in diagnosis.causes)
    said = f"Numbers of the law refitted with what diagnosis.json names: {names}."
    if alone := [name for name in _fitted(fit) if name not in _told_by_refit(fit, diagnosis)]:
        said += f" Of the law alone, since the refit does not tell it apart: {', '.join(alone)}."
    return said


def numbers_of(fit: FitFile, diagnosis: DiagnosisFile) -> dict[str, Number]:
    """Return the numbers of the law by name, from the refit if the diagnosis names a cause.

    A number that the diagnosis holds fixed, or that the refit does not determine, is that of the
    fit. A number that the data cannot determine is left out.

    Parameters
    ----------
    fit : FitFile
        Fit of the law alone.
    diagnosis : DiagnosisFile
        Diagnosis of the same recording and law.
    """
    every = _fitted(fit) | _told_by_refit(fit, diagnosis)
    return {name: number for name, number in every.items() if name not in diagnosis.untold}


def _fitted(fit: FitFile) -> dict[str, Number]:
    entries = dict(fit.parameters)
    for size, coefficients in fit.pulleys.items():
        entries |= {coefficient_name(name, size): entry for name, entry in coefficients.items()}
    return {name: Number(entry, entry.unit) for name, entry in entries.items()}


def _told_by_refit(fit: FitFile, diagnosis: DiagnosisFile) -> dict[str, Number]:
    """Return the numbers that the refit determines; none without causes.

    If two numbers are not identifiable separately, as c1 and c2 under a single load, the fit has
    one of them. The refit has both and determines neither.
    """
    alone = _fitted(fit)
    law = diagnosis.law
    apart = {_size(name) for name in law if name not in alone}
    return {
        name: Number(number.after, number.unit)
        for name, number in law.items()
        if diagnosis.causes and name in alone and _size(name) not in apart
    }


def _size(name: str) -> str:
    """Return the pulley size of a number; empty if it has none."""
    return name.partition("[")[2]


def drawn_numbers(folder: Path, fit: FitFile, diagnosis: DiagnosisFile) -> dict[str, list[float]]:
    """Return joint draws of the numbers: a subset of the posterior's.

    Parameters
    ----------
    folder : Path
        Folder with ``draws.nc`` and ``diagnosis.nc``.
    fit : FitFile
        Fit of that folder.
    diagnosis : DiagnosisFile
        Diagnosis of that folder. If it has numbers with causes, the draws are those of the
        refit, over all hypotheses; an amplitude is 0 in draws of hypotheses without the effect.
    """
    if by_refit := _told_by_refit(fit, diagnosis):
        flat = _of_refit(
            read_tree(folder / "diagnosis.nc")["law"].to_dataset(), diagnosis, by_refit
        )
    else:
        flat = by_parameter(by_walker(read_tree(folder / "draws.nc")["posterior"].to_dataset()))
    count = next(iter(flat.values())).size
    chosen = evenly(count, MOST_DRAWS)
    return {name: values[chosen].tolist() for name, values in flat.items()}


def _of_refit(
    table: xr.Dataset, diagnosis: DiagnosisFile, wanted: Collection[str]
) -> dict[str, Array]:
    """Return all draws of the refit by name."""
    flat: dict[str, Array] = {}
    for size in map(str, table["pulley"].to_numpy()):
        columns = [table[name].sel(pulley=size).to_numpy() for name in Coefficients._fields]
        names = [coefficient_name(name, size) for name in Coefficients._fields]
        flat |= dict(zip(names, columns, strict=True))
    flat = {name: values for name, values in flat.items() if name in wanted}
    scatter = [str(name) for name in table.data_vars if str(name).startswith("omega")]
    flat |= {name: table[name].to_numpy() for name in scatter}
    drawn: Mapping[str, int] = {}
    if "effect" in table.coords:
        drawn = {str(name): place for place, name in enumerate(table["effect"].to_numpy())}
    for cause in diagnosis.causes:
        if cause.effect in drawn:
            values = table["amplitude"].isel(effect=drawn[cause.effect]).to_numpy()
            flat[f"amplitude[{cause.effect}]"] = values
    return flat


ABSENT = {
    "velocity": 0.0,
    "tension": 0.0,
    "n_pulleys": 1.0,
    "wrap_angle": REFERENCE_WRAP_ANGLE_DEG,
}


@dataclass(frozen=True)
class StoredLaw:
    """The results on the friction of a recording.

    Parameters
    ----------
    name : str
        Name of the recording.
    baseline : str
        The friction law.
    unit : str
        Unit of friction.
    numbers : mapping of str to Number
        Numbers of the law by name, refitted with the causes if there are any.
    said : str
        A sentence that says to which law they belong.
    coefficients : mapping of str to Coefficients
        Their means by pulley size; the size is empty without pulleys.
    draws : mapping of str to list of float
        Joint draws of each coefficient and of the scatter; a subset of the posterior's.
    causes : tuple of Cause
        Effects that the diagnosis named.
    places : mapping of str to ndarray, shape (R,)
        ``velocity``, ``tension``, ``n_pulleys`` and ``wrap_angle`` at which friction was
        measured, as far as the rig has them.
    friction : ndarray, shape (R,)
        Friction by the law with the causes.
    measured : ndarray, shape (R,)
        Measured friction.
    trial : ndarray, shape (R,)
        Trial of each row.
    """

    name: str
    baseline: str
    unit: str
    numbers: Mapping[str, Number]
    said: str
    coefficients: Mapping[str, Coefficients]
    draws: Mapping[str, list[float]]
    causes: tuple[Cause, ...]
    places: Mapping[str, Array]
    friction: Array
    measured: Array
    trial: NDArray[Any]

    @property
    def noise(self) -> float:
        """Rms residual around the law, from the scatter of friction and the sensors."""
        return float(np.sqrt(((self.measured - self.friction) ** 2).mean()))

    def error_of(self, name: str) -> float | None:
        """Return the standard deviation of a number; None if the law has no such number.

        The constant of a law without pulleys is its Coulomb friction.
        """
        entry = name if name in self.numbers else "coulomb" if name == "c2" else ""
        return self.numbers[entry].value.sd if entry in self.numbers else None

    @property
    def tested(self) -> dict[str, tuple[float, float]]:
        """The least and the largest value of each place that the rig has."""
        return {name: (float(at.min()), float(at.max())) for name, at in self.places.items()}

    def place(self, name: str) -> Array:
        """Return the values at which friction was measured; neutral values if the rig has none."""
        place = self.places.get(name)
        return np.full(self.friction.size, ABSENT[name]) if place is None else np.nan_to_num(place)


def read_law(folder: Path) -> StoredLaw:
    """Read the law of a folder.

    Parameters
    ----------
    folder : Path
        Folder with the results of ``diagnose`` and, for pulleys, of ``fit``, for the same
        recording and law.

    Raises
    ------
    InputError
        A result is missing, the two have different recordings or laws, or a joint has no number
        to enter.
    """
    diagnosis = read_diagnosis(folder)
    curves = read_beside(diagnosis, folder / "diagnosis.nc")
    if diagnosis.baseline in OF_AXES:
        (joint,) = joints_of(diagnosis, curves)
        return _of_joint(_measured(diagnosis, curves, folder), joint)
    fit = read_json(FitFile, folder / "fit.json", "fit")
    same_law = fit.baseline == diagnosis.baseline
    if not same_law or not fit.recording.same_data(diagnosis.recording):
        expected = "a diagnosis of the recording and with the law of fit.json"
        raise InputError([Fault("diagnosis.json", expected)])
    refuse_mixed(fit, folder / "fit.json")
    law, numbers = _measured(diagnosis, curves, folder), numbers_of(fit, diagnosis)
    return replace(
        law,
        numbers=numbers,
        said=law_said(fit, diagnosis),
        coefficients=_coefficients(fit, numbers, law.friction),
        draws=drawn_numbers(folder, fit, diagnosis),
    )


def _measured(diagnosis: DiagnosisFile, curves: xr.DataTree, folder: Path) -> StoredLaw:
    """Return measured friction and its conditions, without numbers of the law."""
    rows = curves["residuals"].to_dataset()
    if "diagnosed_n" not in rows:
        expected = f"friction by the causes: run `bayesfric diagnose RECORDING -o {folder}` again"
        raise InputError([Fault("diagnosis.nc", expected)])
    rows = rows.isel(row=rows["rig"].to_numpy() == diagnosis.rigs[0])
    names = ("velocity", "tension", "n_pulleys", "wrap_angle")
    every = {name: np.asarray(rows[name].to_numpy(), dtype=np.float64) for name in names}
    return StoredLaw(
        name=diagnosis.recording.name,
        baseline=diagnosis.baseline,
        unit=diagnosis.gap.unit,
        numbers={},
        said="",
        coefficients={},
        draws={},
        causes=diagnosis.causes,
        places={name: at for name, at in every.items() if np.isfinite(at).all()},
        friction=np.asarray(rows["diagnosed_n"].to_numpy(), dtype=np.float64),
        measured=np.asarray(rows["measured_n"].to_numpy(), dtype=np.float64),
        trial=rows["trial"].to_numpy(),
    )


def _alone(name: str) -> str:
    """Return the name of a joint's number in a law that is written without its robot."""
    return "mass" if name in INERTIAS else name


def _of_joint(law: StoredLaw, joint: ExportedJoint) -> StoredLaw:
    """Return the law of a driven joint, with the numbers to enter of its diagnosis.

    Friction is their constant plus powers of speed; the residual of each row is kept. The rows'
    own `diagnosed_n` is not used, since it also contains changes of inertia and gravity.
    """
    numbers = {name: Number(given.value, given.unit) for name, given in joint.numbers.items()}
    friction = joint.friction(law.place("velocity"))
    means = {name: number.value.mean for name, number in numbers.items()}
    return replace(
        law,
        numbers={_alone(name): number for name, number in numbers.items()},
        said=joint.said,
        coefficients={NO_PULLEY: Coefficients(0.0, means.get("coulomb", 0.0), 0.0)},
        draws={_alone(name): values.tolist() for name, values in joint.draws.items()},
        friction=friction,
        measured=friction + (law.measured - law.friction),
    )


def _coefficients(
    fit: FitFile, numbers: Mapping[str, Number], friction: Array
) -> dict[str, Coefficients]:
    """Return the law of each size; a law without these numbers is a constant here.

    The correction factor of the law then describes how friction changes with speed.
    """
    means = {name: number.value.mean for name, number in numbers.items()}
    laws = {size: law_of(means, size) for size in fit.pulleys or (NO_PULLEY,)}
    if any(np.any(np.asarray(part)) for law in laws.values() for part in law):
        return laws
    constant = means.get("coulomb", float(friction.mean()))
    return dict.fromkeys(laws, Coefficients(0.0, constant, 0.0))
