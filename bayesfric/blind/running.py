"""A campaign of blind cases, or one recording with its answer, to a scorecard."""

import json
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any, Literal

from bayesfric.analysis import Analysis, analysis_sha256
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

    Cases that are done are kept under ``blind/``, so that a campaign that was killed goes
    on where it stopped, and one of more cases continues one of fewer.

    Parameters
    ----------
    folder : Path or str
        Created if it is not there.
    engine : str
        Who makes the recordings.
    number, first_seed : int
        Of cases, and the first one's seed: below 10,000 for tuning, from there on for scoring.
    from_prior : bool
        Whether hypotheses are drawn from the prior that a diagnosis reports, not laid out.
    workers : int
        Processes of this machine; any number gives the same scorecard.
    scheduler : str or None
        Address of a Dask scheduler, whose workers take the place of processes.
    analysis : Analysis or None
        Of every diagnosis, but for its seed.
    so_far : bool
        Score the cases that are done, and run none.
    progress : callable or None
        Called with the cases done and the cases in all.

    Returns
    -------
    ScorecardFile
        What was written.

    Raises
    ------
    InputError
        An engine, number or seed that there is not, a scheduler that does not answer,
        nothing done where `so_far` asks for it, or a folder that cannot be written.
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
        Created if it is not there.
    recording : Recording
        What is diagnosed.
    answer : Path or str
        A JSON file, see :class:`bayesfric.blind.answers.Answer`.
    analysis : Analysis or None
        Of the diagnosis.

    Raises
    ------
    InputError
        The answer is none, or the recording has nothing to diagnose.
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
        digest = seal(place, truth, public, analysis.seed)
    diagnosis = diagnose_sealed(recording, analysis, place)
    scored = score(
        public | {"envelope_sha256": digest},
        open_envelope(place),
        diagnosis,
        gap=None,
        true_shrink=None,
        oracle_power=None,
        effect_names=all_effects(),
    )
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
    """Return where the cases of a campaign are kept, however many it has."""
    catalogue = catalogue_of(campaign.engine)
    key = {
        "engine": campaign.engine,
        "catalogue": [sorted(catalogue.effects.items()), catalogue.outsiders],
        "design": campaign.design,
        "hypotheses": campaign.hypotheses,
        "first_seed": campaign.seed,  # what a seed's case is depends on where the campaign begins
        "analysis_sha256": analysis_sha256(analysis),
        "versions": package_versions(),
    }
    return case_folder(folder, CASES, key)


def _done(cases: Mapping[str, BlindCase], kept: Path) -> dict[str, BlindCase]:
    """Return the cases that are done, of which there has to be one."""
    done = {n: case for n, case in cases.items() if (kept / "scored" / f"{n}.json").is_file()}
    if not done:
        raise InputError([Fault(str(kept), "a case that is done, of these seeds")])
    return done


def _write_log(folder: Path, campaign: Campaign, analysis: Analysis, *, so_far: bool) -> None:
    """Append a line to the log of campaigns."""
    record = asdict(campaign) | {
        "scoring": campaign.scoring,
        "analysis_sha256": analysis_sha256(analysis),
        "so_far": so_far,
        "versions": package_versions(),
        "commit": _commit(),
    }
    with writable(folder):
        (folder / CASES).mkdir(parents=True, exist_ok=True)
        with (folder / CASES / LOG).open("a", encoding="utf-8") as stream:
            stream.write(json.dumps(record, sort_keys=True, allow_nan=False) + "\n")


def _commit() -> str | None:
    """Return the commit of the source tree, marked where files differ; None outside of one."""
    root = Path(__file__).resolve().parents[2]
    if not ((root / ".git").exists() and (root / "pyproject.toml").is_file()):
        return None
    command = ["git", "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    except OSError:
        return None
    return done.stdout.strip() or None
