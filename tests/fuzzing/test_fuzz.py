"""Some seconds of what `make fuzz` does for hours."""

import pytest
from campaigns import evidence
from fuzzing import mutants
from fuzzing.mutants import KINDS, outcome

from bayesfric.errors import InputError

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
        from bayesfric.errors import Fault

        raise InputError([Fault("a\nb", "c")])

    monkeypatch.setitem(KINDS, "json", refuse)
    with pytest.raises(ValueError, match="several lines"):
        outcome("json", 0)


def test_the_campaign_found_no_fault():
    found = evidence.read("fuzz")["figures"]
    assert {kind: one["faults"] for kind, one in found.items()} == {kind: {} for kind in KINDS}
