"""The stored results that a report is written from: whatever the verbs left in a folder."""

from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

import xarray as xr

from bayesfric.errors import Fault, InputError
from bayesfric.invariants.common import intervals_ordered
from bayesfric.results import read_beside, read_json
from bayesfric.schemas import (
    CalibrationFile,
    ClaimsFile,
    ComparisonFile,
    DiagnosisFile,
    FitFile,
    MarginsFile,
    ScorecardFile,
)
from bayesfric.schemas.base import Provenance, Record

Result = TypeVar("Result", bound=Provenance)
Other = TypeVar("Other", bound=Record)


@dataclass(frozen=True)
class StoredFit:
    """What ``bayesfric fit`` left in a folder.

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


@dataclass(frozen=True)
class Stored(Generic[Result]):
    """A JSON file that a verb left in a folder, and the arrays beside it.

    Parameters
    ----------
    record : ClaimsFile or DiagnosisFile
        ``claims.json`` or ``diagnosis.json``.
    curves : DataTree
        ``claims.nc`` or ``diagnosis.nc``.
    """

    record: Result
    curves: xr.DataTree

    def group(self, name: str) -> xr.Dataset | None:
        """Return a group of the curves, None where there is none."""
        return self.curves[name].to_dataset() if name in self.curves.children else None


StoredClaims = Stored[ClaimsFile]
StoredDiagnosis = Stored[DiagnosisFile]


@dataclass(frozen=True)
class StoredResults:
    """What the verbs left in a folder, None for a verb that did not run.

    Parameters
    ----------
    fitted : StoredFit or None
        The posterior of one recording.
    pooled : FitFile or None
        That of the population of several.
    claims : StoredClaims or None
        The paper's claims, judged.
    diagnosis : StoredDiagnosis or None
        Where the simulation misses.
    scorecard : ScorecardFile or None
        How well the diagnosis does where it is not told; of other recordings.
    margins : MarginsFile or None
        Of the loops that were given.
    calibration : CalibrationFile or None
        Whether posteriors of simulated recordings hold their truths.
    comparison : ComparisonFile or None
        What changed since another run.
    """

    fitted: StoredFit | None = None
    pooled: FitFile | None = None
    claims: StoredClaims | None = None
    diagnosis: StoredDiagnosis | None = None
    scorecard: ScorecardFile | None = None
    margins: MarginsFile | None = None
    calibration: CalibrationFile | None = None
    comparison: ComparisonFile | None = None

    @property
    def records(self) -> dict[str, Provenance]:
        """The results of this recording, by file, the fit first."""
        records: dict[str, Provenance] = {}
        if self.fitted is not None:
            records["fit.json"] = self.fitted.fit
        if self.pooled is not None:
            records["fit.json"] = self.pooled
        if self.diagnosis is not None:
            records["diagnosis.json"] = self.diagnosis.record
        if self.claims is not None:
            records["claims.json"] = self.claims.record
        if self.margins is not None:
            records["margins.json"] = self.margins
        return records


def read_stored(folder: Path) -> StoredResults:
    """Read the results in a folder.

    Parameters
    ----------
    folder : Path
        Where the verbs wrote.

    Returns
    -------
    StoredResults
        All of one recording.

    Raises
    ------
    InputError
        No result is there, a file is missing or not what its verb writes, or the files
        are of different fits or recordings.
    """

    def there(name: str) -> bool:
        return (folder / f"{name}.json").is_file()

    def read(model: type[Other], name: str) -> Other | None:
        return read_json(model, folder / f"{name}.json") if there(name) else None

    fit = _fit(folder) if there("fit") else None
    stored = StoredResults(
        fit if isinstance(fit, StoredFit) else None,
        fit if isinstance(fit, FitFile) else None,
        _stored(ClaimsFile, "claims", folder, "claims") if there("claims") else None,
        _stored(DiagnosisFile, "diagnosis", folder, "diagnose") if there("diagnosis") else None,
        read(ScorecardFile, "scorecard"),
        read(MarginsFile, "margins"),
        read(CalibrationFile, "calibration"),
    )
    records = stored.records
    if not records and stored.scorecard is None and stored.calibration is None:
        expected = f"it in {folder}, or another result: run `bayesfric fit RECORDING -o {folder}`"
        raise InputError([Fault("fit.json", expected)])
    first = next(iter(records), "")
    strange = [
        Fault(name, f"a result of the recording in {first}")
        for name, record in records.items()
        if not record.recording.same_data(records[first].recording)
    ]
    strange += [
        Fault(str(folder / name), f"quantiles as bayesfric writes them: {words}")
        for name, record in records.items()
        for words in intervals_ordered(record.model_dump(mode="json", by_alias=True))
    ]
    if strange:
        raise InputError(strange)
    return stored


def _fit(folder: Path) -> StoredFit | FitFile:
    """Return a fit of one recording with its arrays, or what is said of several."""
    _beside("fit", folder, "fit", "draws.nc", "predictive.nc")
    fit = read_json(FitFile, folder / "fit.json")
    draws = read_beside(fit, folder / "draws.nc")
    if (draws.attrs.get("recording.sha256"), draws.attrs.get("analysis_sha256")) != (
        fit.recording.sha256,
        fit.analysis_sha256,
    ):
        raise InputError([Fault("draws.nc", "the draws of the fit in fit.json")])
    predictive = read_beside(fit, folder / "predictive.nc")
    if fit.pooled is not None:
        return fit
    named = any("rig" in predictive[name].attrs for name in predictive.children)
    if not named or not {"coefficients", "densities", "ranks"} <= set(predictive.children):
        expected = f"what this version predicts: run `bayesfric fit RECORDING -o {folder}` again"
        raise InputError([Fault("predictive.nc", expected)])
    return StoredFit(fit, draws, predictive)


def _stored(model: type[Result], name: str, folder: Path, verb: str) -> Stored[Result]:
    _beside(name, folder, verb, f"{name}.nc")
    record = read_json(model, folder / f"{name}.json")
    return Stored(record, read_beside(record, folder / f"{name}.nc"))


def _beside(name: str, folder: Path, verb: str, *others: str) -> None:
    """Refuse a JSON file whose arrays are not beside it."""
    expected = f"beside {name}.json: run `bayesfric {verb} RECORDING -o {folder}` again"
    missing = [Fault(other, expected) for other in others if not (folder / other).is_file()]
    if missing:
        raise InputError(missing)
