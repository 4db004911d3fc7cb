"""Wander along the travel is recovered as when the evidence was made."""

import pytest
from campaigns import evidence, wander


@pytest.mark.nightly
def test_the_first_recording_is_that_of_the_evidence():
    for then in evidence.read("wander")["fixed"]:
        now = wander.case(then["seed"])
        assert now["converged"]
        assert now["ranks"] == pytest.approx(then["ranks"], abs=0.1)


def test_figures_by_hand():
    """Of two recordings one rank is inside, and one fit converged."""
    done = [
        {"converged": rank == 0.5, "ranks": dict.fromkeys(wander.NAMES, rank)}
        for rank in (0.5, 0.99)
    ]
    figures = wander.figures(done)
    assert (figures["wander"], figures["converged"], figures["recordings"]) == (0.5, 1, 2)
