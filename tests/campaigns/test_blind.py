"""What the diagnosis finds on recordings whose effect it is not told.

The fixed cases are repeated nightly and compared with the evidence. The long campaigns are
resumable; ``BAYESFRIC_BLIND_CASES=200`` runs or scores the first 200 cases, which are a
balanced sample.
"""

from functools import partial

import pytest
from campaigns import blind, evidence

from bayesfric.blind.running import run_blind
from bayesfric.campaign import run_on_processes

WORKERS = 2
LEAST_CORRECT = 12  # of 15: an engine that is right in 19 of 20 does worse once in 180 times
NAMES = [f"{seed:06d}" for seed in blind.FIXED_SEEDS]


def run_fixed(folder):
    work = partial(blind.run_fixed, folder=folder / "sealed")
    return run_on_processes(work, blind.fixed(), folder / "done", WORKERS)


def agrees(now, then):
    """Verdicts exactly; closed forms within what another machine's arithmetic moves."""
    exact = ("withheld", "form", "strength", "verdict", "causes", "correct")
    assert {key: now[key] for key in exact} == {key: then[key] for key in exact}
    assert now["noise_free_gap"] == pytest.approx(then["noise_free_gap"], rel=1e-3, abs=1e-6)
    assert now["probability"] == pytest.approx(then["probability"], abs=1e-3)
    if then["shrink"] is None:
        assert now["shrink"] is None
    else:
        for key, value in then["shrink"].items():
            assert now["shrink"][key] == pytest.approx(value, rel=1e-3, abs=1e-3)


def test_scoring_begins_after_the_seeds_that_were_looked_at(monkeypatch):
    monkeypatch.setattr(evidence, "read", lambda name: {"blind": {"seeds": [10, 49]}}[name])
    assert blind.scoring_seed() == 50


@pytest.fixture(scope="module")
def repeated(tmp_path_factory):
    return run_fixed(tmp_path_factory.mktemp("blind"))


@pytest.mark.nightly
@pytest.mark.parametrize("name", NAMES)
def test_a_fixed_case_agrees_with_the_evidence(name, repeated):
    agrees(repeated[name], evidence.read("blind_fixed")["cases"][name])


@pytest.mark.long
def test_every_fixed_case(tmp_path):
    found = run_fixed(tmp_path)
    correct = sum(case["correct"] for case in found.values())
    evidence.write(
        "blind_fixed",
        blind,
        seeds=[blind.FIXED_SEEDS.start, blind.FIXED_SEEDS.stop - 1],
        figures={"correct": correct},
        cases=found,
    )
    assert correct >= LEAST_CORRECT


@pytest.mark.long
def test_the_scorecard():
    number, first = blind.number_of(blind.whole()), blind.scoring_seed()
    folder = evidence.work(f"blind-{first}", blind)
    card = run_blind(folder, number=number, first_seed=first, workers=WORKERS)
    blind.keep(card, folder, "blind", f"BAYESFRIC_BLIND_CASES={number} make test-long")
    assert [target.name for target in card.targets if target.met is False] == []


@pytest.mark.long
def test_probabilities_come_true_as_often_as_they_say():
    number = blind.number_of(blind.PRIOR_CASES)
    folder = evidence.work("blind_prior", blind)
    card = run_blind(
        folder,
        number=number,
        first_seed=blind.PRIOR_SEED,
        from_prior=True,
        workers=WORKERS,
    )
    blind.keep(card, folder, "blind_prior", f"BAYESFRIC_BLIND_CASES={number} make test-long")
    assert [one.lower for one in card.reliability if not one.inside] == []
