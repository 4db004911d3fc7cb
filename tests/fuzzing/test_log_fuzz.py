"""Altered logs of every kind are imported or refused, and nothing else."""

import pytest
from fuzzing.log_mutants import LOG_KINDS
from fuzzing.mutants import outcome

SOME, THOROUGH = 50, 2000


@pytest.mark.parametrize("kind", LOG_KINDS)
def test_mutants_of_a_log_are_imported_or_refused(kind):
    ends = [outcome(kind, seed, LOG_KINDS) for seed in range(SOME)]
    assert set(ends) <= {"read", "refused"}
    assert "refused" in ends  # they are not all alike


@pytest.mark.nightly
@pytest.mark.parametrize("kind", LOG_KINDS)
def test_many_mutants_of_a_log_are_imported_or_refused(kind):
    ends = [outcome(kind, seed, LOG_KINDS) for seed in range(THOROUGH)]
    assert set(ends) <= {"read", "refused"}
