"""Wander along the travel is recovered as often as its intervals say."""

import pytest
from campaigns import evidence, wander

from bayesfric.campaign import processes, run_campaign


@pytest.mark.long
def test_coverage_of_the_wander_on_a_hundred_recordings():
    with processes(2) as executor:
        cases = {f"{seed:04d}": seed for seed in wander.SEEDS}
        done = list(
            run_campaign(wander.case, cases, evidence.work("wander", wander), executor).values()
        )
    figures = wander.coverage(done)
    seeds = [wander.SEEDS.start, wander.SEEDS.stop - 1]
    evidence.write("wander", wander, seeds=seeds, figures=figures, cases=done)
    low, high = wander.BOUNDS
    assert all(case["converged"] for case in done)
    for name in ("wander", "wander_length"):
        assert low <= figures[name] <= high, figures
