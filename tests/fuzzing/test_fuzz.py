"""Some seconds of what `make fuzz` does for hours."""

import os
from pathlib import Path

import pytest
from campaigns import evidence
from fuzzing import campaign, mutants
from fuzzing.mutants import KINDS, outcome

from bayesfric.errors import Fault, InputError

CASES = {"recording": 40, "toml": 100, "json": 100, "netcdf": 30}


@pytest.mark.parametrize("kind", KINDS)
def test_mutants_are_read_or_refused(kind):
    outcomes = [outcome(kind, seed) for seed in range(CASES[kind])]
    assert set(outcomes) <= {"read", "refused"}
    assert outcomes.count("refused") > len(outcomes) / 2  # most are past reading


def test_a_fault_and_a_hang_are_noticed(monkeypatch):
    def fault(random, folder):
        raise KeyError("a fault")

    def hang(random, folder):
        while True:
            pass

    monkeypatch.setitem(KINDS, "json", fault)
    monkeypatch.setattr(mutants, "HANGS_S", 0.05)
    with pytest.raises(KeyError):
        outcome("json", 0)
    monkeypatch.setitem(KINDS, "json", hang)
    with pytest.raises(TimeoutError):
        outcome("json", 0)


def test_a_refusal_of_many_lines_is_noticed(monkeypatch):
    def refuse(random, folder):
        raise InputError([Fault("a\nb", "c")])

    monkeypatch.setitem(KINDS, "json", refuse)
    with pytest.raises(ValueError, match="several lines"):
        outcome("json", 0)


def test_the_campaign_found_no_fault():
    counts_by_kind = evidence.read("fuzz")["figures"]["mutants"]
    assert {kind: counts["faults"] for kind, counts in counts_by_kind.items()} == {
        kind: {} for kind in KINDS
    }


def test_a_mutant_that_takes_too_much_memory_is_noticed(monkeypatch):
    held, written = [100], []

    def greedy(random, folder):
        held[0] += 8
        raise InputError([Fault("a", "b")])

    monkeypatch.setattr(evidence, "names", list)  # nothing is kept: the campaign begins
    monkeypatch.setattr(evidence, "write", lambda *given: written.append(given[-1]))
    monkeypatch.setattr(campaign, "peak_mib", lambda: held[0])
    monkeypatch.setattr(campaign, "PEAK_MIB", 104)
    monkeypatch.setattr(campaign, "WHOLE", dict.fromkeys(KINDS, 1))
    monkeypatch.setattr("sys.argv", ["campaign"])
    for kind in KINDS:
        monkeypatch.setitem(KINDS, kind, greedy)
    assert campaign.main() == 1
    faults = [len(counts["faults"]) for counts in written[-1].figures["mutants"].values()]
    assert faults == [1, 0, 0, 0]


def test_the_peak_of_memory_is_between_what_is_held_now_and_what_there_is():
    page = os.sysconf("SC_PAGE_SIZE") / 2**20
    held = int(Path("/proc/self/statm").read_text().split()[1]) * page
    assert held - 1 <= campaign.peak_mib() <= os.sysconf("SC_PHYS_PAGES") * page
