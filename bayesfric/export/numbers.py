"""The numbers of a stored law of pulleys, with or without effects, and their draws."""

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from bayesfric.arrays import Array, evenly
from bayesfric.chains import by_walker
from bayesfric.observation.coefficients import coefficient_name
from bayesfric.physics.friction import Coefficients
from bayesfric.results import read_tree
from bayesfric.schemas import DiagnosisFile, FitFile
from bayesfric.schemas.base import Interval
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
