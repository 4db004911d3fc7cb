"""A campaign: sealed before it is diagnosed, resumed after a stop, the same in any order."""

import hashlib
import json
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import pytest
from blind.verdicts import diagnosed

from bayesfric import campaign
from bayesfric.analysis import Analysis
from bayesfric.blind import case as one_case
from bayesfric.blind import running
from bayesfric.blind.answers import AXES, WithheldEffect, read_answer
from bayesfric.blind.engines.reference import Made
from bayesfric.campaign import run_campaign
from bayesfric.diagnosis.discrepancy import SHARED_AXES
from bayesfric.errors import InputError
from bayesfric.results import read_json
from bayesfric.rigs.gravity_board.rows import GravityRows
from bayesfric.schemas import ScorecardFile
from bayesfric.simulate import simulate_recording

RECORDING = simulate_recording("quick", seed=3)


class Engine:
    """Recordings that say nothing; the truth is what was asked for."""

    def __init__(self):
        self.diagnosed = []

    def Withheld(self, kind, effects, form):
        return effects

    def effect_names(self):
        return ("viscous", "runout")

    def forms(self, name):
        return (SimpleNamespace(own=True), SimpleNamespace(own=False))

    def outsider_names(self):
        return ("wave",)

    def make(self, withheld, seed, *, design, noise=True, beside=True):
        effects_of_truth = [
            {"name": name, "form": "plain", "own": True, "strength": s, "axes": ["order"]}
            for name, s in withheld
        ]
        return Made(RECORDING, {"withheld": effects_of_truth})


@pytest.fixture
def engine(monkeypatch):
    """A campaign in threads, with a stand-in for what takes long."""
    engine = Engine()

    def diagnose(recording, analysis):
        engine.diagnosed.append((recording, analysis.seed))
        names = ("viscous",) if analysis.seed % 2 else ()
        summary = diagnosed(
            "named" if names else "no-gap",
            names,
            seed=analysis.seed,
            verdict_probability=0.9 + 0.0001 * (analysis.seed % 100),
        )
        return SimpleNamespace(summary=summary)

    def in_threads(work, cases, results, workers, progress):
        with ThreadPoolExecutor(workers) as executor:
            return run_campaign(work, cases, results, executor, progress)

    clean = SimpleNamespace(gap=0.03, shrink=lambda causes: 0.98, oracle_power=lambda: 0.9)
    monkeypatch.setattr(one_case, "engine_of", lambda name: engine)
    monkeypatch.setattr(one_case, "diagnose", diagnose)
    monkeypatch.setattr(one_case, "CleanCase", lambda recording, analysis: clean)
    monkeypatch.setattr(campaign, "run_on_processes", in_threads)
    return engine


def kept(folder):
    (only,) = [path for path in (folder / "blind").iterdir() if path.is_dir()]
    return only


def test_the_envelope_is_sealed_before_the_diagnosis(engine, monkeypatch, tmp_path):
    diagnose, seen = one_case.diagnose, []

    def watching(recording, analysis):
        place = kept(tmp_path) / f"{analysis.seed:06d}"
        sealed = hashlib.sha256((place / "envelope.json").read_bytes()).hexdigest()
        seen.append(json.loads((place / "case.json").read_text())["envelope_sha256"] == sealed)
        assert not (place / "verdict.json").exists()
        return diagnose(recording, analysis)

    monkeypatch.setattr(one_case, "diagnose", watching)
    running.run_blind(tmp_path, number=4)
    assert seen == [True] * 4
    assert all((kept(tmp_path) / f"01000{k}" / "verdict.json").is_file() for k in range(4))


def test_the_diagnosis_is_told_nothing(engine, tmp_path):
    running.run_blind(tmp_path, number=3)
    for recording, seed in engine.diagnosed:
        assert (recording.name, recording.title) == (f"{seed:06d}", "A blind case")
        assert recording.metadata == {}
        assert recording.sha256 == RECORDING.sha256
    public = json.loads((kept(tmp_path) / "010001" / "case.json").read_text())
    assert set(public) == {
        *("name", "seed", "engine", "design", "recording_sha256", "envelope_sha256"),
    }


def test_any_number_of_workers_gives_the_same_bytes(engine, tmp_path):
    running.run_blind(tmp_path / "one", number=12, workers=1)
    running.run_blind(tmp_path / "four", number=12, workers=4)
    by_a_worker, by_four = (tmp_path / name / "scorecard.json" for name in ("one", "four"))
    assert by_a_worker.read_bytes() == by_four.read_bytes()
    assert read_json(ScorecardFile, by_a_worker).planned == 12


def test_a_campaign_goes_on_where_it_stopped(engine, tmp_path):
    running.run_blind(tmp_path, number=5)
    assert len(engine.diagnosed) == 5
    (kept(tmp_path) / "scored" / "010002.json").unlink()  # it was killed on the way
    engine.diagnosed.clear()
    card = running.run_blind(tmp_path, number=8)
    assert [seed for _, seed in engine.diagnosed] == [10_002, 10_005, 10_006, 10_007]
    assert [case.seed for case in card.cases] == list(range(10_000, 10_008))


def test_what_is_done_is_scored_without_a_new_case(engine, tmp_path):
    running.run_blind(tmp_path, number=5)
    engine.diagnosed.clear()
    card = running.run_blind(tmp_path, number=600, so_far=True)
    assert engine.diagnosed == []
    assert (len(card.cases), card.planned) == (5, 600)
    with pytest.raises(InputError, match="expected a case that is done"):
        running.run_blind(tmp_path / "empty", so_far=True)


def test_cases_of_another_analysis_are_not_taken(engine, tmp_path):
    running.run_blind(tmp_path, number=2)
    running.run_blind(tmp_path, number=2, from_prior=True)
    analysis = Analysis.model_validate({"priors": {"c1": {"family": "half-normal", "scale": 1}}})
    running.run_blind(tmp_path, number=2, analysis=analysis)
    assert len(engine.diagnosed) == 6


def test_a_seed_of_another_campaign_is_another_case(engine, tmp_path):
    first = running.run_blind(tmp_path, number=4, first_seed=1)
    later = running.run_blind(tmp_path, number=2, first_seed=3)
    assert later.cases[0].seed == first.cases[2].seed
    assert len(engine.diagnosed) == 6
    fresh = running.run_blind(tmp_path / "fresh", number=2, first_seed=3)
    assert [case.withheld for case in later.cases] == [case.withheld for case in fresh.cases]


def test_every_campaign_is_logged(engine, tmp_path):
    running.run_blind(tmp_path, number=2, first_seed=3)
    running.run_blind(tmp_path, number=3)
    lines = (tmp_path / "blind" / "log.jsonl").read_text().splitlines()
    entries = [json.loads(line) for line in lines]
    assert [(e["seed"], e["planned"], e["scoring"]) for e in entries] == [
        (3, 2, False),
        (10_000, 3, True),
    ]
    assert all("commit" in entry for entry in entries)


def answer_of(folder, text):
    path = folder / "answer.json"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "expected an answer as"),
        ('{"withheld": [{"nam": "viscous"}]}', "withheld.0.nam"),
        ('{"withheld": [{"name": "wave"}]}', "expected the axes along which 'wave' shows"),
        ('{"withheld": [{"name": "wave", "axes": ["up"]}]}', "found 'up', expected one of veloc"),
        ('{"withheld": [{"name": "slip"}, {"name": "slip"}]}', "expected each effect once"),
        ('{"withheld": [{"name": "slip", "strength": -1}]}', "withheld.0.strength"),
    ],
)
def test_a_bad_answer_is_told_and_nothing_is_written(engine, tmp_path, text, said):
    with pytest.raises(InputError, match=r"^answer\.json") as error:
        running.score_recording(tmp_path / "out", RECORDING, answer_of(tmp_path, text))
    assert said in str(error.value)
    assert not (tmp_path / "out").exists()
    assert engine.diagnosed == []


def test_a_users_recording_is_scored_against_its_answer(engine, tmp_path):
    answer = answer_of(tmp_path, '{"withheld": [{"name": "viscous", "own": true}]}')
    analysis = Analysis(seed=1)
    card = running.score_recording(tmp_path / "out", RECORDING, answer, analysis)
    (case,) = card.cases
    assert (case.withheld, case.correct, case.noise_free_gap) == (("viscous",), True, None)
    assert card.recording.sha256 == RECORDING.sha256
    (place,) = (tmp_path / "out" / "blind").iterdir()
    sealed = json.loads((place / "envelope.json").read_text())["truth"]
    assert sealed == read_answer(answer)
    nothing = answer_of(tmp_path, '{"withheld": []}')
    card = running.score_recording(tmp_path / "out", RECORDING, nothing, analysis)
    assert card.cases[0].falsely_named


def test_the_documented_answer_is_one_and_its_table_has_all_keys(tmp_path):
    text = (Path(__file__).parents[2] / "docs" / "blind.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```json\n(.*?)```", text, flags=re.DOTALL)
    assert read_answer(answer_of(tmp_path, example))["withheld"][0]["name"] == "viscous"
    keys = set(re.findall(r"^\| `(\w+)` \|", text, flags=re.MULTILINE))
    assert keys == set(WithheldEffect.model_fields)
    lacking = "required for an effect that bayesfric does not have"
    (axes,) = re.findall(rf"^\| `axes` \|.*{lacking}: (.*) \|$", text, flags=re.MULTILINE)
    assert tuple(re.findall(r"`(\w+)`", axes)) == AXES


def test_an_answer_may_name_every_axis_of_a_remainder():
    assert set(AXES) == {*SHARED_AXES, *GravityRows.trial_axes, "rig"}
