"""Runs a campaign of blind cases, or one recording with its answer, and writes a scorecard."""

import json
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any, Literal

from bayesfric.analysis import Analysis, settings_sha256
from bayesfric.blind.answers import read_answer
from bayesfric.blind.case import catalogue_of, diagnose_sealed, run_case
from bayesfric.blind.design import SCORING_FROM, BlindCase, cases_from_prior, cases_of
from bayesfric.blind.envelope import open_envelope, seal
from bayesfric.blind.scorecard import Campaign, scorecard_of
from bayesfric.blind.scoring import score
from bayesfric.campaign import case_folder, run_cases
from bayesfric.effects import all_effects
from bayesfric.errors import Fault, InputError, writable
from bayesfric.recording.tables import Recording
from bayesfric.results import package_versions, recording_id, replace_outputs
from bayesfric.schemas import ScorecardFile
from bayesfric.schemas.scorecard import ScoredCase

CASES = "blind"
"""Folder of the cases beside ``scorecard.json``."""
LOG = "log.jsonl"


def run_blind(
    folder: Path | str,
    *,
    engine: str = "reference",
    number: int = 30,
    first_seed: int = SCORING_FROM,
    from_prior: bool = False,
    workers: int = 1,
    scheduler: str | None = None,
    analysis: Analysis | None = None,
    so_far: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> ScorecardFile:
    """Diagnose recordings whose effect is withheld, and write ``scorecard.json``.

    Finished cases are kept under ``blind/``. So an interrupted campaign continues where it
    stopped, and a campaign of more cases continues one of fewer.

    Parameters
    ----------
    folder : Path or str
        Created if needed.
    engine : str
        The engine that makes the recordings.
    number, first_seed : int
        Number of cases, and seed of the first: below 10,000 for tuning, else for scoring.
    from_prior : bool
        Whether hypotheses are drawn from the prior of a diagnosis, not from a fixed design.
    workers : int
        Number of processes on this machine; it does not affect the scorecard.
    scheduler : str or None
        Address of a Dask scheduler, whose workers replace the processes.
    analysis : Analysis or None
        Settings of every diagnosis, except its seed.
    so_far : bool
        Score the finished cases, and run none.
    progress : callable or None
        Called with the number of finished cases and the number of all cases.

    Returns
    -------
    ScorecardFile
        The scorecard, as written.

    Raises
    ------
    InputError
        An unknown engine, an invalid number or seed, a scheduler that does not answer, no
        finished case with `so_far`, or a folder that cannot be written.
    """
    folder, analysis = Path(folder), Analysis() if analysis is None else analysis
    campaign, cases = _laid_out(engine, number, first_seed, from_prior)
    kept = _kept(folder, campaign, analysis)
    cases = _done(cases, kept) if so_far else cases
    _write_log(folder, campaign, analysis, so_far=so_far)
    work = partial(run_case, folder=kept, analysis=analysis)
    scored = run_cases(work, cases, kept / "scored", workers, scheduler, progress)
    scorecard = scorecard_of([*map(_read, scored.values())], campaign, analysis)
    replace_outputs(folder, {"scorecard.json": scorecard})
    return scorecard


def score_recording(
    folder: Path | str,
    recording: Recording,
    answer: Path | str,
    analysis: Analysis | None = None,
) -> ScorecardFile:
    """Seal a user's answer, diagnose the recording, open the answer, and write the scorecard.

    Parameters
    ----------
    folder : Path or str
        Created if needed.
    recording : Recording
        The recording to diagnose.
    answer : Path or str
        A JSON file, see :class:`bayesfric.blind.answers.Answer`.
    analysis : Analysis or None
        Settings of the diagnosis.

    Raises
    ------
    InputError
        The answer is invalid, or the recording has nothing to diagnose.
    """
    folder, analysis = Path(folder), Analysis() if analysis is None else analysis
    truth = read_answer(Path(answer))
    public = {
        "name": recording.name,
        "seed": analysis.seed,
        "engine": "user",
        "design": "user",
        "recording_sha256": recording.sha256,
    }
    place = folder / CASES / f"user-{recording.sha256[:12]}"
    with writable(folder):
        seal(place, truth, public, analysis.seed)
    diagnosis = diagnose_sealed(recording, analysis, place)
    scored = score(*open_envelope(place), diagnosis, effect_names=all_effects())
    campaign = Campaign("user", "user", "user", analysis.seed, planned=1)
    scorecard = scorecard_of([scored], campaign, analysis, recording_id(recording))
    replace_outputs(folder, {"scorecard.json": scorecard})
    return scorecard


def _read(scored: Mapping[str, Any]) -> ScoredCase:
    return ScoredCase.model_validate_json(json.dumps(scored))


def _laid_out(
    engine: str, number: int, first_seed: int, from_prior: bool
) -> tuple[Campaign, dict[str, BlindCase]]:
    """Return a campaign with its cases by name."""
    lay_out = cases_from_prior if from_prior else cases_of
    cases = lay_out(catalogue_of(engine), number, first_seed, engine=engine)
    design = next(iter(cases.values())).design
    hypotheses: Literal["prior", "design"] = "prior" if from_prior else "design"
    return Campaign(engine, design, hypotheses, first_seed, number), cases


def _kept(folder: Path, campaign: Campaign, analysis: Analysis) -> Path:
    """Return the folder of the cases of a campaign, which does not depend on their number."""
    catalogue = catalogue_of(campaign.engine)
    key = {
        "engine": campaign.engine,
        "catalogue": [sorted(catalogue.effects.items()), catalogue.outsiders],
        "design": campaign.design,
        "hypotheses": campaign.hypotheses,
        "first_seed": campaign.seed,  # the case of a seed depends on the first seed of the campaign
        "analysis_sha256": settings_sha256(analysis),
        "versions": package_versions(),
    }
    return case_folder(folder, CASES, key)


def _done(cases: Mapping[str, BlindCase], kept: Path) -> dict[str, BlindCase]:
    """Return the finished cases; raise if there is none."""
    done = {n: case for n, case in cases.items() if (kept / "scored" / f"{n}.json").is_file()}
    if not done:
        raise InputError([Fault(str(kept), "a case that is done, of these seeds")])
    return done


def _write_log(folder: Path, campaign: Campaign, analysis: Analysis, *, so_far: bool) -> None:
    """Append a line to the log of campaigns."""
    record = asdict(campaign) | {
        "scoring": campaign.scoring,
        "analysis_sha256": settings_sha256(analysis),
        "so_far": so_far,
        "versions": package_versions(),
        "commit": _commit(),
    }
    with writable(folder):
        (folder / CASES).mkdir(parents=True, exist_ok=True)
        with (folder / CASES / LOG).open("a", encoding="utf-8") as stream:
            stream.write(json.dumps(record, sort_keys=True, allow_nan=False) + "\n")


def _commit() -> str | None:
    """Return the commit of the source tree, marked if files differ; None outside of a tree."""
    root = Path(__file__).resolve().parents[2]
    if not ((root / ".git").exists() and (root / "pyproject.toml").is_file()):
        return None
    command = ["git", "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    except OSError:
        return None
    return done.stdout.strip() or None
