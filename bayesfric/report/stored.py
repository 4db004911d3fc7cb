"""The stored results that a report is written from."""

from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from bayesfric.errors import Fault, InputError
from bayesfric.results import read_json, read_tree
from bayesfric.schemas import ClaimsFile, DiagnosisFile, FitFile, MarginsFile, ScorecardFile

__all__ = [
    "StoredDiagnosis",
    "StoredResults",
    "read_diagnosis",
    "read_margins",
    "read_scorecard",
    "read_stored",
]


@dataclass(frozen=True)
class StoredDiagnosis:
    """What ``bayesfric diagnose`` left in a folder.

    Parameters
    ----------
    found : DiagnosisFile
        ``diagnosis.json``.
    curves : DataTree
        ``diagnosis.nc``.
    """

    found: DiagnosisFile
    curves: xr.DataTree

    def group(self, name: str) -> xr.Dataset | None:
        """Return a group of the curves, None where there is none."""
        return self.curves[name].to_dataset() if name in self.curves.children else None


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
    diagnosis : StoredDiagnosis or None
        Where the simulation misses, where that was asked.
    scorecard : ScorecardFile or None
        How well the diagnosis does where it is not told, likewise.
    margins : MarginsFile or None
        ``margins.json``, where loops were given.
    """

    fit: FitFile
    draws: xr.DataTree
    predictive: xr.DataTree
    claims: ClaimsFile | None = None
    claim_curves: xr.DataTree | None = None
    diagnosis: StoredDiagnosis | None = None
    scorecard: ScorecardFile | None = None
    margins: MarginsFile | None = None


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
    claims, claim_curves = _claims(folder, fit)
    diagnosis = read_diagnosis(folder) if (folder / "diagnosis.json").is_file() else None
    if diagnosis is not None and diagnosis.found.recording.sha256 != fit.recording.sha256:
        raise InputError([Fault("diagnosis.json", "a diagnosis of the recording in fit.json")])
    margins = read_margins(folder) if (folder / "margins.json").is_file() else None
    if margins is not None and margins.recording.sha256 != fit.recording.sha256:
        raise InputError([Fault("margins.json", "margins over the draws of the fit in fit.json")])
    card = read_scorecard(folder)
    return StoredResults(fit, draws, predictive, claims, claim_curves, diagnosis, card, margins)


def read_diagnosis(folder: Path) -> StoredDiagnosis:
    """Read the diagnosis in a folder.

    Raises
    ------
    InputError
        A file is missing or not what ``bayesfric diagnose`` writes.
    """
    found = read_json(DiagnosisFile, folder / "diagnosis.json")
    _beside("diagnosis", folder, "diagnose")
    return StoredDiagnosis(found, read_tree(folder / "diagnosis.nc"))


def read_scorecard(folder: Path) -> ScorecardFile | None:
    """Read the scorecard in a folder, None where there is none.

    Raises
    ------
    InputError
        The file is not what ``bayesfric blind`` writes.
    """
    path = folder / "scorecard.json"
    return read_json(ScorecardFile, path) if path.is_file() else None


def read_margins(folder: Path) -> MarginsFile:
    """Read the margins in a folder.

    Raises
    ------
    InputError
        The file is missing or not what ``bayesfric margins`` writes.
    """
    return read_json(MarginsFile, folder / "margins.json")


def _claims(folder: Path, fit: FitFile) -> tuple[ClaimsFile | None, xr.DataTree | None]:
    if not (folder / "claims.json").is_file():
        return None, None
    claims = read_json(ClaimsFile, folder / "claims.json")
    if claims.recording.sha256 != fit.recording.sha256:
        raise InputError([Fault("claims.json", "claims of the recording in fit.json")])
    _beside("claims", folder, "claims")
    return claims, read_tree(folder / "claims.nc")


def _beside(name: str, folder: Path, verb: str) -> None:
    """Refuse a JSON file whose curves are not beside it."""
    if not (folder / f"{name}.nc").is_file():
        expected = f"beside {name}.json: run `bayesfric {verb} RECORDING -o {folder}` again"
        raise InputError([Fault(f"{name}.nc", expected)])
