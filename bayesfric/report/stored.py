"""The stored results that a report is written from."""

from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from bayesfric.errors import Fault, InputError
from bayesfric.results import read_json, read_tree
from bayesfric.schemas import ClaimsFile, FitFile

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
    claims : ClaimsFile or None
        ``claims.json``, where the claims were judged.
    claim_curves : DataTree or None
        ``claims.nc``, likewise.
    """

    fit: FitFile
    draws: xr.DataTree
    predictive: xr.DataTree
    claims: ClaimsFile | None = None
    claim_curves: xr.DataTree | None = None


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
        A file is missing or not what its verb writes, or the files are of different
        fits or recordings.
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
    if not (folder / "claims.json").is_file():
        return StoredResults(fit, draws, predictive)
    claims = read_json(ClaimsFile, folder / "claims.json")
    if claims.recording.sha256 != fit.recording.sha256:
        raise InputError([Fault("claims.json", "claims of the recording in fit.json")])
    if not (folder / "claims.nc").is_file():
        expected = f"beside claims.json: run `bayesfric claims RECORDING -o {folder}` again"
        raise InputError([Fault("claims.nc", expected)])
    return StoredResults(fit, draws, predictive, claims, read_tree(folder / "claims.nc"))
