"""What the diagnosis finds on recordings whose effect it is not told."""

import pytest
from campaigns import blind, blind_fixed, evidence


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
    return blind_fixed.run(tmp_path_factory.mktemp("blind"))


@pytest.mark.nightly
@pytest.mark.parametrize("seed", blind_fixed.SEEDS)
def test_a_fixed_case_agrees_with_the_evidence(seed, repeated):
    name = f"{seed:06d}"
    agrees(repeated[name], evidence.read("blind_fixed")["fixed"][name])
