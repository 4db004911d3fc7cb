"""Evidence is valid as long as the numbers that it rests on are those of now."""

import hashlib
import json

import pytest
from campaigns import check, evidence, release
from fingerprint import stored

NUMBERS = {
    "margins": {"gain": {"value": 2.0, "bound": 1e-8, "error": 0.0}},
    "claims": {"factor": {"value": -3.0, "bound": 1e-5, "error": 0.1}},
}


class Campaign:
    FINGERPRINT = ("margins",)


@pytest.fixture
def numbers(tmp_path, monkeypatch):
    """A fingerprint of two parts, and an empty folder of evidence; returns what sets a number."""
    path = tmp_path / "numbers.json"
    path.write_text(json.dumps(NUMBERS))
    monkeypatch.setattr(evidence, "EVIDENCE", tmp_path / "evidence")
    monkeypatch.setattr(evidence, "CASES", tmp_path / "evidence" / "cases")
    digest, parts = stored.digest, stored.parts
    monkeypatch.setattr(stored, "digest", lambda part: digest(part, path))
    monkeypatch.setattr(stored, "parts", lambda: parts(path))
    monkeypatch.setattr(evidence, "campaign_of", lambda name: Campaign)

    def put(part, name, value):
        contents = json.loads(path.read_text())
        contents[part][name]["value"] = value
        path.write_text(json.dumps(contents))

    put.path = path
    return put


def write(cases=(1, 2, 3)):
    gathered = evidence.Gathered([0, 2], {"n": 3}, list(cases), fixed=[1])
    evidence.write("loops", Campaign, gathered)
    return evidence.read("loops")


def test_what_is_written_is_valid_and_has_no_raw_cases(numbers):
    record = write()
    assert evidence.moved(record) == []
    assert evidence.stale_line() == ""
    assert (record["figures"], record["fixed"]) == ({"n": 3}, [1])
    assert "cases" not in record
    raw = (evidence.CASES / "loops.json").read_bytes()
    assert json.loads(raw) == [1, 2, 3]
    assert record["cases_sha256"] == hashlib.sha256(raw).hexdigest()


def test_evidence_is_stale_where_a_part_of_it_has_moved_and_no_other(numbers):
    write()
    numbers("claims", "factor", -4.0)
    assert evidence.stale_line() == ""
    numbers("margins", "gain", 2.1)
    assert evidence.moved(evidence.read("loops")) == ["margins"]
    line = "Evidence to be made again at the next release: loops (fingerprint moved: margins)\n"
    assert evidence.stale_line() == line
    numbers("margins", "gain", 2.0)
    assert evidence.stale_line() == ""


def test_a_part_that_is_gone_has_moved(numbers):
    record = write()
    numbers.path.write_text(json.dumps({"claims": NUMBERS["claims"]}))
    assert evidence.moved(record) == ["margins"]


def test_adopting_takes_the_fingerprint_of_now_and_nothing_else(numbers):
    before = write()
    numbers("margins", "gain", 2.1)
    evidence.adopt()
    after = evidence.read("loops")
    assert evidence.moved(after) == []
    assert {**after, "fingerprint": 0} == {**before, "fingerprint": 0}


def test_cases_of_other_numbers_or_another_version_are_no_cases_of_a_campaign(numbers, monkeypatch):
    now = evidence.work("loops", Campaign)
    assert now.parent == evidence.CASES
    numbers("claims", "factor", -4.0)
    assert evidence.work("loops", Campaign) == now
    numbers("margins", "gain", 2.1)
    moved = evidence.work("loops", Campaign)
    assert moved != now
    monkeypatch.setattr(evidence, "version", lambda: "9.9.9")
    assert evidence.work("loops", Campaign) not in (now, moved)


def test_a_campaign_is_left_until_it_was_run_to_its_end_for_this_version(numbers, monkeypatch):
    assert release.why_left("loops") == "never run"
    write()
    assert release.why_left("loops") == ""
    numbers("margins", "gain", 2.1)
    assert release.why_left("loops") == "fingerprint moved: margins"
    gathered = evidence.Gathered([0], {}, [], complete=False)
    evidence.write("loops", Campaign, gathered)
    assert release.why_left("loops") == "stopped on its way"
    then = evidence.version()
    monkeypatch.setattr(evidence, "version", lambda: "9.9.9")
    assert release.why_left("loops") == f"run for {then}"


def test_nightly_cases_are_those_of_what_moved_or_of_named_parts():
    """`joints` rests on the margins alone."""
    assert check.concerned(["margins"]) == ["tests/campaigns/test_joints.py"]
    with pytest.raises(SystemExit, match="no gains; it has"):
        check.concerned(["gains"])


# What is kept


@pytest.mark.parametrize("name", release.campaigns())
def test_each_campaign_rests_on_parts_that_there_are(name):
    """And evidence was made with the parts that its campaign names."""
    campaign = evidence.campaign_of(name)
    assert set(campaign.FINGERPRINT) <= set(stored.parts())
    if name in evidence.names():
        assert set(evidence.read(name)["fingerprint"]) == set(campaign.FINGERPRINT)


def test_all_evidence_is_of_a_campaign_and_is_small():
    assert set(evidence.names()) <= set(release.campaigns())
    tracked = [path for path in evidence.EVIDENCE.iterdir() if path.is_file()]
    assert sum(path.stat().st_size for path in tracked) < 300_000
