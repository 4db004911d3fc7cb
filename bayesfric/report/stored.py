"""The stored results that a report is written from."""

from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from bayesfric.errors import Fault, InputError
from bayesfric.results import read_json, read_tree
from bayesfric.schemas import FitFile

__all__ = ["StoredResults", "read_stored"]


@dataclass(frozen=True)
class StoredResults:
    """What the verbs left in a folder.

    Parameters
    ----------
    fit : FitFile
        ``fit.json``.
    draws, predictive : DataTree
        ``draws.nc`` and ``predictive.nc``.
    """

    fit: FitFile
    draws: xr.DataTree
    predictive: xr.DataTree


def read_stored(folder: Path) -> StoredResults:
    """Read the results in a folder.

    Parameters
    ----------
    folder : Path
        Where ``bayesfric fit`` wrote.

    Returns
    -------
    StoredResults
        All of one fit.

    Raises
    ------
    InputError
        A file is missing or not what ``bayesfric fit`` writes, or the files are of
        different fits.
    """
    missing = [
        Fault(name, f"in {folder}: run `bayesfric fit RECORDING -o {folder}` first")
        for name in ("fit.json", "draws.nc", "predictive.nc")
        if not (folder / name).is_file()
    ]
    if missing:
        raise InputError(missing)
    fit = read_json(FitFile, folder / "fit.json")
    draws = read_tree(folder / "draws.nc")
    if (draws.attrs.get("recording.sha256"), draws.attrs.get("analysis_sha256")) != (
        fit.recording.sha256,
        fit.analysis_sha256,
    ):
        raise InputError([Fault("draws.nc", "the draws of the fit in fit.json")])
    predictive = read_tree(folder / "predictive.nc")
    if not {"coefficients", "densities", "ranks"} <= set(predictive.children):
        expected = f"what this version predicts: run `bayesfric fit RECORDING -o {folder}` again"
        raise InputError([Fault("predictive.nc", expected)])
    return StoredResults(fit, draws, predictive)
