"""One case: made, sealed, diagnosed, its verdict written, and only then opened and scored."""

from dataclasses import replace
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from bayesfric.analysis import Analysis
from bayesfric.blind.design import BlindCase, Catalogue
from bayesfric.blind.envelope import open_envelope, seal
from bayesfric.blind.noise_free import CleanCase
from bayesfric.blind.scoring import score
from bayesfric.diagnosis import diagnose
from bayesfric.effects import all_effects
from bayesfric.errors import Fault, InputError, one_of
from bayesfric.files import write_whole
from bayesfric.recording.tables import Recording
from bayesfric.results import json_bytes
from bayesfric.schemas import DiagnosisFile

ENGINES = {
    "reference": "bayesfric.blind.engines.reference",
    "mujoco": "bayesfric.blind.engines.mujoco_board",
}
"""Realities of another hand, by name."""
VERDICT = "verdict.json"


def engine_of(name: str) -> Any:
    """Return an engine's module.

    Raises
    ------
    InputError
        There is no such engine, or what it needs is not installed.
    """
    if name not in ENGINES:
        expected = one_of(sorted(ENGINES), name)
        raise InputError([Fault("command line", expected, column="--engine", value=name)])
    if name == "mujoco" and find_spec("mujoco") is None:
        expected = 'an installation with MuJoCo: pip install ".[mujoco]" in a clone'
        raise InputError([Fault("command line", expected, column="--engine", value=name)])
    return import_module(ENGINES[name])


def catalogue_of(engine: str) -> Catalogue:
    """Return what an engine can withhold."""
    module = engine_of(engine)
    effects = {}
    for name in module.effect_names():
        forms = [bool(form.own) for form in module.forms(name)]
        effects[str(name)] = (any(forms), not all(forms))
    return Catalogue(effects, tuple(module.outsider_names()))


def run_case(case: BlindCase, folder: Path, analysis: Analysis) -> dict[str, Any]:
    """Run one case.

    Parameters
    ----------
    case : BlindCase
        What is withheld, and the seed.
    folder : Path
        Gains a folder of the case's name, with its envelope and its verdict. Workers on
        other machines write to their own folder of this name, if it is not shared.
    analysis : Analysis
        Of the diagnosis; the seed is the case's.

    Returns
    -------
    dict
        A :class:`~bayesfric.schemas.ScoredCase` as plain JSON types.
    """
    engine = engine_of(case.engine)
    withheld = engine.Withheld(case.kind, case.effects, case.form)
    made = engine.make(withheld, case.seed, design=case.design)
    # Not a word of an engine's own about its recording reaches the diagnosis.
    recording = replace(made.recording, name=case.name, title="A blind case", metadata={})
    public = {
        "name": case.name,
        "seed": case.seed,
        "engine": case.engine,
        "design": case.design,
        "recording_sha256": recording.sha256,
    }
    place = folder / case.name
    digest = seal(place, made.truth, public, case.seed)
    diagnosis = diagnose_sealed(recording, analysis.model_copy(update={"seed": case.seed}), place)
    gap, shrink, power = 0.0, None, None
    if case.effects:
        clean = partial(engine.make, withheld, case.seed, design=case.design, noise=False)
        alone = CleanCase(clean(beside=False).recording, analysis)
        gap, power = alone.gap, alone.oracle_power()
        # Causes shrink the gap of the whole recording, small amounts of other effects included.
        whole = CleanCase(clean().recording, analysis)
        shrink = whole.shrink([(cause.effect, cause.law) for cause in diagnosis.causes])
    scored = score(
        public | {"envelope_sha256": digest},
        open_envelope(place),
        diagnosis,
        gap=gap,
        true_shrink=shrink,
        oracle_power=power,
        effect_names=all_effects(),
    )
    result: dict[str, Any] = scored.model_dump(mode="json")
    return result


def diagnose_sealed(recording: Recording, analysis: Analysis, place: Path) -> DiagnosisFile:
    """Diagnose a recording whose answer is sealed, and write the verdict beside it."""
    diagnosis = diagnose(recording, analysis).summary
    write_whole(place / VERDICT, json_bytes(diagnosis))
    return diagnosis
