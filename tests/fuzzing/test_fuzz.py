"""Some seconds of what `make fuzz` does for hours."""

import numpy as np
import pytest
from campaigns import evidence
from fuzzing import campaign, mutants
from fuzzing.mutants import KINDS, outcome

from bayesfric.errors import Fault, InputError

CASES = {"recording": 40, "toml": 100, "json": 100, "netcdf": 30}


@pytest.mark.parametrize("kind", KINDS)
def test_mutants_are_read_or_refused(kind):
    found = [outcome(kind, seed) for seed in range(CASES[kind])]
    assert set(found) <= {"read", "refused"}
    assert found.count("refused") > len(found) / 2  # most are past reading


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
    found = evidence.read("fuzz")["figures"]
    assert {kind: one["faults"] for kind, one in found.items()} == {kind: {} for kind in KINDS}


def test_a_mutant_that_takes_too_much_memory_is_noticed(monkeypatch, tmp_path):
    def greedy(random, folder):
        np.ones((campaign.peak_mib() + 8) * 2**17)  # more than was ever held
        raise InputError([Fault("a", "b")])

    monkeypatch.setattr(evidence, "EVIDENCE", tmp_path)
    monkeypatch.setattr(campaign, "PEAK_MIB", campaign.peak_mib() + 4)
    monkeypatch.setattr(mutants, "HANGS_S", 60)  # a machine short of memory is slow to give it
    monkeypatch.setattr(campaign, "WHOLE", dict.fromkeys(KINDS, 1))
    monkeypatch.setattr("sys.argv", ["campaign"])
    for kind in KINDS:
        monkeypatch.setitem(KINDS, kind, greedy)
    assert campaign.main() == 1
    found = evidence.read("fuzz")["figures"]
    assert [len(one["faults"]) for one in found.values()] == [1, 0, 0, 0]
