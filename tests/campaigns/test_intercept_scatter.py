"""90 % intervals hold Table I as often as they say, however much c2 scatters.

The seeds were fixed before the first run.
"""

import pytest
from campaigns import evidence, intercept_scatter

from bayesfric.campaign import run_on_processes


def test_coverage_by_hand():
    """Of four recordings with one size, three of them inside."""
    ranks = [0.5, 0.06, 0.94, 0.99]
    done = [
        {
            "level": level,
            "r_hat": rank,
            "ranks": {"c1[a]": rank, "c2[a]": 0.5, "c3[a]": 0.01},
        }
        for level in intercept_scatter.LEVELS
        for rank in ranks
    ]
    entry = intercept_scatter.figures(done)["0.07"]
    assert entry["recordings"] == 4
    assert entry["largest_r_hat"] == 0.99
    assert entry["c1"]["coverage"] == 0.75
    assert entry["c1"]["low"] == pytest.approx(0.1941, abs=1e-4)  # of Clopper and Pearson
    assert entry["c1"]["high"] == pytest.approx(0.9937, abs=1e-4)
    assert entry["c2"]["coverage"] == 1.0
    assert entry["c3"]["coverage"] == 0.0


@pytest.mark.nightly
def test_the_first_recordings_are_those_of_the_evidence(tmp_path):
    seeds = intercept_scatter.SEEDS[:1]
    cases = intercept_scatter.cases(seeds)
    done = run_on_processes(intercept_scatter.case, cases, tmp_path, workers=2).values()
    recorded = {
        (record["seed"], record["level"]): record
        for record in evidence.read("intercept_scatter")["fixed"]
    }
    for now in done:
        then = recorded[now["seed"], now["level"]]
        for name, rank in now["ranks"].items():
            assert rank == pytest.approx(then["ranks"][name], abs=0.1), name
