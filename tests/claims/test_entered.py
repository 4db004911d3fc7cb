"""Whose data enter, and which law is claimed: the same for every verb, or refused."""

import pytest
from typer.testing import CliRunner

from bayesfric.claims import check_claims, registered
from bayesfric.claims.entered import Entered
from bayesfric.cli import app
from bayesfric.errors import InputError
from bayesfric.recording import write_recording
from bayesfric.rigs.base import Unsupported
from bayesfric.simulate import simulate_recording


@pytest.fixture(scope="module")
def both():
    return simulate_recording("quick", seed=4)


def test_data_are_of_each_rig_of_each_size_and_of_two_rigs(both):
    names = set(Entered.of(both).data)
    sizes = ("small", "medium", "large")
    by_size = {f"{rig}/{size}" for rig in ("gravity", "motor") for size in sizes}
    assert names == {"gravity", "motor", "gravity+motor", "motor+gravity"} | by_size


def test_a_claim_takes_the_rig_that_moves_as_it_needs(both):
    entered = Entered.of(both)
    taken = {
        claim.name: claim.subject(entered) for claim in registered() if claim.regime is not None
    }
    assert taken.pop("no-viscous-motor") == "motor"
    assert taken.pop("rigs-agree") == taken.pop("rigs-mostly-agree") == "gravity+motor"
    assert set(taken.values()) == {"gravity"}


def test_a_rig_that_was_not_asked_for_is_said_to_be_left_out(both):
    checked = check_claims(both, only=["no-viscous-motor"], rigs=["gravity"])
    (result,) = checked.summary.claims
    assert (result.verdict, result.reason) == ("not-testable", "The motor board was left out.")
    assert checked.summary.rigs == ("gravity",)


@pytest.mark.nightly
def test_a_rival_that_a_rig_cannot_show_makes_the_claim_not_testable_with_the_reason(
    both, monkeypatch
):
    reason = "Nothing moves here."

    def unable(_, effect):
        return Unsupported(reason) if effect.name == "stribeck" else None

    monkeypatch.setattr(type(Entered.of(both).trials("gravity")), "supports", unable)
    lacking = {claim.name: claim.untestable(Entered.of(both)) for claim in registered()}
    assert lacking.pop("no-stribeck") == reason
    assert set(lacking.values()) == {""}


def test_the_law_that_is_claimed_is_the_baseline(both):
    tasks = [
        task for claim in registered() for task in claim.tasks(Entered.of(both, law="recursive"))
    ]
    assert {task.hypothesis.law for task in tasks} == {"recursive", "no-wrap", "bearing-load"}
    summary = check_claims(both, only=["nominal-tension"], baseline="recursive").summary
    assert summary.baseline == "recursive"


@pytest.mark.parametrize("asked", [{"rigs": ["crane"]}, {"baseline": "newton"}])
def test_what_there_is_not_is_refused(both, asked):
    with pytest.raises(InputError, match=r"crane|newton"):
        check_claims(both, only=["nominal-tension"], **asked)


@pytest.mark.parametrize("asked", [("--rigs", "crane"), ("--baseline", "newton")])
def test_the_verb_hands_on_what_is_asked(small_recording, tmp_path, asked):
    write_recording(small_recording, tmp_path / "board")
    refused = CliRunner().invoke(
        app, ["claims", str(tmp_path / "board"), "-o", str(tmp_path / "out"), *asked]
    )
    assert refused.exit_code == 2
    assert asked[1] in refused.output
    assert not (tmp_path / "out" / "claims.json").exists()
