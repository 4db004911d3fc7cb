"""Reads a stored fit, if it has the same recording and analysis."""

from pathlib import Path

from bayesfric.analysis import Analysis, settings_sha256
from bayesfric.arrays import Array
from bayesfric.chains import by_walker
from bayesfric.claims.entered import PAPER
from bayesfric.recording.tables import Recording
from bayesfric.results import read_beside, read_json, recording_id
from bayesfric.schemas import FitFile
from bayesfric.stored_names import by_parameter


def current_posterior(
    folder: Path, recording: Recording, analysis: Analysis, baseline: str = PAPER
) -> dict[str, dict[str, Array]]:
    """Return the draws of a stored fit by rig and parameter name, each of shape (S,).

    Parameters
    ----------
    folder : Path
        Folder that may contain ``fit.json`` and ``draws.nc``.
    recording : Recording
        The recording of the fit.
    analysis : Analysis
        The analysis of the fit.
    baseline : str
        The friction law, a name in :data:`bayesfric.physics.laws.BASELINES`.

    Returns
    -------
    dict of str to dict of str to ndarray
        Empty if there is no fit of this law to a single rig, or if it has not converged.
    """
    if not (folder / "fit.json").exists() or not (folder / "draws.nc").exists():
        return {}
    summary = read_json(FitFile, folder / "fit.json")
    current = (
        summary.recording == recording_id(recording)
        and summary.analysis_sha256 == settings_sha256(analysis)
        and len(summary.rigs) == 1
        and summary.baseline == baseline
        and summary.converged
    )
    if not current:
        return {}
    draws = by_walker(read_beside(summary, folder / "draws.nc")["posterior"].to_dataset())
    return {summary.rigs[0]: by_parameter(draws)}
