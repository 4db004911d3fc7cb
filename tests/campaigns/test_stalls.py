"""Near-threshold boards are not biased where what did not move is an observation.

The seeds 0…59 were fixed before the first run.
"""

import pytest
from campaigns import evidence, stalls

from bayesfric.campaign import run_on_processes

LARGEST_BIAS = 0.2  # of a posterior sd
CHOSEN = 4


def run(seeds, folder):
    cases = {f"{seed:04d}": seed for seed in seeds}
    return list(run_on_processes(stalls.case, cases, folder, workers=2).values())


@pytest.mark.nightly
def test_a_few_agree_with_the_evidence(tmp_path):
    recorded = {case["seed"]: case for case in evidence.read("stalls")["cases"]}
    for now in run(range(CHOSEN), tmp_path):
        then = recorded[now["seed"]]
        assert now["at_rest"] == then["at_rest"]
        for which in ("with", "without"):
            for name, one in now[which].items():
                if name != "pareto_k":
                    assert abs(one["error"] - then[which][name]["error"]) < 0.3 * one["sd"]


@pytest.mark.long
def test_sixty_near_threshold_boards():
    cases = run(stalls.SEEDS, evidence.work("stalls", stalls))
    at_rest = sum(case["at_rest"] for case in cases) / len(cases)
    found = {which: stalls.bias(cases, which) for which in ("with", "without")}
    evidence.write(
        "stalls",
        stalls,
        seeds=[stalls.SEEDS.start, stalls.SEEDS.stop - 1],
        figures={"recordings": len(cases), "share_at_rest": at_rest} | found,
        cases=cases,
    )
    assert 0.15 < at_rest < 0.3
    for name, one in found["with"].items():
        assert abs(one["bias_in_sd"]) < LARGEST_BIAS, name
