"""``make release-evidence`` runs what is left, writes what it found and says what was missed."""

import sys
from types import SimpleNamespace

import pytest
from campaigns import evidence, history, release
from campaigns.promises import rate


@pytest.fixture
def drops(tmp_path, monkeypatch):
    """A campaign that is alone, in an empty folder; returns the folders that it was run in."""
    ran = []

    def gather(folder):
        ran.append(folder)
        return evidence.Gathered([0, 9], {"right": 8}, list(range(10)), fixed=[0])

    campaign = SimpleNamespace(
        FINGERPRINT=("margins",),
        gather=gather,
        promises=lambda figures: [rate("it falls", figures["right"], 10, least=0.9)],
        needs=lambda: "",
    )
    monkeypatch.setattr(evidence, "EVIDENCE", tmp_path)
    monkeypatch.setattr(evidence, "CASES", tmp_path / "cases")
    monkeypatch.setattr(history, "HISTORY", tmp_path / "history.csv")
    monkeypatch.setattr(evidence, "campaign_of", lambda name: campaign)
    monkeypatch.setattr(release, "campaigns", lambda: ["drops"])
    campaign.ran = ran
    return campaign


def run(monkeypatch, *arguments):
    monkeypatch.setattr(sys, "argv", ["release", *arguments])
    return release.main()


def test_the_list_runs_nothing(drops, monkeypatch, capsys):
    assert run(monkeypatch, "--list") == 0
    assert capsys.readouterr().out.split() == ["left:", "drops", "never", "run"]
    assert drops.ran == []


def test_what_is_left_is_run_once_and_what_was_missed_is_told(drops, monkeypatch, capsys):
    assert run(monkeypatch) == 0
    assert capsys.readouterr().out.splitlines() == [
        "drops (never run)",
        "missed, drops: it falls: 0.8 (promised 0.9 to …)",
        f"nothing is left of {evidence.version()}",
    ]
    (row,) = history.read()
    assert (row["campaign"], row["value"], row["met"]) == ("drops", "0.8", "false")
    assert run(monkeypatch) == 0
    assert len(drops.ran) == 1


def test_what_cannot_be_run_here_is_left_with_the_reason(drops, monkeypatch, capsys):
    drops.needs = lambda: "a hill is needed"
    assert run(monkeypatch) == 1
    assert "never run; a hill is needed" in capsys.readouterr().out
    assert drops.ran == []


def test_a_campaign_that_there_is_not_is_told(drops, monkeypatch, capsys):
    with pytest.raises(SystemExit):
        run(monkeypatch, "drip")
    assert "no campaign drip; there are drops" in capsys.readouterr().err
